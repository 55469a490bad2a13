#!/bin/sh
# The formats of every command, parsed strictly, and the JSON contract.
# shellcheck source=tests/command/harness.sh
. "${0%/*}/harness.sh"

# kernels: as many rows as files
files=$(find "$SPHVERIFY_DATA/kernels" -name '*.yaml' | wc -l)
expect 0 kernels
expect 0 kernels --format csv
rows=$("$READ_OUTPUT" csv "$out") || failed 'kernels: not CSV'
is "${rows% *}" "$files" 'the number of kernels'
names=$("$READ_OUTPUT" column "$out" name)
"$READ_OUTPUT" column "$out" dimensions >"$work/dimensions"
on_a_line=$(printf '%s\n' "$names" | paste -d ' ' - "$work/dimensions" | sed -n 's/ 1\( .*\)*$//p')
expect 0 kernels --format json
"$READ_OUTPUT" json "$out" >/dev/null || failed 'kernels: not JSON'
expect 0 kernels --format md
holds '|---|'

# kernel: every kernel, and every format for kernels of each kind
for kernel in $names; do
    expect 0 kernel "$kernel" --format json
    is "$(json kernel)" "$kernel" name
done
for kernel in cubic-spline gaussian sinc-3 monaghan-m4-prime; do
    for format in text md; do
        expect 0 kernel "$kernel" --format $format
        grep -qiw 'nan' "$out" && failed "kernel $kernel --format $format prints NaN"
    done
    expect 0 kernel "$kernel" --format csv
    "$READ_OUTPUT" finite "$out" || failed "kernel $kernel: bad CSV"
done

# error: every kernel for one dimension agrees; the contract's fields, and the same numbers in JSON
# and CSV
math 20 le "$(printf '%s\n' "$on_a_line" | wc -l)"
for kernel in $on_a_line; do
    expect 0 error --kernel "$kernel" --h 1/50 --spacing 4/11
done
for kernel in cubic-spline quinlan-w8 quinlan-w10 gaussian; do
    expect 0 error --kernel "$kernel" --h 1/50 --spacing 4/11 --format json
    is "$(json kernel)" "$kernel" name
    is "$(json dim)" 1 dim
    is "$(json form)" exact form
    is "$(json method)" sph method
    is "$(json layout)" lattice layout
    is "$(json volume)" lattice volume
    is "$(json verdict)" agrees verdict
    is "$(json analytic.rigour)" exact rigour
    math "$(json h)" eq 0.02
    math "$(json spacing)" eq 0.36363636363636365
    for field in analytic.smoothing analytic.discretisation analytic.total analytic.l2 \
        analytic.bound empirical.total empirical.l2 empirical.bound empirical.particles \
        empirical.neighbours empirical.pairs empirical.seconds difference; do
        math "$(json $field)" le 1e30
    done
    for field in sigma seed; do
        [ "$(json $field)" = - ] && failed "error: no field $field"
    done
    total=$(json analytic.total)
    expect 0 error --kernel "$kernel" --h 1/50 --spacing 4/11 --format csv
    is "$("$READ_OUTPUT" column "$out" analytic.total)" "$total" 'the total in CSV'
done
expect 0 error --kernel quinlan-w10 --h 0.02 --spacing 4/11 --form paper --format json
is "$(json form)" paper form
is "$(json analytic.rigour)" asymptotic rigour
expect 0 error --kernel quinlan-w10 --h 0.02 --spacing 4/11 --exhaustive --format json
math 100 le "$(json empirical.particles)"
expect 1 error --kernel cubic-spline --h 0.02 --spacing 4/11 --form paper --format json
is "$(json verdict)" disagrees 'the verdict on the paper form for the cubic spline'

# the exact form at a spacing that is no 2κ/(2n+1), given as a fraction and as a decimal
expect 0 error --kernel cubic-spline --h 0.02 --spacing 3/8 --format json
total=$(json analytic.total)
expect 0 error --kernel cubic-spline --h 2e-2 --spacing 0.375 --format json
is "$(json analytic.total)" "$total" 'the total at 3/8 and at 0.375'

# a title is data: quotes, commas, markup and formulae must come out as they went in
cat >"$work/odd.yaml" <<'END'
name: odd
title: "a \"b\", <script>alert(1)</script> & |x| =1+1 `id` $(id)"
source: "line one\nline two, \"quoted\""
support: 2
family: double-cosine
dimensions: [1]
END
# shellcheck disable=SC2016  # nothing is to be expanded
title='a "b", <script>alert(1)</script> & |x| =1+1 `id` $(id)'
expect 0 kernel "$work/odd.yaml" --format json
is "$(json title)" "$title" 'the title in JSON'
mkdir -p "$work/data/kernels" "$work/data/scenes"
cp "$work/odd.yaml" "$work/data/kernels/"
expect 0 kernels --data-dir "$work/data" --format csv
is "$("$READ_OUTPUT" csv "$out")" '1 6' 'the size of the table'
# a leading =, +, - or @ may be disarmed, so only the end is compared
is "$("$READ_OUTPUT" column "$out" title | tail -c 24)" "$(printf '%s\n' "$title" | tail -c 24)" \
    'the title in CSV'
expect 0 kernels --data-dir "$work/data" --format md
is "$(grep -c . "$out")" 3 'lines of the Markdown table'
finish
