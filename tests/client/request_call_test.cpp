#include "client/request_call.hpp"

#include <chrono>
#include <cstdint>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_rc10d.hpp"

namespace rc10::test::request_call_test {
namespace {

using testing::HasSubstr;

constexpr auto kShort = std::chrono::milliseconds{30};

// The first call of a RequestCall learns its session: a request that is never answered.
link::Request learn(RequestCall& call, FakeRc10d& rc10d) {
  EXPECT_FALSE(call.call({}, kShort));
  link::Request request;
  EXPECT_TRUE(rc10d.receive(request));
  return request;
}

link::Response answerTo(const link::Request& request, std::int64_t seq) {
  link::Response response;
  response.client = request.client;
  response.session = request.session;
  response.seq = seq;
  response.message = "done";
  return response;
}

TEST(RequestCall, ReturnsTheMatchingResponseAndIgnoresOthers) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  RequestCall call(client, "tester");
  const auto first = learn(call, rc10d);
  EXPECT_EQ(first.client.view(), "tester");
  EXPECT_EQ(first.seq, 1);

  auto late = answerTo(first, 1);  // the answer to the first comes too late
  auto other_session = answerTo(first, 2);
  other_session.session ^= 1U;
  auto other_client = answerTo(first, 2);
  other_client.client = "somebody";
  auto right = answerTo(first, 2);
  right.status = link::ResponseStatus::kFailed;
  right.message = "yaw: offline";
  link::Event event;
  link::State state;
  rc10d.send(late);
  rc10d.send(event);
  rc10d.send(state);
  rc10d.send(other_session);
  rc10d.send(other_client);
  rc10d.send(right);

  link::Request request;
  request.operation = "enable";
  const auto response = call.call(request);
  ASSERT_TRUE(response) << response.error().message;
  EXPECT_EQ(response->status, link::ResponseStatus::kFailed);
  EXPECT_EQ(response->message.view(), "yaw: offline");
  link::Request sent;
  ASSERT_TRUE(rc10d.receive(sent));
  EXPECT_EQ(sent.seq, 2);
  EXPECT_EQ(sent.session, first.session);
  EXPECT_EQ(sent.operation.view(), "enable");
}

TEST(RequestCall, HandsOverWhatComesBeforeTheAnswer) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  RequestCall call(client, "tester");
  const auto first = learn(call, rc10d);
  link::Sighting sighting;
  sighting.frame_id = 0x203;
  rc10d.send(sighting);
  auto right = answerTo(first, 2);
  rc10d.send(right);
  std::vector<std::uint32_t> heard;
  EXPECT_TRUE(call.call({}, std::chrono::seconds{5}, [&heard](auto datagram) {
    link::Sighting told;
    if (link::open(datagram, told)) heard.push_back(told.frame_id);
  }));
  EXPECT_EQ(heard, std::vector<std::uint32_t>{0x203});
}

TEST(RequestCall, IsGivenUpWhenThePersonSaysSo) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  RequestCall call(client, "tester");
  const auto result = call.call({}, std::chrono::hours{1}, {}, []() noexcept { return true; });
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("interrupted"));
}

TEST(RequestCall, FailsAfterTheTimeout) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  RequestCall call(client, "tester");
  const auto start = std::chrono::steady_clock::now();
  const auto response = call.call({}, kShort);
  ASSERT_FALSE(response);
  EXPECT_GE(std::chrono::steady_clock::now() - start, kShort);
  EXPECT_EQ(
      response.error().message,
      "rc10d did not answer within 30 ms: see its log: `journalctl -eu 'rc10d*'`, or the terminal of rc10d");
}

TEST(RequestCall, DoesNotWaitLongerBecauseOthersTalk) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  RequestCall call(client, "tester");
  link::Event event;
  for (int i = 0; i < 50; ++i) rc10d.send(event);
  EXPECT_FALSE(call.call({}, std::chrono::nanoseconds{1}));
}

TEST(RequestCall, NoticesThatRc10dEnds) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  RequestCall call(client, "tester");
  rc10d.end();
  const auto response = call.call({});
  ASSERT_FALSE(response);
  EXPECT_THAT(response.error().message, HasSubstr("rc10d ended"));
}

TEST(RequestCall, SaysWhenRc10dDoesNotRead) {
  FakeRc10d rc10d;
  auto client = rc10d.welcomed();
  link::Command command;
  command.setpoint_count = link::kMaxMotors;
  while (client.send(command) == LinkClient::SendStatus::kSent) {
  }
  link::Request request;
  while (client.send(request) == LinkClient::SendStatus::kSent) {
  }
  RequestCall call(client, "tester");
  const auto response = call.call({}, kShort);
  ASSERT_FALSE(response);
  EXPECT_THAT(response.error().message, HasSubstr("does not take requests"));
}

TEST(RandomSession, IsAnotherOneEachTime) {
  std::set<std::uint64_t> sessions;
  for (int i = 0; i < 100; ++i) sessions.insert(randomSession());
  EXPECT_EQ(sessions.size(), 100U);
}

}  // namespace
}  // namespace rc10::test::request_call_test
