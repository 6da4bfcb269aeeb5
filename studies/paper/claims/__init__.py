# SPDX-License-Identifier: GPL-3.0-or-later
"""What the paper says of its Figures 13 to 16, held against runs of both models.

Every verdict follows from the numbers by a rule that is printed beside it, and every reason from the verdict and
the numbers: ``statistics`` has the tests, ``findings`` what is judged, ``verdicts`` and ``measures`` the statements,
``page`` their page.
"""
