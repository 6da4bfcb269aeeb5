// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace statejump {

/// How a structure reaches its first equilibrium at ΔT = 0 from the reference configuration.
///
/// `stuck`: before loads and preloads act, joints stick in the reference configuration. A joint
/// slides only if its friction limit is exceeded; its friction then equals the limit.
/// `frictionless`: loads and preloads act on joints without friction. Friction starts in that
/// equilibrium with zero force.
///
/// A clearance joint has no contact in the reference configuration that could stick, so it finds
/// its contact without friction in both cases.
enum class StartFriction : unsigned char { stuck, frictionless };

}  // namespace statejump
