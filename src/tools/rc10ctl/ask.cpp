#include "ask.hpp"

#include <algorithm>
#include <cstdio>
#include <span>
#include <string_view>

#include "app/printable.hpp"
#include "client/json_line.hpp"
#include "client/request_call.hpp"
#include "link/estop_datagram.hpp"

namespace rc10::ctl {
namespace {

Result<link::Request> robotRequest(Operation operation, const std::vector<std::string>& motors,
                                   const std::vector<link::NamedValue>& values) {
  std::string target;
  for (const auto& motor : motors) {
    // An empty name would be left out, and no name at all means every motor.
    if (motor.empty() || motor.find(',') != std::string::npos)
      return fail("'" + motor + "' is not the name of a motor");
    target += (target.empty() ? "" : ",") + motor;
  }
  link::Request request;
  if (target.size() >= sizeof(request.target))
    return fail("too many motors at once: name none for all, or do it in parts");
  request.operation = toString(operation);
  request.target = target;
  request.value_count = static_cast<std::uint32_t>(std::min(values.size(), link::kMaxValues));
  std::copy_n(values.begin(), request.value_count, request.values.begin());
  return request;
}

using Values = std::span<const link::NamedValue>;

void printAnswerText(const std::string& message, Values values) {
  std::printf("%s\n", message.c_str());
  for (const auto& value : values)
    std::printf("%s = %g\n", printable(value.name.view()).c_str(), value.value);
}

void printAnswerJson(std::string_view operation, const std::string& message, Values values) {
  client::Json json = client::Json::object();
  for (const auto& value : values) json[std::string{value.name.view()}] = value.value;
  std::puts(client::lineOf(
                {{"operation", std::string{operation}}, {"message", message}, {"values", std::move(json)}})
                .c_str());
}

// Past connections that are all taken and an rc10d that answers nobody. False: it was no e-stop, or is not
// under way.
bool sendEstop(const Global& global, Operation operation) {
  if (operation != Operation::kEstop) return false;
  const auto path = socketOf(global);
  return path && link::EstopDatagram::to(*path).send(kClientName);
}

// `before` is said before an error.
ExitCode call(const Global& global, LinkClient& rc10d, const link::Request& request,
              const std::string& before) {
  const auto response = RequestCall(rc10d, kClientName).call(request);
  if (!response) return complain({before + response.error().message}, ExitCode::kFailed);
  const std::string message = printable(response->message.view());
  if (response->status != link::ResponseStatus::kOk) return complain({message}, ExitCode::kFailed);
  const auto told =
      std::span(response->values).first(std::min<std::size_t>(response->value_count, link::kMaxValues));
  global.json ? printAnswerJson(request.operation.view(), message, told) : printAnswerText(message, told);
  return ExitCode::kOk;
}

}  // namespace

ExitCode ask(const Global& global, Operation operation, const std::vector<std::string>& motors,
             const std::vector<link::NamedValue>& values) {
  const auto request = robotRequest(operation, motors, values);
  if (!request) return complain(request.error(), ExitCode::kUsage);
  const std::string estop = sendEstop(global, operation) ? "the e-stop was sent and is not confirmed: " : "";
  auto rc10d = connect(global);
  if (!rc10d) return complain({estop + rc10d.error().message}, ExitCode::kNoDaemon);
  return call(global, *rc10d, *request, estop);
}

ExitCode askOver(LinkClient& rc10d, const Global& global, Operation operation,
                 const std::vector<std::string>& motors, const std::vector<link::NamedValue>& values) {
  const auto request = robotRequest(operation, motors, values);
  if (!request) return complain(request.error(), ExitCode::kUsage);
  return call(global, rc10d, *request, "");
}

}  // namespace rc10::ctl
