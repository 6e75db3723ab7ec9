#include <atomic>
#include <future>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rc10/counter_t.hpp"
#include "rc10/named_value_t.hpp"
#include "rc10/publisher.hpp"
#include "rc10/service_client.hpp"
#include "rc10/service_request_t.hpp"
#include "rc10/service_response_t.hpp"
#include "rc10/service_server.hpp"
#include "rc10/subscriber.hpp"

namespace rc10 {
inline namespace robot_client {
namespace services_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using Kind = ServiceError::Kind;

constexpr auto kPatience = 20s;

counter_t counter(std::int64_t count) {
  counter_t message{};
  message.name = "n";
  message.count = count;
  return message;
}

TEST(PubSub, ACallbackGetsEveryMessage) {
  const LcmLink link("memq://");
  std::promise<void> all;
  std::vector<std::int64_t> seen;
  const Subscriber<counter_t> subscriber(link, "a.b", [&](const counter_t& message) {
    seen.push_back(message.count);
    if (seen.size() == 3) all.set_value();
  });
  const Publisher<counter_t> publisher(link, "a.b");
  for (int i = 1; i <= 3; ++i) ASSERT_TRUE(publisher.publish(counter(i)));
  ASSERT_EQ(all.get_future().wait_for(kPatience), std::future_status::ready);
  EXPECT_THAT(seen, testing::ElementsAre(1, 2, 3));
}

TEST(PubSub, TheLatestComesWithItsAge) {
  const LcmLink link("memq://");
  const Subscriber<counter_t> subscriber(link, "a.b");
  EXPECT_EQ(subscriber.latest(), nullptr);
  auto next = std::async(std::launch::async, [&] { return subscriber.waitForNext(kPatience); });
  // The one that is waited for may begin to wait late.
  std::shared_ptr<const Received<counter_t>> received;
  while (next.wait_for(1ms) != std::future_status::ready) ASSERT_TRUE(link.publish("a.b", counter(7)));
  received = next.get();
  ASSERT_NE(received, nullptr);
  EXPECT_EQ(received->message.count, 7);
  EXPECT_GE(received->age(), 0ns);
  EXPECT_GE(subscriber.count(), 1U);
  EXPECT_EQ(subscriber.waitForNext(0ms), nullptr);
}

TEST(PubSub, AChannelIsAWordAndNoPattern) {
  const LcmLink link("memq://");
  std::promise<std::int64_t> first;
  const Subscriber<counter_t> subscriber(link, "a.b", [&](const counter_t& m) { first.set_value(m.count); });
  ASSERT_TRUE(link.publish("axb", counter(1)));
  ASSERT_TRUE(link.publish("a.b", counter(2)));
  EXPECT_EQ(first.get_future().get(), 2);
}

TEST(PubSub, MessagesOfAnotherTypeAreCounted) {
  const LcmLink link("memq://");
  std::promise<void> ours;
  const Subscriber<counter_t> subscriber(link, "a", [&](const counter_t&) { ours.set_value(); });
  named_value_t other{};
  ASSERT_TRUE(link.publish("a", other));
  ASSERT_TRUE(link.publish("a", counter(1)));
  ours.get_future().wait();
  EXPECT_EQ(subscriber.foreign(), 1U);
  EXPECT_EQ(subscriber.count(), 1U);
}

TEST(PubSub, ASubscriberMayEndInItsOwnCallback) {
  const LcmLink link("memq://");
  std::unique_ptr<Subscriber<counter_t>> subscriber;
  std::promise<void> ended;
  int calls = 0;
  subscriber = std::make_unique<Subscriber<counter_t>>(link, "a", [&](const counter_t& message) {
    calls += static_cast<int>(message.count);
    subscriber->end();
  });
  const Subscriber<counter_t> other(link, "b", [&](const counter_t&) { ended.set_value(); });
  ASSERT_TRUE(link.publish("a", counter(1)));
  ASSERT_TRUE(link.publish("a", counter(1)));
  ASSERT_TRUE(link.publish("b", counter(1)));
  ended.get_future().wait();
  EXPECT_EQ(calls, 1);
}

TEST(PubSub, AChannelThatLcmCannotHaveIsAnError) {
  const LcmLink link("memq://");
  EXPECT_FALSE(link.publish(std::string(64, 'a'), counter(1)));
  EXPECT_FALSE(link.publish("", counter(1)));
}

/// A service that doubles, on one memq link with its client.
class ServiceTest : public testing::Test {
 protected:
  using Server = ServiceServer<counter_t, named_value_t>;
  using Client = ServiceClient<counter_t, named_value_t>;

  static Result<named_value_t> doubled(const counter_t& request) {
    if (request.count < 0) return fail("it is negative");
    if (request.count == 13) throw std::runtime_error("unlucky");
    named_value_t answer{};
    answer.name = request.name;
    answer.value = 2.0 * static_cast<double>(request.count);
    return answer;
  }
  static CallOptions patient() { return {.timeout = 20s}; }
  /// As a client sends it that waits so long.
  static service_request_t requestOf(std::int32_t timeout_ms) {
    service_request_t request{};
    request.request_type = counter_t::getHash();
    request.response_type = named_value_t::getHash();
    for (const auto byte : LcmLink::encoded(counter(1)))
      request.payload.push_back(static_cast<std::uint8_t>(byte));
    request.size = static_cast<std::int32_t>(request.payload.size());
    request.timeout_ms = timeout_ms;
    return request;
  }

  LcmLink link_{"memq://"};
};

TEST_F(ServiceTest, IsCalledAndAnswers) {
  const Server server(link_, "double", doubled);
  Client client(link_, "double");
  ASSERT_TRUE(server.status());
  for (int i = 0; i < 5; ++i) {
    const auto answer = client.call(counter(i), patient());
    ASSERT_TRUE(answer) << answer.error().message;
    EXPECT_EQ(answer->value, 2.0 * i);
  }
}

TEST_F(ServiceTest, FailsInTheWordsOfTheServer) {
  const Server server(link_, "double", doubled);
  Client client(link_, "double");
  auto answer = client.call(counter(-1), patient());
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().kind, Kind::kFailed);
  EXPECT_EQ(answer.error().message, "service 'double' failed: it is negative");
  answer = client.call(counter(13), patient());
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().message, "service 'double' failed: unlucky");
}

TEST_F(ServiceTest, NoAnswerSaysWhatToCheck) {
  Client client(link_, "double");
  const auto answer = client.call(counter(1), {.timeout = 5ms});
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().kind, Kind::kNoAnswer);
  EXPECT_THAT(answer.error().message,
              HasSubstr("no answer from service 'double' within 5 ms: is the program"));
}

TEST_F(ServiceTest, ARepeatedCallIsCarriedOutOnce) {
  std::atomic<int> calls{0};
  std::promise<void> let_it_end;
  auto end = let_it_end.get_future().share();
  const Server server(link_, "double", [&](const counter_t& request) {
    ++calls;
    end.wait();
    return doubled(request);
  });
  std::atomic<int> sent{0};
  const Subscriber<service_request_t> listener(link_, "double.request", [&](const service_request_t&) {
    if (++sent == 4) let_it_end.set_value();
  });
  Client client(link_, "double");
  const auto answer = client.call(counter(4), {.timeout = 20s, .repeat = 1ms});
  ASSERT_TRUE(answer);
  EXPECT_EQ(calls, 1);
}

TEST_F(ServiceTest, ALateRepetitionGetsTheFirstAnswerAgain) {
  std::atomic<int> calls{0};
  const Server server(link_, "double", [&](const counter_t& request) {
    ++calls;
    return doubled(request);
  });
  std::promise<service_request_t> asked;
  bool first = true;
  const Subscriber<service_request_t> listener(link_, "double.request",
                                               [&](const service_request_t& request) {
                                                 if (std::exchange(first, false)) asked.set_value(request);
                                               });
  Client client(link_, "double");
  ASSERT_TRUE(client.call(counter(4), patient()));
  std::promise<service_response_t> again;
  bool once = true;
  const Subscriber<service_response_t> answers(link_, "double.response",
                                               [&](const service_response_t& response) {
                                                 if (std::exchange(once, false)) again.set_value(response);
                                               });
  ASSERT_TRUE(link_.publish("double.request", asked.get_future().get()));
  EXPECT_EQ(again.get_future().get().status, +service_response_t::STATUS_OK);
  EXPECT_EQ(calls, 1);
}

TEST_F(ServiceTest, OtherTypesAreRefusedInWords) {
  const Server server(link_, "double", doubled);
  ServiceClient<named_value_t, named_value_t> other(link_, "double");
  const auto answer = other.call({}, patient());
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().kind, Kind::kRefused);
  EXPECT_THAT(answer.error().message, HasSubstr("other definitions of the types of 'double'"));
}

TEST_F(ServiceTest, ManyThreadsMayCallAtOnce) {
  const Server server(link_, "double", doubled);
  Client client(link_, "double");
  std::vector<std::future<double>> answers;
  for (int i = 0; i < 8; ++i) {
    answers.push_back(
        std::async(std::launch::async, [&, i] { return client.call(counter(i), patient())->value; }));
  }
  for (int i = 0; i < 8; ++i) EXPECT_EQ(answers[static_cast<std::size_t>(i)].get(), 2.0 * i);
}

TEST_F(ServiceTest, RefusesWhatWouldWaitTooLong) {
  std::promise<void> begun;
  std::promise<void> let_it_end;
  auto end = let_it_end.get_future().share();
  bool first = true;
  const Server server(link_, "double", [&](const counter_t& request) {
    if (std::exchange(first, false)) begun.set_value();
    end.wait();
    return doubled(request);
  });
  std::promise<std::vector<std::string>> refused;
  std::vector<std::string> reasons;
  const Subscriber<service_response_t> answers(link_, "double.response",
                                               [&](const service_response_t& response) {
                                                 if (response.status != service_response_t::STATUS_REFUSED)
                                                   return;
                                                 reasons.push_back(response.message);
                                                 if (reasons.size() == 2) refused.set_value(reasons);
                                               });
  auto request = requestOf(20'000);
  ASSERT_TRUE(link_.publish("double.request", request));
  begun.get_future().wait();
  for (int i = 1; i <= 17; ++i) {  // 16 may wait; the first of them does not wait long
    request.seq = i;
    request.timeout_ms = i == 1 ? 0 : 20'000;
    ASSERT_TRUE(link_.publish("double.request", request));
  }
  const Subscriber<counter_t> last(link_, "last", [&](const counter_t&) { let_it_end.set_value(); });
  ASSERT_TRUE(link_.publish("last", counter(0)));
  EXPECT_THAT(refused.get_future().get(),
              testing::ElementsAre("busy: 16 calls wait already",
                                   "too late: the client does not wait for it any more"));
}

// So it does after a stop of the program, and in the socket.
TEST_F(ServiceTest, RefusesWhatHasWaitedForACallbackOfAnother) {
  std::promise<void> begun;
  std::promise<void> let_it_end;
  const Subscriber<counter_t> busy(link_, "busy", [&](const counter_t&) {
    begun.set_value();
    let_it_end.get_future().wait();
  });
  std::atomic<int> calls{0};
  const Server server(link_, "double", [&](const counter_t& request) {
    ++calls;
    return doubled(request);
  });
  std::promise<std::string> refused;
  const Subscriber<service_response_t> answers(link_, "double.response",
                                               [&, first = true](const service_response_t& response) mutable {
                                                 if (std::exchange(first, false))
                                                   refused.set_value(response.message);
                                               });
  ASSERT_TRUE(link_.publish("busy", counter(0)));
  begun.get_future().wait();
  ASSERT_TRUE(link_.publish("double.request", requestOf(50)));
  // Longer than that: a client whose time is over just then may still be served.
  Client client(link_, "nobody");
  EXPECT_EQ(client.call(counter(1), {.timeout = 100ms}).error().kind, Kind::kNoAnswer);
  let_it_end.set_value();
  EXPECT_THAT(refused.get_future().get(), HasSubstr("too late"));
  EXPECT_EQ(calls, 0);
}

TEST_F(ServiceTest, CallingInACallbackIsAnErrorAndNoDeadlock) {
  const Server server(link_, "double", doubled);
  Client client(link_, "double");
  std::promise<Kind> kind;
  const Subscriber<counter_t> subscriber(link_, "go", [&](const counter_t&) {
    kind.set_value(client.call(counter(1), patient()).error().kind);
  });
  ASSERT_TRUE(link_.publish("go", counter(0)));
  EXPECT_EQ(kind.get_future().get(), Kind::kNotSent);
}

}  // namespace
}  // namespace services_test
}  // namespace robot_client
}  // namespace rc10
