#!/bin/sh
# nevh flow: areas, shapes, pictures, and what it refuses.

. "${srcdir:-.}/tests/support/nevh_support.sh"

rows() { grep -v '^#' $work/out | tail -n +2; }
# holds EXPRESSION: awk's, of every row.
holds() {
    rows | awk -F, "function abs(x) { return x < 0 ? -x : x }
        !($1) { print; wrong = 1 } END { exit wrong || NR == 0 }" ||
        fails "does not hold: $1"
}

# A disc of radius 0.3, 300 steps: symplectic schemes keep its area.
exits 0 flow pendulum --shape 'disc(phi = 1, p_phi = 0, 0.3)' \
    --gradient exact --dt 0.1 --samples 4 --t-end 30 --format csv \
    --integrators verlet,gauss4,implicit-euler,rk4
test "$(grep -v '^#' $work/out | head -n 1)" = \
    scene,integrator,symplectic,dt,t,area,ratio,points,status,error ||
    fails "has other columns"
test "$(rows | wc -l)" -eq 16 || fails "has not 16 rows"
holds '$9 == "ok" && $1 == "pendulum" && $4 == 0.1'
holds '$3 == "yes" && abs($7 - 1) < 1e-9 || $3 == "no" && ($5 == 0 || $7 < 0.9995)'
holds '$5 > 0 || abs($6 - 3.14159265358979*0.09) < 1e-14'
holds '$5 == (NR - 1) % 4*10'

# An ellipse, a rectangle and the cat; where no shape is named the cat is round
# the start.
exits 0 flow pendulum --shape 'disc(p_phi = 1, phi = 0, 0.3, 0.1)' --at 1 \
    --format csv --integrators verlet
holds '$5 > 0 || abs($6 - 3.14159265358979*0.03) < 1e-14'
test "$(rows | wc -l)" -eq 2 || fails "has not 2 rows"
exits 0 flow pendulum --shape 'box(phi = pi/2, p_phi = 0, 0.3, 0.1)' --at 0,1 \
    --format csv --integrators verlet
holds '$5 > 0 || abs($6 - 0.03) < 1e-14'
test "$(rows | wc -l)" -eq 2 || fails "has not 2 rows"
exits 0 flow pendulum --integrators verlet,heun --t-end 2
has '^shape: cat\(phi = 2, p_phi = 0, '
has '^ verlet  .* 1\.000000000 .* ok$'
has '^heun, dt = 0\.1: the area (grows|shrinks) (to|by) '
has '^Symplectic integrators keep the area: ratios are 1 within '
lacks 'ensemble'

# A time comes once, whatever the step.
for times in '--t-end 5' '--t-end 3 --samples 100' '--t-end 0.3'; do
    exits 0 flow pendulum --dt 0.1,0.05 --format csv --integrators verlet $times
    rows | cut -d, -f 4,5 | sort >$work/times
    test "$(uniq -d $work/times)" = '' || fails "has a time twice: $(uniq -d $work/times)"
done

# Two degrees of freedom: the sum, of a loop of formulas or of a disc.
exits 0 flow henon-heiles --dt 0.1 --gradient exact --format csv --t-end 50 \
    --integrators verlet,rk4 \
    --shape 'loop(x = 0.15*cos(t), p_x = 0.3 + 0.1*sin(t), y = 0.05*sin(t))'
holds '$9 == "ok"'
holds '$2 == "verlet" && abs($7 - 1) < 1e-9 || $2 == "rk4" && ($5 < 5 || $7 < 0.999999)'
exits 0 flow henon-heiles --dt 0.1 --gradient exact --format csv --t-end 20 \
    --integrators midpoint --shape 'disc(y = 0.1, p_y = 0, 0.05)'
holds 'abs($7 - 1) < 1e-9'

# The shape is what starts, and the scene's own members are not.
has "^# shape: disc.*the scene's .ensemble. is left aside"

# Friction shrinks the area by exp(-gamma t).
cat >$work/damped.nevh <<'END'
[coordinates]
x = 1
[effects]
kinetic = p_x^2/2
spring = 1 - cos(x)
[friction]
drag = x: 0.1
[run]
t_end = 10
dt = 0.1
END
exits 0 flow $work/damped.nevh --integrators verlet --gradient exact \
    --shape 'disc(x = 1, p_x = 0, 0.3)' --format csv
holds 'abs($7 - exp(-0.1*$5)) < 1e-9'

# What is refused, or fails, has rows of its own.
exits 0 flow kepler-0.9 --integrators verlet,adaptive-verlet --t-end 1 \
    --shape 'disc(x = 0.1, p_x = 0, 0.01)' --dt 0.001
has '^ adaptive-verlet .* refused$'
has 'adaptive-verlet refused: .*chooses times of its own'
cat >$work/edge.nevh <<'END'
[coordinates]
x = 1
[effects]
kinetic = p_x^2/2
push = -x - sqrt(9 - x)
[run]
t_end = 10
dt = 0.1
END
exits 1 flow $work/edge.nevh --integrators verlet --format csv \
    --shape 'disc(x = 1, p_x = 0, 0.3)'
has '^.*edge.nevh,verlet,yes,0.1,10,,,,"?failed: a point of the curve failed'
lacks ",-?nan"

# refuses WORDS ARGUMENT...
refuses() {
    words=$1
    shift
    exits 2 flow "$@"
    says "$words"
    test -s $work/out && fails "prints to stdout"
}
for bad in disc 'disc()' 'disc(phi = 1)' 'disc(phi = 1, p_phi = 0)' \
    'blob(phi = 1, p_phi = 0, 1)' 'disc(1, 0, 1)' 'disc(phi = 1, p_phi = 0, 1' \
    'box(phi = 1, p_phi = 0, 1)' ''; do
    refuses '--shape takes disc' pendulum --shape "$bad"
done
refuses 'sizes are above 0, not -1' pendulum --shape 'disc(phi=1, p_phi=0, -1)'
refuses 'sizes are above 0, not 0' pendulum --shape 'box(phi=1, p_phi=0, 1, 0)'
refuses 'coordinate or momentum psi' pendulum --shape 'disc(psi=1, p_phi=0, 1)'
refuses 'own momentum: x goes with p_x' henon-heiles \
    --shape 'disc(x=1, p_y=0, 1)'
refuses 'own momentum' henon-heiles --shape 'disc(x=1, y=0, 1)'
refuses 'not closed: x is' henon-heiles --shape 'loop(x=t, p_x=sin(t))'
refuses 'x is given twice' henon-heiles --shape 'loop(x=sin(t), x=cos(t))'
refuses 'encloses no area' henon-heiles --shape 'loop(x=sin(t))'
refuses 'not finite' henon-heiles --shape 'loop(x=sqrt(cos(t)), p_x=sin(t))'
refuses 'frobnicate' henon-heiles --shape 'loop(x=frobnicate(t), p_x=sin(t))'
refuses 'no option of nevh flow: its starts are those of --shape; --set' pendulum \
    --vary 'l=range(0.5,2,3)'
refuses 'stays where it starts' pendulum --start phi=0
refuses 'takes 1000 times' pendulum --samples 100000000
refuses 'the run is from' pendulum --at -1
refuses 'dt = 2000 is longer' pendulum --dt 2000
refuses 'FILE.svg' pendulum --plot nowhere.doc

# The picture: a panel an integrator.
exits 0 flow pendulum --integrators verlet,euler --t-end 10 \
    --plot $work/flow.svg --keep-plot-script $work/script
test -s $work/flow.svg || fails "draws nothing"
test "$(grep -c '^set lmargin at' $work/script)" -eq 2 ||
    fails "has not 2 panels"
test "$(grep -c '^set label "t = ' $work/script)" -ge 8 || fails "names no times"
grep -q '^set title "verlet: area kept until t = 10 s"' $work/script &&
    grep -q '^set title "euler: area .* 0\.3251 until t = 10 s' $work/script ||
    { fails "has other areas"; grep '^set title' $work/script; }
grep -q 'filledcurves closed' $work/script || fails "fills no shape"
# A panel that a shape has left says so.
test "$(grep -c '^set title .*, outside"' $work/script)" = 1 &&
    grep -q '^set title "euler.*, outside"' $work/script ||
    { fails "has other panels with shapes outside"; grep '^set title' $work/script; }
# Shapes that fill the panel with a thread are left out: the note says so.
exits 0 flow pendulum --integrators verlet --at 1,10,100 --plot $work/flow.svg
grep -q 'long threads are not drawn' $work/flow.svg || fails "draws a thread"
test "$(grep -c "fill-opacity='0.45'" $work/flow.svg)" = 3 || fails "draws other shapes"

# Nothing is said of areas that no run has carried on.
printf '[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = -1/x\n[run]
t_end = 10\ndt = 0.1\nintegrators = gauss4, rk4\n' >$work/pole.nevh
exits 1 flow $work/pole.nevh --shape 'disc(x = 1, p_x = 0, 2)'
has '^gauss4 failed: a point of the curve failed before t = 0.1'
lacks 'keep the area|shrinks|grows'
sed -i 's/^x = 1/x = 0, 1/; /^V/d' $work/pole.nevh
exits 2 flow $work/pole.nevh
says 'no coordinate changes together with its momentum'
# An orbit that fails has the shape of what there is of it.
exits 2 flow pendulum --set g=1e200
says 'pendulum: the orbit fails, so that no shape follows from it: '

# The default shape stays away from a singularity that the orbit passes by.
exits 0 flow kepler-0.9 --integrators gauss4 --t-end 0.2 --samples 3 --format csv
test "$(rows | wc -l)" -eq 3 || fails "has not 3 rows"
holds '$9 == "ok" && abs($7 - 1) < 1e-6'

# Titles: as many digits of a ratio as tell it from 1, and what has failed.
exits 0 flow pendulum --integrators rk4 --dt 0.05 --t-end 10 --plot $work/flow.svg \
    --keep-plot-script $work/script
grep -q '^set title "rk4: area × 0\.999975 until t = 10 s"' $work/script ||
    { fails "has another title"; grep '^set title' $work/script; }
cat >$work/cr3bp.nevh <<'END'
[parameters]
mu = 0.01215
[coordinates]
x = 0.6
y = 0
v_y = 0.6
[effects]
rotating = (p_x^2 + p_y^2)/2 + y*p_x - x*p_y
earth = -(1 - mu)/hypot(x + mu, y)
moon = -mu/hypot(x - 1 + mu, y)
[run]
t_end = 20
dt = 0.01
integrators = gauss4
END
exits 1 flow $work/cr3bp.nevh --plot $work/flow.svg --keep-plot-script $work/script
grep -q '^set title "gauss4: sum of areas kept until t = 1, then failed"' $work/script ||
    { fails "has another title"; grep '^set title' $work/script; }

# A ratio near 0 is told as the table has it.  The note names dt and
# the last time that has a shape; a panel that ends before says when.
sed 's/x: 0.1/x: 0.5/; s/^t_end.*/t_end = 100/' $work/damped.nevh >$work/strong.nevh
exits 0 flow $work/strong.nevh --integrators verlet --gradient exact \
    --shape 'disc(x = 1, p_x = 0, 0.3)' --at 1,100 --format csv \
    --plot $work/flow.svg --keep-plot-script $work/script
at_end=$(rows | awk -F, '$5 == 100 { print $7 }')
sed -n 's/^set title "verlet: area × \([0-9.e+-]*\) until.*/\1/p' $work/script |
    awk -v all="$at_end" '{ exit !(NR == 1 && all > 0 && ($1 / all - 1)^2 < 1e-6) }' ||
    { fails "has another ratio than $at_end"; grep '^set title' $work/script; }
exits 0 flow pendulum --at 1,10,100 --plot $work/flow.svg --keep-plot-script $work/script
grep -q '^set label "dt = 0.1 s; gradient central4; t = 0 ... 10 s; cat' $work/script ||
    { fails "has another note"; grep '^set label "dt' $work/script; }
grep -q 'drawn until' $work/script && fails "ends panels at different times"
exits 0 flow pendulum --integrators verlet,implicit-euler --at 1,10,100 \
    --plot $work/flow.svg --keep-plot-script $work/script
grep -q '^set title "implicit-euler: area × 0.0002[0-9]* until t = 10 s"' $work/script &&
    grep -q '^set title "verlet: area kept until t = 100 s"' $work/script ||
    { fails "has other titles"; grep '^set title' $work/script; }
exits 0 flow pendulum --integrators ralston,euler --at 5,10,20,30 \
    --plot $work/flow.svg --keep-plot-script $work/script
grep -q '^set title "ralston: area × 1.135 until t = 30 s, drawn until t = 20 s"' $work/script &&
    grep -q '^set title "euler: area × 0.1723 until t = 30 s"' $work/script ||
    { fails "has other titles"; grep '^set title' $work/script; }
# The default shape does not run away with the first integrator; what fails far out
# names where.
exits 0 flow pendulum --integrators euler --dt 0.1 --t-end 1
has '^shape: cat\(phi = 2, p_phi = 0, 0\.4, 1\.0[0-9]\)'
# An angle that goes round has a shape of a part of a turn, and shapes at the cut of an
# angle are drawn beside each other.
exits 0 flow pendulum-rotating --integrators verlet --t-end 5
has '^shape: cat\(phi = 0, p_phi = 8, 0\.628, 0\.2[0-9]+\)'
exits 0 flow kapitza --integrators verlet --plot $work/flow.svg
grep -q '>3\.10*<' $work/flow.svg && ! grep -q '>-[2-4][.0-9]*<' $work/flow.svg ||
    fails "draws shapes on both sides of the cut"
printf '%s\n' '[coordinates]' 'x = 2' '[effects]' 'kinetic = p_x^2/2' \
    'hill = x^2/2 - x^4/4' '[run]' 'dt = 0.1' 't_end = 50' >$work/hill.nevh
exits 1 run $work/hill.nevh --integrators verlet
says 'the solution itself ends at t = 1\.00'
# Of the orbit that failed, of 256 side by side.
sed 's/^hill.*/V = -x^2\/2/' $work/hill.nevh >$work/away.nevh
exits 1 flow $work/away.nevh --integrators verlet --shape 'disc(x = 0, p_x = 0, 0.9)'
tr '\n' ' ' <$work/out | tr -s ' ' |
    grep -Eq 'not finite at p_x = -?[0-9.]*e\+(1[4-9]|[2-9][0-9])' ||
    fails "names the value of another orbit"
lacks 'lane'
exit $status
