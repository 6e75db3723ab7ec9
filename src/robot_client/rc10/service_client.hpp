#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "app/time.hpp"
#include "rc10/lcm_link.hpp"
#include "rc10/service_error.hpp"

namespace rc10 {
inline namespace robot_client {

struct CallOptions {
  /// Time-out of the answer. A call that has waited longer at the server is not carried out.
  std::chrono::milliseconds timeout{1000};
  /// A call or its answer can be lost: LCM is UDP. It is sent again at this period, under the same number, so
  /// that it is carried out once.
  std::chrono::milliseconds repeat{100};
};

/// The part of a ServiceClient that does not depend on its types.
class ServiceCaller {
 public:
  ServiceCaller(const LcmLink& link, std::string name, std::string client);
  ServiceCaller(const ServiceCaller&) = delete;
  ServiceCaller& operator=(const ServiceCaller&) = delete;
  ~ServiceCaller();

  [[nodiscard]] tl::expected<std::vector<std::byte>, ServiceError> call(std::span<const std::byte> request,
                                                                        std::int64_t request_type,
                                                                        std::int64_t response_type,
                                                                        const CallOptions& options);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Calls one service: requests of one LCM type, answers of another. Any thread, several at once; not in a
/// handler of the link, since the answer could not arrive.
template <typename Request, typename Response>
class ServiceClient {
 public:
  /// `client`: shown to the server; empty: the program's name.
  ServiceClient(const LcmLink& link, std::string name, std::string client = {})
      : caller_(link, std::move(name), std::move(client)) {}

  /// Waits for the answer.
  [[nodiscard]] tl::expected<Response, ServiceError> call(const Request& request,
                                                          const CallOptions& options = {}) {
    const auto answer =
        caller_.call(LcmLink::encoded(request), Request::getHash(), Response::getHash(), options);
    if (!answer) return tl::unexpected(answer.error());
    Response response;
    if (!LcmLink::decode(*answer, response)) {
      return tl::unexpected(
          ServiceError{ServiceError::Kind::kFailed, "the answer is of another type or of other definitions"});
    }
    return response;
  }

 private:
  ServiceCaller caller_;
};

}  // namespace robot_client
}  // namespace rc10
