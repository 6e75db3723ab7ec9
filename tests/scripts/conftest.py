"""The programs of scripts/lib are modules without a package."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts" / "lib"))

# A shell that runs this in the background ignores Ctrl-C, and programs inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def stranger(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Begin of a command to which our files are another user's, if they cannot be written."""
    identity = tmp_path / "stranger" / "id"
    identity.parent.mkdir()
    identity.write_text("#!/bin/sh\necho 4711\n")
    identity.chmod(0o755)
    monkeypatch.setenv("PATH", f"{identity.parent}:{os.environ['PATH']}")
    # Root writes whatever it likes, unless it may not.
    return ["setpriv", "--bounding-set=-all", "--inh-caps=-all"] if os.geteuid() == 0 else []
