# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump figures``: Figures 13 to 16 of the paper with both models, and tests of its claims."""
