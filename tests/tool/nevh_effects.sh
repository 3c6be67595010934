#!/bin/sh
# nevh effects: what effects read and cost, and what they change.

. "${srcdir:-.}/tests/support/nevh_support.sh"

exits 0 effects damped-driven-pendulum --t-end 20
has '^ kinetic +on +momenta +1 +[0-9]+ +0\.2[45][0-9] '
has '^ gravity +on +coordinates +1 +[0-9]+ +0\.5[0-9]* '
has '^ drive +on +t, coordinates '
has '^ drag +on +momenta \(friction\) +0\.5 +0 +0 '
exits 0 effects fput --t-end 1 --format csv
has '^kinetic,on,momenta,,32,'
has '^springs,on,coordinates,,33,'

# CSV: shares add up to 1, of time, too; off is 0 evaluations.
exits 0 effects damped-driven-pendulum --without drag --t-end 20 --format csv
grep -v '^#' $work/out | sed 's/"[^"]*"/text/' | awk -F, 'NR > 1 {
    share += $7; time += $9; each[NR] = $6*$8; all += $6*$8; part[NR] = $9
    if ($2 == "off" && $6 + $7 + $8 + $9 != 0) wrong = 1
    if ($2 == "on" && $8 <= 0) wrong = 1 }
    END { for (i in part) if ((each[i]/all - part[i])^2 > 1e-4) wrong = 1
          exit wrong || share < 0.99 || share > 1.01 || time < 0.99 ||
          time > 1.01 }' || { fails "has other shares"; cat $work/out; }
exits 0 effects pendulum --gradient exact --t-end 10 --format csv
grep -v '^#' $work/out | awk -F, 'NR > 1 { time += $9 }
    END { exit time < 0.99 || time > 1.01 }' || fails "lacks shares of time"

# What is not there changes nothing; what is there changes what it should.
cat >$work/parts.nevh <<'END'
[scene]
effects = kinetic, spring, nothing, pull
[coordinates]
x = 1
y = 0.5
[effects]
kinetic = (p_x^2 + p_y^2)/2
spring = x^2/2 + y^2/2
nothing = 0*x
pull = 1e-6*x^3
twist = 0.1*(x*p_y - y*p_x)
wave = 0.1*x*cos(3*t)
[friction]
drag = all: 0.1
[run]
t_end = 20
dt = 0.01
integrators = verlet, gauss4
transform = 1 + x^2
END
exits 0 effects $work/parts.nevh --impact --format csv
row() { grep "^$1," $work/out; }
row nothing | grep -q '^nothing,on,verlet,0,0,,0,' ||
    fails "nothing changes something: $(row nothing)"
row pull | awk -F, '{ exit !($4 > 1e-7 && $4 < 1e-4 && $6 == "") }' ||
    fails "pull changes otherwise: $(row pull)"
row wave | grep -q 'gauss4+transform' || fails "wave rules nothing out"
row drag | grep -q 'adaptive-verlet' || fails "drag rules nothing out"
row twist | grep -q '^twist,off,gauss4,.*"symplectic-euler-a, .*verlet' ||
    fails "twist rules nothing out: $(row twist)"
row spring | awk -F, '{ exit !($5 > 0.5 && $6 > 0) }' ||
    fails "spring changes little: $(row spring)"
exits 0 effects $work/parts.nevh --impact
has 'With wave H depends on time'
has 'drag is friction'
has 'With twist H\(q, p\) is not separable'
exits 0 effects $work/parts.nevh --impact --integrators verlet --quiet
has '^ twist +off +[0-9]+$'
lacks 'fits'
exits 0 effects $work/parts.nevh --impact --integrators verlet
has "none of the scene's integrators fits"

# In a picture, a panel for each effect: what the table says, and both orbits.
exits 0 effects $work/parts.nevh --impact --plot $work/parts.svg \
    --keep-plot-script $work/parts.gp
has '^ twist +off +gauss4'
grep -q '>twist: [0-9]* % of the range<' $work/parts.svg || fails "draws no twist"
test "$(grep -c '^\$series' $work/parts.gp)" -eq 14 || fails "draws not two orbits each"
# The orbit with twist is another one, the one with nothing the same.
same() {
    heading=$(grep -n "^set title \"$1: " $work/parts.gp | cut -d: -f1)
    first=$(tail -n +$heading $work/parts.gp | grep -m 1 -o 'series[0-9]*')
    next=series$((${first#series} + 1))
    for s in $first $next; do
        sed -n "/^.$s <</,/^EOD/p" $work/parts.gp | tail -n +2 >$work/$s
    done
    test -s $work/$next && cmp -s $work/$first $work/$next
}
same nothing || fails "draws what nothing changes"
same twist && fails "draws twist without a difference"
exits 2 effects pendulum --plot $work/none.svg
says 'with --impact --plot'

# Without what moves coordinates there is no orbit to compare with; without a
# force, from rest, there is one.
exits 0 effects earth-halley --impact
has '^verlet at dt = 0.4: half the step changes the state at the end by [1-9].*e[-+]0[01]'
exits 0 effects pendulum --impact --t-end 10
has '^Without kinetic no coordinate moves'
has '^ kinetic +on +verlet +[0-9.]+ +[0-9.]+ +0$'
has '^Without gravity nothing moves'
has '^ gravity +on +verlet +[0-9.]+e'
has '^difference: of the states'
lacks 'is chaotic'
# Where chaos makes differences large, that is said.
exits 0 effects damped-driven-pendulum --impact --t-end 200
has '^The orbit is chaotic: a difference grows by a factor e in '

# Also of scenes whose start asks for velocities.
exits 0 effects sun-earth-moon --impact --t-end 0.1
exits 2 compare pendulum --impact
says 'no option of nevh compare'

# What is off is as if its line were deleted: all columns but seconds.
table() { grep -v '^#' $work/out | cut -d, -f2-16,18,19; }
while read -r scene effect end; do
    exits 0 compare "$scene" --without "$effect" --t-end "$end" --format csv
    table >$work/off
    sed -e '/^effects = /d' \
        -e "/^\[effects\]/,/^\$/{/^$effect *=/d}" \
        -e "/^\[friction\]/,/^\$/{/^$effect *=/d}" \
        -e '/^\[effects\]/,/^$/{/^\(earth\|jupiter\|relativity\) *=/d}' \
        "$srcdir/scenes/$scene.nevh" >$work/less.nevh
    exits 0 compare $work/less.nevh --t-end "$end" --format csv
    lacks "effects on: .*$effect"
    table >$work/less
    test "$(wc -l <$work/less)" -gt 3 || fails "has too few rows"
    cmp -s $work/off $work/less ||
        { fails "leaves a trace of $effect"; diff $work/off $work/less; }
done <<END
coupled-pendulums coupling 20
coupled-oscillators springs 20
damped-driven-pendulum drag 20
damped-driven-pendulum drive 20
double-pendulum gravity 2
earth-halley relativity 40
elastic-pendulum gravity 2
fput cubic 20
henon-heiles cubic 20
kapitza shaking 1
magnetic trap 5
outer-solar-system planets 20000
sun-earth-moon moon 0.5
END

# Runs that fail both ways are a failure.
printf '[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = acos(x)\n[run]
t_end = 2\ndt = 0.1\nintegrators = verlet\n' >$work/edge.nevh
exits 1 effects $work/edge.nevh --impact
has '^With V the run fails'

# The fewest effects that keep an observable, as by runs of all subsets; pull and push
# cancel.
cat >$work/needed.nevh <<'END'
[coordinates]
x = 1
y = 0.5
[effects]
kinetic = (p_x^2 + p_y^2)/2
spring = x^2/2 + y^2/2
pull = 0.3*x
push = -0.29999*x
twist = 1e-3*x^2*y
small = 1e-7*x^4
[run]
t_end = 10
dt = 0.02
integrators = verlet
END
column() { grep -v '^#' $work/out | cut -d, -f2; }
exits 0 run $work/needed.nevh --samples 50
column >$work/whole
for set in $(awk 'BEGIN { for (i = 0; i < 16; i++) print i }'); do
    off=
    for name in pull:1 push:2 twist:4 small:8; do
        test $((set / ${name#*:} % 2)) = 0 || off=$off,${name%:*}
    done
    exits 0 run $work/needed.nevh --samples 50 ${off:+--without ${off#,}}
    column | paste $work/whole - | awk -v off="$off" 'NR > 1 {
        d = $1 > $2 ? $1 - $2 : $2 - $1; most = d > most ? d : most
        low = $1 < low ? $1 : low; high = $1 > high ? $1 : high }
        END { n = split(off, all, ",") - 1; print n < 0 ? 0 : n, most/(high - low), off }'
done >$work/subsets
for error in 0.3 0.01 1e-4 1e-9; do
    fewest=$(awk -v e=$error '$2 <= e && $1 > n { n = $1; off = $3 }
        END { print off }' $work/subsets)
    exits 0 effects $work/needed.nevh --needed x --error $error
    found=$(awk '$2 == "no" { off = off "," $1 } END { print off }' $work/out)
    test "$found" = "$fewest" ||
        { fails "leaves out '$found', not '$fewest'"; cat $work/subsets; }
    has '^needed: kinetic, spring'
done
# Two that cancel, though what each of them does is thousands of times the error, or
# whatever one of them keeps from escaping; not two that nearly do.
for each in '0.001 0.001 K, V\.' '0.3 0.3 K, V\.' '0.001 0.0011 K, V, A, B\.'; do
    set -- $each
    printf '%s\n' '[coordinates]' 'x = 1' 'y = 0.2' '[effects]' \
        'K = (p_x^2 + p_y^2)/2' 'V = (x^2 + y^2)/2' "A = $1*x^4" "B = -$2*x^4" \
        'C = 1e-9*x*y' '[run]' 't_end = 50' 'dt = 0.05' >$work/cancel.nevh
    shift 2
    exits 0 effects $work/cancel.nevh --needed x --error 1e-6
    has "^needed: $*"
done
# Without the springs the solution ends: no step is too long.
cat >$work/ends.nevh <<'END'
[coordinates]
x = 0.4
y = 0.1
[effects]
K = (p_x^2 + p_y^2)/2
V = (x^2 + y^2)/2
C = x^2*y - y^3/3
[run]
t_end = 100
dt = 0.1
integrators = verlet
END
exits 0 effects $work/ends.nevh --impact
has '^Without V the run fails: the solution itself ends at'
lacks 'smaller step'
exits 2 effects $work/needed.nevh --needed x
says 'needs --error'
exits 2 effects $work/needed.nevh --needed xx --error 1e-3
says 'xx'

# An orbit that leaves without an effect does not make the other flat.
exits 0 effects kepler --impact --t-end 100 --plot $work/impact.svg
sed -n "s/^<text .*text-anchor='end'>\([0-9.-]*\)<.*/\1/p" $work/impact.svg >$work/heights
awk '$1 > most { most = $1 } END { exit !(NR > 4 && most < 10) }' $work/heights ||
    fails "shows an orbit without gravity up to $(sort -g $work/heights | tail -n 1)"
exit $status
