# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of the paper's statements about its Figures 13 to 16, by runs of both models.

A rule derives the verdict on each statement from numbers, and the page prints this rule beside the verdict.
``statistics`` holds the tests, ``findings`` the input of the tests, ``verdicts`` and ``measures`` the statements, and
``page`` the page of results.
"""
