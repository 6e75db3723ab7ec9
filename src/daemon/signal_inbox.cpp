#include "daemon/signal_inbox.hpp"

#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>

#include <fmt/format.h>

namespace rc10 {
namespace {

struct Taken {
  int number;
  SignalMeaning meaning;
  const char* words;
};

// signal(7): all whose default is to end or to stop the process; the real-time ones are added by their range.
constexpr std::array kTaken{
    Taken{SIGTERM, SignalMeaning::kStop, ""},
    Taken{SIGINT, SignalMeaning::kStop, ""},
    Taken{SIGQUIT, SignalMeaning::kStop, "Ctrl-\\"},
    Taken{SIGTSTP, SignalMeaning::kStop, "Ctrl-Z: rc10d cannot pause while it holds motors"},
    Taken{SIGHUP, SignalMeaning::kStop,
          "the terminal was closed; to outlive it, start with nohup or as a service"},
    Taken{SIGUSR1, SignalMeaning::kStop, ""},
    Taken{SIGUSR2, SignalMeaning::kStop, ""},
    Taken{SIGALRM, SignalMeaning::kStop, ""},
    Taken{SIGVTALRM, SignalMeaning::kStop, ""},
    Taken{SIGPROF, SignalMeaning::kStop, ""},
    Taken{SIGPOLL, SignalMeaning::kStop, ""},
    Taken{SIGPWR, SignalMeaning::kStop, "power failure"},
    Taken{SIGSTKFLT, SignalMeaning::kStop, ""},
    Taken{SIGXCPU, SignalMeaning::kStop,
          "the limit of CPU time is reached: ulimit -t, or LimitRTTIME of the unit"},
    Taken{SIGCHLD, SignalMeaning::kChild, ""},
    Taken{SIGXFSZ, SignalMeaning::kIgnored,
          "a file has reached the limit of ulimit -f; the black box or the log is cut off there"},
    Taken{SIGTTIN, SignalMeaning::kIgnored,
          "rc10d runs in the background of a terminal and reads nothing from it"},
    Taken{SIGTTOU, SignalMeaning::kIgnored,
          "rc10d runs in the background of a terminal that has `stty tostop`"},
};

[[nodiscard]] const Taken* find(int signal) noexcept {
  const auto* const found =
      std::find_if(kTaken.begin(), kTaken.end(), [&](const Taken& taken) { return taken.number == signal; });
  return found != kTaken.end() ? found : nullptr;
}

[[nodiscard]] bool ignoredFromTheStart(int signal) noexcept {
  struct sigaction inherited {};
  return ::sigaction(signal, nullptr, &inherited) == 0 && inherited.sa_handler == SIG_IGN;
}

[[nodiscard]] sigset_t takenSignals() noexcept {
  sigset_t signals;
  sigemptyset(&signals);
  for (const auto& taken : kTaken) sigaddset(&signals, taken.number);
  for (int number = SIGRTMIN; number <= SIGRTMAX; ++number) sigaddset(&signals, number);
  // A blocked signal is queued even where it is ignored: this one is left alone instead.
  if (ignoredFromTheStart(SIGHUP)) sigdelset(&signals, SIGHUP);
  return signals;
}

}  // namespace

SignalMeaning meaningOf(int signal) noexcept {
  const auto* const taken = find(signal);
  return taken != nullptr ? taken->meaning : SignalMeaning::kStop;
}

std::string describeSignal(int signal) {
  const char* const short_name = ::sigabbrev_np(signal);
  const std::string name =
      short_name != nullptr ? std::string("SIG") + short_name : fmt::format("signal {}", signal);
  const auto* const taken = find(signal);
  return taken == nullptr || *taken->words == '\0' ? name : fmt::format("{} ({})", name, taken->words);
}

SignalInbox::SignalInbox() noexcept {
  const sigset_t signals = takenSignals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  fd_ = UniqueFd{::signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK)};
}

int SignalInbox::take() noexcept {
  signalfd_siginfo info{};
  return ::read(fd_.get(), &info, sizeof info) == sizeof info ? static_cast<int>(info.ssi_signo) : 0;
}

}  // namespace rc10
