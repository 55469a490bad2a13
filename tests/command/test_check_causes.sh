#!/bin/sh
# check: a newcomer copies a kernel file, breaks it, and is told what is wrong.
# shellcheck source=tests/command/harness.sh
. "${0%/*}/harness.sh"

kernels=$SPHVERIFY_DATA/kernels
cubic=$kernels/cubic-spline.yaml

# told NAME PART FILE: the file disagrees, and the likely cause holds PART
told() {
    expect 1 check "$3" --format json
    is "$(json verdict)" disagrees "the verdict on $1"
    case $(json cause) in
    *"$2"*) ;;
    *) failed "$1: the cause is '$(json cause)', not '$2'" ;;
    esac
}

# edited NAME PART EDIT [FILE]: the same of a file with that edit; judged together, at the end
edited() {
    sed "$3" "${4:-$cubic}" >"$work/$1.yaml"
    cmp -s "${4:-$cubic}" "$work/$1.yaml" && failed "$1: the edit changes nothing"
    printf '%s\n' "$1" >>"$work/names"
    printf '%s\n' "$2" >>"$work/parts"
}

# judge: all edited files, in one process and without the checks that take long
judge() {
    command_line='edited files'
    # shellcheck disable=SC2046  # the names have no spaces
    (cd "$work" && "$JUDGE_FILES" "$SPHVERIFY_DATA" $(sed 's/$/.yaml/' names)) >"$out" 2>"$err" ||
        failed 'not every edited file could be judged'
    is "$(wc -l <"$out")" "$(wc -l <"$work/names")" 'the number of files judged'
    while IFS= read -r name <&3 && IFS= read -r part <&4 && IFS= read -r judged <&5; do
        checks=$((checks + 1))
        case $judged in
        "disagrees "*"$part"*) ;;
        *) failed "$name: judged '$judged', not 'disagrees' with '$part'" ;;
        esac
    done 3<"$work/names" 4<"$work/parts" 5<"$out"
}

# silent NAME EDIT [FILE]: a change that leaves the kernel sound
silent() {
    sed "$2" "${3:-$cubic}" >"$work/$1.yaml"
    cmp -s "${3:-$cubic}" "$work/$1.yaml" && failed "$1: the edit changes nothing"
    expect 0 check "$work/$1.yaml" --format json
    is "$(json verdict)" agrees "the verdict on $1"
}

# what is wrong, whatever is said of the cause
edited last-coefficient '' 's|"-1/4"|"-0.25001"|'
edited constant-five-digits '' 's|1d: "2/3"|1d: "0.66667"|'
edited constant-3d-digits '' 's|3d: "1/pi"|3d: "0.3183099"|'
edited smoothness '' 's|boundary_smoothness: 2|boundary_smoothness: 4|'
edited knot-1e-3 '' 's|until: 1,|until: 1.001,|'
edited negative '' 's/^claims:.*/claims: {non_negative: true}/' "$kernels/monaghan-m4-prime.yaml"

# the pieces
edited coefficient-1e-6 'the coefficient of q^2 in piece 1 is wrong' 's|"-3/2"|"-1.5000015"|'
edited coefficient-digit-5 'the coefficient of q^3 in piece 1 is wrong' 's|"3/4"|"0.75002"|'
edited coefficient-dropped 'the coefficient of q^2 in piece 2 is wrong' 's|"3/2", "-1/4"|"0", "-1/4"|'
edited coefficient-sign 'the sign of the coefficient of q^2 in piece 1 is flipped' 's|"-3/2"|"3/2"|'
edited swapped 'swapped: those of q^2 and q^3 in piece 1' 's|"-3/2", "3/4"|"3/4", "-3/2"|'
edited swapped-ends 'swapped: those of q^0 and q^1 in piece 2' 's|"2", "-3"|"-3", "2"|'
edited left-out 'the coefficient of q^1 is left out' 's|"1", "0", "-3/2"|"1", "-3/2"|'
edited one-too-many 'one zero too many' 's|"1", "0", "-3/2"|"1", "0", "0", "-3/2"|'
edited knot 'a knot is moved: piece 1 ends at' 's|until: 1,|until: 1.1,|'
edited curvature 'the curvature of w was made to jump at q = 1' \
    's|"2", "-3", "3/2", "-1/4"|"2.01", "-3.02", "1.51", "-1/4"|'
edited offset 'the coefficient of q^0 in piece 2 is wrong: 21/10 in the file, 2 would fit' 's|"2", "-3"|"2.1", "-3"|'
edited float 'rounded to single precision' \
    's|"43471/72000"|"0.6037638783454895"|; s|"-55759/96000"|"-0.5808229446411133"|; s|"16067/76800"|"0.2092057317495346"|; s|"-154063/4608000"|"-0.033433809876441956"|; s|"1/500"|"0.0020000000949949026"|' \
    "$kernels/quinlan-w8.yaml"
edited printed 'rounded' \
    's|"43471/72000"|"0.603764"|; s|"-55759/96000"|"-0.580823"|; s|"16067/76800"|"0.209206"|; s|"-154063/4608000"|"-0.0334338"|' \
    "$kernels/quinlan-w8.yaml"
edited scaled 'the argument is scaled' \
    's|"1", "0", "-5/4", "0", "5/8", "0", "-5/32", "0", "5/256", "0", "-1/1024"|"1", "0", "-5", "0", "10", "0", "-10", "0", "5", "0", "-1"|' \
    "$kernels/quinlan-w10.yaml"
edited truncated 'truncated at q = 1.5' 's|until: 2,|until: 1.5,|; s|^support: 2|support: 1.5|'
edited cut-at-a-knot 'this is cubic-spline truncated at q = 1' \
    '/until: 2/d; s|^support: 2|support: 1|'
edited overstated 'the support is overstated: w is identically zero from q = 2 on' \
    's|^support: 2|support: 3|; s|^dimensions|  - {until: 3, coefficients: ["0"]}\n&|'
edited clamped 'negative part clamped' 's|"2", "-4", "5/2", "-1/2"|"0"|' \
    "$kernels/monaghan-m4-prime.yaml"
edited illegal 'the integral of w over 3 dimensions is not positive' \
    's|dimensions: \[1, 2\]|dimensions: [1, 2, 3]|' "$kernels/monaghan-m4-prime.yaml"

# the constants
edited constant-digits 'rounded to 6 digits' 's|1d: "2/3"|1d: "0.666667"|'
edited constant-cut 'cut off after 6 digits' 's|1d: "2/3"|1d: "0.666666"|'
edited constant-float 'single precision' 's|1d: "2/3"|1d: "0.66666668653488159"|'
edited constant-support '2^3 too large: the file'"'"'s h is the support radius' 's|3d: "1/pi"|3d: "8/pi"|'
edited constant-pi 'pi is missing' 's|3d: "1/pi"|3d: "1"|'
edited constant-1d 'this is the 1D constant' 's|2d: "10/7/pi"|2d: "2/3"|'
edited constant-3d-in-2d 'this is the 3D constant' 's|2d: "10/7/pi"|2d: "1/pi"|'
edited constant-half 'integrated over one half of the line' 's|1d: "2/3"|1d: "4/3"|'
edited constant-other 'the 2D constant of' 's|2d: "10/7/pi"|2d: "96/1199/pi"|'
edited all-scaled 'different scalings' 's|"2/3"|"1/6"|; s|"10/7/pi"|"5/14/pi"|; s|"1/pi"|"1/4/pi"|'
edited gaussian 'renormalised over the truncated support' 's|1d: "[0-9.]*"|1d: "0.56420204705138327129"|' \
    "$kernels/gaussian.yaml"

# the claims
edited beta 'claims β = 3; found β = 2' 's|boundary_smoothness: 2|boundary_smoothness: 3|'
edited order 'claims order 4; found 2' 's|smoothing_order: 2|smoothing_order: 4|'
edited monotone 'the file says it is not' 's|monotone: true|monotone: false|'
edited sign 'w is negative at' 's|non_negative: false|non_negative: true|' \
    "$kernels/monaghan-m4-prime.yaml"
edited transform 'constant before the fourth-order transform' \
    's|1d: "18/17"|1d: "2/3"|' "$kernels/cubic-spline-fourth-order.yaml"

# the gradient
w10=$work/w10.yaml
{
    cat "$kernels/quinlan-w10.yaml"
    printf 'derivative:\n  - {until: 2, coefficients: ["0", "-5/2", "0", "5/2", "0", "-15/16", "0", '
    printf '"5/32", "0", "-5/512"]}\n'
} >"$w10"
expect 0 check "$w10"
edited gradient-sign "the gradient's sign is flipped" \
    's|"-5/2", "0", "5/2", "0", "-15/16", "0", "5/32", "0", "-5/512"|"5/2", "0", "-5/2", "0", "15/16", "0", "-5/32", "0", "5/512"|' "$w10"
edited gradient-q 'the gradient lacks a factor q' 's|\["0", "-5/2"|["-5/2"|' "$w10"
edited gradient-qq 'a factor q too many' 's|\["0", "-5/2"|["0", "0", "-5/2"|' "$w10"
edited gradient-chain 'chain rule' \
    's|"-5/2", "0", "5/2", "0", "-15/16", "0", "5/32", "0", "-5/512"|"-5", "0", "5", "0", "-15/8", "0", "5/16", "0", "-5/256"|' "$w10"
edited gradient-digit 'the coefficient of q^9 is -0.009765635; w'"'"' needs -5/512' \
    's|"-5/512"|"-0.009765635"|' "$w10"
edited gradient-swapped 'the coefficients of q^5 and q^7 are swapped' \
    's|"-15/16", "0", "5/32"|"5/32", "0", "-15/16"|' "$w10"

pieces=$work/pieces.yaml
{
    cat "$cubic"
    printf 'derivative:\n'
    printf '  - {until: 1, coefficients: ["0", "-3", "9/4"]}\n'
    printf '  - {until: 2, coefficients: ["-3", "3", "-3/4"]}\n'
} >"$pieces"
edited gradient-factor '' 's|"0", "-3", "9/4"|"-3", "9/4"|' "$pieces"
edited gradient-piece-sign '' 's|"-3", "3", "-3/4"|"3", "-3", "3/4"|' "$pieces"

# a bare file, without constants or claims, has less to contradict it, but a kernel must still be one
bare=$work/bare.yaml
sed '/^constants/d; /^claims/d' "$cubic" >"$bare"
expect 0 check "$bare"
edited bare-coefficient 'the coefficient of q^2 in piece 1 is wrong' 's|"-3/2"|"-1.5000015"|' "$bare"
edited bare-swapped 'swapped' 's|"-3/2", "3/4"|"3/4", "-3/2"|' "$bare"
edited bare-knot 'a knot is moved' 's|until: 1,|until: 1.1,|' "$bare"
edited bare-truncated 'truncated at q = 1.5' 's|until: 2,|until: 1.5,|; s|^support: 2|support: 1.5|' "$bare"
edited bare-overstated 'overstated' \
    's|^support: 2|support: 3|; s|^dimensions|  - {until: 3, coefficients: ["0"]}\n&|' "$bare"
edited bare-offset 'the coefficient of q^0 in piece 2 is wrong' 's|"2", "-3"|"2.1", "-3"|' "$bare"

judge
# the command says the same, as JSON and by its exit status
told swapped 'swapped: those of q^2 and q^3 in piece 1' "$work/swapped.yaml"
told illegal 'the integral of w over 3 dimensions is not positive' "$work/illegal.yaml"
told constant-pi 'pi is missing' "$work/constant-pi.yaml"
told beta 'claims β = 3; found β = 2' "$work/beta.yaml"
told gradient-q 'the gradient lacks a factor q' "$work/gradient-q.yaml"
told bare-overstated 'overstated' "$work/bare-overstated.yaml"

# what is meant is not a mistake
silent no-claims '/^claims/d'
silent decimals 's|1d: "2/3"|1d: "0.66666666666666667"|'
silent expression 's|2d: "10/7/pi"|2d: "10 / (7 * pi)"|'
silent scaled-all 's|"1", "0", "-3/2", "3/4"|"4", "0", "-6", "3"|; s|"2", "-3", "3/2", "-1/4"|"8", "-12", "6", "-1"|; /^constants/d'
silent one-dimension 's|dimensions: \[1, 2, 3\]|dimensions: [3]|'
silent gaussian-cut 's|^support: 3|support: 4|' "$kernels/gaussian.yaml"
silent gaussian-root 's|1d: "[0-9.]*"|1d: "pi^(-1/2)"|; s|3d: "[0-9.]*"|3d: "1/(pi*sqrt(pi))"|' \
    "$kernels/gaussian.yaml"

# several files: a bad one is one line, the others are still checked, the worst status wins
printf 'name: [\n' >"$work/broken.yaml"
expect 2 check cubic-spline "$work/broken.yaml" "$work/swapped.yaml" --format json
is "$(json 0.verdict)" agrees 'the first of three'
is "$(json 1.verdict)" disagrees 'the last of three'
[ "$(wc -l <"$err")" -eq 1 ] || failed 'a broken file among others: not one line'
expect 1 check cubic-spline "$work/swapped.yaml" -o "$work/out"
holds 'likely cause: two coefficients are swapped'
"$READ_OUTPUT" json "$work/out/check-cubic-spline-2.json" >/dev/null || failed 'names collide'
refuse 2 'broken.yaml:' check "$work/broken.yaml"
sed 's|10/7/pi|10/7//pi|' "$cubic" >"$work/unreadable.yaml"
refuse 2 'is not a constant' check "$work/unreadable.yaml"
sed 's|dimensions: \[1, 2, 3\]|dimensions: [1]|' "$cubic" >"$work/line.yaml"
refuse 2 'does not declare dimension 3' check "$work/line.yaml" --dim 3
refuse 2 'allowed' check cubic-spline --all
finish
