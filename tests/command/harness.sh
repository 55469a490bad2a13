# What every command test shares; sourced. Needs SPHVERIFY (the program), READ_OUTPUT and
# SPHVERIFY_DATA in the environment.
# shellcheck shell=sh
set -u
LC_ALL=C
export LC_ALL
: "${SPHVERIFY:?the program under test}" "${READ_OUTPUT:?the reader}" "${SPHVERIFY_DATA:?}"

work=$(mktemp -d) || exit 99
trap 'chmod -R u+w "$work" 2>/dev/null; rm -rf "$work"' EXIT INT TERM
out=$work/stdout
err=$work/stderr
failures=0
checks=0

failed() {
    failures=$((failures + 1))
    echo "FAILED: $*"
    echo "  stdout: $(head -c 400 "$out" 2>/dev/null)"
    echo "  stderr: $(head -c 400 "$err" 2>/dev/null)"
}

# run ARGS…: runs the program; its exit status is in $status.
run() {
    command_line="sphverify $*"
    "$SPHVERIFY" "$@" >"$out" 2>"$err"
    status=$?
    checks=$((checks + 1))
    # a signal, or a sanitizer's report, is a crash whatever was expected
    if [ "$status" -ge 124 ] || grep -q 'Sanitizer\|runtime error' "$err"; then
        failed "$command_line crashed with status $status"
    fi
}

# expect STATUS ARGS…
expect() {
    wanted=$1
    shift
    run "$@"
    [ "$status" -eq "$wanted" ] || failed "$command_line: status $status, expected $wanted"
}

# refuse STATUS PART ARGS…: that status, nothing on stdout, one line on stderr that holds PART.
refuse() {
    wanted=$1
    part=$2
    shift 2
    run "$@"
    [ "$status" -eq "$wanted" ] || failed "$command_line: status $status, expected $wanted"
    [ -s "$out" ] && failed "$command_line: wrote to stdout"
    [ "$(wc -l <"$err")" -eq 1 ] || failed "$command_line: $(wc -l <"$err") lines on stderr, not 1"
    grep -qF -- "$part" "$err" || failed "$command_line: stderr lacks '$part'"
    # a message is plain text, whatever was in the input
    tr -d '\n\t\040-\176\200-\377' <"$err" | grep -q . && failed "$command_line: control characters"
}

# holds PART: the last output contains it.
holds() {
    grep -qF -- "$1" "$out" || failed "$command_line: stdout lacks '$1'"
}

# json PATH: a value of the last output.
json() {
    "$READ_OUTPUT" json "$out" "$1"
}

# is VALUE EXPECTED WHAT
is() {
    checks=$((checks + 1))
    [ "$1" = "$2" ] || failed "$command_line: $3 is '$1', expected '$2'"
}

# math A OP B: a comparison of numbers that must hold; NaN never does.
math() {
    checks=$((checks + 1))
    "$READ_OUTPUT" math "$1" "$2" "$3" || failed "$command_line: not $1 $2 $3"
}

# no_partial FOLDER: no temporary or empty file was left there.
no_partial() {
    checks=$((checks + 1))
    left=$(find "$1" \( -name '*.tmp*' -o -name '.*' -o -size 0 \) ! -type d 2>/dev/null)
    [ -z "$left" ] || failed "$command_line: left behind: $left"
}

finish() {
    echo "$checks checks, $failures failed"
    [ "$failures" -eq 0 ]
    exit
}
