#include <array>

#include "config/keys/key_table.hpp"

namespace rc10 {
namespace {

using enum ValueKind;

constexpr TextForm kLcmName{"[A-Za-z0-9_.:+-]{1,31}",
                            "the name of a client: 1 to 31 of A-Z, a-z, 0-9, _ . : + and -"};
constexpr TextForm kAccount{"[A-Za-z_][A-Za-z0-9_.-]{0,31}|[0-9]{1,9}",
                            "a name of /etc/passwd or /etc/group, or a number"};

constexpr TextForm kTokenHash{"[0-9a-f]{64}",
                              "64 hexadecimal digits, as `rc10ctl web --new-token` prints them"};

std::vector<std::string_view> operations() { return {"observe", "command", "clear", "tune", "configure"}; }

constexpr std::array kClientKeys{
    Key{.name = "lcm",
        .kind = kText,
        .form = &kLcmName,
        .about = "Client name of messages on LCM. Counts only for those that were sent on this computer."},
    Key{.name = "user",
        .kind = kText,
        .form = &kAccount,
        .about =
            "User at the other end of the link socket (rc10ctl), as the kernel tells it: name or number."},
    Key{.name = "group", .kind = kText, .form = &kAccount, .about = "The same of one of the user's groups."},
    Key{.name = "token",
        .kind = kText,
        .form = &kTokenHash,
        .about = "SHA-256 of a token, which a page of rc10-web on this computer shows behind the # of its "
                 "address. Its rights add to those of the user that rc10-web runs as."},
    Key{.name = "may",
        .kind = kTextList,
        .range = {.min = 1, .max = 5},
        .choices = operations,
        .required = true,
        .about =
            "What it may. command: setpoints, inputs of modules, enable, disable, zero. clear: faults and "
            "e-stops. tune: gains. configure: settings in the memory of a drive, scans of a bus. "
            "observe, and the e-stop, everybody may."},
    Key{.name = "motors",
        .kind = kTextList,
        .range = {.min = 0, .max = 128},
        .form = &kNameForm,
        .about =
            "Motors that it may do that with. Without motors and modules: all; with modules alone: none."},
    Key{.name = "modules",
        .kind = kTextList,
        .range = {.min = 0, .max = 16},
        .form = &kNameForm,
        .about =
            "Modules that it may give inputs. Without motors and modules: all; with motors alone: none."},
    Key{.name = "max_priority",
        .kind = kInteger,
        .range = {.min = -1'000'000, .max = 1'000'000},
        .about = "Highest priority of its commands. Default: any."}};

}  // namespace

constexpr Section kClientSection{
    "client", kClientKeys, "Rights of one client: exactly one of lcm, user, group and token says whose."};

}  // namespace rc10
