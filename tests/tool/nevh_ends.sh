#!/bin/sh
# Solutions that end at a finite time, steps past a pole, invariants that are none,
# scenes that are never written: each command says so.

. "${srcdir:-.}/tests/support/nevh_support.sh"

# scene NAME COORDINATES EFFECTS REST
scene() {
    printf '[coordinates]\n%b\n[effects]\n%b\n%b\n' "$2" "$3" "$4" \
        >$work/$1.nevh
}
# tells PATTERN ARGUMENT...: on stdout or stderr, with any exit status.
tells() {
    pattern=$1
    shift
    command=$*
    $limit "$nevh" "$@" >$work/out 2>&1 </dev/null
    tr '\n' ' ' <$work/out | tr -s ' ' >$work/all
    grep -q "$pattern" $work/all ||
        { fails "does not tell '$pattern'"; cat $work/out; }
}
run='[run]\nt_end = 20\ndt = 0.01\nintegrators = rk4'
sections='[sections]\ns = when p_x = 0, rising: x, p_x\n'

scene fall 'x = -1' 'H = p_x^2/2 - x^3/3' "$sections$run"
scene quartic 'x = 1' 'H = p_x^2/2 - x^4' "$sections$run"
scene flow 'x = 0.5, 1' 'H = x^2*p_x' "$sections$run"
scene centre 'x = 1' 'H = p_x^2/2 - 1/x^2' "$sections$run"
for name in fall:5.15195 quartic:0.92703 flow:2 centre:0.70710; do
    file=$work/${name%:*}.nevh
    at="the solution itself ends at t = ${name#*:}"
    tells "$at" chaos $file --t-end 6
    tells "$at" frequencies $file
    tells "$at" section $file
    tells "$at" flow $file
done
# Up to a time before the end the orbit has a size; a curve of which points end earlier.
exits 0 flow $work/fall.nevh --t-end 3 --format csv
tells 'a point of the curve failed before t = 6: from there the solution itself ends at t = 4.9' \
    flow $work/fall.nevh --t-end 6 --shape 'disc(x = -1, p_x = 0, 0.1)'
# The first of the members that fail.
tells 'the first, member 0: the solution itself ends at t = 5.15195' \
    sweep $work/fall.nevh --vary 'p_x = range(0, 0.1, 3)'
tells 'the first, member 0: the solution itself ends at t = 2,' \
    sweep $work/flow.nevh --vary 'p_x = range(1, 2, 2)'

# Henon-Heiles: after chaotic motion the end is named where two runs still agree on it;
# 131.356916 has 60 digits behind it, and 377 is beyond all of 113 bits.
# escape NAME STATE
escape() {
    scene $1 "$2" 'H = (p_x^2 + p_y^2 + x^2 + y^2)/2 + x^2*y - y^3/3' \
        '[run]\nt_end = 400\ndt = 0.1\nintegrators = verlet'
}
escape known 'x = -0.4\ny = -0.19\np_x = 0.34\np_y = -0.36'
escape unknown 'x = 0.2\ny = -0.3\np_x = 0.45\np_y = 0.2'
tells 'solution itself ends at t = 131\.356916:' reference $work/known.nevh
tells 'solution itself ends at t = 131\.357' recommend $work/known.nevh \
    --energy-error 1e-3
for one in reference check chaos frequencies 'recommend --energy-error 1e-3'; do
    tells '' $one $work/unknown.nevh
    grep -q 'itself ends' $work/all && fails 'ends an orbit that is not known'
done
tells 'not known that far: no digit is left of it at t = 2[45]' \
    reference $work/unknown.nevh

# No verdict on a run past that end, and no step that would keep its energy to a time
# after it.
exits 0 compare $work/fall.nevh --t-end 6 --format csv
has '^[^#].*,rk4,.*,undecided,'
lacks '^[^#].*,unstable,'
escape late 'x = 0\ny = 0.5\np_x = 0.46'
for dt in 0.1 0.3; do
    exits 0 compare $work/late.nevh --t-end 200 --dt $dt --format csv
    has '^[^#].*,verlet,.*,undecided,'
    exits 0 compare $work/late.nevh --t-end 200 --dt $dt
    has 'itself ends at t = 50\.7427'
    lacks 'To keep|take dt'
done
exits 0 compare $work/late.nevh --t-end 40 --dt 0.3
has 'To keep the energy error of verlet'
exits 0 compare $work/unknown.nevh --dt 0.2
lacks 'To keep|take dt|itself ends'
tells 'Chaotic or regular: .* the orbit is followed no further' check $work/late.nevh
lacks '^Chaotic or.*--t-end'
tells 'Chaotic or regular: .*--t-end' check $work/late.nevh --t-end 5

# Edges of the domain: an operation, and the place on the orbit.
scene root 'x = 1' 'H = p_x^2/2 + sqrt(x)' "$run"
tells 'ends at t = 1.88561808: .*, with sqrt(...)' compare $work/root.nevh
scene edge 'x = 1' 'H = p_x^2/2 + acos(x)' "$run"
tells 'x = 1, an edge of the domain of H' run $work/edge.nevh
scene edge 'x = 0' 'H = p_x^2/2 + sqrt(x)' "$run"
tells 'x = 0, an edge of the domain of H' run $work/edge.nevh

# A wall so thin that series get too short before the orbit turns: it does not end.
scene wall 'x = 0, 1' 'H = p_x^2/2 + 1e-76/(1 - x)^2' "$run"
tells 'get too short near t = 1: does the orbit end there' reference $work/wall.nevh --at 3
grep -q 'solution itself' $work/all && fails 'ends an orbit that turns'
scene wall 'x = 0, 1' 'H = p_x^2/2 - 1e-30/(1 - x)^2' "$run"
tells 'the solution itself ends at t = 1' reference $work/wall.nevh --at 3

# A pole of even order, which steps pass: 1/(t - 1)^2.
scene even 'x = 1' 'K = -2*(t - 1)*p_x*x^2' \
    '[run]\nt_end = 3\ndt = 0.01\nintegrators = gauss4'
tells 'warning: the solution itself ends at t = 1,' run $work/even.nevh
exits 0 compare $work/even.nevh --format csv
has '^# no state errors: the solution itself ends at t = 1:'
has '^[^#].*,gauss4,.*,undecided,'
tells 'the solution itself ends at t = 1,' cost $work/even.nevh

# The end of a solution is no kink of H.
exits 0 check $work/fall.nevh
has '^  smooth  *yes'

# Orbits that go on say nothing of that, and have what was asked for.
scene well 'x = 0.5' 'H = p_x^2/2 + x^2/2 + x^4/4' "$sections$run"
for one in chaos frequencies section; do
    exits 0 $one $work/well.nevh
    cat $work/err >>$work/out
    lacks 'solution itself|warning'
done

# The momentum is infinite at x = 0.
scene weak 'x = 1' 'H = p_x^2/2 - 1/abs(x)^0.5' \
    "${run%rk4}verlet"
tells 'warning: the solution itself ends at t = 1.66608' run $work/weak.nevh --dt 0.05

# Steps past a pole, or thrown about by it, where no series tells of the end.
scene weak 'x = 1' 'H = p_x^2/2 - 1/abs(x)^0.5 + 0*bessel_j0(x)' \
    "${run%rk4}verlet"
tells 'warning: a step before t = 1.[67]' run $work/weak.nevh --dt 0.05
tells 'warning: the energy changes by up to 13 times' \
    run $work/weak.nevh --dt 0.05 --integrators rk4

# Invariants that are none.
scene planes 'x = 1\ny = 0.3' 'H = (p_x^2 + p_y^2)/2 + (x^2 + y^2)/2' \
    "[invariants]\nL = x*p_y - y*p_x\nvirial = x*p_x\n$run"
tells 'warning: virial of .invariants. is not conserved' run $work/planes.nevh
lacks 'L of .invariants.'

# H that jumps on the way.
scene steps 'x = 0.3' 'H = p_x^2/2 + x^2/2 + 0.1*floor(3*x)' "$run"
tells 'smooth no ' check $work/steps.nevh
scene cut 'x = -1\ny = 0' \
    'H = (p_x^2 + p_y^2)/2 + (x^2 + y^2)/2 - 0.1*atan2(y, x)' "$run"
tells 'smooth no ' check $work/cut.nevh
tells 'smooth yes ' check $work/well.nevh

# Momenta have the names of the scene.
scene damped 'x = 1' 'H = p_x^2/2 + x^2/2' \
    "[friction]\none = x: 1e308\nother = x: 1e308\n$run"
tells 'the rates of friction of p_x add up to inf' run $work/damped.nevh

# A pipe with a writer is a scene; without one it is refused.
mkfifo $work/pipe 2>/dev/null && {
    cat $work/well.nevh >$work/pipe &
    exits 0 check $work/pipe
    limit="${limit:+timeout 60}"
    tells 'nothing was written to this pipe' check $work/pipe
    # So are measured points.
    cat "$srcdir/scenes/pendulum-filmed.csv" >$work/pipe &
    exits 0 fit pendulum-filmed --data $work/pipe --vary l
    tells 'nothing was written to this pipe' fit pendulum-filmed --data $work/pipe --vary l
}

# Words of CC that make double another type.
for words in -Ddouble=float '-Ddouble=long\ double' -D__SIZE_TYPE__=char; do
    CC="cc $words"
    export CC
    XDG_CACHE_HOME=$work/cache exits 0 compare pendulum --t-end 2 \
        --integrators verlet,gauss4 --native always --repeat 1
    has '^native: no steps are compiled'
    unset CC
done
# Sums that are longer than doubles; steps of these schemes agree with others to the end.
CC='cc -mfpmath=387' XDG_CACHE_HOME=$work/cache exits 0 compare double-pendulum --t-end 2 \
    --native always --repeat 1
has '^native: no steps are compiled'
exit $status
