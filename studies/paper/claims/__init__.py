# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of the paper's statements about its Figures 13 to 16 with runs of both models.

Every verdict follows from the numbers by a rule that is printed beside it, and every reason from the verdict and the
numbers. ``statistics`` has the tests, ``findings`` their input, ``verdicts`` and ``measures`` the statements, ``page``
their page.
"""
