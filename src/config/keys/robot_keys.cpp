#include <array>

#include "app/guard_priority.hpp"
#include "config/keys/key_table.hpp"

namespace rc10 {
namespace {

using enum ValueKind;

constexpr TextForm kRobotName{"[a-z0-9_-]{1,31}", "1 to 31 of a-z, 0-9, _ and -"};
constexpr TextForm kUdpmUrl{"udpm://[0-9]{1,3}(\\.[0-9]{1,3}){3}:[0-9]{1,5}(\\?ttl=[0-9]{1,3})?",
                            "udpm://A.B.C.D:PORT?ttl=N"};

std::vector<std::string_view> realtimePolicies() { return {"required", "preferred"}; }

std::vector<std::string_view> guardPolicies() { return {"required", "preferred", "off"}; }

std::vector<std::string_view> tuningPolicies() { return {"open", "locked"}; }

std::vector<std::string_view> clearPolicies() { return {"anywhere", "local"}; }

std::vector<std::string_view> unrestPolicies() { return {"group", "estop", "heartbeat"}; }

std::vector<std::string_view> timerPolicies() { return {"auto", "timerfd", "nanosleep"}; }

std::vector<std::string_view> phaseClocks() { return {"monotonic", "realtime"}; }

std::vector<std::string_view> receivePolicies() { return {"tick", "thread"}; }

// Between "lines", one below the scheduler, and rc10-guard, which a tick that spins must not keep from the
// CPU.
constexpr Range kSchedulerPriorities{.min = 2, .max = kGuardPriority - 2};
constexpr Range kRxPriorities{.min = 3, .max = kGuardPriority - 1};
constexpr Range kCpus{.min = 0, .max = 1023};

constexpr std::array kSchedulerKeys{
    Key{.name = "rate_hz",
        .kind = kInteger,
        .unit = "Hz",
        .range = {.min = 100, .max = 4000},
        .default_text = "1000",
        .about = "How often every motor is computed and commanded. Must "
                 "divide 1e9 ns evenly: 250, 500, 1000, 2000."},
    Key{.name = "priority",
        .kind = kInteger,
        .range = kSchedulerPriorities,
        .default_text = "60",
        .about = "SCHED_FIFO priority of the thread that owns the motors. "
                 "Above 50 it precedes threaded interrupts; with timer: timerfd on PREEMPT_RT its own "
                 "wake-up is that of ktimers (FIFO 1)."},
    Key{.name = "timer",
        .kind = kText,
        .choices = timerPolicies,
        .default_text = "auto",
        .about = "Wake-up of the thread. nanosleep: clock_nanosleep, which on "
                 "PREEMPT_RT no FIFO thread below it delays. auto: nanosleep on "
                 "PREEMPT_RT, else timerfd."},
    Key{.name = "phase",
        .kind = kNumber,
        .range = {.min = 0.0, .max = 0.99},
        .default_text = "0.3",
        .about = "Place of the ticks in each period of phase_clock, as a part of "
                 "the period. At 0 of monotonic the kernel's own timer tick delays "
                 "them."},
    Key{.name = "phase_clock",
        .kind = kText,
        .choices = phaseClocks,
        .default_text = "monotonic",
        .about = "Clock that phase belongs to. monotonic begins at the boot of each "
                 "computer. realtime: computers whose wall clocks are kept alike (PTP, "
                 "chrony) share out a bus with different phases; a step of that clock "
                 "ends this until a restart, and is told."},
    Key{.name = "overload_ms",
        .kind = kInteger,
        .unit = "ms",
        .range = {.min = 20, .max = 60000},
        .default_text = "100",
        .about = "The robot stops when ticks that take nearly all of the CPU have used so much of its "
                 "time, before the kernel cuts them into lumps. Above 250 LimitRTTIME of the systemd "
                 "unit may end rc10d first; above 900 the kernel cuts them."},
    Key{.name = "cpu",
        .kind = kInteger,
        .range = kCpus,
        .about = "CPU the thread is pinned to. Default: any."}};

constexpr std::array kRxKeys{
    Key{.name = "priority",
        .kind = kInteger,
        .range = kRxPriorities,
        .default_text = "65",
        .about = "SCHED_FIFO priority of the RX thread: serial ports, and with receive: thread CAN. Must be "
                 "above the scheduler's."},
    Key{.name = "lead_us",
        .kind = kNumber,
        .unit = "us",
        .range = {.min = 0, .max = 200},
        .default_text = "100",
        .about = "With receive: thread, how long before each tick the CAN buses are drained."},
    Key{.name = "cpu",
        .kind = kInteger,
        .range = kCpus,
        .about = "CPU the thread is pinned to. Default: any."}};

constexpr std::array kLcmKeys{
    Key{.name = "enabled",
        .kind = kBoolean,
        .default_text = "true",
        .about = "Whether rc10d starts rc10-lcm."},
    Key{.name = "url",
        .kind = kText,
        .form = &kUdpmUrl,
        .default_text = "udpm://239.255.76.67:7667?ttl=0",
        .about = "Multicast group, port and ttl of LCM. The group must be a multicast address. ttl=0 stays "
                 "on this computer, ttl=1 on its network. Without ?ttl= it is 0."},
    Key{.name = "state_hz",
        .kind = kInteger,
        .unit = "Hz",
        .range = {.min = 1, .max = 1000},
        .default_text = "200",
        .about = "How often the state of the robot is published."}};

constexpr Section kScheduler{"scheduler", kSchedulerKeys, "The thread that owns the motors."};
constexpr Section kRx{"rx", kRxKeys,
                      "The thread that reads serial ports, e-stops by datagram and, with receive: "
                      "thread, the CAN buses."};
constexpr Section kLcm{"lcm", kLcmKeys, "The link to programs in any language, through LCM."};

constexpr std::array kRobotKeys{
    Key{.name = "robot",
        .kind = kText,
        .form = &kRobotName,
        .required = true,
        .about = "Name of the robot: the prefix of its LCM channels and the name of its socket."},
    Key{.name = "realtime",
        .kind = kText,
        .choices = realtimePolicies,
        .default_text = "required",
        .about = "required: do not start without real-time priority and locked memory. preferred: warn and "
                 "go on."},
    Key{.name = "guard",
        .kind = kText,
        .choices = guardPolicies,
        .default_text = "preferred",
        .about =
            "rc10-guard, which tells the drives to rest when rc10d dies or hangs. required: do not start "
            "without it. preferred: warn and go on. off: for a debugger, which stops rc10d."},
    Key{.name = "on_unrest",
        .kind = kText,
        .choices = unrestPolicies,
        .default_text = "group",
        .about =
            "What stops when a drive has torque though it is told to rest. group: its motor, in FAULT, and "
            "its group. estop: the robot as well. heartbeat: the robot, and heartbeat_gpio stops at once, so "
            "that its relay cuts the power, until the e-stop is cleared."},
    Key{.name = "receive",
        .kind = kText,
        .choices = receivePolicies,
        .default_text = "tick",
        .about = "Reader of the CAN sockets, once a period. tick: the scheduler, at the start of the "
                 "tick that uses them. thread: the rx thread, rx.lead_us before the tick."},
    Key{.name = "scheduler",
        .kind = kSection,
        .section = &kScheduler,
        .about = "The thread that owns the motors."},
    Key{.name = "rx",
        .kind = kSection,
        .section = &kRx,
        .about = "The thread that reads serial ports, e-stops by datagram and, with receive: "
                 "thread, the CAN buses."},
    Key{.name = "lcm", .kind = kSection, .section = &kLcm, .about = "The link to programs, through LCM."},
    Key{.name = "clients",
        .kind = kSectionList,
        .range = {.min = 0, .max = 32},
        .section = &kClientSection,
        .about = "Rights of programs and people. With this key everybody else may only observe, and stop the "
                 "robot. Default: everybody may do everything."},
    Key{.name = "tuning",
        .kind = kText,
        .choices = tuningPolicies,
        .default_text = "open",
        .about = "locked: nobody changes gains or the settings of drives while rc10d runs, for a match."},
    Key{.name = "clear",
        .kind = kText,
        .choices = clearPolicies,
        .default_text = "anywhere",
        .about = "local: an e-stop is cleared from this computer only, not through LCM from another one."},
    Key{.name = "estop_gpio",
        .kind = kSection,
        .section = &kEstopGpioSection,
        .about = "An emergency-stop contact on a GPIO line. Default: none."},
    Key{.name = "enabling_gpio",
        .kind = kSection,
        .section = &kEnablingGpioSection,
        .about = "An enabling switch on a GPIO line: released or squeezed, it is an e-stop. Default: none."},
    Key{.name = "mode_gpio",
        .kind = kSection,
        .section = &kModeGpioSection,
        .about = "A contact on a GPIO line that is open while a person is near: each motor has its "
                 "reduced_velocity_rpm and reduced_current_a then. Default: none."},
    Key{.name = "heartbeat_gpio",
        .kind = kSection,
        .section = &kHeartbeatGpioSection,
        .about = "A GPIO line that toggles while the scheduler ticks, for a relay. Default: none."},
    Key{.name = "blackbox_mib",
        .kind = kInteger,
        .unit = "MiB",
        .range = {.min = 0, .max = 256},
        .default_text = "16",
        .about = "Size of the file that records the last minute: see docs/blackbox.md. 0: no recording."},
    Key{.name = "profiles",
        .kind = kNamedSections,
        .range = {.min = 0, .max = 128},
        .form = &kNameForm,
        .section = &kProfileSection,
        .about = "Keys that several motors share. A motor names one with 'profile'; its own keys win, key by "
                 "key."},
    Key{.name = "buses",
        .kind = kSectionList,
        .range = {.min = 1, .max = 4},
        .section = &kBusSection,
        .required = true,
        .about = "The CAN buses, each with its motors."},
    Key{.name = "groups",
        .kind = kSectionList,
        .range = {.min = 0, .max = 32},
        .section = &kGroupSection,
        .about = "Motors that are coupled and must stop together."},
    Key{.name = "modules",
        .kind = kTypedSections,
        .range = {.min = 0, .max = 16},
        .types = &kModuleSections,
        .about = "Parts of the robot that rc10d runs in every tick before the motors: see docs/modules.md."}};

}  // namespace

constexpr Section kRobotSection{"robot", kRobotKeys, "A robot for rc10d."};

}  // namespace rc10
