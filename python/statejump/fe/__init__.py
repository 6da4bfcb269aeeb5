# SPDX-License-Identifier: GPL-3.0-or-later
"""A finite-element model of a case in CalculiX, as a third leg beside the reduced model and the DEM."""
