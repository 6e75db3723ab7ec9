"""The messages are those of the C++ side: Debian's lcm-gen and liblcm are the reference."""

from __future__ import annotations

import itertools
import math
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from rc10 import lcm_types
from rc10.link import LcmLink

HERE = Path(__file__).parent
DEFINITIONS = HERE.parent.parent / "lcm_types"

# Not the one that comes with the Python package: it would agree with itself.
SYSTEM_PATH = "/usr/local/bin:/usr/bin:/bin"
LCM_GEN = shutil.which("lcm-gen", path=SYSTEM_PATH)
GXX = shutil.which("g++")

# Frozen with 0.2.0: a change of one is a change for every client and recording. A later need gets a
# type of its own; constants may be added, since they are not part of a fingerprint.
FINGERPRINTS = {
    "bus_state_t": "53f82d2bd85bd80d",
    "command_t": "f1caa229fe8b9154",
    "counter_t": "85bf7873eaa98dd0",
    "diagnostics_t": "00fd6894bbc663d8",
    "durations_t": "31385adb5f853df6",
    "event_t": "e8f447978fb074ea",
    "motor_state_t": "7b828820c7a8fe92",
    "named_value_t": "ea7bbdc5e39b2f1e",
    "request_t": "08f58e022dfc1a65",
    "response_t": "ef49a799b41638b7",
    "robot_state_t": "d6c35e7ac8bb4d0f",
    "service_request_t": "5cef2c9f5aa9d4cb",
    "service_response_t": "7b5a6714ec98ecd6",
    "setpoint_t": "0d73bbbd8438f491",
    "signals_t": "881b66e3e7668501",
}
TYPES = list(FINGERPRINTS)


@pytest.fixture(scope="module")
def peer(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A program of generated C++."""
    missing = [
        name
        for name, found in (
            ("g++", GXX),
            ("lcm-gen (liblcm-bin)", LCM_GEN),
            ("lcm/lcm-cpp.hpp (liblcm-dev)", Path("/usr/include/lcm/lcm-cpp.hpp").exists()),
            (f"{DEFINITIONS.name}/*.lcm", any(DEFINITIONS.glob("*.lcm"))),
        )
        if not found
    ]
    if missing:
        pytest.skip(f"needs {', '.join(missing)}")
    assert LCM_GEN is not None
    assert GXX is not None
    build = tmp_path_factory.mktemp("peer")
    sources = [str(path) for path in sorted(DEFINITIONS.glob("*.lcm"))]
    subprocess.run([LCM_GEN, "--cpp", "--cpp-hpath", str(build), *sources], check=True)
    program = build / "wire_peer"
    source = str(HERE / "wire_peer.cpp")
    subprocess.run([GXX, "-I", str(build), source, "-o", str(program), "-llcm"], check=True)
    return str(program)


def example(name: str, numbers: Iterator[int] | None = None) -> Any:  # noqa: ANN401
    """Returns a message of the type `name` in which no two members are alike."""
    numbers = numbers or itertools.count(1)
    message = getattr(lcm_types, name)()

    def value_of(kind: str) -> object:
        number = next(numbers)
        if kind == "string":
            return f"{number} °C"
        if kind in ("float", "double"):
            return number + 0.5
        if kind == "boolean":
            return True
        if kind.startswith("int"):
            return number % 100
        return example(kind.rpartition(".")[2], numbers)

    dimensions = dict(zip(message.__slots__, message.__dimensions__))
    for member, kind in zip(message.__slots__, message.__typenames__):
        if kind == "byte":
            setattr(message, member, bytes([next(numbers), next(numbers)]))
        elif dimensions[member]:
            setattr(message, member, [value_of(kind), value_of(kind)])
        else:
            setattr(message, member, value_of(kind))
    for length in filter(None, dimensions.values()):
        setattr(message, length[0], 2)
    return message


def test_all_definitions_are_generated() -> None:
    if not DEFINITIONS.is_dir():
        pytest.skip("no lcm_types beside this package")
    assert sorted(path.stem for path in DEFINITIONS.glob("*.lcm")) == TYPES
    assert all(hasattr(lcm_types, name) for name in TYPES)


def test_fingerprints_are_those_of_cpp(peer: str) -> None:
    output = subprocess.run([peer, "fingerprints"], check=True, capture_output=True, text=True)
    cpp = dict(line.split() for line in output.stdout.splitlines())
    python = {name: example(name).encode()[:8].hex() for name in TYPES}
    assert python == cpp


@pytest.mark.parametrize("name", TYPES)
def test_the_types_stay_as_they_were_released(name: str) -> None:
    assert example(name).encode()[:8].hex() == FINGERPRINTS[name]


@pytest.mark.parametrize("name", TYPES)
def test_cpp_understands_every_member(peer: str, name: str) -> None:
    data = example(name).encode()
    recoded = subprocess.run([peer, "recode", name], input=data, check=True, capture_output=True)
    assert recoded.stdout == data


@pytest.mark.parametrize("name", TYPES)
def test_python_understands_every_member(name: str) -> None:
    data = example(name).encode()
    assert getattr(lcm_types, name).decode(data).encode() == data


def test_nan_means_not_given_on_both_sides(peer: str) -> None:
    setpoint = lcm_types.setpoint_t()
    setpoint.stiffness_nm_per_rad = math.nan
    data = setpoint.encode()
    recoded = subprocess.run(
        [peer, "recode", "setpoint_t"], input=data, check=True, capture_output=True
    )
    assert math.isnan(lcm_types.setpoint_t.decode(recoded.stdout).stiffness_nm_per_rad)


@pytest.mark.netns
def test_messages_travel_between_the_two_lcms(peer: str) -> None:
    sent = example("command_t")
    received: list[bytes] = []
    link = LcmLink()
    link.subscribe("python", received.append, 10)
    process = subprocess.Popen([peer, "echo", "cpp", "python"], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == "listening\n"
        link.publish("cpp", sent.encode())
        # More than 64 kB has to be cut into fragments and put together again.
        sent.client = "x" * 100_000
        link.publish("cpp", sent.encode())
        while len(received) < 2:
            assert link.pump(10.0) > 0
    finally:
        process.kill()
        process.communicate()
    assert lcm_types.command_t.decode(received[0]).client != sent.client
    assert received[1] == sent.encode()


@pytest.mark.skipif(LCM_GEN is None, reason="needs lcm-gen (liblcm-bin)")
def test_the_other_lcm_gen_makes_types_that_work(tmp_path: Path) -> None:
    """The build falls back to an installed lcm-gen, which may be as old as 1.3.1."""
    hook = HERE.parent / "hatch_build.py"
    program = f"""
import importlib.util, sys
from pathlib import Path
spec = importlib.util.spec_from_file_location("hatch_build", {str(hook)!r})
hook = importlib.util.module_from_spec(spec)
spec.loader.exec_module(hook)
package = Path({str(tmp_path)!r}, "rc10")
package.mkdir()
(package / "__init__.py").touch()
hook.generate(hook.find_definitions(), package / "lcm_types", {LCM_GEN!r})
sys.path.insert(0, {str(tmp_path)!r})
import rc10
from rc10.lcm_types import command_t, setpoint_t
assert Path(rc10.__file__).parent == package
message = command_t()
message.setpoints, message.setpoint_count = [setpoint_t()], 1
data = message.encode()
assert command_t.decode(data).encode() == data
print(data.hex())
"""
    result = subprocess.run(
        [sys.executable, "-c", program], check=True, capture_output=True, text=True
    )
    ours = lcm_types.command_t()
    ours.setpoints, ours.setpoint_count = [lcm_types.setpoint_t()], 1
    assert result.stdout.strip() == ours.encode().hex()
