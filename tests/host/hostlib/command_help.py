"""The `--help` of a program, parsed."""

from __future__ import annotations

import re
import subprocess

from hostlib.daemon import BIN


def help_of(*words: str, program: str = "rc10ctl") -> str:
    return subprocess.run(
        [BIN / program, *words, "--help"], capture_output=True, text=True, check=True
    ).stdout


def verbs() -> list[str]:
    """Those of rc10ctl."""
    below = help_of().split("Subcommands:\n", 1)[1]
    return re.findall(r"^  ([a-z][a-z-]*)(?: |$)", below, re.MULTILINE)
