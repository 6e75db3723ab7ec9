#include <array>

#include "config/keys/key_table.hpp"

namespace rc10 {
namespace {

using enum ValueKind;

// Linux: IFNAMSIZ is 16 with the terminating zero.
constexpr TextForm kInterfaceForm{"[A-Za-z0-9_.-]{1,15}",
                                  "the name of a CAN interface, as `ip link` shows it"};

constexpr std::array kBusSimKeys{Key{
    .name = "seed",
    .kind = kInteger,
    .range = {.min = 0, .max = 4'294'967'295.0},
    .default_text = "1",
    .about =
        "Seed of the random numbers of the simulation (noise, lost frames). The same seed, the same run."}};

constexpr Section kBusSim{"bus_sim", kBusSimKeys,
                          "How the bus is simulated, by rc10d (type: sim) or rc10-sim."};

std::vector<std::string_view> busTypes() { return {"socketcan", "sim"}; }

constexpr std::array kBusKeys{
    Key{.name = "name",
        .kind = kText,
        .form = &kNameForm,
        .required = true,
        .about = "Name of the bus, unique."},
    Key{.name = "type",
        .kind = kText,
        .choices = busTypes,
        .default_text = "socketcan",
        .about = "socketcan: a CAN interface of this computer. sim: motors simulated inside rc10d, no CAN "
                 "needed."},
    Key{.name = "interface",
        .kind = kText,
        .form = &kInterfaceForm,
        .about = "CAN interface, such as can0. Required for socketcan, not allowed for sim."},
    Key{.name = "bitrate",
        .kind = kInteger,
        .unit = "bit/s",
        .range = {.min = 10'000, .max = 1'000'000},
        .default_text = "1000000",
        .about = "Bit rate of the bus, for the predicted load. The system sets it on the interface, or rc10d "
                 "with manage_link. DJI drives: 1000000."},
    Key{.name = "data_bitrate",
        .kind = kInteger,
        .unit = "bit/s",
        .range = {.min = 100'000, .max = 8'000'000},
        .about =
            "Bit rate of the data phase of CAN FD frames; makes the bus an FD bus. Default: a classic bus."},
    Key{.name = "sample_point",
        .kind = kNumber,
        .range = {.min = 0.5, .max = 0.95},
        .about = "Where in a bit the controller looks, as a share of it. All nodes of a bus should agree. "
                 "Default: what the kernel chooses, 0.75 above 800 kbit/s."},
    Key{.name = "data_sample_point",
        .kind = kNumber,
        .range = {.min = 0.5, .max = 0.95},
        .about = "The same for the data phase of CAN FD frames. Default: what the kernel chooses."},
    Key{.name = "manage_link",
        .kind = kBoolean,
        .default_text = "false",
        .about = "true: rc10d sets both bit rates and the sample points, brings the interface up, and takes "
                 "it down "
                 "and up when the bus is off, stalled or down; needs CAP_NET_ADMIN, and a CAN controller "
                 "(not vcan). false: it says "
                 "which command to type."},
    Key{.name = "foreign_frames",
        .kind = kInteger,
        .range = {.min = 0, .max = 16},
        .default_text = "3",
        .about = "This number of frames within foreign_ms from somebody else that command one of our drives "
                 "is a fault of each motor that obeys them; questions and rest frames do not count. 0: they "
                 "are only told."},
    Key{.name = "foreign_ms",
        .kind = kInteger,
        .unit = "ms",
        .range = {.min = 1, .max = 10'000},
        .default_text = "100",
        .about = "See foreign_frames."},
    Key{.name = "stalled_ms",
        .kind = kInteger,
        .unit = "ms",
        .range = {.min = 5, .max = 50},
        .default_text = "5",
        .about =
            "For this time, and five ticks, no frame of ours was echoed: the bus is stalled and its motors "
            "are OFFLINE. More for a USB adapter whose host is late. Not for type: sim."},
    Key{.name = "sim", .kind = kSection, .section = &kBusSim, .about = "How the bus is simulated."},
    Key{.name = "motors",
        .kind = kSectionList,
        .range = {.min = 1, .max = 32},
        .section = &kMotorSection,
        .required = true,
        .about = "The motors on this bus."}};

}  // namespace

constexpr Section kBusSection{"bus", kBusKeys, "One CAN bus."};

}  // namespace rc10
