#!/bin/bash
# Drives a simulated robot, without CAN and without rights: rc10d with the motors of config/demo.yaml, and
# a program in a process of its own that commands them through LCM.
#   scripts/demo.sh [--seconds N]       until Ctrl-C, or for N seconds
# RC10_BUILD: a build tree to use as it is, instead of making build/release.
set -euo pipefail
unset CDPATH # a `cd` that finds a folder by it prints that

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=scripts/lib/project.sh
. "$here/lib/project.sh"
# shellcheck source=scripts/lib/nearest.sh
. "$here/lib/nearest.sh"
# shellcheck source=scripts/lib/progress.sh
. "$here/lib/progress.sh"

usage() {
    echo "usage: scripts/demo.sh [--seconds N]"
}

die() {
    echo "demo: $*" >&2
    exit 1
}

seconds=0
lcm=${RC10_DEMO_LCM:-}
while [ $# -gt 0 ]; do
    case $1 in
        --seconds) seconds=${2:-} && shift ;;
        -h | --help) usage && exit ;;
        *)
            meant=$(did_you_mean "$1" --seconds --help)
            [[ ! $1 =~ ^[0-9]+$ ]] || meant="; did you mean --seconds $1?"
            echo "demo: no option '$1'$meant" >&2
            usage >&2
            exit 2
            ;;
    esac
    [[ $seconds =~ ^[0-9]{1,6}$ ]] || {
        echo "demo: --seconds takes a whole number of seconds, at most 999999, not '$seconds'" >&2
        exit 2
    }
    seconds=$((10#$seconds))
    shift
done

build_tree=${RC10_BUILD:-$repo/build/release}

# Session of a preparation, which ends with all that it has started. Sets $pid.
in_background() {
    setsid "$@" &
    pid=$!
    preparing+=("$pid")
}

# shellcheck disable=SC2317  # called by the trap
give_up() {
    local leader
    for leader in "${preparing[@]}"; do
        # Also by itself: it may not have its session yet.
        kill -TERM -- "-$leader" "$leader" 2>/dev/null || true
    done
    rm -rf "$RC10_RUN_DIR"
}

# Preparations, once, outside the namespace. The times are those of a bare Debian with 2 cores.
prepare() {
    local pid client_maker page_maker client_log=$RC10_RUN_DIR/client.log page_log=$RC10_RUN_DIR/page.log
    if [ -z "${RC10_BUILD:-}" ]; then
        "$here/install-deps.sh" --may-ask build
        progress "demo: installing packages of Debian" 30 need build || die "the packages could not be installed"
    fi
    # Beside the compiler: it waits for the network.
    in_background "$here/venv.sh" client >"$client_log" 2>&1
    client_maker=$pid
    if [ -z "${RC10_BUILD:-}" ]; then
        in_background "$here/web.sh" >"$page_log" 2>&1
        page_maker=$pid
        build_shows_files=yes
        progress "demo: compiling rc10d" 75 build release rc10d rc10-lcm rc10ctl rc10-web || die "the build failed"
    fi
    [ -x "$build_tree/bin/rc10d" ] || die "no rc10d in $build_tree/bin"
    progress "demo: installing the Python client" 10 wait "$client_maker" \
        || { cat "$client_log" >&2 && die "the Python client could not be installed"; }
    RC10_PYTHON=$(tail -n 1 "$client_log")
    [ -n "${RC10_BUILD:-}" ] || progress "demo: making the page" 10 wait "$page_maker" || {
        cat "$page_log" >&2
        echo "demo: without the page, then; rc10ctl shows the robot" >&2
    }
    preparing=()
    rm -f "$client_log" "$page_log"
}

# The page is served outside of the namespace, where the browser is; it reaches rc10d by its socket.
serve_page() {
    local port
    page=
    [ -x "$build_tree/bin/rc10-web" ] && [ -e "$repo/build/web/index.html" ] || return 0
    for port in 8010 0; do
        : >"$RC10_RUN_DIR/web.log" # the words of the try before are no answer of this one
        setsid setpriv --pdeathsig TERM "$build_tree/bin/rc10-web" --page "$repo/build/web" --port "$port" \
            >"$RC10_RUN_DIR/web.log" 2>&1 &
        RC10_DEMO_WEB=$!
        until grep -q . "$RC10_RUN_DIR/web.log" || ! kill -0 "$RC10_DEMO_WEB" 2>/dev/null; do sleep 0.05; done
        page=$(sed -n 's/^rc10-web: \(http:.*\)/\1/p' "$RC10_RUN_DIR/web.log")
        [ -z "$page" ] || return 0
        RC10_DEMO_WEB=
    done
    sed 's/^/demo: without the page: /' "$RC10_RUN_DIR/web.log" >&2
}

# LCM's multicast goes to a loopback of our own and reaches no network.
enter_namespace() {
    local ways=("unshare --net --map-root-user") way refused=
    [ "$(id -u)" -ne 0 ] || ways=("unshare --net" "${ways[@]}")
    for way in "${ways[@]}"; do
        # shellcheck disable=SC2086  # words
        refused=$($way ip link set lo up 2>&1) && RC10_DEMO_LCM=yes exec $way "$here/demo.sh" --seconds "$seconds"
    done
    echo "demo: this system refuses network namespaces ($refused):" >&2
    echo "demo: without LCM, then; rc10ctl drives the robot through rc10d's own socket" >&2
    lcm=no
}

if [ -z "$lcm" ]; then
    preparing=()
    RC10_RUN_DIR=$(mktemp -d /tmp/rc10-demo.XXXX)
    RC10_DEMO_WEB=''
    trap give_up EXIT
    trap 'exit 130' INT
    trap 'exit 143' TERM
    trap 'exit 129' HUP
    prepare
    export RC10_RUN_DIR RC10_STATE_DIR=$RC10_RUN_DIR RC10_DEMO_WEB
    serve_page
    export RC10_PYTHON RC10_BUILD=$build_tree RC10_DEMO_PAGE=$page
    enter_namespace
fi

# ---- from here on in the namespace, if there is one

# That of the caller's network; the demo's is in config/demo.yaml.
unset LCM_DEFAULT_URL

bin=$build_tree/bin
log=$RC10_RUN_DIR/rc10d.log
rc10d='' clients=() ended=

# Ctrl-C is for this script, which then ends the others in order; without it they end too.
start() {
    setsid setpriv --pdeathsig TERM "$@" &
}

alive() {
    kill -0 "$1" 2>/dev/null
}

end() {
    local pid status=0
    kill -TERM "$@" 2>/dev/null || true
    for pid; do
        wait "$pid" || status=$?
    done
    return "$status"
}

# shellcheck disable=SC2317  # called by the trap
clean_up() {
    trap '' INT TERM HUP
    local pid
    for pid in "${clients[@]}" $rc10d; do
        end "$pid" || true
    done 2>/dev/null
    [ -z "$RC10_DEMO_WEB" ] || kill -TERM "$RC10_DEMO_WEB" 2>/dev/null || true
    rm -rf "$RC10_RUN_DIR"
}
trap clean_up EXIT
trap 'ended=yes' INT TERM HUP

broken() {
    echo "demo: $*" >&2
    tail -n 20 "$RC10_RUN_DIR"/*.log >&2
    exit 1
}

answers() {
    "$bin/rc10ctl" list >/dev/null 2>&1
}

start_rc10d() {
    local config=$repo/config/demo.yaml deadline=$((SECONDS + 20))
    if [ "$lcm" = yes ]; then
        ip link set lo up
        ip route add 239.255.76.67/32 dev lo src 127.0.0.1
    else
        config=$RC10_RUN_DIR/demo.yaml
        sed 's/^lcm:.*/lcm: {enabled: false}/' "$repo/config/demo.yaml" >"$config"
    fi
    start "$bin/rc10d" -c "$config" >"$log" 2>&1
    rc10d=$!
    until answers; do
        [ -z "$ended" ] || exit 0
        alive "$rc10d" || broken "rc10d did not start"
        [ "$SECONDS" -lt "$deadline" ] || broken "rc10d does not answer"
        sleep 0.05 || true
    done
}

start_setting() {
    start "$bin/rc10ctl" set "$@" --for 1440min >"$RC10_RUN_DIR/set-$1.log" 2>&1
    clients+=($!)
}

start_clients() {
    local out=$RC10_RUN_DIR/drive.log
    if [ "$lcm" = yes ]; then
        start "$RC10_PYTHON" "$repo/python/examples/demo_drive.py" >"$out" 2>&1
        clients=($!)
        # Its first line says that the motors are enabled.
        until grep -q enabled "$out"; do
            [ -z "$ended" ] || exit 0
            alive "${clients[0]}" || broken "the program that drives could not"
            sleep 0.05 || true
        done
    else
        "$bin/rc10ctl" enable >"$out" 2>&1 || broken "the motors could not be enabled"
        start_setting front_left velocity 120
        start_setting front_right velocity -120
        start_setting rear_left velocity -120
        start_setting rear_right velocity 120
        start_setting yaw angle 90
        start_setting pitch angle 15
        start_setting feeder velocity 20
    fi
}

hints() {
    local ctl
    printf -v ctl 'RC10_RUN_DIR=%q %q' "$RC10_RUN_DIR" "$bin/rc10ctl"
    cat <<END
A robot with seven simulated motors runs.${RC10_DEMO_PAGE:+ In a browser: $RC10_DEMO_PAGE}
In a second terminal:
  $ctl watch
  $ctl estop      (go on: clear, then enable)
END
    [ "$seconds" -gt 0 ] || echo "Ctrl-C ends it."
    echo
}

# Draws each table over the one before it.
overdraw() {
    local line rows=0
    trap '' INT
    printf '\e[?7l'
    while IFS= read -r line; do
        if [ -n "$line" ]; then
            printf '%s\e[K\n' "$line"
            rows=$((rows + 1))
        else
            printf '\e[%dA' "$rows"
            rows=0
        fi
    done
    printf '\e[?7h'
}

all_alive() {
    local pid
    for pid in "$@"; do
        alive "$pid" || return
    done
}

# Until the time is over, Ctrl-C, or something breaks.
show() {
    local hz=1 count=() draw=cat watch
    if [ -t 1 ]; then
        hz=5
        draw=overdraw
    fi
    [ "$seconds" -eq 0 ] || count=(--count $((seconds * hz)))
    "$bin/rc10ctl" watch --hz "$hz" "${count[@]}" > >("$draw") &
    watch=$!
    # `wait -n` would miss one that has ended just before it.
    while [ -z "$ended" ] && all_alive "$watch" "$rc10d" "${clients[@]}"; do
        sleep 0.1 || true
    done
    if [ -n "$ended" ]; then
        # A second Ctrl-C would interrupt the waiting for those that end.
        trap '' INT TERM HUP
        end "$watch" || true
        return
    fi
    # A process that is killed closes its sockets, and its clients end, before it has ended itself.
    if ! alive "$rc10d" || ! answers; then broken "rc10d ended by itself"; fi
    all_alive "${clients[@]}" || broken "a program that drives ended by itself"
    wait "$watch" || broken "rc10ctl watch failed"
}

# The clients let go of the motors, then rc10d stops; each says how it was.
finish() {
    trap '' INT TERM HUP
    end "${clients[@]}" || broken "a program that drives did not end well"
    clients=()
    end "$rc10d" || broken "rc10d did not end well"
    rc10d=
    echo
    sed -n '/^followed/,$p' "$RC10_RUN_DIR/drive.log"
    sed -n 's/^.* info \([0-9]* ticks,.*\)/rc10d: \1/p' "$log"
}

start_rc10d
start_clients
hints
show
finish
