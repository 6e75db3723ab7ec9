#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/result.hpp"
#include "rc10/lcm_link.hpp"

namespace rc10 {
inline namespace robot_client {

/// The part of a ServiceServer that does not depend on its types.
class ServiceDesk {
 public:
  using Handler = std::function<Result<std::vector<std::byte>>(std::span<const std::byte> request)>;
  struct Types {
    std::int64_t request = 0;
    std::int64_t response = 0;
  };

  ServiceDesk(const LcmLink& link, std::string name, Types types, Handler handler);
  ServiceDesk(const ServiceDesk&) = delete;
  ServiceDesk& operator=(const ServiceDesk&) = delete;
  ~ServiceDesk();

  [[nodiscard]] const Result<void>& status() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Answers calls of one service: requests of one LCM type in, answers of another out.
///
/// The handler runs on a thread of the server's own, one call after the other; it may wait. 16 calls may wait
/// for it, more are refused as busy, and so is a call whose client has stopped waiting. A call that comes
/// again is answered again and not carried out again; the last 64 answers are remembered. An exception of
/// the handler is a failure in its words. The destructor waits for the handler.
template <typename Request, typename Response>
class ServiceServer {
 public:
  using Handler = std::function<Result<Response>(const Request&)>;

  ServiceServer(const LcmLink& link, std::string name, Handler handler)
      : desk_(link, std::move(name), {Request::getHash(), Response::getHash()},
              [handler =
                   std::move(handler)](std::span<const std::byte> bytes) -> Result<std::vector<std::byte>> {
                Request request;
                if (!LcmLink::decode(bytes, request)) return fail("the request is cut off");
                const Result<Response> response = handler(request);
                if (!response) return tl::unexpected(response.error());
                return LcmLink::encoded(*response);
              }) {}

  /// Whether it can be called at all.
  [[nodiscard]] const Result<void>& status() const noexcept { return desk_.status(); }

 private:
  ServiceDesk desk_;
};

}  // namespace robot_client
}  // namespace rc10
