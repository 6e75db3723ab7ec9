# Sourced by the scripts that take words: the word that was meant.
# shellcheck shell=bash

# edit_distance A B: insertions, deletions and replacements between two words.
edit_distance() {
    local a=$1 b=$2 i j cost corner above
    local -a row
    for ((j = 0; j <= ${#b}; j++)); do row[j]=$j; done
    for ((i = 1; i <= ${#a}; i++)); do
        corner=${row[0]} row[0]=$i
        for ((j = 1; j <= ${#b}; j++)); do
            above=${row[j]} cost=$corner
            [ "${a:i-1:1}" = "${b:j-1:1}" ] || cost=$((corner + 1))
            row[j]=$((above + 1 < row[j - 1] + 1 ? above + 1 : row[j - 1] + 1))
            ((row[j] <= cost)) || row[j]=$cost
            corner=$above
        done
    done
    echo "${row[${#b}]}"
}

# did_you_mean WORD KNOWN...: "; did you mean host?", or nothing if none is near.
did_you_mean() {
    local word=${1:0:40} known best='' distance least
    least=$((${#word} / 3 + 1))
    [ "$least" -ge 2 ] || least=2
    for known in "${@:2}"; do
        distance=$(edit_distance "$word" "$known")
        [ "$distance" -gt "$least" ] || { best=$known && least=$((distance - 1)); }
    done
    [ -z "$best" ] || echo "; did you mean $best?"
}
