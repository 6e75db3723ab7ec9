#!/bin/bash
# both commands of the README in a bare Debian 12, with the minutes they took, and the build with GCC 11 (on request)
# RC10_FRESH=demo: only the first command.
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need package
root=$scratch/root
clone=/srv/rc10d
minutes=$scratch/minutes

as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(mmdebstrap --unshare-helper)
trap '"${as_root[@]}" rm -rf "$root"; rm -rf "$scratch"' EXIT

# There is nothing in it but apt. What this machine needs to reach the package archives goes along.
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
    "${as_root[@]}" unshare --mount --pid --fork sh -c '
        root=$1 clone=$2
        shift 2
        mount --bind "$root" "$root" && cd "$root" && mount -t proc proc proc && mount --rbind /dev dev \
            && mount -t sysfs sysfs sys && mount -t tmpfs -o mode=1777 tmpfs tmp && mount --move . / || exit
        exec chroot . env -C "$clone" -u TMPDIR HOME=/root "$@"' sh "$root" "$clone" "$@"
}

# timed NAME COMMAND...
timed() {
    local begin=$SECONDS status=0
    "${@:2}" || status=$?
    # A file: some run in a subshell.
    printf '%-34s %3d:%02d\n' "$1" $(((SECONDS - begin) / 60)) $(((SECONDS - begin) % 60)) >>"$minutes"
    return "$status"
}

gcc_11() {
    in_root apt-get -qq install --no-install-recommends --yes g++-11 || return
    # shellcheck disable=SC2016  # for the inner shell
    in_root sh -c 'cmake -S . -B build/gcc11 -G Ninja -DCMAKE_CXX_COMPILER=g++-11 -DCMAKE_BUILD_TYPE=Release \
            -DRC10_BUILD_TESTS=OFF -DRC10_WERROR=ON && cmake --build build/gcc11 && RC10_BUILD=$PWD/build/gcc11 scripts/demo.sh --seconds 5'
}

step "a bare Debian 12" make_root
if [ "$failed" -eq 0 ]; then
    step "scripts/demo.sh" timed "scripts/demo.sh, 10 s of it" in_root scripts/demo.sh --seconds 10
    if [ "${RC10_FRESH:-}" != demo ]; then
        suite "scripts/test.sh" timed scripts/test.sh in_root scripts/test.sh
        step "the build with GCC 11, and its demo" timed "build with GCC 11" gcc_11
    fi
    cat "$minutes"
fi
finish
