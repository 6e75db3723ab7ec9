"""The check of hardened programs finds each thing that one lacks; what is shipped is hardened."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

REPO = Path(__file__).resolve().parents[2]
CHECK = REPO / "tests/package/hardened"
# Something for each to do: an array, an index, a copy of unknown size.
PROGRAM = r"""
#include <cstdio>
#include <cstring>
#include <vector>
int main(int count, char** words) {
  std::vector<int> v(count);
  char text[20];
  std::memcpy(text, words[0], std::strlen(words[0]));
  std::printf("%s", text);
  return v[count - 1];
}
"""
FLAGS = {
    "-fstack-protector-strong": "-fno-stack-protector",
    "_FORTIFY_SOURCE": "-U_FORTIFY_SOURCE",
    "_GLIBCXX_ASSERTIONS": "-U_GLIBCXX_ASSERTIONS",
    "position-independent code": "-no-pie",
    "calls bound at the start": "-Wl,-z,lazy",
    "relocations that are read-only": "-Wl,-z,norelro",
    "a stack that is no code": "-Wl,-z,execstack",
}


def built(folder: Path, *flags: str) -> Path:
    source = folder / "program.cpp"
    source.write_text(PROGRAM)
    hardened = [
        "-O2", "-fstack-protector-strong", "-U_FORTIFY_SOURCE", "-D_FORTIFY_SOURCE=2",
        "-D_GLIBCXX_ASSERTIONS", "-pie", "-fPIE", "-Wl,-z,relro,-z,now",
    ]  # fmt: skip
    program = folder / "program"
    subprocess.run(["c++", *hardened, *flags, source, "-o", program], check=True)
    return program


def check(*files: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([CHECK, *files], capture_output=True, text=True, check=False)


def test_a_hardened_program_lacks_nothing(tmp_path: Path) -> None:
    done = check(built(tmp_path))
    assert (done.returncode, done.stdout) == (0, "1 programs and shared libraries\n")


@pytest.mark.parametrize("what", FLAGS)
def test_what_a_program_lacks_is_named(what: str, tmp_path: Path) -> None:
    done = check(built(tmp_path, FLAGS[what]))
    assert done.returncode == 1
    assert f"program lacks {what}" in done.stdout


def test_a_folder_without_programs_is_no_success(tmp_path: Path) -> None:
    assert check(tmp_path).returncode == 1


def test_what_is_shipped_is_hardened() -> None:
    presets = json.loads((REPO / "CMakePresets.json").read_text())["configurePresets"]
    by_name = {preset["name"]: preset for preset in presets}
    for name in ("package", "release", "arm64"):
        preset = by_name[name]
        while "RC10_HARDEN" not in preset.get("cacheVariables", {}):
            preset = by_name[preset["inherits"]]
        assert preset["cacheVariables"]["RC10_HARDEN"] == "ON"
