#!/bin/sh
# Every bad input: one line, status 2, nothing on stdout.
# shellcheck source=tests/command/harness.sh
. "${0%/*}/harness.sh"

point() { # STATUS PART H SPACING
    refuse "$1" "$2" error --kernel quinlan-w10 --h "$3" --spacing "$4"
}
for bad in 0 -1 -0.02 nan NaN inf -inf 1e999 1e-999 1e300 '' ' ' x 0.02x 1/0 0/0 1,5 0x10 \
    "$(printf '1\n2')" 1e-12 11 "$(head -c 5000 /dev/zero | tr '\0' 9)"; do
    point 2 '' "$bad" 4/11
done
for bad in 0 -1 nan inf 1e999 '' x 1/0 1e-9 -4/11 --; do
    point 2 '' 0.02 "$bad"
done
point 2 'no neighbour' 0.02 2
point 2 'no neighbour' 0.02 2.5
point 2 'no neighbour' 0.02 1e9
refuse 2 'paper' error --kernel quinlan-w10 --h 0.02 --spacing 0.37 --form paper
refuse 2 'form' error --kernel quinlan-w10 --h 0.02 --spacing 0.37 --form guess
refuse 2 '' error --kernel quinlan-w10 --h 0.02
refuse 2 '' error --kernel quinlan-w10 --spacing 0.4
refuse 2 '' error --h 0.02 --spacing 0.4
refuse 2 "unknown kernel 'nonsense'" error --kernel nonsense --h 0.02 --spacing 0.4
refuse 2 '' error --kernel quinlan-w10 --h 0.02 --spacing 0.4 --dim 4
refuse 2 '' error --kernel quinlan-w10 --h 0.02 --spacing 0.4 --dim 0
refuse 2 '' error --kernel quinlan-w10 --h 0.02 --spacing 0.4 --dim x
refuse 2 '' error --kernel quinlan-w10 --h 0.02 --spacing 0.4 --method magic
refuse 2 '' error --kernel quinlan-w10 --h 0.02 --spacing 0.4 --layout spiral
refuse 2 '' error --kernel quinlan-w10 --h 0.02 --spacing 0.4 --volume none
for option in '--field f1' '--placement cell' '--jitter uniform' --reflected --periodic; do
    # shellcheck disable=SC2086  # an option and its word
    refuse 2 'of a box' error --kernel quinlan-w10 --h 0.02 --spacing 0.4 $option
done
for option in '--form exact' --exhaustive '--width 0.1' '--realisations 4'; do
    # shellcheck disable=SC2086
    refuse 2 'of the endless line' error --kernel quinlan-w10 --particles 25 --spacing 0.4 $option
done
refuse 2 'too many' error --kernel quinlan-w10 --h 1e-9 --spacing 1e-4 --exhaustive

refuse 2 '/nowhere' kernels --data-dir /nowhere
refuse 2 'nothing.yaml' kernel ./nothing.yaml
refuse 2 'nothing.yaml' check ./nothing.yaml
refuse 2 'nothing.yaml' run ./nothing.yaml
refuse 2 'unknown scene' run no-such-scene
refuse 2 'unknown kernel' check no-such-kernel
refuse 2 'folder' kernel "$work/"
refuse 2 '' kernel ''
refuse 2 '' run ''

# files: missing, empty, truncated, binary, huge, unknown keys, and YAML's own traps
kernel=$SPHVERIFY_DATA/kernels/cubic-spline.yaml
bad() { # NAME PART: the file $work/NAME is refused by every command that reads kernels
    for command in kernel check; do
        refuse 2 "$2" $command "$work/$1"
        grep -q "$1:[0-9]" "$err" || failed "$command $1: no line number"
    done
    refuse 2 "$2" error --kernel "$work/$1" --h 0.02 --spacing 0.4
}
: >"$work/empty.yaml"
bad empty.yaml 'empty'
printf 'name: x\000y\n' >"$work/zero.yaml"
bad zero.yaml 'binary'
head -c 4096 /dev/urandom | tr -d '\000' >"$work/random.yaml"
bad random.yaml ''
head -c 1500000 /dev/zero | tr '\0' '#' >"$work/huge.yaml"
bad huge.yaml 'too large'
head -c 1000000 /dev/zero | tr '\0' '[' >"$work/deep.yaml"
bad deep.yaml 'nested'
{ echo 'a: &a [x, x, x, x, x, x, x, x, x]'; echo 'b: &b [*a, *a, *a, *a, *a, *a, *a, *a]'; } \
    >"$work/alias.yaml"
bad alias.yaml 'alias'
sed 's/^support:/suport:/' "$kernel" >"$work/key.yaml"
bad key.yaml "unknown key 'suport'"
sed 's/^support: 2/support: 0/' "$kernel" >"$work/support.yaml"
bad support.yaml 'support 0'
sed 's/until: 1/until: 2/' "$kernel" >"$work/overlap.yaml"
bad overlap.yaml 'overlap'
sed 's/"3\/4"/"3\/0"/' "$kernel" >"$work/divide.yaml"
bad divide.yaml 'divides by zero'
sed 's/"3\/4"/"NaN"/' "$kernel" >"$work/nan.yaml"
bad nan.yaml "'NaN' is not a number"
{ cat "$kernel"; echo 'support: 2'; } >"$work/twice.yaml"
bad twice.yaml 'again'

# a truncated file is either refused with a line, or still a kernel: never a crash
size=$(wc -c <"$kernel")
cut=0
while [ "$cut" -lt "$size" ]; do
    head -c "$cut" "$kernel" >"$work/cut.yaml"
    run kernel "$work/cut.yaml" --dim 1
    case $status in
    0 | 2) ;;
    *) failed "cut at $cut: status $status" ;;
    esac
    cut=$((cut + 13))
done

# scenes
for scene in "$SPHVERIFY_DATA"/scenes/*.yaml; do
    [ -e "$scene" ] || continue
    base=$(basename "$scene")
    for edit in 's/^name:/nome:/' 's/^curves:/curbs:/' 's/kernel: [a-z0-9-]*/kernel: no-such/' \
        's/^points: .*/points: -5/' 's/^from: .*/from: .nan/' 's/^to: .*/to: 1e999/'; do
        sed "$edit" "$scene" >"$work/$base"
        cmp -s "$scene" "$work/$base" && continue
        refuse 2 "$base" run "$work/$base" -o "$work/out"
        [ -e "$work/out/${base%.yaml}.csv" ] && failed "run $base: wrote results of a bad scene"
    done
done
: >"$work/s.yaml"
refuse 2 'empty' run "$work/s.yaml"
cp "$work/deep.yaml" "$work/s.yaml"
refuse 2 'nested' run "$work/s.yaml"
cp "$work/random.yaml" "$work/s.yaml"
refuse 2 's.yaml' run "$work/s.yaml"
finish
