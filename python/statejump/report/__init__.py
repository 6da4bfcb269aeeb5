# SPDX-License-Identifier: GPL-3.0-or-later
"""Result files as one self-contained HTML page with a 3-D replay."""
