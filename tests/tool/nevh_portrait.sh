#!/bin/sh
# nevh portrait: orbits, level curves, equilibria, and what it refuses.

. "${srcdir:-.}/tests/support/nevh_support.sh"

exits 2 portrait pendulum
says 'nevh portrait draws: give --plot FILE'
exits 2 portrait pendulum --plot $work/a.doc
says 'FILE.svg'
exits 2 portrait pendulum --plot $work/a.svg -o $work/a.csv
says 'writes no rows'
exits 2 portrait pendulum --vary 'g = 1, 2' --plot $work/a.svg
says 'change more than where members start'
exits 2 portrait elastic-pendulum --plot $work/a.svg --section nothing
says 'unknown section nothing'
exits 2 portrait coupled-oscillators --plot $work/a.svg --section nothing
says 'section'
exits 2 portrait double-pendulum --integrators verlet --plot $work/a.svg
says 'nothing to draw|fits'
test -e $work/a.svg && fails "leaves a picture"

# series NAME: points of the series of that name in the first panel.
points() {
    awk -v name="\$series$1" '$1 == name && $2 == "<<" { on = 1; next }
        /^EOD/ { on = 0 } on && NF == 2' $work/gp
}

# H of an equilibrium is no rounding, however small it is; the orbit that failed is named.
printf '[coordinates]\nx = 1, 0\n[effects]\nkinetic = p_x^2/2
V = 3.3*(x - 0.3)^2*(x + 0.7)^2 - 0.03*(x - 0.3)^2
[run]\nt_end = 5\ndt = 0.05\nintegrators = yoshida4\n' >$work/zero.nevh
exits 0 portrait $work/zero.nevh --plot $work/a.svg
has '^centre at x = 0\.3, p_x = 0: H = 0$'
sed 's/^V = .*/V = 1e-30*(x^4\/4 - x^2\/2) + 1e-32/; s/= p_x/= 1e-30*p_x/' $work/zero.nevh >$work/tiny.nevh
exits 0 portrait $work/tiny.nevh --plot $work/a.svg
has '^saddle at x = 0, p_x = 0: H = 1e-32$'
sed 's/^V = .*/V = x^2\/2 - x^3\/3/' $work/zero.nevh >$work/edge.nevh
exits 1 portrait $work/edge.nevh --vary 'x = 0.5, 2.5' --plot $work/a.svg
says 'x = 2\.5'
rm -f $work/a.svg

# The pendulum: level curves are those of H, and so is the separatrix.
exits 0 portrait pendulum --vary 'phi = 0' --vary 'p_phi = 1, 3, 5, 8' \
    --integrators verlet,euler --t-end 20 --dt 0.1 --plot $work/a.svg \
    --keep-plot-script $work/gp
test -s $work/a.svg || fails "draws nothing"
has '^centre at phi = 0, p_phi = 0: H = -9\.8 J$'
has '^saddle at phi = 3\.141592654, p_phi = 0: H = 9\.8 J$'
lacks 'phi = -3\.14' # the same, a period on
test "$(grep -c '^[cs]' $work/out)" -eq 2 || fails "has other equilibria"
grep -q '^set title "verlet: H within ' $work/gp || fails "has no panel of verlet"
grep -q '^set title "euler: H within ' $work/gp || fails "has no panel of euler"
points 1 >$work/levels
points 2 >$work/separatrix
test "$(wc -l <$work/levels)" -gt 1000 || fails "has no levels"
awk '{ h = $2^2/2 - 9.8*cos($1); near = 1
       for (p = 1; p <= 8; p++) if (p != 2 && p != 4 && p < 6 || p == 8) {
           d = h - (p^2/2 - 9.8); d = d < 0 ? -d : d
           near = d < near ? d : near }
       if (near > 0.02) { print; wrong = 1 } } END { exit wrong }' \
    $work/levels || fails "draws other levels"
awk '{ d = $2^2/2 - 9.8*cos($1) - 9.8
       if (d > 0.02 || d < -0.02) { print; wrong = 1 } }
    END { exit wrong || NR < 100 }' $work/separatrix ||
    fails "draws another separatrix"
# Angles are wrapped: the member that goes round stays in one period.
points 8 >$work/round
awk '$1 > 3.15 || $1 < -3.15 || $2 < 3 { print; wrong = 1 }
    END { exit wrong || NR < 100 }' $work/round ||
    fails "does not wrap the angle"

# An orbit about half a turn is in one piece.
exits 0 portrait kapitza --integrators verlet --t-end 5 --plot $work/a.svg \
    --keep-plot-script $work/gp
has '^centre at phi = 3\.14'
points 5 | awk '$1 < 2.9 || $1 > 3.4 { wrong = 1 } END { exit wrong || NR < 100 }' ||
    fails "cuts an orbit about half a turn"

# A double well: two centres, and a saddle between them.
cat >$work/well.nevh <<'END'
[coordinates]
x = 1.2
[effects]
kinetic = p_x^2/2
well = (x^2 - 1)^2
[ensemble]
x = range(0.2, 1.5, 5)
p_x = solve(H = 2, from 1)
[run]
t_end = 20
dt = 0.05
integrators = verlet
END
exits 0 portrait $work/well.nevh --plot $work/b.svg
has '^.*b.svg: 5 orbits by each integrator$'
has '^centre at x = -1, p_x = 0: H = [0-9.e-]+$'
has '^saddle at x = 0, p_x = 0: H = 1$'
has '^centre at x = 1, p_x = 0: '

# All of the window, those near the start first: 38 of a cosine, and the saddle at 0
# of a rippled well, which Newton's method seldom finds from elsewhere.
plane() { # V STARTS
    printf '[coordinates]\nx = 0.2\n[effects]\nK = p_x^2/2\nV = %s\n[run]
t_end = 0.5\ndt = 0.02\nintegrators = verlet\n' "$1" >$work/plane.nevh
    exits 0 portrait $work/plane.nevh --vary "x = $2" --plot $work/plane.svg
}
plane 'cos(x)' 'range(-40, 40, 5)'
places() { sed -n 's/^[a-z]* at x = \([^,]*\),.*/\1/p' $work/out; }
# Multiples of pi, one by one from the start on.
places | awk 'function abs(x) { return x < 0 ? -x : x }
    { n = $1/3.14159265358979; d = abs(n - int(n + (n < 0 ? -0.5 : 0.5)))
      if (d > 1e-8 || abs($1 - 0.2) < last || seen[$1]++) wrong = 1
      last = abs($1 - 0.2); if (abs($1) < 40) inside++ }
    END { exit wrong || inside != 25 }' || fails "is not all of a cosine"
plane 'cos(10*x)/10 + x^2/20' 'range(-12, 12, 7)'
test $(places | wc -l) = 63 || fails "is not all of a rippled well"
has '^saddle at x = 0, p_x = 0: H = 0\.1$'
# Degenerate ones, which derivatives cross, touch, or that fill a line.
plane 'x^4' 'range(-1, 1, 4)'
has '^degenerate at x = 0, p_x = 0: '
plane 'x^3' 'range(-1, 1, 4)'
has '^degenerate at x = 0, p_x = 0: '
plane '0*x' 'range(-1, 1, 4)'
has '^degenerate equilibria fill a curve'
test $(places | wc -l) = 1 || fails "lists a line"
has '^degenerate at x = 0\.2, p_x = 0: ' # the start, which is the nearest
# Of any unit of energy.
plane '1e-20*cos(x)' 'range(-4, 4, 5)'
has '^saddle at x = 0, p_x = 0: H = 1e-20$'
has '^centre at x = 3\.14'
exits 0 portrait $work/well.nevh --plot $work/b.svg --quiet
test -s $work/out && fails "is not quiet"
exits 1 portrait $work/well.nevh --plot $work/b.svg --vary 'x = 0, 9'
says '1 of 2 members have no start'

# An orbit that fails does so on stderr; what is drawn ends there.
cat >$work/edge.nevh <<'END'
[coordinates]
x = 1
[effects]
kinetic = p_x^2/2
root = sqrt(x)
[run]
t_end = 20
dt = 0.05
integrators = verlet
END
exits 1 portrait $work/edge.nevh --plot $work/b.svg
lacks failed
says '^nevh: .*edge.nevh: verlet failed: '

# More degrees of freedom: a plane of section, a panel an integrator.
exits 0 portrait henon-heiles --integrators verlet,blanes-moan4 --t-end 60 \
    --plot $work/c.svg --keep-plot-script $work/gp
for text in verlet blanes-moan4; do
    grep -q "^set title \"$text\"" $work/gp || fails "has no panel of $text"
done
test "$(grep -c '^\$series' $work/gp)" -eq 32 || fails "has not 32 series"
for axis in x y; do
    test "$(grep "^set ${axis}range" $work/gp | head -n 2 | sort -u | wc -l)" -eq 1 ||
        fails "has other ranges of $axis in each panel"
done
grep -q 'NaN with points .*pointsize 0.70 title "start y' $work/gp ||
    fails "has small dots in its legend"
# Under a drive and friction H does change, and its levels are those of the start.
exits 0 portrait damped-driven-pendulum --integrators verlet --plot $work/d.svg \
    --keep-plot-script $work/gp
grep -q '^set title "verlet; lines: H at t = 0, without friction"' $work/gp ||
    fails "tells a change of H"
# What is given to all orbits is in the title as it is.
exits 0 portrait henon-heiles --vary p_x=0.3 --integrators verlet --t-end 20 \
    --plot $work/c.svg --keep-plot-script $work/gp
grep -q 'side by side, but p_x=0.3' $work/gp || fails "says that p_x is varied"
exit $status
