#!/bin/bash
# Installs the Debian packages that parts of this project need.
#   scripts/install-deps.sh [--list|--missing|--may-ask] [build] [test] [languages] [lint] [kernel] [vm] [web] [package]      default: all
# --list: installs nothing, and prints the packages; --missing: those that are not installed.
# --may-ask: installs nothing, but says what is missing, and lets sudo ask for the password now.
set -euo pipefail
# shellcheck source=scripts/lib/nearest.sh
. "$(dirname "${BASH_SOURCE[0]}")/lib/nearest.sh"

# Also where packages have no manager to ask, which is told further below.
machine=$(dpkg --print-architecture 2>/dev/null) || machine=amd64
declare -A packages=(
    [build]="g++ cmake ninja-build pkg-config ccache git python3 python3-venv iproute2
        libyaml-cpp-dev libspdlog-dev libfmt-dev liblcm-dev liblcm-bin libexpected-dev
        libcli11-dev libboost-dev libseccomp-dev libgpiod-dev libsocketcan-dev libmnl-dev libmd-dev
        libqrencode-dev nlohmann-json3-dev libeigen3-dev"
    [test]="libgtest-dev libgmock-dev libbenchmark-dev strace procps util-linux groff-base mount can-utils jq"
    [languages]="make liblcm-java default-jdk-headless"
    [lint]="clang-16 clang-tidy-16 clang-format-16 libclang-rt-16-dev shellcheck systemd udev"
    [kernel]="linux-source-6.1 gcc make flex bison bc libelf-dev xz-utils mount can-utils"
    [vm]="qemu-system-x86 linux-image-rt-$machine linux-headers-rt-$machine linux-source-6.1 make xz-utils busybox-static kmod file mount
        can-utils systemd udev valgrind"
    [web]="chromium fonts-noto-cjk"
    [package]="dpkg-dev file fakeroot mmdebstrap uidmap lintian binutils mount"
)
groups=(build test languages lint kernel vm web package)

usage() {
    echo "usage: scripts/install-deps.sh [--list|--missing|--may-ask] [${groups[*]}]  (default: all)"
}

die() {
    echo "install-deps: $*" >&2
    exit 1
}

installed() {
    dpkg-query -W -f '${binary:Package} ${db:Status-Status}\n' "$@" 2>/dev/null \
        | sed -n 's/^\([^: ]*\)[^ ]* installed$/\1/p'
}

missing() {
    grep -vxFf <(installed "$@") < <(printf '%s\n' "$@") || true
}

as_root() {
    local sudo=(sudo)
    # Without a terminal nobody can type a password: fail rather than wait.
    [ -t 0 ] || sudo+=(-n)
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    else
        "${sudo[@]}" "$@"
    fi
}

apt() {
    # sudo forgets a proxy.
    as_root env ${http_proxy:+"http_proxy=$http_proxy"} ${https_proxy:+"https_proxy=$https_proxy"} \
        ${no_proxy:+"no_proxy=$no_proxy"} DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 "$@"
}

# DPkg::Lock::Timeout is not for the lock of the lists (apt 2.6), which another apt may hold on a machine that was just started.
update_lists() {
    local said begin=$SECONDS
    until said=$(apt update 2>&1); do
        if [[ $said != */lists/lock* ]] || [ $((SECONDS - begin)) -ge 300 ]; then
            echo "$said" >&2
            return 1
        fi
        sleep 2
    done
}

tell() {
    echo "install-deps: $1 ${#absent[@]} Debian packages: ${absent[*]}" >&2
    [[ ${absent[*]} != *linux-image-rt-* ]] \
        || echo "install-deps: NOTE among them is a PREEMPT_RT kernel, which GRUB may start from then on" >&2
}

# Packages of another release than Debian 12 have other names and interfaces; without lists of packages nobody can tell.
# --old-lists: they may lack a package that is there.
refuse_other_releases() {
    local candidates lacking gpiod
    [[ $(LC_ALL=C apt-cache policy 2>/dev/null) == *" Packages"* ]] || return 0
    # "NAME VERSION" of each that apt could install.
    candidates=$(LC_ALL=C apt-cache policy "${absent[@]}" 2>/dev/null | awk '/^[^ ].*:$/ {name = substr($1, 1, length($1) - 1)}
        $1 == "Candidate:" && $2 != "(none)" {print name, $2}') || true
    lacking=$(cut -d ' ' -f 1 <<<"$candidates" | grep -vxFf - <(printf '%s\n' "${absent[@]}") | paste -sd ' ') || true
    [ -z "$lacking" ] || [ "${1:-}" = --old-lists ] || die "apt here has no $lacking: those are packages of Debian 12 (if this is one: sudo apt-get update)"
    gpiod=$(sed -n 's/^libgpiod-dev //p' <<<"$candidates")
    [[ ! $gpiod =~ ^([0-9]+:)?([2-9]|[1-9][0-9]+)\. ]] \
        || die "libgpiod-dev here is $gpiod, which has another interface than 1.6: rc10d needs that of Debian 12"
}

list='' list_missing='' may_ask=''
[ "${1:-}" != --list ] || { list=yes && shift; }
[ "${1:-}" != --missing ] || { list_missing=yes && shift; }
[ "${1:-}" != --may-ask ] || { may_ask=yes && shift; }
[ $# -gt 0 ] || set -- "${groups[@]}"
wanted=()
for group in "$@"; do
    case $group in -h | --help) usage && exit ;; esac
    if [ -z "$group" ] || [ -z "${packages[$group]:-}" ]; then
        echo "install-deps: no group '$group'$(did_you_mean "$group" "${groups[@]}" --list --missing --may-ask)" >&2
        usage >&2
        exit 2
    fi
    read -r -d '' -a names <<<"${packages[$group]}" || true
    wanted+=("${names[@]}")
done

[ -z "$list" ] || { printf '%s\n' "${wanted[@]}" && exit; }
command -v dpkg-query >/dev/null || die "this is no Debian; what is needed, as Debian 12 calls it: ${wanted[*]}"
mapfile -t absent < <(missing "${wanted[@]}" | sort -u)
[ ${#absent[@]} -gt 0 ] || exit 0
[ -z "$list_missing" ] || { printf '%s\n' "${absent[@]}" && exit; }
# Modules that are built with the headers must fit the kernel: both of one version.
[[ " ${absent[*]} " != *" linux-headers-rt-$machine "* ]] || absent+=("linux-image-rt-$machine")

# Root is asked for no password, and has the lists updated below.
if [ "$(id -u)" -eq 0 ]; then refuse_other_releases --old-lists; else refuse_other_releases; fi
if [ "$(id -u)" -ne 0 ] && ! command -v sudo >/dev/null; then
    die "missing packages, and neither root nor sudo to install them: apt-get install ${absent[*]}"
fi
if [ -n "$may_ask" ]; then
    tell "this needs"
    [ ! -t 0 ] || as_root true || die "sudo did not allow it; somebody who may: apt-get install ${absent[*]}"
    exit
fi
tell installing
install=(install --no-install-recommends --yes "${absent[@]}")
# The package lists may be missing or name versions that the archive no longer has.
apt "${install[@]}" >&2 || { update_lists && refuse_other_releases && apt "${install[@]}" >&2; } \
    || die "apt-get could not install ${absent[*]}"
