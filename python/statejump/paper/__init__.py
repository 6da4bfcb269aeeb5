# SPDX-License-Identifier: GPL-3.0-or-later
"""The umbrella antenna's rib: both models of ``umbrella`` cases and what is made of them."""
