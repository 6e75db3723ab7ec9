// Arbitrary bytes to the binary frames: content is never empty, and never longer than it may be.
#include "module/cobs_protocol.hpp"
#include "protocol_stream.hpp"

namespace {

using namespace rc10;

/// A protocol and what it has heard, as one.
class Cobs : public I_Protocol, public CobsListener {
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
  void onFrame(std::span<const std::uint8_t> content, MonotonicTime) noexcept override {
    fuzz::require(!content.empty() && content.size() <= CobsProtocol::kLongestContent);
  }

 private:
  CobsProtocol protocol_{*this};
};

std::unique_ptr<Cobs> make() { return std::make_unique<Cobs>(); }

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::streamOf({data, size}, CobsProtocol::kLongestFrame, make, [](const Cobs&) {});
  fuzz::roundTrip({data, size}, make);
  return 0;
}
