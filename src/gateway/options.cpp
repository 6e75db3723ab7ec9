#include "gateway/options.hpp"

#include <string_view>

#include "app/nearest.hpp"
#include "app/printable.hpp"

namespace rc10::gateway {
namespace {

std::string unknownArgument(std::string_view word, std::string_view name) {
  std::string text = "unknown argument '";
  text += printable(word);
  text += "'";
  text += didYouMean(name, {"--robot", "--socket", "--url", "--version", "--help"});
  text += "; see rc10-lcm --help";
  return text;
}

}  // namespace

const char* helpText() noexcept {
  return "Usage: rc10-lcm [--robot NAME] [--socket PATH] [--url URL]\n"
         "Connects a running rc10d with LCM. rc10d starts it by itself; by hand it is for trying things "
         "out.\n"
         "\n"
         "  --robot NAME   the robot; needed only if several run on this computer\n"
         "  --socket PATH  its link socket, default /run/rc10d/<robot>.sock\n"
         "  --url URL      LCM provider, default: lcm.url of the robot's configuration\n"
         "  --version, --help\n"
         "\n"
         "Exit status: 0 rc10d has ended or SIGTERM, 1 failure, 2 wrong usage, 3 no rc10d.\n";
}

Result<Options> parseOptions(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    std::string_view name = argv[i];
    std::optional<std::string> value;
    if (const auto equals = name.find('='); equals != std::string_view::npos) {
      value = name.substr(equals + 1);
      name = name.substr(0, equals);
    }
    if (name == "--help" || name == "-h") {
      options.help = true;
      continue;
    }
    if (name == "--version") {
      options.version = true;
      continue;
    }
    auto* field = name == "--robot"    ? &options.robot
                  : name == "--socket" ? &options.socket
                  : name == "--url"    ? &options.url
                                       : nullptr;
    if (field == nullptr) return fail(unknownArgument(argv[i], name));
    if (!value && i + 1 < argc) value = argv[++i];
    if (!value || value->empty()) return fail(std::string(name) + " needs a value; see rc10-lcm --help");
    *field = *value;
  }
  return options;
}

}  // namespace rc10::gateway
