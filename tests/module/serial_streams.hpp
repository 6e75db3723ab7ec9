#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "bus/i_protocol.hpp"
#include "support/hex_bytes.hpp"

namespace rc10::test {

using Bytes = std::vector<std::uint8_t>;

inline Bytes hex(const std::string& text) { return hexBytes(text); }

inline Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// Gives bytes to a protocol in a heap buffer of exactly their size: a read past it is found by ASan.
inline void feed(I_Protocol& protocol, const std::uint8_t* begin, std::size_t size, MonotonicTime at) {
  const std::unique_ptr<std::uint8_t[]> exact(new std::uint8_t[size]);
  std::copy_n(begin, size, exact.get());
  protocol.parse_stream({exact.get(), size}, at);
}
inline void feed(I_Protocol& protocol, const Bytes& bytes, MonotonicTime at = {}) {
  feed(protocol, bytes.data(), bytes.size(), at);
}

/// Frames and noise of a protocol. `outcome(protocol)` is what it has made of a stream: something comparable.
/// Every cut into two, every byte by itself and random cuts must lead to the outcome of the whole; the
/// counters too.
template <typename MakeProtocol, typename Outcome>
void expectTheSameForEverySplit(const Bytes& stream, const MakeProtocol& make, const Outcome& outcome) {
  const auto whole = make();
  feed(*whole, stream);
  const auto same = [&](const I_Protocol& one, auto& protocol, const std::string& how) {
    EXPECT_EQ(one.counters().frames, whole->counters().frames) << how;
    EXPECT_EQ(one.counters().checksum_errors, whole->counters().checksum_errors) << how;
    EXPECT_EQ(one.counters().resync_bytes, whole->counters().resync_bytes) << how;
    EXPECT_TRUE(outcome(protocol) == outcome(*whole)) << how;
  };
  for (std::size_t cut = 0; cut <= stream.size(); ++cut) {
    const auto protocol = make();
    feed(*protocol, stream.data(), cut, {});
    feed(*protocol, stream.data() + cut, stream.size() - cut, {});
    same(*protocol, *protocol, "cut at " + std::to_string(cut));
  }
  const auto single = make();
  for (const auto byte : stream) feed(*single, Bytes{byte});
  same(*single, *single, "byte by byte");
  std::mt19937 random(20);  // the same every time
  for (int run = 0; run < 200; ++run) {
    const auto protocol = make();
    for (std::size_t at = 0; at < stream.size();) {
      const auto size = std::min<std::size_t>(random() % 23, stream.size() - at);
      feed(*protocol, stream.data() + at, size, {});
      at += size;
    }
    same(*protocol, *protocol, "random run " + std::to_string(run));
  }
}

/// Bytes from a generator, always the same for one seed.
inline Bytes noise(std::size_t size, std::uint32_t seed) {
  std::mt19937 random(seed);
  Bytes bytes(size);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

}  // namespace rc10::test
