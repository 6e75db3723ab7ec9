#pragma once

#include <string>

#include "blackbox/recording.hpp"

namespace rc10::client {

/// A recorded frame as `candump -L -x` writes it, for canplayer, log2asc and others:
/// "(1436509052.249713) can0 201#0011223344556677 R"; T: sent. A simulated bus appears under its name.
[[nodiscard]] std::string candumpLine(const blackbox::Recording& recording, const blackbox::Frame& frame);

/// The frame alone: "201#0011223344556677", "201##1001122" (FD), "12345678#R".
[[nodiscard]] std::string frameText(const blackbox::Frame& frame);

}  // namespace rc10::client
