"""Generates the package rc10.lcm_types while rc10 is built.

The messages are declared in the LCM package `rc10`, for which lcm-gen would write a Python
package `rc10`: the place of the hand-written one. An LCM package name is no part of a message's
fingerprint (only the names and types of its members are), so it is changed on the way. What
comes out is an ordinary subpackage whose imports work, and whose messages are those of C++.

Run by hand, `python hatch_build.py` renews the files of an editable installation.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

ROOT = Path(__file__).resolve().parent
IN_TREE = ROOT / "src" / "rc10" / "lcm_types"


def find_definitions(root: Path = ROOT) -> Path:
    """Returns the folder of the .lcm files: in an sdist inside it, in the repository beside it."""
    for folder in (root / "lcm_types", root.parent / "lcm_types"):
        if any(folder.glob("*.lcm")):
            return folder
    raise FileNotFoundError(
        f"no lcm_types/*.lcm in {root} or beside it: build from a clone of the repository "
        "or from an sdist"
    )


def find_lcm_gen() -> str:
    """Returns the lcm-gen of the lcm wheel, or else an installed one."""
    try:
        import lcm
    except ImportError:
        pass
    else:
        bundled = Path(lcm.LCM_BIN_DIR) / "lcm-gen"
        if bundled.is_file():
            return str(bundled)
    installed = shutil.which("lcm-gen")
    if installed is None:
        raise FileNotFoundError("no lcm-gen: pip install lcm, or apt-get install liblcm-bin")
    return installed


def generate(definitions: Path, destination: Path, lcm_gen: str | None = None) -> None:
    """Writes the Python of all .lcm files in `definitions` as the package `destination`."""
    with tempfile.TemporaryDirectory() as scratch:
        sources = []
        for source in sorted(definitions.glob("*.lcm")):
            text = source.read_text(encoding="utf-8")
            # lcm-gen takes the comment behind a member for that of the next member.
            text = re.sub(r"//.*", "", text)
            text, declarations = re.subn(
                r"^package rc10;", "package rc10.lcm_types;", text, flags=re.MULTILINE
            )
            if declarations != 1:
                raise ValueError(f"{source}: expected one line 'package rc10;'")
            copy = Path(scratch, source.name)
            copy.write_text(text, encoding="utf-8")
            sources.append(str(copy))
        command = [lcm_gen or find_lcm_gen(), "--python", "--ppath", scratch, *sources]
        subprocess.run(command, check=True)
        generated = Path(scratch, "rc10", "lcm_types")
        for copied in map(Path, sources):
            hints = type_hints_of(copied.read_text(encoding="utf-8"))
            (generated / copied.with_suffix(".pyi").name).write_text(hints, encoding="utf-8")
        shutil.rmtree(destination, ignore_errors=True)
        shutil.copytree(generated, destination)


_PYTHON_TYPES = {
    "boolean": "bool",
    "string": "str",
    "float": "float",
    "double": "float",
    "byte": "int",
    **{f"int{bits}_t": "int" for bits in (8, 16, 32, 64)},
}


def type_hints_of(definition: str) -> str:
    """Returns type hints, as a .pyi file, for what lcm-gen writes for one struct.

    Args:
        definition: one struct, without comments.

    Raises:
        ValueError: something that LCM allows and this does not know.
    """
    head = re.search(r"struct\s+(\w+)\s*\{(.*)\}", definition, re.DOTALL)
    if head is None:
        raise ValueError(f"no struct in: {definition}")
    name, body = head.groups()
    imports: set[str] = set()
    constants, members = [], []
    for line in filter(None, (part.strip() for part in body.split(";"))):
        if constant := re.fullmatch(r"const\s+(\w+)\s+(\w+)\s*=\s*\S+", line):
            constants.append(f"    {constant[2]}: {_PYTHON_TYPES[constant[1]]}")
            continue
        member = re.fullmatch(r"(\w+)\s+(\w+)((?:\[\w+\])*)", line)
        if member is None:
            raise ValueError(f"{name}: cannot read {line!r}")
        kind, dimensions = member[1], member[3].count("[")
        hint = _PYTHON_TYPES.get(kind, kind)
        if kind not in _PYTHON_TYPES:
            imports.add(f"from .{kind} import {kind}")
        if kind == "byte" and dimensions:
            hint, dimensions = "bytes", dimensions - 1
        members.append(f"    {member[2]}: {'list[' * dimensions}{hint}{']' * dimensions}")
    methods = [
        "    def __init__(self) -> None: ...",
        "    def encode(self) -> bytes: ...",
        "    @staticmethod",
        f"    def decode(data: bytes) -> {name}: ...",
        "    def get_hash(self) -> int: ...",
        "    @staticmethod",
        "    def _get_packed_fingerprint() -> bytes: ...",
    ]
    parts = [*sorted(imports), f"class {name}:", *constants, *members, *methods]
    return "\n".join(parts) + "\n"


class LcmTypesHook(BuildHookInterface[Any]):
    """Adds the generated package to a wheel, and the definitions to an sdist."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Is called by hatchling before the files of the target are collected."""
        definitions = find_definitions(Path(self.root))
        if self.target_name == "sdist":
            build_data["force_include"][str(definitions)] = "lcm_types"
        elif version == "editable":
            generate(definitions, IN_TREE)
        else:
            # Not into the source tree, which may be read-only and is not ours to change.
            self._scratch = tempfile.mkdtemp()
            generated = os.path.join(self._scratch, "lcm_types")
            generate(definitions, Path(generated))
            build_data["force_include"][generated] = "rc10/lcm_types"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Is called by hatchling after the target is written."""
        scratch = getattr(self, "_scratch", None)
        if scratch is not None:
            shutil.rmtree(scratch)


if __name__ == "__main__":
    generate(find_definitions(), IN_TREE)
    print(f"wrote {IN_TREE}", file=sys.stderr)
