"""Which sources are looked at by themselves, and what that finds."""

from __future__ import annotations

import json
import os
import subprocess
from typing import TYPE_CHECKING

import alone
import pytest
import tidy

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def repo(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository with one commit: a.cpp and b.cpp include a.hpp, c.cpp nothing."""
    src = tmp_path / "src" / "app"
    src.mkdir(parents=True)
    (src / "a.hpp").write_text("#pragma once\n#include <string>\nstd::string a();\n")
    (src / "a.cpp").write_text('#include "app/a.hpp"\nstd::string a() { return {}; }\n')
    (src / "b.cpp").write_text('#include "app/a.hpp"\n')
    (src / "c.cpp").write_text("int c() { return 0; }\n")
    (tmp_path / ".clang-tidy").write_text("# clang-tidy\nChecks: -*\n")
    for name in [name for name in os.environ if name.startswith("GIT_")]:  # a hook's
        monkeypatch.delenv(name)
    for scope in ("GLOBAL", "SYSTEM"):
        monkeypatch.setenv(f"GIT_CONFIG_{scope}", os.devnull)
    git = ["git", "-C", str(tmp_path), "-c", "user.name=n", "-c", "user.email=e"]
    for words in (["init", "--quiet"], ["add", "."], ["commit", "--quiet", "--message=first"]):
        subprocess.run([*git, *words], check=True)
    monkeypatch.setattr(tidy, "REPO", tmp_path)
    monkeypatch.setattr(alone, "REPO", tmp_path)
    monkeypatch.setattr(alone, "SRC", tmp_path / "src")
    return tmp_path


def changed(repo: Path) -> list[str]:
    sources = sorted((repo / "src" / "app").glob("*.cpp"))
    return sorted(source.name for source in tidy.changed_sources("HEAD", sources))


def test_a_source_that_changed_is_looked_at(repo: Path) -> None:
    assert changed(repo) == []
    (repo / "src" / "app" / "c.cpp").write_text("int c() { return 1; }\n")
    assert changed(repo) == ["c.cpp"]


def test_a_header_that_changed_is_seen_through_one_source(repo: Path) -> None:
    (repo / "src" / "app" / "a.hpp").write_text("#pragma once\n#include <string>\n")
    assert changed(repo) == ["a.cpp"]
    (repo / "src" / "app" / "b.cpp").write_text('#include "app/a.hpp"\nint b();\n')
    assert changed(repo) == ["b.cpp"]


def test_a_file_that_was_only_moved_says_nothing_new(repo: Path) -> None:
    git = ["git", "-C", str(repo)]
    app = repo / "src" / "app"
    text = '#include "app/a.hpp"\n' + "".join(f"int a{i}();\n" for i in range(9))
    (app / "b.cpp").write_text(text)
    subprocess.run([*git, "add", "."], check=True)
    words = ["-c", "user.name=n", "-c", "user.email=e", "commit", "--quiet", "--message=second"]
    subprocess.run([*git, *words], check=True)
    (app / "b.cpp").unlink()
    (app / "d.cpp").write_text(text.replace("app/a.hpp", "app/other/a.hpp"))
    subprocess.run([*git, "add", "."], check=True)
    assert changed(repo) == []
    (app / "d.cpp").write_text(text + "int d();\n")
    assert changed(repo) == ["d.cpp"]


def test_a_comment_says_nothing_to_clang_tidy_but_nolint_does(repo: Path) -> None:
    app = repo / "src" / "app"
    (app / "c.cpp").write_text("// Reason.\nint c() { return 0; }  ///< Of c.\n")
    (app / "a.hpp").write_text("#pragma once\n#include <string>\n\n/// A text.\nstd::string a();\n")
    assert changed(repo) == []
    (app / "c.cpp").write_text("int c() { return 0; }  // NOLINT\n")
    assert changed(repo) == ["c.cpp"]
    near, far = "// NOLINTNEXTLINE\nint c();\n", "// NOLINTNEXTLINE\n// Reason.\nint c();\n"
    assert not tidy.says_the_same(near, far)


def test_settings_of_clang_tidy_that_change_concern_each_source(repo: Path) -> None:
    (repo / ".clang-tidy").write_text("# clang-tidy 16\nChecks: -*\n")
    assert changed(repo) == [], "a comment"
    (repo / ".clang-tidy").write_text("# clang-tidy\nChecks: misc-*\n")
    assert changed(repo) == ["a.cpp", "b.cpp", "c.cpp"]


def test_no_comment_begins_in_a_string(repo: Path) -> None:
    assert tidy.read_by_tidy('f("http://x");  // where\n') == 'f("http://x");'
    assert tidy.read_by_tidy("g('\"', 1'000, '/');  // how\n") == "g('\"', 1'000, '/');"
    assert tidy.read_by_tidy('h(R"(a // b\nc)");') == 'h(R"(a // b\nc)");'
    app = repo / "src" / "app"
    (app / "c.cpp").write_text('int c() { return "//x"[0]; }\n')
    assert changed(repo) == ["c.cpp"]


def test_each_source_whose_check_crashes_is_shown(
    repo: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    app = repo / "src" / "app"
    commands = [{"file": str(app / name), "directory": str(repo)} for name in ("a.cpp", "b.cpp")]
    (repo / "compile_commands.json").write_text(json.dumps(commands))

    def crash(_build: Path, _tool: bytes, entry: dict[str, str]) -> str:
        return f"crashed in {entry['file']}\n{app / 'a.hpp'}:2:1: warning: one of both\n"

    monkeypatch.setattr(tidy, "check", crash)
    monkeypatch.setattr(tidy, "version", lambda: b"")
    monkeypatch.setattr("sys.argv", ["tidy.py", str(repo)])
    assert tidy.main() == 1
    shown = capsys.readouterr().out
    assert f"crashed in {app / 'a.cpp'}" in shown
    assert f"crashed in {app / 'b.cpp'}" in shown
    assert shown.count("one of both") == 1


def test_what_compiles_only_behind_another_is_found(
    repo: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    app = repo / "src" / "app"
    (app / "b.cpp").write_text("std::string b;\n")
    (app / "b.hpp").write_text("#pragma once\ninline std::string b2;\n")
    commands = [
        {
            "file": str(file),
            "directory": str(repo),
            "command": f"c++ -std=c++20 -I{repo}/src -o x.o -c {file}",
        }
        for file in app.glob("*.cpp")
    ]
    (repo / "compile_commands.json").write_text(json.dumps(commands))
    monkeypatch.setattr("sys.argv", ["alone.py", str(repo)])
    assert alone.main() == 1
    shown = capsys.readouterr().out
    assert "4 compiled, 2 do not compile alone" in shown
    assert "src/app/b.cpp:" in shown
    assert "src/app/b.hpp:" in shown
    assert "src/app/a" not in shown


def test_a_header_that_no_source_includes_is_checked_by_itself(
    repo: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    app = repo / "src" / "app"
    (app / "users.hpp").write_text("#pragma once\ninline int users() { return 0; }\n")
    command = f"c++ -I{repo}/src -o x.o -c {app / 'c.cpp'}"
    commands = [{"file": str(app / "c.cpp"), "directory": str(repo), "command": command}]
    (repo / "compile_commands.json").write_text(json.dumps(commands))
    checked: dict[str, str] = {}

    def find(build: Path, _tool: bytes, entry: dict[str, str]) -> str:
        checked[entry["file"].rpartition("/")[2]] = entry.get("command", "")
        listed = json.loads((build / "compile_commands.json").read_text())
        assert entry in listed
        return ""

    monkeypatch.setattr(tidy, "check", find)
    monkeypatch.setattr(tidy, "version", lambda: b"")
    monkeypatch.setattr("sys.argv", ["tidy.py", str(repo)])
    assert tidy.main() == 0
    assert checked.keys() == {"c.cpp", "app_a.hpp.cpp", "app_users.hpp.cpp"}
    assert checked["app_users.hpp.cpp"].endswith("app_users.hpp.cpp")
    assert "1 sources, 2 headers alone" in capsys.readouterr().out
    monkeypatch.setattr("sys.argv", ["tidy.py", str(repo), "--since", "HEAD"])
    checked.clear()
    tidy.main()
    assert checked.keys() == {"app_users.hpp.cpp"}, "what has not changed is not checked again"
