#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bus/fake_devices.hpp"
#include "bus/fdcan_bus.hpp"
#include "bus/socket_pair.hpp"
#include "support/frame_calls.hpp"

namespace rc10::test {

inline CanFrame classic(CanId id, std::initializer_list<std::uint8_t> payload = {}) {
  return makeClassicFrame(id, std::span(payload.begin(), payload.size()));
}

/// A classic bus on one end of a socketpair, the other end of which is the wire.
class FdCanBusTest : public testing::Test {
 protected:
  void SetUp() override { frameCalls() = {}; }
  void TearDown() override { frameCalls() = {}; }

  void useFd() { bus_ = adopt(true); }

  std::unique_ptr<fdCANbus> adopt(bool fd_frames) {
    pair_ = SocketPair();
    return fdCANbus::adopt("chassis", std::move(pair_.near), fd_frames);
  }

  FakePacker& addPacker(std::uint32_t id, std::size_t frames_per_tick = 1) {
    FakePacker& packer = packers_.emplace_back("p" + std::to_string(id), CanId{id, false}, frames_per_tick);
    const auto ok = bus_->registerMotor(packer);
    EXPECT_TRUE(ok) << (ok ? "" : ok.error().message);
    return packer;
  }

  void addPackers(std::uint32_t count, std::size_t frames_per_tick = 1) {
    for (std::uint32_t id = 1; id <= count; ++id) addPacker(id, frames_per_tick);
  }

  FakeDevice& addDevice(std::string name, std::vector<FrameFilter> filters) {
    FakeDevice& device = devices_.emplace_back(std::move(name), std::move(filters));
    const auto ok = bus_->registerMotor(device);
    EXPECT_TRUE(ok) << (ok ? "" : ok.error().message);
    return device;
  }

  /// One tick's packing and sending; the ids that arrived on the wire.
  std::vector<std::uint32_t> sendTick() {
    bus_->packCommands(tick_);
    ++tick_.index;
    bus_->flush();
    return idsOnWire();
  }

  std::vector<std::uint32_t> idsOnWire() {
    std::vector<std::uint32_t> ids;
    for (const CanFrame& frame : pair_.read()) ids.push_back(frame.id.value);
    return ids;
  }

  /// Makes the kernel refuse after a few frames. A socketpair's far end must be emptied to go on.
  void shrinkSendBuffer() {
    const int minimum = 1;
    ASSERT_EQ(::setsockopt(bus_->descriptor(), SOL_SOCKET, SO_SNDBUF, &minimum, sizeof(minimum)), 0);
  }

  const BusCounters& counters() const { return bus_->counters(); }

  SocketPair pair_;
  std::unique_ptr<fdCANbus> bus_ = adopt(false);
  std::deque<FakePacker> packers_;
  std::deque<FakeDevice> devices_;
  Tick tick_;
};

}  // namespace rc10::test
