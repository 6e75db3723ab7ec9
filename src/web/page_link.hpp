#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/time.hpp"
#include "client/link_client.hpp"
#include "web/page_request.hpp"

namespace rc10::web {

/// A page's own connection to rc10d, for what it asks: so that owners and logs name the page. Opened when it
/// first asks for something.
class PageLink {
 public:
  explicit PageLink(std::string client_name);

  /// Shows the token of an entry of `clients`: the link is opened anew with it.
  void showToken(std::string token);
  [[nodiscard]] const std::string& token() const noexcept { return token_; }

  /// Reason why it could not be sent; empty: it was, and an answer() comes, from rc10d or for it.
  [[nodiscard]] std::string ask(const AskRobot& request, const std::string& socket_path, MonotonicTime now);

  [[nodiscard]] bool isOpen() const noexcept { return rc10d_.has_value(); }
  /// Before drive(), which must not wait. Why there is no connection; empty: there is one. For half a second
  /// after a failure it is that one again.
  [[nodiscard]] std::string connect(const std::string& socket_path);
  /// A target for this validity. The reason why it could not be sent; empty: it was.
  [[nodiscard]] std::string drive(const DriveMotor& wanted, std::int32_t validity_ms);

  struct Answer {
    std::int64_t seq = 0;  ///< The page's number.
    link::Response response;
    std::vector<link::Sighting> sightings{};  ///< Sightings of a scan, before its answer.
  };
  /// The next answer that is there; nothing: none. A request that rc10d leaves without one fails in its
  /// place.
  [[nodiscard]] std::optional<Answer> answer(MonotonicTime now);
  /// rc10d has ended.
  void close() noexcept { rc10d_.reset(); }

 private:
  struct Open {
    std::int64_t number = 0;  ///< Number of this link.
    std::int64_t seq = 0;     ///< Number of the page.
    bool estop = false;
    MonotonicTime sent;
    Duration patience{};
    std::vector<link::Sighting> sightings{};
  };

  [[nodiscard]] std::string outcome(LinkClient::SendStatus status);
  void take(const link::Sighting& sighting);
  [[nodiscard]] std::optional<Answer> answerOfRc10d();
  [[nodiscard]] std::optional<Answer> answerInItsPlace(MonotonicTime now);

  std::string client_name_;
  std::string token_;
  std::uint64_t session_;
  std::int64_t seq_ = 0;
  std::optional<LinkClient> rc10d_;
  MonotonicTime next_try_{};  ///< Until then why_not_ holds.
  std::string why_not_;
  std::vector<Open> open_;
  std::vector<std::byte> buffer_;
};

}  // namespace rc10::web
