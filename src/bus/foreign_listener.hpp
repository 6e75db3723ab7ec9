#pragma once

#include "bus/can_frame.hpp"

namespace rc10 {

class fdCANbus;

/// Hears the data frames that no device of the bus has sent: somebody else did. Scheduler thread only.
class ForeignListener {
 public:
  ForeignListener() = default;
  ForeignListener(const ForeignListener&) = delete;
  ForeignListener& operator=(const ForeignListener&) = delete;
  virtual ~ForeignListener() = default;

  virtual void onForeign(const fdCANbus& bus, const CanFrame& frame) noexcept = 0;
};

}  // namespace rc10
