#!/bin/sh
# Every command shown in README, run as shown; its output must hold every line that README prints.
# Rounding differs between machines, so numbers are compared to seven digits, and bounds and times by
# their presence.
# shellcheck source=tests/command/harness.sh
. "${0%/*}/harness.sh"
readme=$(cd "${0%/*}/../.." && pwd)/README.md
cd "$work" || exit 99

# what the reader is told to make first
sed -e 's/"-3\/2", "3\/4"/"3\/4", "-3\/2"/' -e 's/^name: .*/name: mine/' \
    "$SPHVERIFY_DATA/kernels/cubic-spline.yaml" >mine.yaml

plain() {
    sed -E 's/\([0-9.]+ s\)/(# s)/g
        s/([0-9]\.[0-9]{6})[0-9]*(e[-+][0-9]+)?/\1\2/g
        s/\b[0-9]\.[0-9]e[-+][0-9]+/#/g
        s/ +/ /g; s/ +$//'
}

# shown N: the N-th command of README and the lines below it, without their indent
shown() {
    awk -v wanted="$1" '
        /^    \$ sphverify / { count++; taking = count == wanted }
        taking && /^[^ ]/ { exit }
        taking { sub(/^    /, ""); print }' "$readme"
}

number=1
while shown "$number" >block && [ -s block ]; do
    line=$(head -n 1 block)
    arguments=${line#'$ sphverify '}
    number=$((number + 1))
    case $arguments in *libmine.so*) continue ;; esac # needs a compiled library; tested elsewhere
    # shellcheck disable=SC2086  # README's words
    run $arguments
    [ "$status" -le 1 ] || failed "$line: status $status"
    plain <"$out" >actual
    tail -n +2 block | plain | grep -v -e '^$' -e '^…$' >expected
    while IFS= read -r wanted_line; do
        grep -qxF -- "$wanted_line" actual || failed "$line: README shows '$wanted_line'"
    done <expected
done
[ "$number" -ge 5 ] || failed "README shows only $((number - 1)) commands"
finish
