#!/bin/sh
# check: sound kernels pass, wrong ones are noticed; test_check_causes.sh has each kind.
# shellcheck source=tests/command/harness.sh
. "${0%/*}/harness.sh"

# a catalogue with a kernel of each kind: the self-test and the tests of the library check them all
mkdir -p "$work/data/kernels" "$work/data/scenes"
for name in cubic-spline gaussian sinc-3 monaghan-m4-prime; do
    cp "$SPHVERIFY_DATA/kernels/$name.yaml" "$work/data/kernels"
done
expect 0 check --all --data-dir "$work/data" --format json
"$READ_OUTPUT" json "$out" >/dev/null || failed 'check --all: not JSON'
is "$(json 3.kernel)" sinc-3 'the last of four kernels'
expect 0 check quinlan-w10 --format json
is "$(json verdict)" agrees verdict
is "$(json kernel)" quinlan-w10 kernel
for field in id claim analytic empirical bound verdict; do
    [ "$(json checks.0.$field)" = - ] && failed "check: no field $field"
done
for format in text csv md; do
    expect 0 check cubic-spline --format $format
    grep -qiw nan "$out" && failed "check --format $format prints NaN"
done
expect 0 check cubic-spline -o "$work/out"
"$READ_OUTPUT" json "$work/out/check-cubic-spline.json" >/dev/null || failed 'no check JSON'
[ -s "$work/out/check-cubic-spline.md" ] || failed 'no check Markdown'
no_partial "$work/out"

cubic=$SPHVERIFY_DATA/kernels/cubic-spline.yaml
# wrong NAME EDIT [FILE]: the edited file is noticed, by name, with the exit status
wrong() {
    sed "$2" "${3:-$cubic}" >"$work/$1.yaml"
    cmp -s "${3:-$cubic}" "$work/$1.yaml" && failed "$1: the edit changes nothing"
    expect 1 check "$work/$1.yaml" --format json
    is "$(json verdict)" disagrees "the verdict on $1"
}
wrong fifth-digit 's|"3/4"|"0.75001"|'
wrong constant-2d 's|2d: "10/7/pi"|2d: "10/7.0001/pi"|'

# a gradient of its own, right and wrong
{
    cat "$cubic"
    printf 'derivative:\n'
    printf '  - {until: 1, coefficients: ["0", "-3", "9/4"]}\n'
    printf '  - {until: 2, coefficients: ["-3", "3", "-3/4"]}\n'
} >"$work/gradient.yaml"
expect 0 check "$work/gradient.yaml"
wrong gradient-digit 's|"9/4"|"2.250001"|' "$work/gradient.yaml"

# two kernels: the worse verdict decides, and the sound one is still judged
expect 1 check cubic-spline "$work/fifth-digit.yaml"
finish
