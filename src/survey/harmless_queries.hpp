#pragma once

#include <vector>

#include "bus/can_frame.hpp"

namespace rc10::survey {

/// Questions that are safe on a bus whose drives are not known: every VESC for a sign of life (PING), every
/// RobStride and CyberGear for its serial number (type 0). Neither moves, enables or sets anything.
///
/// Both are extended frames, which DJI, Damiao, LK-Tech and MyActuator drives do not listen to, and ODrives
/// only where `is_extended` is set: then they are commands to the nodes 136 to 143 and 2024 to 2027, from an
/// e-stop to a target of zero. Listen first, and do not send those for which BusSurvey::commandedBy() names a
/// node. To a VESC the second is packet 0xFD, to a CubeMars drive both are commands 0x11 and 0xFD, which do
/// not exist; to a RobStride the first is type 0 too; to a moteus they are an unknown subframe and a write of
/// no registers. No other family is asked: a standard id of one is a command of another (0x142, a question to
/// an LK-Tech or MyActuator drive, is the e-stop of ODrive's node 10; 0x7FF, Damiao's, is its firmware
/// update).
///
/// The answers are frames too. RobStride `ii` answers both under 0x0000iiFE, which commands a VESC or a
/// CubeMars drive whose id is 254: BusSurvey and DriveClaims name it, and no RobStride is asked beside it.
[[nodiscard]] std::vector<CanFrame> harmlessQueries();

/// Whether some drive's answer to this question is a command to the VESC or CubeMars drive that has frames of
/// this id: both are extended ids of 16 bits that end in the same byte, whatever the packet before it is.
[[nodiscard]] bool isAnsweredTo(CanId question, CanId drives);

}  // namespace rc10::survey
