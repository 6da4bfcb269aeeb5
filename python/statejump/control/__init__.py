# SPDX-License-Identifier: GPL-3.0-or-later
"""What makes a state jump smaller: studies of one parameter after the other, whatever the kind of case."""
