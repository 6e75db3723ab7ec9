#include "link/link_message.hpp"

#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace rc10::link::test::link_message_test {
namespace {

using Bytes = std::vector<std::byte>;

template <typename Message>
Bytes sealed(Message& message) {
  const auto bytes = seal(message);
  return {bytes.begin(), bytes.end()};
}

template <typename Message>
void setCount(Message&, std::uint32_t) {}
void setCount(Welcome& m, std::uint32_t n) { m.motor_count = n; }
void setCount(Command& m, std::uint32_t n) { m.setpoint_count = n; }
void setCount(Request& m, std::uint32_t n) { m.value_count = n; }
void setCount(Response& m, std::uint32_t n) { m.value_count = n; }
void setCount(State& m, std::uint32_t n) { m.motor_count = n; }
void setCount(Diagnostics& m, std::uint32_t n) {
  m.refusal_count = m.counter_count = m.notice_count = m.bus_count = m.duration_count = n;
}
void setCount(TraceChoice& m, std::uint32_t n) { m.signal_count = n; }
void setCount(Trace& m, std::uint32_t n) { m.signal_count = m.row_count = n; }
void setCount(Sighting& m, std::uint32_t n) { m.guess_count = n; }

template <typename Message>
constexpr std::uint32_t room() {
  if constexpr (std::is_same_v<Message, Request> || std::is_same_v<Message, Response>) return kMaxValues;
  if constexpr (std::is_same_v<Message, Diagnostics>) return kMaxBuses;
  if constexpr (std::is_same_v<Message, Hello> || std::is_same_v<Message, Event>) return 0;
  if constexpr (std::is_same_v<Message, TraceChoice> || std::is_same_v<Message, Trace>) return kMaxTraceRows;
  if constexpr (std::is_same_v<Message, Sighting>) return kMaxScanGuesses;
  return kMaxMotors;
}

// The promises of open() when it returns true.
template <typename Message>
void expectSafe(const Bytes& bytes) {
  Message message;
  if (!open(bytes, message)) return;
  EXPECT_EQ(message.header.type, Message::kType);
  EXPECT_EQ(message.header.size, bytes.size());
  EXPECT_TRUE(countsFit(message));
  EXPECT_EQ(wireSize(message), bytes.size());
}

void expectAllSafe(const Bytes& bytes) {
  expectSafe<Hello>(bytes);
  expectSafe<Welcome>(bytes);
  expectSafe<Command>(bytes);
  expectSafe<Request>(bytes);
  expectSafe<Response>(bytes);
  expectSafe<State>(bytes);
  expectSafe<Diagnostics>(bytes);
  expectSafe<Event>(bytes);
  expectSafe<TraceChoice>(bytes);
  expectSafe<Trace>(bytes);
  expectSafe<Sighting>(bytes);
}

template <typename Message>
class LinkMessage : public testing::Test {};
using Messages = testing::Types<Hello, Welcome, Command, Request, Response, State, Diagnostics, Event,
                                TraceChoice, Trace, Sighting>;
TYPED_TEST_SUITE(LinkMessage, Messages);

TYPED_TEST(LinkMessage, ComesBackAsItWasForEveryCount) {
  for (std::uint32_t count = 0; count <= room<TypeParam>(); ++count) {
    TypeParam message;
    setCount(message, count);
    const auto bytes = sealed(message);
    TypeParam copy;
    ASSERT_TRUE(open(bytes, copy)) << count;
    EXPECT_EQ(sealed(copy), bytes) << count;
  }
}

TYPED_TEST(LinkMessage, EveryOtherLengthIsRefused) {
  TypeParam message;
  setCount(message, room<TypeParam>());
  auto bytes = sealed(message);
  TypeParam copy;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ASSERT_FALSE(open(std::span{bytes}.first(size), copy)) << size;
  }
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(open(bytes, copy));
}

TYPED_TEST(LinkMessage, EveryOtherLengthIsRefusedWithAHeaderThatAgrees) {
  TypeParam message;
  setCount(message, room<TypeParam>() / 2);
  const auto bytes = sealed(message);
  Bytes padded = bytes;
  padded.resize(kMaxMessageSize + 64);
  for (std::size_t size = sizeof(Header); size < padded.size(); ++size) {
    const auto claimed = static_cast<std::uint32_t>(size);
    std::memcpy(padded.data() + offsetof(Header, size), &claimed, sizeof(claimed));
    TypeParam copy;
    ASSERT_EQ(open(std::span{padded}.first(size), copy), size == bytes.size()) << size;
  }
}

TYPED_TEST(LinkMessage, HeaderThatLiesAboutTheLengthIsRefused) {
  TypeParam message;
  auto bytes = sealed(message);
  TypeParam copy;
  for (const std::uint32_t lie : {0U, 7U, static_cast<std::uint32_t>(bytes.size() - 1),
                                  static_cast<std::uint32_t>(bytes.size() + 1), 0x7FFFFFFFU, 0xFFFFFFFFU}) {
    std::memcpy(bytes.data() + offsetof(Header, size), &lie, sizeof(lie));
    EXPECT_FALSE(open(bytes, copy)) << lie;
  }
}

TYPED_TEST(LinkMessage, OtherTypesAreRefused) {
  TypeParam message;
  const auto original = sealed(message);
  for (std::uint32_t type = 0; type < 200; ++type) {
    auto bytes = original;
    std::memcpy(bytes.data(), &type, sizeof(type));
    TypeParam copy;
    EXPECT_EQ(open(bytes, copy), static_cast<MessageType>(type) == TypeParam::kType);
  }
}

TYPED_TEST(LinkMessage, CountBeyondItsRoomIsRefusedAtAnyLength) {
  if (room<TypeParam>() == 0) return;
  for (const std::uint32_t count : {room<TypeParam>() + 1, 1000U, 0x01000000U, 0x80000000U, 0xFFFFFFFFU}) {
    TypeParam message;
    setCount(message, count);
    EXPECT_FALSE(countsFit(message));
    EXPECT_LE(wireSize(message), sizeof(message));
    const auto bytes = sealed(message);
    TypeParam copy;
    EXPECT_FALSE(open(bytes, copy)) << count;
  }
}

TYPED_TEST(LinkMessage, CountThatAShortDatagramDoesNotCarryIsNotTakenFromThePreviousMessage) {
  TypeParam message;
  setCount(message, room<TypeParam>());
  TypeParam reused = message;  // with all its elements
  struct {
    Header header;
  } stub{{TypeParam::kType, sizeof(Header)}};
  Bytes bytes(sizeof(Header));
  std::memcpy(bytes.data(), &stub, sizeof(stub));
  EXPECT_FALSE(open(bytes, reused));
}

TYPED_TEST(LinkMessage, ChangedBytesNeverOpenIntoSomethingUnsafe) {
  std::mt19937 random(1);  // NOLINT(cert-msc51-cpp): the same cases in every run
  TypeParam message;
  setCount(message, room<TypeParam>() / 2);
  const auto original = sealed(message);
  for (int round = 0; round < 3000; ++round) {
    auto bytes = original;
    // Mostly in the beginning, where the counts are.
    const std::size_t reach = round % 2 == 0 ? std::min<std::size_t>(bytes.size(), 160) : bytes.size();
    for (unsigned changes = 1 + random() % 4; changes > 0; --changes) {
      bytes[random() % reach] = static_cast<std::byte>(random());
    }
    if (round % 3 == 0) bytes.resize(random() % (bytes.size() + 1));
    expectAllSafe(bytes);
  }
}

TEST(LinkMessageProperty, RandomBytesNeverOpenIntoSomethingUnsafe) {
  std::mt19937 random(2);  // NOLINT(cert-msc51-cpp)
  constexpr std::array kTypes{MessageType::kHello,   MessageType::kCommand, MessageType::kRequest,
                              MessageType::kWelcome, MessageType::kState,   MessageType::kDiagnostics,
                              MessageType::kEvent,   MessageType::kResponse};
  for (int round = 0; round < 3000; ++round) {
    Bytes bytes(random() % (kMaxMessageSize + 32));
    for (auto& byte : bytes) byte = static_cast<std::byte>(random());
    if (bytes.size() >= sizeof(Header)) {
      // A header that agrees, or nothing behind it is ever looked at.
      const Header header{kTypes[random() % kTypes.size()], static_cast<std::uint32_t>(bytes.size())};
      std::memcpy(bytes.data(), &header, sizeof(header));
    }
    expectAllSafe(bytes);
  }
}

TEST(LinkMessageSize, GrowsWithWhatIsUsed) {
  Command command;
  EXPECT_EQ(wireSize(command), offsetof(Command, setpoints));
  command.setpoint_count = 1;
  EXPECT_EQ(wireSize(command), offsetof(Command, setpoints) + sizeof(Setpoint));
  command.setpoint_count = kMaxMotors;
  EXPECT_EQ(wireSize(command), sizeof(Command));
}

TEST(LinkMessageSize, EveryMessageFitsTheReceiveBuffer) {
  EXPECT_GE(kMaxMessageSize, sizeof(State));
  EXPECT_GE(kMaxMessageSize, sizeof(Welcome));
  EXPECT_GE(kMaxMessageSize, sizeof(Response));
  EXPECT_GE(kMaxMessageSize, sizeof(Event));
  // The kernel's default send buffer has to hold a few, or a SOCK_SEQPACKET refuses it as a whole.
  EXPECT_LT(kMaxMessageSize, 64U * 1024U);
}

TEST(LinkHeader, IsReadOnlyFromDatagramsOfItsLength) {
  Header header;
  EXPECT_FALSE(readHeader({}, header));
  const Header original{MessageType::kHello, sizeof(Header)};
  Bytes bytes(sizeof(Header));
  std::memcpy(bytes.data(), &original, sizeof(original));
  EXPECT_TRUE(readHeader(bytes, header));
  EXPECT_EQ(header.type, MessageType::kHello);
  EXPECT_FALSE(readHeader(std::span{bytes}.first(7), header));
}

TEST(Text, KeepsWhatFits) {
  const Text<8> text{"seven77"};
  EXPECT_EQ(text.view(), "seven77");
  EXPECT_EQ(Text<8>{}.view(), "");
}

TEST(Text, EqualsByWhatIsBeforeItsEnd) {
  Text<8> text{"arm"};
  text.chars[5] = 'x';
  EXPECT_TRUE(text.equals(Text<8>{"arm"}));
  EXPECT_FALSE(text.equals(Text<8>{"arms"}));
  EXPECT_FALSE((Text<8>{"arms"}.equals(text)));
}

// Bytes of a stranger may have no end.
TEST(Text, EqualsWithinItsRoom) {
  Text<4> full;
  full.chars = {'a', 'b', 'c', 'd'};
  EXPECT_TRUE(full.equals(full));
  EXPECT_FALSE((full.equals(Text<4>{"abc"})));
}

TEST(Text, IsCutOffAndTerminated) {
  const Text<8> text{"more than eight"};
  EXPECT_EQ(text.view(), "more th");
  EXPECT_EQ(text.chars.back(), '\0');
}

TEST(Text, IsCutOffBetweenCharacters) {
  EXPECT_EQ((Text<8>{"abcdef\u00e9"}.view()), "abcdef");              // 6 + 2 bytes, 7 fit
  EXPECT_EQ((Text<8>{"abcde\u00e9"}.view()), "abcde\u00e9");          // 7 fit exactly
  EXPECT_EQ((Text<8>{"\u7535\u673a\u7535"}.view()), "\u7535\u673a");  // 3 bytes each
}

TEST(Text, TakesAnEmptyViewWithoutBytes) {
  Text<8> text{"old"};
  text = std::string_view{};
  EXPECT_EQ(text.view(), "");
}

TEST(Text, ForgetsTheLongerTextBefore) {
  Text<16> text{"a long text"};
  text = "b";
  EXPECT_EQ(text.view(), "b");
  EXPECT_EQ(text.chars[5], '\0');
}

TEST(Text, OfAStrangerWithoutTerminatorIsBounded) {
  Text<8> text;
  text.chars.fill('x');
  EXPECT_EQ(text.view().size(), 8U);
}

}  // namespace
}  // namespace rc10::link::test::link_message_test
