#include <array>

#include "config/keys/key_table.hpp"

namespace rc10 {
namespace {

using enum ValueKind;

std::vector<std::string_view> memberOfflineChoices() { return {"stop_group"}; }
std::vector<std::string_view> returnChoices() { return {"request", "rearm_at_rest"}; }

constexpr std::array kGroupKeys{
    Key{.name = "name",
        .kind = kText,
        .form = &kNameForm,
        .required = true,
        .about = "Name of the group, unique."},
    Key{.name = "motors",
        .kind = kTextList,
        .range = {.min = 2, .max = 128},
        .form = &kNameForm,
        .required = true,
        .about = "Names of its motors, on any buses. A motor is in one group at most."},
    Key{.name = "on_member_offline",
        .kind = kText,
        .choices = memberOfflineChoices,
        .default_text = "stop_group",
        .about = "stop_group: while a member is offline or in fault, the others stop by their on_estop and "
                 "are not enabled. They stop as well when one is disabled, or its drive refuses to be "
                 "enabled. A motor that is optional stops with its group, and nothing stops for it."},
    Key{.name = "together",
        .kind = kBoolean,
        .default_text = "false",
        .about = "true: mechanically one. Enabled all or none, in one request that names them all, and no "
                 "target acts before all are ACTIVE. An optional member is not waited for."},
    Key{.name = "on_return",
        .kind = kText,
        .choices = returnChoices,
        .default_text = "request",
        .about = "request: every member must be enabled again. rearm_at_rest: enabled again by itself once "
                 "all are there, within 3 s, and stand still, within 10 s; not after a fault, an e-stop, a "
                 "disable or an "
                 "enable_alone."}};

}  // namespace

constexpr Section kGroupSection{"group", kGroupKeys, "Motors that stop together."};

}  // namespace rc10
