#!/bin/bash
# the commands of README.md and what pages install, in a bare Debian 12, with the minutes they took; the build with GCC 11 (on request; above an hour)
# RC10_FRESH: one thing only: demo, the first command of README.md; default, ci or all, that set of scripts/test.sh; pages, what they install.
# Without it: demo, all, the build with GCC 11, pages.
# RC10_FRESH_CACHE=1: with this machine's compiler cache, and its list of what clang-tidy found clean.
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

wanted=${RC10_FRESH:-everything}
case $wanted in
    demo | default | ci | all | pages | everything) ;;
    *)
        echo "FAILED fresh: no RC10_FRESH=$wanted: demo, default, ci, all or pages"
        echo "0 passed, 1 failed, 0 skipped"
        exit 1
        ;;
esac

if [ "$(id -u)" -ne 0 ]; then
    echo "FAILED fresh: it makes a Debian with mounts of its own, and installs in it: run it as root"
    echo "0 passed, 1 failed, 0 skipped"
    exit 1
fi

need package
root=$scratch/root
clone=/srv/rc10d
home=/root
minutes=$scratch/minutes

# A Debian of nothing but apt, and what this machine needs to reach the package archives.
make_root() {
    local file
    "$repo/scripts/lib/debian_sources" | mmdebstrap --quiet --variant=apt --dpkgopt=force-unsafe-io bookworm "$root" - \
        && git clone --quiet "$repo" "$root$clone" || return
    for file in /etc/resolv.conf /etc/pip.conf "${PIP_CERT:-}" "${SSL_CERT_FILE:-}" "${REQUESTS_CA_BUNDLE:-}"; do
        [ ! -f "$file" ] || install -D -m 644 "$file" "$root$file"
    done
    # Certificates of this machine's own: the package ca-certificates writes its list anew, with these.
    [ ! -d /usr/local/share/ca-certificates ] || cp -r /usr/local/share/ca-certificates "$root/usr/local/share/"
}

# in_root COMMAND...: in the clone, with mounts that end with it. The root is moved to / before: in a mere chroot
# the kernel lets nobody make a user namespace, nor a mount private.
in_root() {
    # shellcheck disable=SC2016  # for the inner shell
    unshare --mount --pid --fork sh -c '
        root=$1 clone=$2 home=$3 caches=${XDG_CACHE_HOME:-$HOME/.cache}
        shift 3
        for cache in ${RC10_FRESH_CACHE:+ccache rc10/tidy}; do
            mkdir -p "$caches/$cache" "$root$home/.cache/$cache" \
                && mount --bind "$caches/$cache" "$root$home/.cache/$cache" || exit
        done
        mount --rbind "$root" "$root" && cd "$root" && mount -t proc proc proc && mount --rbind /dev dev \
            && mount -t sysfs sysfs sys && mount -t tmpfs -o mode=1777 tmpfs tmp && mount --move . / || exit
        exec chroot . env -C "$clone" -u TMPDIR -u XDG_CACHE_HOME HOME="$home" XDG_RUNTIME_DIR="$home" "$@"' sh "$root" "$clone" "$home" "$@"
}

# timed NAME COMMAND...
timed() {
    local begin=$SECONDS status=0
    "${@:2}" || status=$?
    # A file: some run in a subshell.
    printf '%-34s %3d:%02d\n' "$1" $(((SECONDS - begin) / 60)) $(((SECONDS - begin) % 60)) >>"$minutes"
    return "$status"
}

# shown PAGE NUMBER: types what the page shows, its NUMBERth block that is marked with this script.
shown() {
    local text
    text=$("$repo/scripts/lib/page_block" scripts/test/fresh.sh "$repo/$1" "$2") || return
    in_root bash -ec "$text"
}

pages() {
    # Nobody types "y", and root has no use for sudo.
    echo 'APT::Get::Assume-Yes "true";' >"$root/etc/apt/apt.conf.d/90yes"
    printf '#!/bin/sh\nexec "$@"\n' >"$root/usr/local/bin/sudo" && chmod 755 "$root/usr/local/bin/sudo"
    step "docs/quick-start.md: without the demo" timed "quick start, section 2" shown docs/quick-start.md 2
    step "docs/quick-start.md: what draws" shown docs/quick-start.md 3
    step "docs/quick-start.md: rc10-sim" shown docs/quick-start.md 4
    step "docs/python.md: installing" timed "Python package" shown docs/python.md 1
    step "docs/robot-programs.md: installing" shown docs/robot-programs.md 1
    step "python/README.md: installing" shown python/README.md 1
    step "python/README.md: developing" shown python/README.md 2
    step "docs/measuring.md: measuring" timed "benchmarks" shown docs/measuring.md 1
}

demo() {
    in_root scripts/demo.sh --seconds 10 | tee "$scratch/shown"
}

gcc_11() {
    in_root apt-get -qq install --no-install-recommends --yes g++-11 || return
    # shellcheck disable=SC2016  # for the inner shell
    in_root sh -c 'cmake -S . -B build/gcc11 -G Ninja -DCMAKE_CXX_COMPILER=g++-11 -DCMAKE_BUILD_TYPE=Release \
            -DRC10_BUILD_TESTS=OFF -DRC10_WERROR=ON && cmake --build build/gcc11 && RC10_BUILD=$PWD/build/gcc11 scripts/demo.sh --seconds 5'
}

# test_set SET
test_set() {
    suite "scripts/test.sh $1" timed "scripts/test.sh $1" in_root env CI="${CI:-}" scripts/test.sh "$1"
}

first_command() {
    step "scripts/demo.sh" timed "scripts/demo.sh, 10 s of it" demo
    step "it serves the page" grep -q 'http://localhost:' "$scratch/shown"
}

step "a bare Debian 12" make_root
if [ "$failed" -eq 0 ]; then
    case $wanted in
        demo) first_command ;;
        default | ci | all) test_set "$wanted" ;;
        pages) pages ;;
        everything)
            first_command
            test_set all
            step "the build with GCC 11, and its demo" timed "build with GCC 11" gcc_11
            pages
            step "CONTRIBUTING.md: building" shown CONTRIBUTING.md 1
            ;;
    esac
    cat "$minutes"
fi
finish
