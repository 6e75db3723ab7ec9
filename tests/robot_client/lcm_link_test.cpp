#include "rc10/lcm_link.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/unique_fd.hpp"

#include "gateway/private_network.hpp"

namespace rc10 {
inline namespace robot_client {
namespace test::link_test {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 20s;
const std::vector<std::byte> kMessage(4);

// Another computer at the end of a wire, `near`; it sends forged messages to this one, and to LCM's group.
class OtherComputer {
 public:
  OtherComputer() {
    EXPECT_EQ(::pipe2(orders_.data(), O_CLOEXEC), 0);
    EXPECT_EQ(::pipe2(reports_.data(), O_CLOEXEC), 0);
    child_ = ::fork();
    if (child_ == 0) {
      ::close(orders_[1]);
      work();
    }
    expect('u');
    const std::string ends =
        "ip link add near address 02:00:00:00:00:01 type veth peer name far address "
        "02:00:00:00:00:01 netns ";
    EXPECT_EQ(std::system((ends + std::to_string(child_)).c_str()), 0);
    EXPECT_EQ(std::system(wire("near", "1").c_str()), 0);
    order();
    expect('w');
  }
  OtherComputer(const OtherComputer&) = delete;
  OtherComputer& operator=(const OtherComputer&) = delete;
  ~OtherComputer() {
    for (const int end : {orders_[0], orders_[1], reports_[0], reports_[1]}) ::close(end);
    ::waitpid(child_, nullptr, 0);
  }
  void attack() {
    order();
    expect('a');
  }

 private:
  // Without ARP, for which a datagram would wait.
  static std::string wire(const std::string& end, const std::string& number) {
    return "ip addr add 10.9.0." + number + "/24 dev " + end + " && ip link set " + end + " arp off up";
  }
  void order() const { EXPECT_EQ(::write(orders_[1], "x", 1), 1); }
  void expect(char report) const {
    char got = 0;
    EXPECT_EQ(::read(reports_[0], &got, 1), 1);
    EXPECT_EQ(got, report);
  }
  void report(char word) const {
    if (::write(reports_[1], &word, 1) != 1) ::_exit(1);
  }
  void awaitOrder() const {
    char word = 0;
    if (::read(orders_[0], &word, 1) != 1) ::_exit(0);
  }
  [[noreturn]] void work() const {
    if (::unshare(CLONE_NEWNET) != 0) ::_exit(1);
    report('u');
    awaitOrder();
    if (std::system(wire("far", "2").c_str()) != 0) ::_exit(1);
    report('w');
    for (;;) {
      awaitOrder();  // with its end the wire would be gone
      send("10.9.0.1");
      send("239.255.76.67");
      report('a');
    }
  }
  static void send(const char* to) {
    const UniqueFd udp{::socket(AF_INET, SOCK_DGRAM, 0)};
    const in_addr by{::inet_addr("10.9.0.2")};
    ::setsockopt(udp.get(), IPPROTO_IP, IP_MULTICAST_IF, &by, sizeof by);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(7667);
    address.sin_addr.s_addr = ::inet_addr(to);
    // Whole, and in one fragment.
    const std::array messages{std::string("LC02\0\0\0\0demo.v1.state\0forged", 28),
                              std::string("LC03\0\0\0\0\0\0\0\6\0\0\0\0\0\0\0\1demo.v1.state\0forged", 40)};
    for (int i = 0; i < 20; ++i) {
      for (const auto& message : messages)
        if (::sendto(udp.get(), message.data(), message.size(), 0, reinterpret_cast<sockaddr*>(&address),
                     sizeof address) < 0)
          ::_exit(1);
    }
  }

  std::array<int, 2> orders_{};
  std::array<int, 2> reports_{};
  pid_t child_ = 0;
};

/// Words that a program hears while another computer forges messages, before its robot's first own one and
/// after.
struct Heard {
  std::set<std::string> before;
  std::set<std::string> after;
};

Heard heard(const std::string& url, const std::string& way) {
  OtherComputer other;
  EXPECT_EQ(std::system(("ip route add 239.255.76.67/32 dev " + way).c_str()), 0);
  const LcmLink link(url);
  std::mutex mutex;
  std::set<std::string> words;
  std::promise<void> own;
  std::promise<void> last;
  const auto subscription = link.subscribe("demo.v1.state", [&](std::span<const std::byte> message) {
    const std::string word(reinterpret_cast<const char*>(message.data()), message.size());
    const std::lock_guard lock(mutex);
    const bool is_new = words.insert(word).second;
    if (is_new && word == "own") own.set_value();
    if (is_new && word == "last") last.set_value();
  });
  const auto publish = [&](const char* word, std::promise<void>& until) {
    EXPECT_TRUE(link.publish("demo.v1.state", std::as_bytes(std::span(word, std::strlen(word)))));
    EXPECT_EQ(until.get_future().wait_for(kPatience), std::future_status::ready);
    const std::lock_guard lock(mutex);
    return std::exchange(words, {});
  };
  other.attack();
  Heard found;
  found.before = publish("own", own);
  other.attack();
  found.after = publish("last", last);
  return found;
}

TEST(LcmLink, ForgedMessagesOfAnotherComputerChangeNothing) {
  using private_network::inPrivateNetwork;
  const auto nothing_forged = [](const std::string& url, const std::string& way) {
    const auto found = heard(url, way);
    EXPECT_EQ(found.before, std::set<std::string>{"own"});
    EXPECT_EQ(found.after, std::set<std::string>{"last"});
  };
  inPrivateNetwork([&] { nothing_forged("", "lo src 127.0.0.1"); });
  // Its own multicast leaves by the wire, and comes back as a copy.
  inPrivateNetwork([&] { nothing_forged("", "near"); });
}

TEST(LcmLink, OverTheNetworkOfARobotThatIsHereNobodyElseSpeaks) {
  private_network::inPrivateNetwork([] {
    const auto found = heard("udpm://239.255.76.67:7667?ttl=1", "near");
    EXPECT_EQ(found.before, (std::set<std::string>{"forged", "own"})) << "the robot may be elsewhere";
    EXPECT_EQ(found.after, std::set<std::string>{"last"});
  });
  // Not by another interface than that of the group.
  private_network::inPrivateNetwork([] {
    const auto found = heard("udpm://239.255.76.67:7667?ttl=1", "lo src 127.0.0.1");
    EXPECT_EQ(found.before, std::set<std::string>{"own"});
  });
}

TEST(LcmLink, SubscriptionsThatEndMeanwhileTakeNoMessageFromTheOthers) {
  constexpr int kMessages = 2000;
  const LcmLink link("memq://");
  std::atomic<int> first = 0;
  std::atomic<int> last = 0;
  std::promise<void> all;
  const auto at_first = link.subscribe("a", [&](auto) { ++first; });
  std::optional<Subscription> short_lived = link.subscribe("a", [](auto) {});
  const auto at_last = link.subscribe("a", [&](auto) {
    if (++last == kMessages) all.set_value();
  });
  for (int i = 0; i < kMessages; ++i) {
    ASSERT_TRUE(link.publish("a", kMessage));
    // While the link's thread gives out messages. The place of the new one is behind the others.
    short_lived.emplace(link.subscribe("a", [](auto) {}));
  }
  ASSERT_EQ(all.get_future().wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(first, kMessages);
  EXPECT_EQ(last, kMessages);
}

TEST(LcmLink, WhatAnEndedHandlerHeldIsLetGo) {
  const LcmLink link("memq://");
  struct Held {
    std::promise<void>& gone;
    ~Held() { gone.set_value(); }
  };
  std::promise<void> gone;
  auto subscription = link.subscribe("a", [held = std::make_shared<Held>(gone)](auto) {});
  subscription.end();
  EXPECT_EQ(gone.get_future().wait_for(kPatience), std::future_status::ready);
}

TEST(LcmLink, AHandlerMayEndItself) {
  const LcmLink link("memq://");
  int calls = 0;
  Subscription itself;
  std::promise<void> second;
  itself = link.subscribe("a", [&](auto) {
    ++calls;
    itself.end();
  });
  const auto other = link.subscribe("b", [&](auto) { second.set_value(); });
  ASSERT_TRUE(link.publish("a", kMessage));
  ASSERT_TRUE(link.publish("a", kMessage));
  ASSERT_TRUE(link.publish("b", kMessage));
  ASSERT_EQ(second.get_future().wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace test::link_test
}  // namespace robot_client
}  // namespace rc10
