#!/bin/sh
# Full disks, folders that cannot be written, gnuplot missing: status 3 (or a report that says what
# is missing), one line, and no half-written file under a final name.
# shellcheck source=tests/command/harness.sh
. "${0%/*}/harness.sh"

# a small data folder: what fails here fails the same way with all kernels and scenes
data=$work/data
mkdir -p "$data/kernels" "$data/scenes"
for name in cubic-spline quinlan-w10 gaussian; do
    cp "$SPHVERIFY_DATA/kernels/$name.yaml" "$data/kernels"
done
cp "$SPHVERIFY_DATA/scenes/quinlan-2006-fig-2a.yaml" "$data/scenes"
scene=$data/scenes/quinlan-2006-fig-2a.yaml
SPHVERIFY_DATA=$data

# stdout on a full disk
if [ -e /dev/full ]; then
    for line in 'kernels' 'kernel cubic-spline' 'error --kernel gaussian --h 0.1 --spacing 0.5' \
        'kernels --format json' 'check cubic-spline' '--help' '--version'; do
        command_line="sphverify $line >/dev/full"
        checks=$((checks + 1))
        # shellcheck disable=SC2086
        "$SPHVERIFY" $line >/dev/full 2>"$err"
        status=$?
        : >"$out"
        [ "$status" -eq 3 ] || failed "$command_line: status $status, expected 3"
        [ "$(wc -l <"$err")" -eq 1 ] || failed "$command_line: not one line"
    done
fi

# a folder that cannot be made, because a file stands there
: >"$work/file"
unwritable() { # PART ARGS…: the verdict may stand on stdout; the files cannot be written
    part=$1
    shift
    expect 3 "$@"
    [ "$(wc -l <"$err")" -eq 1 ] || failed "$command_line: $(wc -l <"$err") lines on stderr, not 1"
    grep -qF -- "$part" "$err" || failed "$command_line: stderr lacks '$part'"
}
unwritable 'file' run "$scene" --no-plot -o "$work/file"
unwritable 'file' run "$scene" --no-plot -o "$work/file/below"
unwritable 'file' check cubic-spline -o "$work/file"

# a folder without permission (root may write anywhere, so there this shows nothing)
mkdir "$work/closed"
chmod 555 "$work/closed"
if ! touch "$work/closed/probe" 2>/dev/null; then
    unwritable 'closed' run "$scene" --no-plot -o "$work/closed"
    unwritable 'closed' report -o "$work/closed"
fi

# a full disk, by a limit on the size of files: SIGXFSZ must not kill, and nothing half-written
# may stand under a final name
mkdir "$work/full"
limited() { # ARGS…
    command_line="sphverify $* with ulimit -f 1"
    checks=$((checks + 1))
    (ulimit -f 1 && trap '' XFSZ && exec "$SPHVERIFY" "$@") >/dev/null 2>"$err"
    status=$?
    [ "$status" -eq 3 ] || failed "$command_line: status $status, expected 3"
    [ "$(wc -l <"$err")" -eq 1 ] || failed "$command_line: not one line"
    left=$(find "$work/full" ! -type d)
    [ -z "$left" ] || failed "$command_line: left $left"
}
limited run "$scene" --no-plot -o "$work/full"
limited report -o "$work/full"

# gnuplot missing: PATH has nothing at all
mkdir "$work/empty"
command_line='sphverify report without gnuplot'
checks=$((checks + 1))
PATH=$work/empty "$SPHVERIFY" report -o "$work/plain" >"$out" 2>"$err"
status=$?
[ "$status" -le 1 ] || failed "$command_line: status $status"
for file in index.html report.json report.md; do
    [ -s "$work/plain/$file" ] || failed "$command_line: no $file"
done
grep -qi 'gnuplot' "$work/plain/index.html" || failed "$command_line: the page does not say so"
"$READ_OUTPUT" json "$work/plain/report.json" >/dev/null || failed "$command_line: bad JSON"
no_partial "$work/plain"

command_line='sphverify run without gnuplot'
checks=$((checks + 1))
PATH=$work/empty "$SPHVERIFY" run "$scene" -o "$work/unplotted" >"$out" 2>"$err"
status=$?
[ "$status" -eq 3 ] || failed "$command_line: status $status, expected 3"
[ "$(wc -l <"$err")" -eq 1 ] || failed "$command_line: not one line"
grep -qi gnuplot "$err" || failed "$command_line: does not name gnuplot"
grep -qF -- --no-plot "$err" || failed "$command_line: does not say how to do without"
no_partial "$work/unplotted"

# gnuplot that fails, and one that never ends its output properly
mkdir "$work/bin"
printf '#!/bin/sh\nexit 1\n' >"$work/bin/gnuplot"
chmod +x "$work/bin/gnuplot"
command_line='sphverify run with a failing gnuplot'
PATH=$work/bin:/usr/bin:/bin "$SPHVERIFY" run "$scene" -o "$work/broken" >"$out" 2>"$err"
status=$?
[ "$status" -eq 3 ] || failed "$command_line: status $status, expected 3"
find "$work/broken" -name '*.svg' 2>/dev/null | grep -q . && failed "$command_line: left a plot"
no_partial "$work/broken"
finish
