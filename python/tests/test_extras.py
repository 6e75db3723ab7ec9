"""Without the optional packages the client works, and what needs one says how to get it."""

from __future__ import annotations

import subprocess
import sys

import pytest

# None in sys.modules is what makes an import fail.
WITHOUT = "import sys; sys.modules.update({name}=None); sys.argv[0] = 'x'\n"


def run(missing: str, code: str) -> subprocess.CompletedProcess[str]:
    program = WITHOUT.format(name=missing) + code
    return subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )


def test_the_client_needs_none() -> None:
    code = "sys.modules.update(matplotlib=None, mcap=None)\nimport rc10, rc10.aio, rc10.stream\n"
    done = run("numpy", code + "import rc10.export.table, rc10.command_line")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("missing", "module", "what", "extra"),
    [
        ("numpy", "rc10.recording", "recording needs numpy", "numpy"),
        ("numpy", "rc10.step.analysis", "the analysis of a step needs numpy", "numpy"),
        ("matplotlib", "rc10.plot.figure", "plotting needs matplotlib", "plot"),
        ("matplotlib", "rc10.plot.live", "plotting needs matplotlib", "plot"),
        ("mcap", "rc10.export.mcap_file", "MCAP needs mcap", "mcap"),
        ("mcap", "rc10.export.recording_file", "MCAP needs mcap", "mcap"),
        ("numpy", "rc10.joints", "joints() needs numpy", "numpy"),
    ],
)
def test_what_is_missing_is_named(missing: str, module: str, what: str, extra: str) -> None:
    done = run(missing, f"import {module}")
    assert done.returncode == 1
    assert f"MissingPackage: {what}, which is not installed: pip install {missing} " in done.stderr
    # The package itself is not on PyPI.
    assert f"in a clone of rc10d, the tried version: pip install './python[{extra}]'" in done.stderr


def test_a_tool_says_so_without_a_traceback() -> None:
    code = "import runpy\nsys.argv += ['wheel', 'velocity', '1']\n"
    done = run("numpy", code + "runpy.run_module('rc10.step', run_name='__main__')")
    assert done.returncode == 1
    assert done.stderr.startswith("step: the analysis of a step needs numpy")
    assert "Traceback" not in done.stderr
