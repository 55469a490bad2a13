#!/bin/sh
# Every shipped scene through the real command; the report over some of them.
# shellcheck source=tests/command/harness.sh
. "${0%/*}/harness.sh"

data_of_tests=${0%/*}/../data
count=0
for scene in "$SPHVERIFY_DATA"/scenes/*.yaml "$data_of_tests/scenes/convergence-small.yaml"; do
    name=$(basename "$scene" .yaml)
    # Long work: the report runs them; here the small scene of the same kind does.
    case $name in
    sigalotti-2016-table-[23] | consistency-against-neighbours) continue ;;
    esac
    count=$((count + 1))
    expect 0 run "$scene" --no-plot -o "$work/out" --format json
    "$READ_OUTPUT" json "$out" >/dev/null || failed "$name: not JSON"
    grep -qw 'agrees' "$out" || failed "$name: no verdict"
    csv=$work/out/$name.csv
    [ -s "$csv" ] || failed "$name: no CSV"
    "$READ_OUTPUT" finite "$csv" || failed "$name: not all numbers are finite"
    size=$("$READ_OUTPUT" csv "$csv")
    least=50
    [ "$name" != sigalotti-2016-table-1 ] || least=13 # one row for each N of the table
    math "$least" le "${size% *}"
    for column in $(head -n 1 "$csv" | tr ',' ' '); do
        case $column in
        verdict) "$READ_OUTPUT" column "$csv" verdict | grep -qx 'disagrees' &&
            failed "$name: a point disagrees" ;;
        esac
    done
done
[ "$count" -ge 5 ] || failed "only $count scenes"
no_partial "$work/out"

# by name, and with one thread: the same bits
OMP_NUM_THREADS=1
export OMP_NUM_THREADS
for name in quinlan-2006-fig-3a quinlan-2006-fig-9; do
    expect 0 run "$name" --no-plot -o "$work/by-name"
    cmp -s "$work/out/$name.csv" "$work/by-name/$name.csv" || failed "$name: two runs differ"
done

# a table of rates: one row a cell or claim, every column named
expect 0 run "$data_of_tests/scenes/convergence-small.yaml" --no-plot -o "$work/by-name" --format csv
holds 'scene,id,statement,measure,expected,tolerance,analytic,empirical,verdict,slope_in_N'
is "$(wc -l <"$out")" 10 'the number of rows'
cmp -s "$work/out/convergence-small.csv" "$work/by-name/convergence-small.csv" ||
    failed 'convergence-small: two runs differ'
unset OMP_NUM_THREADS

# two scenes in one command, with plots
if command -v gnuplot >/dev/null 2>&1; then
    expect 0 run quinlan-2006-fig-1 quinlan-2006-fig-2a -o "$work/two"
    for name in quinlan-2006-fig-1 quinlan-2006-fig-2a; do
        head -c 400 "$work/two/$name.svg" | grep -q '<svg' || failed "$name: no SVG"
        tail -n 1 "$work/two/$name.svg" | grep -q '</svg>' || failed "$name: half an SVG"
        grep -qiE 'nan|<script' "$work/two/$name.svg" && failed "$name: odd SVG"
    done
    no_partial "$work/two"
fi

# The report over some kernels and scenes, one of them disordered: every scene has run above, and
# every kernel is checked elsewhere.
data=$work/data
mkdir -p "$data/kernels" "$data/scenes"
cp "$SPHVERIFY_DATA"/kernels/quinlan-w*.yaml "$SPHVERIFY_DATA/kernels/cubic-spline.yaml" \
    "$SPHVERIFY_DATA/kernels/gaussian.yaml" "$data/kernels"
for name in 2006-fig-1 2006-fig-2a 2006-fig-9; do
    cp "$SPHVERIFY_DATA/scenes/quinlan-$name.yaml" "$data/scenes"
done
cp "$data_of_tests/scenes/convergence-small.yaml" "$data/scenes"
cp "$SPHVERIFY_DATA/kernels/sigalotti-wendland-c4.yaml" "$data/kernels"
expect 0 report --data-dir "$data" -o "$work/report"
for file in index.html report.json report.md; do
    [ -s "$work/report/$file" ] || failed "report: no $file"
done
report=$work/report/report.json
is "$("$READ_OUTPUT" json "$report" verdict)" agrees verdict
is "$("$READ_OUTPUT" json "$report" kernels)" 5 'the number of kernels'
is "$("$READ_OUTPUT" json "$report" convergence)" 1 'the number of convergence scenes'
is "$("$READ_OUTPUT" json "$report" convergence.0.table.cells.0.verdict)" reproduced 'a cell'
is "$("$READ_OUTPUT" json "$report" scenes)" 3 'the number of scenes'
# Fig. 9 tells the volume rules apart.
is "$("$READ_OUTPUT" json "$report" disorder.volume_rules.reproducing)" tessellated 'the volume rule'
is "$("$READ_OUTPUT" json "$report" scenes.2.curves.0.seed)" 1 'the seed'
grep -qiw 'nan' "$report" "$work/report/report.md" && failed 'report: NaN'
# self-contained: nothing is fetched
grep -oiE '(src|href)="[^"#][^"]*"' "$work/report/index.html" | grep -viE '="(data:|#)' |
    grep -iE '^src=|\.(css|js|woff)"' && failed 'report: something is fetched'
tail -n 1 "$work/report/index.html" | grep -q '</html>' || failed 'report: the page is cut off'
for scene in "$data"/scenes/*.yaml; do
    grep -qF "$(basename "$scene" .yaml)" "$work/report/index.html" ||
        failed "report: no $(basename "$scene" .yaml)"
done
no_partial "$work/report"
# written over an older one
expect 0 run quinlan-2006-fig-1 --no-plot -o "$work/out"
finish
