# Sourced by the scripts that write into the clone: files of another user, as a run with sudo leaves them.
# shellcheck shell=bash

# must_be_ours PATH... [FIND'S OPTION...]: fails, with the remedy, at one that this user neither owns nor can write.
must_be_ours() {
    local foreign
    foreign=$(find "$@" ! -user "$(id -u)" ! -writable -print -quit 2>/dev/null) || true
    [ -n "$foreign" ] || return 0
    case $foreign in
        "${repo:?}"/*) echo "${foreign#"$repo/"} belongs to another user: sudo chown -R \"\$USER\" . (in the clone)" ;;
        *) echo "$foreign belongs to another user: sudo chown -R \"\$USER\" ${1@Q}" ;;
    esac >&2
    return 1
}
