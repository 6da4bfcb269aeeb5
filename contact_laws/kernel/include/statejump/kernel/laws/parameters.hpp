// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "statejump/kernel/laws/law_info.hpp"

/// Parameters shared by the laws of a joint. Each law lists those that it reads.
namespace statejump::kernel::laws::parameter {

inline constexpr LawParameter friction_coefficient{
    "friction_coefficient",    "-", 0.0, LawParameter::infinity, false, 0.0, "mu",
    "of the pair of materials"};
/// v0 must be less than v1; validate(FrictionParameters) checks that.
inline constexpr LawParameter v0{
    "v0",
    "m/s",
    0.0,
    LawParameter::infinity,
    false,
    0.0,
    "no friction up to this sliding speed",
    "Chen, Li, Tang, Wang, Mech. Sci. 12, 2021, eq. 10; value: choice"};
inline constexpr LawParameter v1{
    "v1",
    "m/s",
    0.0,
    LawParameter::infinity,
    true,
    1e-3,
    "full friction from this sliding speed on",
    "Chen, Li, Tang, Wang, Mech. Sci. 12, 2021, eq. 10; value: choice"};
inline constexpr LawParameter restitution{"restitution", "-", 0.0,           1.0,
                                          true,          1.0, "requested e", "choice: no loss"};
/// Range of the restitution e for a law that also covers e = 0, an impact without rebound.
inline constexpr LawParameter restitution_from_zero{
    "restitution", "-", 0.0, 1.0, false, 1.0, "requested e", "choice: no loss"};
inline constexpr LawParameter smallest_impact_speed{
    "smallest_impact_speed",
    "m/s",
    0.0,
    LawParameter::infinity,
    true,
    1e-6,
    "floor of the impact speed: a contact that begins slower would be damped without bound",
    "choice"};
inline constexpr LawParameter contact_length{"contact_length",
                                             "m",
                                             0.0,
                                             LawParameter::infinity,
                                             true,
                                             1e-2,
                                             "axial length of a line contact",
                                             "choice"};

}  // namespace statejump::kernel::laws::parameter
