# bash completion of rc10ctl. Verbs and options are asked of rc10ctl itself, motors of the rc10d that runs, so that
# nothing here grows old.
# shellcheck shell=bash

# Lines of `rc10ctl --help` below "Subcommands:" are "  verb   what it does".
_rc10ctl_verbs() {
    "$1" --help 2>/dev/null | sed -n '/^Subcommands:/,$ s/^  \([a-z][a-z-]*\) .*/\1/p'
}

_rc10ctl_options() {
    "$@" --help 2>/dev/null | grep -o -e '--[a-z][a-z-]*' | sort -u
}

# The first column of `rc10ctl list`, below its titles.
_rc10ctl_motors() {
    "$@" list 2>/dev/null | sed -n '/^MOTOR /,$ { /^MOTOR /d; s/ .*//p; }'
}

# Keys of `rc10ctl gains MOTOR`: the motor comes last.
_rc10ctl_gains() {
    "$@" 2>/dev/null | sed -n 's/^\([a-z]*_pid\.[a-z_]*\) .*/\1=/p'
}

_rc10ctl() {
    local program=${COMP_WORDS[0]} word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
    local verb='' motor='' index words=''
    local -a robot=()
    for ((index = 1; index < COMP_CWORD; index++)); do
        case ${COMP_WORDS[index]} in
            --robot | --socket)
                robot+=("${COMP_WORDS[index]}" "${COMP_WORDS[index + 1]}")
                ((index++))
                ;;
            -*) ;;
            *)
                [ -z "$verb" ] || [ -n "$motor" ] || motor=${COMP_WORDS[index]}
                [ -n "$verb" ] || verb=${COMP_WORDS[index]}
                ;;
        esac
    done
    COMPREPLY=()
    case $before in
        --config | --socket | --out | --csv | --bode)
            mapfile -t COMPREPLY < <(compgen -f -- "$word")
            return
            ;;
    esac
    if [[ $word == -* ]]; then
        words=$(_rc10ctl_options "$program" ${verb:+"$verb"} && _rc10ctl_options "$program")
    elif [ -z "$verb" ]; then
        words=$(_rc10ctl_verbs "$program")
    else
        case $verb in
            check | blackbox)
                mapfile -t COMPREPLY < <(compgen -f -- "$word")
                return
                ;;
            scan) words=$(for net in /sys/class/net/*; do [ "$(cat "$net/type" 2>/dev/null)" != 280 ] || echo "${net##*/}"; done) ;;
            set)
                if [ "$before" = set ]; then
                    words=$(_rc10ctl_motors "$program" "${robot[@]}")
                else
                    words='coast current velocity angle total_angle impedance voltage duty brake'
                fi
                ;;
            test-motion)
                case $before in
                    test-motion) words=$(_rc10ctl_motors "$program" "${robot[@]}") ;;
                    --mode) words='velocity total_angle current' ;;
                    *) words='step ramp sweep multisine' ;;
                esac
                ;;
            gains)
                if [ "$before" = gains ]; then
                    words=$(_rc10ctl_motors "$program" "${robot[@]}")
                else
                    words=$(_rc10ctl_gains "$program" "${robot[@]}" gains "$motor")
                    compopt -o nospace 2>/dev/null || true
                fi
                ;;
            config)
                if [ "$before" = config ]; then
                    words='check install restart'
                else
                    mapfile -t COMPREPLY < <(compgen -f -- "$word")
                    return
                fi
                ;;
            load)
                if [ "$before" = load ]; then
                    words=$(_rc10ctl_motors "$program" "${robot[@]}")
                else
                    words='inertia_kg_m2= viscous_nms_per_rad= coulomb_nm= load_torque_nm= gravity_nm= payload_kg= payload_at_m='
                    compopt -o nospace 2>/dev/null || true
                fi
                ;;
            enable | disable | clear | zero | jog | commission | configure-drive | hand) words=$(_rc10ctl_motors "$program" "${robot[@]}") ;;
        esac
    fi
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}

complete -o default -F _rc10ctl rc10ctl
