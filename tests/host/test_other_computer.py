"""Forged and replayed datagrams of another computer: nothing changes.

The other computer is a network namespace at the end of a wire (a veth pair).
"""

from __future__ import annotations

import json
import os
import socket
import struct
import subprocess
import sys
import time
from contextlib import closing, contextmanager
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon, Program
from hostlib.daemon import BIN, CONFIG
from hostlib.stalls import stood_still_since

import rc10
from rc10.lcm_types import command_t, event_t, request_t, response_t, robot_state_t, setpoint_t

if TYPE_CHECKING:
    from collections.abc import Iterator

GROUP, PORT = "239.255.76.67", 7667
HERE, THERE = "10.9.0.1", "10.9.0.2"
LOCAL = ("lo", "127.0.0.1")
WIRE = ("near", HERE)
# Both ends have one address of hardware, so that no datagram waits for ARP.
MAC = "02:00:00:00:00:01"
WILD = 9999.0

# Each line of its input: datagrams in hexadecimal, and how often; "sent" is the answer. Each goes
# to the group and to the computer, under its own address and under two that are not its own.
FORGER = f"""
import json, socket, struct, sys
raw = socket.socket(socket.AF_INET, socket.SOCK_RAW, socket.IPPROTO_RAW)
raw.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("{THERE}"))
def send(sender, to, data):
    udp = struct.pack(">HHHH", {PORT}, {PORT}, 8 + len(data), 0) + data
    head = struct.pack(">BBHHHBBH", 0x45, 0, 0, 0, 0, 1, socket.IPPROTO_UDP, 0)
    raw.sendto(head + socket.inet_aton(sender) + socket.inet_aton(to) + udp, (to, 0))
print("ready", flush=True)
for line in sys.stdin:
    order = json.loads(line)
    for _ in range(order["times"]):
        for data in order["datagrams"]:
            for sender in ("{THERE}", "{HERE}", "127.0.0.1"):
                for to in ("{GROUP}", "{HERE}"):
                    send(sender, to, bytes.fromhex(data))
    print("sent", flush=True)
"""


def ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True)


class OtherComputer:
    """A computer at the other end of the wire to `near`."""

    def __init__(self) -> None:
        wire = f"ip addr add {THERE}/24 dev far && ip link set far arp off up"
        self._shell = subprocess.Popen(
            [
                *("unshare", "--net", "sh", "-ec", f'echo; read go; {wire}; exec "$@"', "sh"),
                *(sys.executable, "-c", FORGER),
            ],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._hear("\n")
        ends = [
            "type",
            "veth",
            "peer",
            "name",
            "far",
            "address",
            MAC,
            "netns",
            str(self._shell.pid),
        ]
        ip("link", "add", "near", "address", MAC, *ends)
        ip("addr", "add", f"{HERE}/24", "dev", "near")
        ip("link", "set", "near", "arp", "off", "up")
        self._say("go")
        self._hear("ready\n")

    def begin(self, datagrams: list[bytes], times: int = 20) -> None:
        """Sends them, from now on."""
        self._say(json.dumps({"datagrams": [data.hex() for data in datagrams], "times": times}))

    def wait(self) -> None:
        """Until all have left."""
        self._hear("sent\n")

    def close(self) -> None:
        ip("link", "del", "near")
        self._shell.kill()
        self._shell.communicate()

    def _say(self, line: str) -> None:
        assert self._shell.stdin is not None
        self._shell.stdin.write(line + "\n")
        self._shell.stdin.flush()

    def _hear(self, line: str) -> None:
        assert self._shell.stdout is not None
        assert self._shell.stdout.readline() == line


@contextmanager
def route(dev: str, source: str) -> Iterator[None]:
    """The group leaves by this interface."""
    ip("route", "replace", f"{GROUP}/32", "dev", dev, "src", source)
    try:
        yield
    finally:
        ip("route", "replace", f"{GROUP}/32", "dev", "lo", "src", "127.0.0.1")


def datagram(channel: str, message: bytes) -> bytes:
    return b"LC02" + struct.pack(">I", 7) + channel.encode() + b"\0" + message


class Wiretap:
    """Datagrams of the group, as they are."""

    def __init__(self) -> None:
        self._udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._udp.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._udp.bind((GROUP, PORT))
        membership = socket.inet_aton(GROUP) + socket.inet_aton("0.0.0.0")
        self._udp.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)

    def wait(self, channel: str) -> bytes:
        """The next one on this channel."""
        self._udp.settimeout(20.0)
        while True:
            data = self._udp.recv(1 << 16)
            if data[8:].split(b"\0", 1)[0] == channel.encode():
                return data

    def close(self) -> None:
        self._udp.close()


def body(data: bytes) -> bytes:
    return data[8:].split(b"\0", 1)[1]


def forged_words(wiretap: Wiretap) -> list[bytes]:
    """Words as rc10d's: the robot is stopped, its motors fast, and all requests done."""
    state = robot_state_t.decode(body(wiretap.wait("host.v1.state")))
    state.state = robot_state_t.STATE_ESTOP
    state.stopped_by = "forged"
    state.tick += 1_000_000
    state.mono_us += 1_000_000_000
    for motor in state.motors:
        motor.velocity_rpm = motor.total_angle_deg = WILD
    event = event_t()
    event.severity, event.code, event.source, event.text = 2, 200, "robot", "forged"
    response = response_t()
    response.client, response.message = "victim", "forged"
    return [
        datagram("host.v1.state", state.encode()),
        datagram("host.v1.event", event.encode()),
        datagram("host.v1.response", response.encode()),
    ]


def forged_orders(command: bytes, request: bytes) -> list[bytes]:
    """Orders of a new session, and of the one of these."""
    orders = []
    for session in (None, 4711):
        asked = request_t.decode(body(request))
        asked.session, asked.seq = session or asked.session, asked.seq + 1000
        for operation, target in (("enable", "other"), ("disable", "wheel"), ("zero", "")):
            asked.operation, asked.target = operation, target
            asked.seq += 1
            orders.append(datagram("host.v1.request", asked.encode()))
        told = command_t.decode(body(command))
        told.session, told.seq = session or told.session, told.seq + 1000
        told.priority, told.validity_ms = 100, 1000
        told.setpoints = []
        for name in ("wheel", "other"):
            setpoint = setpoint_t()
            setpoint.motor, setpoint.mode, setpoint.value = name, setpoint_t.MODE_VELOCITY, 60.0
            told.setpoints.append(setpoint)
        told.setpoint_count = len(told.setpoints)
        orders.append(datagram("host.v1.command", told.encode()))
    return orders


CLIENTS = """
clients:
  - {{user: {user}, may: [command, clear, tune, configure]}}
  - {{lcm: victim, may: [command]}}
  - {{lcm: hello-motor, may: [command]}}
"""


@pytest.mark.parametrize(("ttl", "way"), [(0, LOCAL), (1, WIRE)])
def test_forged_and_replayed_datagrams_of_another_computer_change_nothing(
    ttl: int, way: tuple[str, str]
) -> None:
    url = f"udpm://{GROUP}:{PORT}?ttl={ttl}"
    config = CONFIG.format(realtime="preferred").replace("?ttl=0", f"?ttl={ttl}")
    with (
        closing(OtherComputer()) as other,
        route(*way),
        closing(Wiretap()) as wiretap,
        Daemon(config + CLIENTS.format(user=os.getuid())) as daemon,
    ):
        daemon.wait_ready()
        with rc10.connect("host", url, client="victim") as victim:
            victim.wait_for_state(20.0)
            said: list[bytes] = []
            for channel in ("state", "event", "response"):
                victim.link.subscribe(f"host.v1.{channel}", said.append, 1000)
            victim.enable("wheel")
            victim.command(wheel=rc10.velocity_rpm(30.0))
            request, command = wiretap.wait("host.v1.request"), wiretap.wait("host.v1.command")
            words = forged_words(wiretap)
            refused = daemon.stats()["refusals"]
            own = wiretap.wait("host.v1.state")

            other.begin([*words, *forged_orders(command, request), own, request, command])
            other.wait()
            # Behind those that were forged: all of them have been heard, or are not.
            victim.enable("yaw")

            assert not {body(word) for word in words} & set(said)
            assert said.count(body(own)) <= 1
            state = victim.state
            assert state.status is rc10.RobotStatus.RUN
            assert all(abs(motor.velocity_rpm) < WILD for motor in state.motors.values())
        now = daemon.state()
        assert now["state"] == "RUN"
        assert {m["name"]: m["status"] for m in now["motors"]}["other"] == "READY"
        assert {m["name"]: m["status"] for m in now["motors"]}["wheel"] == "ACTIVE"
        told = {
            reason: count - refused.get(reason, 0)
            for reason, count in daemon.stats()["refusals"].items()
            if count != refused.get(reason, 0)
        }
        # On loopback nothing of it arrives; from the network it is nobody's.
        assert set(told) == (set() if ttl == 0 else {"not permitted"})
        daemon.must("disable")

        # A C++ program, all the while.
        for _ in range(5):
            begin_s = time.monotonic()
            with Program(
                BIN / "hello_motor", "host", "yaw", "90", env={"LCM_DEFAULT_URL": url}
            ) as program:
                daemon.wait_motor("yaw", lambda motor: motor["mode"] == "velocity", "is moved")
                while program.running:
                    other.begin(words)
                    other.wait()
                status = program.wait()
            assert "9999" not in program.output
            cut_off = status != 0 and "no state for a second" in program.output
            if not cut_off or not stood_still_since(begin_s, "a C++ program, all the while"):
                break
            daemon.must("disable")
        assert status == 0, program.output
