// Any bytes as a black box, and as the stream of records in an undamaged one: a recording or an error.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "blackbox/recording.hpp"
#include "client/candump_line.hpp"
#include "client/recording_json.hpp"
#include "client/recording_text.hpp"

namespace {

using namespace rc10;

void readEverything(std::span<const std::byte> image) {
  const auto recording = blackbox::Recording::parse(image);
  if (!recording) return;
  std::size_t size = client::recordingText(*recording, false).size();
  size += client::recordingJson(*recording).size();
  for (std::size_t i = 0; i < recording->size(); ++i) {
    const auto record = recording->at(i);
    size += client::recordJson(*recording, record).size();
    if (const auto* frame = std::get_if<blackbox::Frame>(&record)) {
      size += client::candumpLine(*recording, *frame).size();
    }
  }
  if (size == 0) std::abort();
}

/// A file whose header is good and whose hand-off ring begins with `stream`.
std::vector<std::byte> around(std::span<const std::byte> stream) {
  constexpr std::uint64_t kRing = 4096;
  blackbox::FileHead head;
  head.header.ring_offset = blackbox::kRingOffset;
  head.header.ring_bytes = kRing;
  head.header.history_offset = blackbox::kRingOffset + kRing;
  head.header.history_bytes = 64;
  head.header.file_bytes = head.header.history_offset + head.header.history_bytes;
  head.header.motor_count = 2;
  head.header.bus_count = 1;
  stream = stream.first(std::min<std::size_t>(stream.size(), kRing));
  head.control.head = stream.size();
  std::vector<std::byte> image(head.header.file_bytes);
  std::memcpy(image.data(), &head, sizeof head);
  if (!stream.empty()) std::memcpy(image.data() + blackbox::kRingOffset, stream.data(), stream.size());
  return image;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes{reinterpret_cast<const std::byte*>(data), size};
  readEverything(bytes);
  readEverything(around(bytes));
  return 0;
}
