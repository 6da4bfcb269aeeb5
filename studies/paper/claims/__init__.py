# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of the paper's statements about its Figures 13 to 16, by runs of both models.

A rule, printed beside the verdict, derives each verdict from numbers; the reason follows from verdict and numbers.
``statistics`` holds the tests, ``findings`` the input of the tests, ``verdicts`` and ``measures`` the statements, and
``page`` the page of results.
"""
