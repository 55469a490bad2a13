#!/bin/sh
# check: sound kernels pass, each kind of wrong kernel is noticed.
# shellcheck source=tests/command/harness.sh
. "${0%/*}/harness.sh"

expect 0 check --all --format json
"$READ_OUTPUT" json "$out" >/dev/null || failed 'check --all: not JSON'
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
wrong last-coefficient 's|"-1/4"|"-0.25001"|'
wrong sign 's|"-3/2"|"3/2"|'
wrong constant-1d 's|1d: "2/3"|1d: "0.66667"|'
wrong constant-2d 's|2d: "10/7/pi"|2d: "10/7.0001/pi"|'
wrong constant-3d 's|3d: "1/pi"|3d: "0.3183099"|'
wrong smoothness 's|boundary_smoothness: 2|boundary_smoothness: 4|'
wrong order 's|smoothing_order: 2|smoothing_order: 4|'
wrong knot 's|until: 1,|until: 1.001,|'
prime=$SPHVERIFY_DATA/kernels/monaghan-m4-prime.yaml
if [ -e "$prime" ]; then
    sed 's/^claims:.*/claims: {non_negative: true}/' "$prime" >"$work/negative.yaml"
    expect 1 check "$work/negative.yaml" --format json
fi

# a wrong gradient of its own: a factor missing
{
    cat "$cubic"
    printf 'derivative:\n'
    printf '  - {until: 1, coefficients: ["0", "-3", "9/4"]}\n'
    printf '  - {until: 2, coefficients: ["-3", "3", "-3/4"]}\n'
} >"$work/gradient.yaml"
expect 0 check "$work/gradient.yaml"
wrong gradient-factor 's|"0", "-3", "9/4"|"-3", "9/4"|' "$work/gradient.yaml"
wrong gradient-sign 's|"-3", "3", "-3/4"|"3", "-3", "3/4"|' "$work/gradient.yaml"
wrong gradient-digit 's|"9/4"|"2.250001"|' "$work/gradient.yaml"

# two kernels: the worse verdict decides, and the sound one is still judged
expect 1 check cubic-spline "$work/sign.yaml"
finish
