#include "robot_file/file_desk.hpp"

#include <optional>

#include "config/sha256.hpp"

namespace rc10::robot_file {
namespace {

using client::FileAnswer;
using client::FileRequest;
using client::FileVerb;

FileAnswer refused(std::string why) { return {.done = false, .message = std::move(why)}; }

FileAnswer install(const FileRequest& request, const ConfigFolder& folder, const RobotPlace& place,
                   const Computer& computer, std::time_t now) {
  const auto path = folder.pathOf(place.file);
  const auto present = folder.read(place.file);
  if (!present) return refused(present.error().message);
  const std::optional<std::string>& text = *present;
  if (!request.replaces.empty() && text && sha256(*text) != request.replaces)
    return refused(
        path +
        " is not the file that this text was made of: it has changed since, or rc10d runs with another " +
        "one. Load it anew");
  if (text && *text == request.text) return {.done = true, .message = path + " has this text already"};
  if (const auto checked = computer.check(request.text); !checked) return refused(checked.error().message);
  const auto backup = folder.replace(place.file, request.text, now);
  if (!backup) return refused(backup.error().message);
  return {.done = true,
          .message = path + " is written" +
                     (backup->empty() ? "" : "; the old one is " + folder.pathOf(*backup)) +
                     ". rc10d reads it when it is restarted"};
}

FileAnswer restart(const FileRequest& request, const RobotPlace& place, const Computer& computer) {
  if (const auto rest = computer.at_rest(request.robot, place.unit); !rest)
    return refused(rest.error().message);
  if (const auto done = computer.restart(place.unit); !done) return refused(done.error().message);
  return {.done = true, .message = place.unit + " was restarted"};
}

}  // namespace

Result<RobotPlace> placeOf(const ConfigFolder& folder, const std::string& robot) {
  const auto own = robot + ".yaml";
  const auto text = folder.read(own);
  if (!text) return tl::unexpected(text.error());
  if (!*text || robot == "robot") return RobotPlace{.file = "robot.yaml", .unit = "rc10d.service"};
  return RobotPlace{.file = own, .unit = "rc10d@" + robot + ".service"};
}

FileAnswer answer(const FileRequest& request, const Caller& caller, const std::string& folder_path,
                  const Computer& computer, std::time_t now) {
  if (const auto allowed = computer.authorise(caller, request.verb); !allowed)
    return refused(allowed.error().message);
  if (request.verb == FileVerb::kCheck) {
    auto checked = computer.check(request.text);
    return checked ? FileAnswer{.done = true, .message = std::move(*checked)}
                   : refused(checked.error().message);
  }
  const auto folder = ConfigFolder::open(folder_path);
  if (!folder) return refused(folder.error().message);
  const auto place = placeOf(*folder, request.robot);
  if (!place) return refused(place.error().message);
  return request.verb == FileVerb::kInstall ? install(request, *folder, *place, computer, now)
                                            : restart(request, *place, computer);
}

}  // namespace rc10::robot_file
