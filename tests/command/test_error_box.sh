#!/bin/sh
# The command `error` on a box of particles.
# shellcheck source=tests/command/harness.sh
. "${0%/*}/harness.sh"

# near ACTUAL EXPECTED WHAT: to 1e-10 relative
near() {
    low=$(awk -v x="$2" 'BEGIN {printf "%.17g", x * (1 - 1e-10)}')
    high=$(awk -v x="$2" 'BEGIN {printf "%.17g", x * (1 + 1e-10)}')
    math "$low" le "$1"
    math "$1" le "$high"
}

# Root mean square errors on 25 x 25 particles, vertices on the edges, h = sqrt(13/(4 pi)) dx with
# the cubic B-spline, or h = N^(-1/6) with Sigalotti's Wendland kernel. Expected: a program of its
# own in another language, every pair summed in double precision and each system solved by LAPACK;
# its rounding is below 1e-12 relative.
h=0.042379468178418951
while read -r method field index expected; do
    expect 0 error -k cubic-spline --particles 625 --h $h --method "$method" --field "$field" \
        --format json
    near "$(json "quantities.$index.empirical.rmse")" "$expected" "$method $field $index"
    near "$(json "quantities.$index.analytic.rmse")" "$expected" "$method $field $index, theory"
done <<'END'
sph f1 0 0.006328083511662879
sph f2 1 28.150292907203973
sph-difference f1 1 0.30642233103328315
sph-difference f2 2 5.836233722936567
cspm f1 0 0.0076321283481541385
cspm f2 2 0.9047989046039288
fpm f1 1 0.019218628647665034
fpm f2 0 0.02706718915223596
END
expect 0 error -k sigalotti-wendland-c4 --particles 625 --h 0.34199518933533945 --method cspm \
    --field f2 --format json
for pair in 0:0.669999740268625 1:2.384726521820847 2:3.6684110377039247; do
    index=${pair%%:*}
    near "$(json "quantities.$index.empirical.rmse")" "${pair##*:}" "cspm f2 $index"
done

# the contract's fields
is "$(json kernel)" sigalotti-wendland-c4 kernel
is "$(json dim)" 2 dim
is "$(json particles)" 625 particles
is "$(json neighbours)" 213 neighbours
is "$(json verdict)" agrees verdict
is "$(json quantities.0.verdict)" agrees 'the verdict of the value'

# every method in every dimension, every format
for method in sph sph-difference shepard bonet-lok rkpm rkpm-0 rkpm-2 cspm fpm msph; do
    for dim_count in 1:40 2:144 3:216; do
        run error -k wendland-c2 --dim "${dim_count%%:*}" --particles "${dim_count##*:}" -s 0.6 \
            --method $method --field 'x^2 - 2*x + 1' --format csv
        if [ "$status" -gt 1 ]; then
            failed "$command_line: status $status"
        fi
        "$READ_OUTPUT" finite "$out" empirical.rmse empirical.maximum ||
            failed "$command_line: bad CSV"
    done
done
expect 0 error -k cubic-spline --particles 400 -s 0.9 --method fpm
holds 'agrees'
expect 0 error -k cubic-spline --particles 400 -s 0.9 --method fpm --format md
holds '|---|'

# without a boundary every particle sees the same
expect 0 error -k cubic-spline --particles 400 -s 0.9 --periodic --field sine --format json
is "$(json neighbours)" "$(json neighbours_least)" 'the number of neighbours'

# layouts without a theory are measured, and say so
expect 1 error -k cubic-spline --particles 400 -s 0.9 --layout random
holds 'no theory'

# where every particle is left out there is no number
expect 1 error -k cubic-spline --particles 900 -s 2.5 --method msph
holds 'no particle'
expect 1 error -k cubic-spline --particles 900 -s 2.5 --method msph --format json
is "$(json quantities.0.empirical.rmse)" null 'a norm over no particle'
is "$(json quantities.0.empirical.excluded.isolated)" 900 'the number of isolated particles'

refuse 2 'square number' error -k cubic-spline --particles 626 -s 0.9
refuse 2 'square number' error -k cubic-spline --particles 1e99 -s 0.9
refuse 2 'cube number' error -k cubic-spline --dim 3 --particles 9 -s 0.9
refuse 2 'not both' error -k cubic-spline --particles 625 -s 0.9 --h 0.1
refuse 2 'not none' error -k cubic-spline --particles 625
refuse 2 'allowed' error -k cubic-spline --particles 1 -s 0.9
refuse 2 'does not repeat' error -k cubic-spline --particles 625 -s 0.9 --periodic
refuse 2 'allowed' error -k cubic-spline --particles 625 -s 0.9 --field 'x^'
refuse 2 'allowed' error -k cubic-spline --particles 625 -s 0.9 --field f2 --dim 1
refuse 2 'not with --particles' error -k cubic-spline --particles 625 -s 0.9 --form paper
refuse 2 'allowed' error -k cubic-spline --particles 625 -s 0.9 --volume tessellated
refuse 2 'not legal' error -k monaghan-m4-prime --dim 3 --particles 1000 -s 0.9
refuse 2 'allowed' error -k cubic-spline --particles 625 --h nan
refuse 2 'perturbed' error -k cubic-spline --particles 625 -s 0.9 --jitter uniform
refuse 2 'perturbed' error -k cubic-spline --particles 625 -s 0.9 --reflected --sigma 0
refuse 2 'x = ' error -k cubic-spline --particles 625 -s 0.9 --field f2 --sigma 0.3
finish
