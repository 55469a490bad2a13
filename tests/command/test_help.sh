#!/bin/sh
# Usage, help, version, and what is not a command or an option.
# shellcheck source=tests/command/harness.sh
. "${0%/*}/harness.sh"

expect 0 --help
holds 'Usage: sphverify COMMAND'
holds 'Exit status: 0'
commands=$(sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p' "$out")
for needed in kernels kernel error check run report; do
    echo "$commands" | grep -qx "$needed" || failed "--help does not list $needed"
done
expect 0 --version
grep -Eq '^sphverify [0-9]+\.[0-9]+\.[0-9]+$' "$out" || failed 'the version is not a version'

for command in $commands; do
    expect 0 "$command" --help
    holds "Usage: sphverify $command"
    holds '--format'
    [ -s "$err" ] && failed "$command --help wrote to stderr"
    refuse 2 'no-such-option' "$command" --no-such-option
    refuse 2 'format' "$command" --format xml
    refuse 2 '' "$command" --format
done

run
[ "$status" -eq 2 ] || failed "without a command: status $status"
[ -s "$out" ] && failed 'without a command: wrote to stdout'
refuse 2 "unknown command 'frobnicate'" frobnicate
refuse 2 'unknown command' ''
refuse 2 'unknown command' "$(printf 'two\nlines\033[31m')"
refuse 2 'unknown command' "$(printf '\377\376')"
refuse 2 '' kernels surplus operand
refuse 2 '' error surplus --kernel gaussian --h 0.1 --spacing 0.5
refuse 2 '' kernel
refuse 2 '' kernel cubic-spline gaussian
refuse 2 '' run
finish
