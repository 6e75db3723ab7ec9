#!/bin/bash
# formatting, shellcheck, ruff, mypy, systemd units
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test lint
need_python
cd "$repo"

python() {
    "$RC10_PYTHON" -m "$@"
}

format_cpp() {
    local wrong
    wrong=$(find src tests bench examples -name '*.[ch]pp' -print0 \
        | xargs -0 clang-format-16 --dry-run -ferror-limit=1 -Werror 2>&1) && return
    echo "to be formatted:"
    sed -nE 's/:[0-9]+:[0-9]+: error.*//p' <<<"$wrong" | sort -u | grep . || echo "$wrong"
    return 1
}

# Files that begin like a shell script, with or without an extension.
shell_scripts() {
    find scripts .ci tests packaging completions -type f -not -path '*/.*_cache/*' -print0 \
        | xargs -0 awk 'FNR == 1 && /^#!.*[\/ ](ba|da)?sh|^# (Sourced by|bash completion)/ {print FILENAME}'
}

shell() {
    local found scripts
    found=$(shell_scripts)
    mapfile -t scripts <<<"$found"
    shellcheck -x "${scripts[@]}"
}

# Each folder by itself: several have a conftest.py.
types_in() {
    (cd "$1" && MYPYPATH="$repo/bench:$repo/bench/peers:$repo/tests/kernel:$repo/tests/host:$repo/scripts/lib" python mypy --strict "${@:2}")
}

# "Name of the motor", not "What the motor is called".
comments_begin_with_a_noun() {
    local status=0
    git grep -nE -e '(//+[!<]?|/\*+|^ *\*|#|""") *(-+ )?(What|Who|Whoever|So that|How|Why|Of)\>' \
        -e '[^ ] +(//+[!<]?|#) (what|who|whoever|so that|how|why)\>' -- \
        src tests bench examples cmake scripts python packaging completions systemd config lcm_types web/src CMakeLists.txt \
        .ci .clang-tidy ':!tests/kernel/uml.config' ':!python/requirements.txt' \
        ':!tests/scripts/test_sources.py' ':!tests/package/0.1.0' \
        || status=$?
    [ "$status" -eq 1 ]  # 0: there are some; more: git did not look
}

# "Velocity" does not say what is true of it.
test_names_are_sentences() {
    local status=0
    git grep -nE '^ *TEST(_F|_P)?\(\w+, *[A-Z]?[a-z0-9]+\)|^ *(async )?def test_[a-z0-9]+\(' -- \
        tests python examples bench || status=$?
    [ "$status" -eq 1 ]
}

# A page that no reader of a clone has proves nothing. Pages of makers are theirs.
named_pages_are_tracked() {
    local makers='can|comm_can|registers|socketcan' tracked named
    tracked=$(git ls-files '*.md' | sed 's|.*/||' | sort -u) || return
    named=$(git grep -hoE '[A-Za-z0-9_.-]*[A-Za-z0-9_-]\.md\>' -- . ':!tests/docs' | grep -vE '^\.|^-' | sort -u) || return
    named=$(comm -23 <(grep -vxE "($makers)\.md" <<<"$named") - <<<"$tracked")
    [ -n "$named" ] || return 0
    echo "named, and not tracked by git:"
    git grep -nwFf - -- . ':!tests/docs' <<<"$named"
    return 1
}

# A file with one idea is short.
sources_are_short() {
    local most=600 long
    long=$(git ls-files -z src tests python scripts web/src bench examples cmake \
        | grep -zE '\.(cpp|hpp|py|sh|ts|tsx|css|cmake)$' | xargs -0 wc -l \
        | awk -v most="$most" '$1 > most && $2 != "total" {print $2}') || return
    [ -n "$long" ] || return 0
    echo "longer than $most lines:" && echo "$long" && return 1
}

# A source that .gitignore hides is compiled here and missing in every clone.
git_sees_each_source() {
    [ -e .git ] || return 0
    local ignored hidden
    ignored=$(git ls-files --others --ignored --exclude-standard -- src tests bench examples cmake scripts docs) || return
    hidden=$(grep -vE '(^|/)(__pycache__|\.[a-z]+_cache)/|^$' <<<"$ignored") || return 0
    echo "hidden from git by .gitignore:" && echo "$hidden" && return 1
}

step "git sees each source" git_sees_each_source
step clang-format format_cpp
step "comments begin with a noun" comments_begin_with_a_noun
step "test names are sentences" test_names_are_sentences
step "sources are short" sources_are_short
step "named pages are tracked" named_pages_are_tracked
step shellcheck shell
# Its scripts have no extension, and are not found by themselves.
bench_scripts=(path_latency table viewers peers/run peers/wall)
step "ruff check" python ruff check python tests scripts examples bench "${bench_scripts[@]/#/bench/}"
step "ruff format" python ruff format --check --quiet python tests scripts examples bench "${bench_scripts[@]/#/bench/}"
step "mypy, python" types_in python
for folder in tests/*/; do
    ! compgen -G "$folder*.py" >/dev/null || step "mypy, $folder" types_in "$folder" .
done
step "mypy, scripts" types_in scripts/lib .
step "mypy, bench" types_in bench --scripts-are-modules . "${bench_scripts[@]}"
step "mypy, examples" types_in examples/small_robot .
suite tests/systemd tests/systemd/run
finish
