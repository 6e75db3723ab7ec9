#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "module/cobs_protocol.hpp"

namespace rc10::test {

/// A CobsProtocol that keeps the frames it has heard.
class HeardCobs final : public I_Protocol, private CobsListener {
 public:
  void parse_stream(std::span<const std::uint8_t> bytes, MonotonicTime received) noexcept override {
    protocol_.parse_stream(bytes, received);
    counters_ = protocol_.counters();
  }
  [[nodiscard]] std::size_t pack_frame(std::span<const std::uint8_t> payload,
                                       std::span<std::uint8_t> out) const noexcept override {
    return protocol_.pack_frame(payload, out);
  }
  void restart() noexcept override { protocol_.restart(); }

  /// Contents without their checksums, in order.
  [[nodiscard]] const std::vector<std::vector<std::uint8_t>>& frames() const noexcept { return frames_; }

  [[nodiscard]] static std::unique_ptr<HeardCobs> make() { return std::make_unique<HeardCobs>(); }
  /// The frame of this content; empty: it does not fit.
  [[nodiscard]] static std::vector<std::uint8_t> packed(std::span<const std::uint8_t> content) {
    std::vector<std::uint8_t> out(CobsProtocol::kLongestFrame);
    out.resize(HeardCobs{}.pack_frame(content, out));
    return out;
  }

 private:
  void onFrame(std::span<const std::uint8_t> content, MonotonicTime) noexcept override {
    frames_.emplace_back(content.begin(), content.end());
  }

  CobsProtocol protocol_{*this};
  std::vector<std::vector<std::uint8_t>> frames_;
};

}  // namespace rc10::test
