#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "app/result.hpp"
#include "daemon/clients/permissions.hpp"
#include "link/link_protocol.hpp"
#include "motor/loop_gain.hpp"

namespace rc10 {

/// Gains that clients try for as long as their connections last: link::kRestoreAtEnd of set_gains. However a
/// client ends, the kernel closes its connection. Link thread only.
class GainsAtEnd {
 public:
  /// Whether a request asks for it; the error is a sentence for its sender.
  [[nodiscard]] static Result<bool> askedBy(const link::Request& request, const Speaker& speaker);

  /// A gain of a motor is tried. `before`: what it was.
  void tried(std::uint64_t connection, const link::Name& client, std::size_t motor, const GainChange& before);
  /// It is set to stay, by whomever: what was before it is past.
  void settled(std::size_t motor, LoopGain gain);
  /// The scheduler has refused to set this one back; true: it was the last try.
  bool refused(std::size_t motor, LoopGain gain);

  /// Gains of one motor.
  struct Due {
    std::size_t motor = 0;
    link::Name client;  ///< The one that tried them.
    GainChanges gains;
  };
  /// Gains of before the tries of connections that have ended: due until they are settled.
  [[nodiscard]] std::optional<Due> due(const std::function<bool(std::uint64_t)>& is_open) const;
  /// Those that stay as they were tried, until somebody sets them: the scheduler has refused too often.
  [[nodiscard]] std::vector<Due> left() const;

 private:
  static constexpr int kTries = 3;

  struct Entry {
    std::uint64_t connection = 0;
    link::Name client;
    std::size_t motor = 0;
    GainChange before;
    int refusals = 0;
  };

  std::vector<Entry> entries_;
};

}  // namespace rc10
