# SPDX-License-Identifier: GPL-3.0-or-later
"""Control of the jump of a node of a truss by added springs and scaled parameters."""
