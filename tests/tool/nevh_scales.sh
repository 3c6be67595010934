#!/bin/sh
# nevh compare: what it says depends neither on the units of length, energy and
# time nor on H being 0, or small by chance, at the start.

. "${srcdir:-.}/tests/support/nevh_support.sh"

# rescale L E T SCENE [AWK-OPTION...]: the scene in units of powers of two.
rescale() {
    powers="$1 $2 $3"
    plain=$4
    shift 4
    awk "$@" $(echo $powers | awk '{
        printf "-v L=%.17g -v E=%.17g -v T=%.17g", 2^$1, 2^$2, 2^$3 }') \
        -f "$srcdir/tests/support/rescale.awk" "$plain" >$work/scene.nevh
}
# scene L E T COORDINATES H
scene() {
    { printf '[parameters]\nl = 1\nm = 1\nk = 1\nf = 1\nw = 1\n'
      printf '[coordinates]\n%s\n[effects]\n%s\n' "$4" "$5" | sed 's/;/\n/g'
      printf '[run]\nt_end = 60\ndt = 0.1\nintegrators = verlet, euler, rk4\n'
    } >$work/plain.nevh
    rescale $1 $2 $3 $work/plain.nevh -v few=
}
# told [DIGITS [OPTIONS]]: columns without a unit, numbers to DIGITS; but for those of
# a row that explodes, in which rounding grows.
told() {
    digits=${1:-5}
    test $# -eq 0 || shift
    "$nevh" compare $work/scene.nevh "$@" --format csv --quiet >$work/out 2>&1
    grep -v '^#' $work/out | awk -F, -v numbers=" %.${digits}g %.${digits}g" '
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        { status = $at["status"]; sub(/:.*/, "", status)
          printf "%s %s %s %s %s", $at["integrator"], $at["steps"], status, \
              $at["verdict"], $at["observed_order"]
          if ($at["max_energy_error"] < 1e9)
              printf numbers, $at["max_energy_error"], $at["rms_energy_error"]
          print "" }'
}

# Starts at rest at 0, at rest elsewhere, where H is small by chance, in motion.
while IFS='|' read -r q h; do
    scene 0 0 0 "$q" "$h"
    told >$work/plain
    test "$(wc -l <$work/plain)" -eq 3 || { fails "$h"; cat $work/out; }
    for units in "-100 0 0" "0 -100 0" "0 0 -60" "50 -27 27" "30 90 -30"; do
        scene $units "$q" "$h"
        told >$work/scaled
        cmp -s $work/plain $work/scaled ||
            { fails "$h in $units"; diff $work/plain $work/scaled; }
    done
done <<'END'
x = 0|H = p_x^2/(2*m) + k*x^2/2 - f*x*cos(1.3*w*t)
x = 0|H = p_x^2/(2*m) + k*x^2/2 - f*x*sin(0.7*w*t)
x = 0|H = p_x^2/(2*m) + k*x^2/2 + k*x^4/l^2 - f*x
x = 1.0000001*l|K = p_x^2/(2*m);V = k*(x - l)*(x + l)/2
x = l|K = p_x^2/(2*m);V = k*x^2/2
x = l;y = 0, m*l*w/2|K = (p_x^2 + p_y^2)/(2*m);V = -k*l^3/hypot(x, y)
END

# A weak force gives the orbit of a strong one, in small.
for f in 1 1e-9 1e-100; do
    scene 0 0 0 "x = 0" "H = p_x^2/2 + x^2/2 - $f*x*cos(1.3*t)"
    told >$work/$f
    cmp -s $work/1 $work/$f || { fails "f = $f"; diff $work/1 $work/$f; }
done

# Where H is below the least normal double nothing is known of its error.
scene 0 0 0 "x = 1e-160" "K = p_x^2/2;V = x^2/2"
told >$work/told
grep -q '^verlet .* undecided ' $work/told || { fails "1e-160"; cat $work/told; }

# At pi/2 a pendulum at rest has no energy but rounding.
scene 0 0 0 "x = pi/2" "K = p_x^2/2;V = -cos(x)"
told >$work/told
grep -q '^verlet .* ok bounded ' $work/told && grep -q '^euler .* unstable ' $work/told ||
    { fails "pi/2"; cat $work/told; }
# A stiff spring at its natural length, where all effects are 0, is followed beyond
# rounding, or not believed.
for spring in 100 2000 1e6; do
    scene 0 0 0 "x = 0.8;y = -0.6" \
        "K = (p_x^2 + p_y^2)/2;V = $spring*(hypot(x, y) - 1)^2/2;G = sinh(y + 0.6)"
    "$nevh" compare $work/scene.nevh --integrators gauss4 --dt 0.001 --t-end 5 \
        >$work/out 2>&1
    grep -Eq '^energy_scale: [0-9.]+(e-0[1-3])? ' $work/out ||
        { fails "$spring"; cat $work/out; }
done
# One that hardly moves beside it changes nothing.
scene 0 0 0 "x = 0;y = 1, 1e-13" \
    "K = (p_x^2 + p_y^2)/2;V = x^2/2;D = -1e-3*x*cos(1.3*t)"
"$nevh" compare $work/scene.nevh --integrators verlet --gradient exact \
    --dt 0.1 --t-end 20 >$work/out 2>&1
grep -Eq '^energy_scale: [0-9.]+e-0[67] ' $work/out || { fails "idle"; cat $work/out; }
# Nor do energies that jumps of H give to a run.
scene 0 0 0 "x = 0.3, 2" "K = p_x^2/2;V = cos(mod(x, 2*pi)/2)"
"$nevh" compare $work/scene.nevh --integrators verlet >$work/out 2>&1
grep -q '^energy_scale: 2\.98877108 ' $work/out || { fails "jumps"; cat $work/out; }
scene 0 0 0 "x = 1e-4" "K = p_x^2/2;V = 5 + x^2/2 + cos(x)"
"$nevh" compare $work/scene.nevh --integrators verlet >$work/out 2>&1
grep -q '^energy_scale: 1 ' $work/out || { fails "flat"; cat $work/out; }
for x in 1.0000001 1.001 0.9999; do
    scene 0 0 0 "x = $x" "K = p_x^2/2;V = (x - 1)*(x + 1)/2"
    told >$work/told
    grep -q '^verlet .* ok bounded ' $work/told || { fails "$x"; cat $work/told; }
done

# A Taylor series of order 23, whose coefficients in these units of time are beyond
# doubles, gives the same orbit; a pulse is seen as one.
while IFS='|' read -r autonomous integrators q h; do
    for t in 0 100 -100 200; do
        scene 0 0 $t "$q" "$h"
        told 10 --integrators $integrators --native never >$work/$t
        "$nevh" check $work/scene.nevh 2>&1 |
            awk '$1 ~ /^(autonomous|reversible|smooth)$/ { print $1, $2 }' >>$work/$t
        cmp -s $work/0 $work/$t || { fails "2^$t: $h"; diff $work/0 $work/$t; }
    done
    grep -q "^$integrators [0-9]* ok" $work/0 && grep -q '^smooth yes' $work/0 &&
        grep -q "^autonomous $autonomous" $work/0 || { fails "$h"; cat $work/0; }
done <<'END'
yes|taylor|x = l;y = 0, m*l*w/2|K = (p_x^2 + p_y^2)/(2*m);V = -k*l^3/hypot(x, y)
yes|taylor|x = 1.3*l|K = p_x^2/(2*m);V = k*x^2/2 + k*x^4/l^2
no|taylor|x = 1.3*l|H = p_x^2/(2*m) + k*x^2/2 - 0.1*f*x*sin(0.7*w*t)
no|verlet|x = 1.3*l|H = p_x^2/(2*m) + k*x^2/2 - 0.1*f*x/(1 + (w*t - 3)^2)
END
# Starts with coordinates that are 0, whose lengths are found from elsewhere.
while read -r name t_end; do
    for L in 0 100 -100; do
        rescale $L 0 0 "$srcdir/scenes/$name.nevh"
        "$nevh" check $work/scene.nevh --t-end $t_end >$work/out 2>&1 ||
            { fails "$name"; cat $work/out; }
        sed -nE -e 's/^  ([a-z ]+) (yes|no) .*/\1 \2/p' \
            -e '/^(Highest|Fastest|Chaotic)/p' $work/out >$work/$L
        cmp -s $work/0 $work/$L || { fails "check $name in 2^$L"; diff $work/0 $work/$L; }
    done
    grep -q '^Highest' $work/0 || { fails "check $name"; cat $work/out; }
done <<'END_OF_NAMES'
earth-halley 60
double-pendulum-as-printed 20
END_OF_NAMES
# Scenes that ship, in other units: 20 steps of two schemes have the same status and
# energy error.
rows() { # rows SCENE L E T [INTEGRATORS]
    rescale $2 $3 $4 "$1" -v few=20
    "$nevh" compare $work/scene.nevh --integrators ${5:-rk4,gauss4} --native never \
        --format csv --quiet 2>&1 | awk -F, '
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        { e = $at["max_energy_error"]
          status = $at["status"]; sub(/: since t = .*/, "", status)
          printf "%s %s %s\n", $at["integrator"], status,
              e < 1e-9 ? "small" : sprintf("%.4g", e) }'
}
units='-100,0,0 0,100,0 0,0,-100'
test "$SLOW" = yes && units="$units 100,0,0 0,-100,0 0,0,100 -33,50,-10"
for file in "$srcdir"/scenes/*.nevh; do
    case $file in
    */fput-1000.nevh) continue ;; # seconds a row
    esac
    rows "$file" 0 0 0 >$work/usual
    grep -q '^gauss4 ok' $work/usual || { fails "$file"; cat $work/usual; }
    for unit in $units; do
        rows "$file" $(echo $unit | tr , ' ') >$work/other
        cmp -s $work/usual $work/other ||
            { fails "$file in 2^($unit)"; diff $work/usual $work/other; }
    done
done
# What is recommended is the same step of the same orbit, to the six digits of its dt.
for name in pendulum kepler; do
    for T in 0 13 -31 60; do
        rescale 0 0 $T "$srcdir/scenes/$name.nevh" -v few=200
        for scheme in gauss8 rk4; do
            "$nevh" recommend $work/scene.nevh --energy-error 1e-7 --gradient exact \
                --integrators $scheme --quiet --format csv 2>&1 |
                awk -F, -v T=$T 'NR == 2 { print $2, $6/2^T, $9 }'
        done >$work/$T
        paste -d ' ' $work/0 $work/$T | awk '
            function far(a, b, most) { return a/b - 1 > most || b/a - 1 > most }
            NF != 6 || $1 != $4 || far($2, $5, 1e-5) || far($3, $6, 1e-2) { wrong = 1 }
            END { exit wrong || NR != 2 }' ||
            { fails "recommend $name in 2^$T"; diff $work/0 $work/$T; }
    done
done
# A scene that gives steps of differences, and has a momentum that is 0.
file=$srcdir/scenes/outer-solar-system.nevh
for units in '0 0 0' '100 0 0' '0 -100 0' '0 0 -100'; do
    rows "$file" $units dprkn12 >$work/other
    grep -q '^dprkn12 ok' $work/other || { fails "dprkn12 in 2^($units)"; cat $work/other; }
done
# States have all digits that were asked for, and those of variables without a unit
# are the same.
for name in pendulum kepler henon-heiles figure-eight; do
    for units in '0 0 0' '0 0 60' '0 0 100' '0 0 -100' '100 0 0' '0 -100 0'; do
        rescale $units "$srcdir/scenes/$name.nevh" -v few=20
        sed -i.old 's/^\[run\]/&\nintegrators = verlet/' $work/scene.nevh
        "$nevh" reference $work/scene.nevh --format csv --quiet >$work/out 2>&1
        awk -F, 'NR > 1 && $4 < 24 || NF < 5 { wrong = 1 } END { exit wrong || NR < 3 }' \
            $work/out || { fails "$name in 2^($units)"; cat $work/out; }
    done
done
exit $status
