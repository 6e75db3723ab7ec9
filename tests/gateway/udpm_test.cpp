#include <linux/filter.h>
#include <sys/socket.h>

#include <cstring>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/unique_fd.hpp"
#include "gateway/channel_filter.hpp"
#include "gateway/udpm_datagram.hpp"
#include "gateway/udpm_url.hpp"
#include "lcm_messages.hpp"

namespace rc10::gateway::test::udpm_test {
namespace {

using rc10::test::Bytes;
using testing::HasSubstr;

void append(Bytes& bytes, std::string_view text) {
  for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
}

Bytes wholeMessage(const std::string& channel, std::string_view payload) {
  const auto header = shortHeader(7);
  Bytes bytes(header.begin(), header.end());
  append(bytes, {channel.c_str(), channel.size() + 1});
  append(bytes, payload);
  return bytes;
}

Bytes fragment(std::uint8_t number, const std::string& channel, std::string_view payload) {
  Bytes bytes(kLongHeaderSize);
  append(bytes, {channel.c_str(), channel.size() + 1});
  append(bytes, payload);
  const std::string magic = "LC03";
  for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<std::byte>(magic[i]);
  bytes[17] = static_cast<std::byte>(number);
  bytes[19] = std::byte{3};
  return bytes;
}

std::string textOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(UdpmUrl, IsReadAsLiblcmReadsIt) {
  const auto url = parseUdpmUrl("udpm://239.1.2.3:4567?ttl=1&recv_buf_size=65536");
  ASSERT_TRUE(url) << url.error().message;
  EXPECT_EQ(url->groupText(), "239.1.2.3");
  EXPECT_EQ(url->port, 4567);
  EXPECT_EQ(url->ttl, 1);
  EXPECT_EQ(url->recv_buf_size, 65536);
}

TEST(UdpmUrl, HasTheDefaultsOfLcm) {
  for (const char* text :
       {"udpm://", "udpm://239.255.76.67", "udpm://:7667", "udpm://239.255.76.67:7667?ttl=0", "udpm://?"}) {
    const auto url = parseUdpmUrl(text);
    ASSERT_TRUE(url) << text;
    EXPECT_EQ(url->groupText(), "239.255.76.67");
    EXPECT_EQ(url->port, 7667);
    EXPECT_EQ(url->ttl, 0);
  }
}

TEST(UdpmUrl, SaysWhatIsWrong) {
  const struct {
    const char* url;
    const char* why;
  } cases[] = {{"memq://", "only udpm://"},
               {"tcpq://localhost", "only udpm://"},
               {"", "only udpm://"},
               {"udpm://10.0.0.1:7667", "not a multicast address"},
               {"udpm://hero.local", "not a multicast address"},
               {"udpm://239.255.76.67:70000", "port"},
               {"udpm://239.255.76.67:76x", "port"},
               {"udpm://239.255.76.67:7667?ttl=256", "option 'ttl=256'"},
               {"udpm://239.255.76.67:7667?tll=1", "option 'tll=1'"},
               {"udpm://239.255.76.67:7667?ttl", "option 'ttl'"}};
  for (const auto& [url, why] : cases) {
    const auto result = parseUdpmUrl(url);
    ASSERT_FALSE(result) << url;
    EXPECT_THAT(result.error().message, HasSubstr(why));
    EXPECT_THAT(result.error().message, HasSubstr("udpm://239.255.76.67:7667?ttl=0"));
  }
}

TEST(ParseDatagram, TakesAMessageApart) {
  const auto bytes = wholeMessage("hero.v1.command", "payload");
  const auto datagram = parseDatagram(bytes);
  EXPECT_EQ(datagram.kind, UdpmDatagram::Kind::kMessage);
  EXPECT_EQ(datagram.channel, "hero.v1.command");
  EXPECT_EQ(textOf(datagram.message), "payload");
}

TEST(ParseDatagram, TakesTheFirstFragmentApart) {
  const auto bytes = fragment(0, "hero.v1.command", "part");
  const auto datagram = parseDatagram(bytes);
  EXPECT_EQ(datagram.kind, UdpmDatagram::Kind::kFragment);
  EXPECT_EQ(datagram.channel, "hero.v1.command");
  EXPECT_EQ(parseDatagram(fragment(1, "hero.v1.command", "part")).kind, UdpmDatagram::Kind::kForeign);
}

TEST(ParseDatagram, OfEveryShorterLengthIsForeignOrShorter) {
  const auto bytes = wholeMessage("hero.v1.command", "payload");
  const std::size_t complete = kShortHeaderSize + 16;
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    const auto datagram = parseDatagram(std::span{bytes}.first(size));
    EXPECT_EQ(datagram.kind == UdpmDatagram::Kind::kMessage, size >= complete) << size;
    if (size >= complete) {
      EXPECT_EQ(datagram.message.size(), size - complete);
    }
  }
}

TEST(ParseDatagram, WithAChannelLongerThanLcmAllowsIsForeign) {
  EXPECT_EQ(parseDatagram(wholeMessage(std::string(63, 'c'), "")).kind, UdpmDatagram::Kind::kMessage);
  EXPECT_EQ(parseDatagram(wholeMessage(std::string(64, 'c'), "")).kind, UdpmDatagram::Kind::kForeign);
}

TEST(ParseDatagram, OfRandomBytesStaysWithinThem) {
  std::mt19937 random(3);  // NOLINT(cert-msc51-cpp): the same cases in every run
  for (int round = 0; round < 20'000; ++round) {
    Bytes bytes = round % 2 == 0 ? wholeMessage("ab", "cd") : fragment(0, "ab", "cd");
    for (std::size_t i = 4 + random() % 4; i < bytes.size(); ++i)
      bytes[i] = static_cast<std::byte>(random() % 3);
    bytes.resize(random() % (bytes.size() + 1));
    const auto datagram = parseDatagram(bytes);
    if (datagram.kind == UdpmDatagram::Kind::kForeign) continue;
    EXPECT_LE(datagram.channel.size() + 1 + datagram.message.size(), bytes.size());
  }
}

// A UNIX datagram socket runs the same filters; eight bytes stand for the UDP header.
class ChannelFilter : public testing::Test {
 protected:
  ChannelFilter() {
    int ends[2] = {-1, -1};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0, ends), 0);
    out_ = UniqueFd{ends[0]};
    in_ = UniqueFd{ends[1]};
  }

  void attach(const std::vector<std::string>& channels) {
    auto filter = channelFilter(channels);
    const sock_fprog program{.len = static_cast<unsigned short>(filter.size()), .filter = filter.data()};
    ASSERT_EQ(::setsockopt(in_.get(), SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof(program)), 0);
  }

  bool passes(const Bytes& datagram) {
    Bytes bytes(8);
    bytes.insert(bytes.end(), datagram.begin(), datagram.end());
    EXPECT_GE(::send(out_.get(), bytes.data(), bytes.size(), 0), 0);
    Bytes received(70'000);
    const auto size = ::recv(in_.get(), received.data(), received.size(), 0);
    if (size >= 0) {
      EXPECT_EQ(static_cast<std::size_t>(size), bytes.size()) << "whole";
    }
    return size >= 0;
  }

 private:
  UniqueFd out_;
  UniqueFd in_;
};

TEST_F(ChannelFilter, LetsTheChannelsInAndNothingElse) {
  attach({"hero.v1.command", "hero.v1.request"});
  EXPECT_TRUE(passes(wholeMessage("hero.v1.command", "12345678")));
  EXPECT_TRUE(passes(wholeMessage("hero.v1.request", "12345678")));
  EXPECT_TRUE(passes(wholeMessage("hero.v1.request", "")));
  EXPECT_TRUE(passes(fragment(0, "hero.v1.command", "12345678")));
  EXPECT_TRUE(passes(fragment(0, "hero.v1.request", "12345678")));
  for (const char* channel : {"hero.v1.state", "hero.v1.command2", "hero.v1.comman", "hero.v1.commanD",
                              "iero.v1.command", "hero.v1.response", "", "hero.v1.requests", "CAMERA"}) {
    EXPECT_FALSE(passes(wholeMessage(channel, "12345678"))) << channel;
    EXPECT_FALSE(passes(fragment(0, channel, "12345678"))) << channel;
  }
  EXPECT_FALSE(passes(fragment(1, "hero.v1.command", "12345678")));
  EXPECT_FALSE(passes({}));
  EXPECT_FALSE(passes(Bytes(40)));
}

TEST_F(ChannelFilter, LooksAtEveryByteOfNamesOfAnyLength) {
  for (std::size_t length = 1; length <= 31; ++length) {
    const std::string channel = std::string(length, 'r') + ".v1.command";
    attach({channel, std::string(length, 'r') + ".v1.request"});
    EXPECT_TRUE(passes(wholeMessage(channel, "12345678")));
    for (std::size_t i = 0; i < channel.size(); ++i) {
      auto other = channel;
      other[i] = 'Z';
      EXPECT_FALSE(passes(wholeMessage(other, "12345678"))) << other;
    }
  }
}

}  // namespace
}  // namespace rc10::gateway::test::udpm_test
