// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace statejump {

/// How a structure gets to its first equilibrium at ΔT = 0, from the reference configuration.
///
/// `stuck`: joints hold by friction where the reference configuration has them, before loads and
/// preloads act. A joint slides only as far as its limit is exceeded; its friction then is the
/// limit.
/// `frictionless`: loads and preloads act on joints without friction. Friction begins in that
/// equilibrium, without force.
///
/// A clearance joint has no contact in the reference configuration that could stick: it finds its
/// contact without friction in both.
enum class StartFriction : unsigned char { stuck, frictionless };

}  // namespace statejump
