# Sourced by the scripts that set things up: one line that moves while something takes its time.
# shellcheck shell=bash

# progress TITLE SECONDS COMMAND...: SECONDS is how long it took elsewhere. What the command prints is shown only
# if it fails. Without a terminal the line is printed once; what is done at once is not mentioned.
progress() {
    local title=$1 expected=$2 file fd log ticker status=0
    # Without a name it goes with the processes that have it open, however these end.
    file=$(mktemp "${TMPDIR:-/tmp}/rc10-progress.XXXXXX")
    exec {fd}<>"$file"
    rm "$file"
    log=/dev/fd/$fd
    tick_progress "$title" "$expected" "$log" "$$" &
    ticker=$!
    "${@:3}" >>"$log" 2>&1 || status=$?
    kill "$ticker" 2>/dev/null || true
    wait "$ticker" 2>/dev/null || true
    [ ! -t 2 ] || printf '\r\e[K' >&2
    [ "$status" -eq 0 ] || cat "$log" >&2
    exec {fd}>&-
    return "$status"
}

# The second hand of progress(), in a process of its own; it ends with the script PID.
tick_progress() {
    local title=$1 expected=$2 log=$3 script=$4 elapsed=0 whole rest=
    whole=$(as_minutes "$expected")
    sleep 1
    [ -t 2 ] || echo "$title (about $whole on 2 cores)" >&2
    while kill -0 "$script" 2>/dev/null; do
        elapsed=$((elapsed + 1))
        if [ -t 2 ]; then
            # Ninja counts its files.
            rest=$(tail -n 1 "$log" 2>/dev/null | sed -nE 's/^\[([0-9]+)\/([0-9]+)\].*/, file \1 of \2/p')
            printf '\r%s: %s of about %s%s\e[K' "$title" "$(as_minutes "$elapsed")" "$whole" "$rest" >&2
        fi
        sleep 1
    done
}

as_minutes() {
    printf '%d:%02d' $(($1 / 60)) $(($1 % 60))
}
