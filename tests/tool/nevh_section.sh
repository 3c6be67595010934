#!/bin/sh
# nevh section: columns, points, directions, periods, and what it refuses.

. "${srcdir:-.}/tests/support/nevh_support.sh"

rows() { grep -v '^#' $work/out | tail -n +2; }
# counts N: as many points.
counts() {
    test "$(rows | wc -l)" -eq "$1" ||
        { fails "has not $1 points"; cat $work/out; }
}
# holds EXPRESSION: awk's, of every point.
holds() {
    rows | awk -F, "function abs(x) { return x < 0 ? -x : x }
        !($1) { print; wrong = 1 } END { exit wrong || NR == 0 }" ||
        fails "does not hold: $1"
}

# One orbit, without the scene's ensemble.
single=$work/single.nevh
sed '/^\[ensemble\]/,/^$/d' "$srcdir/scenes/henon-heiles.nevh" >$single

# The points lie on the surface of the energy, and p_x is positive.
exits 0 section $single --integrators gauss8 --dt 0.1 --t-end 300
has '^# integrator: gauss8, dt = 0\.1$'
has '^# section crossing: 48 points$'
test "$(grep -v '^#' $work/out | head -n 1)" = section,t,direction,y,p_y ||
    fails "has other columns"
counts 48
holds '$1 == "crossing" && $3 == 1'
holds '1/8 - $5^2/2 - $4^2/2 + $4^3/3 > 0'
rows >$work/gauss
exits 0 section $single --integrators blanes-moan6 --dt 0.05 --t-end 300
rows | paste -d, - $work/gauss | awk -F, 'function abs(x) {
        return x < 0 ? -x : x }
    abs($2 - $7) > 1e-6 || abs($4 - $9) > 1e-6 || abs($5 - $10) > 1e-6 {
        print; wrong = 1 } END { exit wrong || NR != 48 }' ||
    fails "has other points than gauss8"

# The scene's 16 orbits of one energy: no point outside of its boundary, each
# orbit with points of its own.  Member 10 (y = 0.2667, near the periodic orbit)
# stays near it, member 4 (y = -0.1333) does not.
exits 0 section henon-heiles --integrators blanes-moan6 --dt 0.1 --t-end 500
has '^# members: 16$'
test "$(grep -v '^#' $work/out | head -n 1)" = section,t,direction,y,p_y,member ||
    fails "has other columns"
holds '1/8 - $5^2/2 - $4^2/2 + $4^3/3 > -1e-9'
rows | cut -d, -f6 | uniq >$work/numbers
seq 0 15 | cmp -s - $work/numbers || fails "has other members"
holds '$6 != 10 || abs($4 - 0.3) < 0.05 && abs($5) < 0.05'
rows | awk -F, '$6 == 4 && ($4 > 0.3 || $5 > 0.3 || $5 < -0.3) { far++ }
    END { exit far < 10 }' || fails "has no chaos"
exits 0 section $single --integrators blanes-moan6 --dt 0.1 --t-end 100 \
    --vary 'y = 0.1, 0.2' --vary 'p_x = solve(H = 1/8, from 0.4)'
has '^# members: 2$'
exits 1 section $single --t-end 50 --vary 'y = 0.1, -1' \
    --vary 'p_x = solve(H = 1/8, from 0.4)'
says '1 of 2 members have no start; the first, member 1: '
has '^# members: 2, 1 without a start$'
exits 2 section $single --vary 'y = -1, -2' \
    --vary 'p_x = solve(H = 1/8, from 0.4)'
says 'no member has a start; the first, member 0: p_x = solve'
# One that escapes to infinity leaves the points of the others.
exits 1 section $single --t-end 50 --vary 'y = 0.1, 3' \
    --vary 'p_x = solve(H = 1/8, from 0.4)'
says 'verlet member 1 failed: '
has '^crossing,.*,0$'
exits 2 section kepler
says 'plane = when y = 0, rising: x, p_x'
exits 2 section pendulum-rotating --vary 'g = 1, 2'
says 'change more than where members start'
# A parameter that only the start reads is a start.
sed 's/^\[coordinates\]/[parameters]\ny0 = 0.1\n&/; s/^y = .*/y = y0/
    s/^p_x = .*/p_x = sqrt(2*(1\/8 - y0^2\/2 + y0^3\/3))/' $single >$work/by_y0.nevh
exits 0 section $work/by_y0.nevh --t-end 50 --vary 'y0 = 0.1, 0.2'
has '^# members: 2$'
rows >$work/by_y0
exits 0 section $single --t-end 50 --vary 'y = 0.1, 0.2' \
    --vary 'p_x = sqrt(2*(1/8 - 0.1^2/2 + 0.1^3/3)), sqrt(2*(1/8 - 0.2^2/2 + 0.2^3/3))' \
    --vary 'combine = zip'
rows | cmp -s - $work/by_y0 || fails "has other points by a parameter"
exits 2 section $single --vary 'y = range(0, 0.1, 100000)'
says '100000 members are more than a picture shows'
# At 1/6, where some escape if a scheme makes errors of the energy.
exits 0 section henon-heiles-chaotic --t-end 300
holds '1/6 - $5^2/2 - $4^2/2 + $4^3/3 > -1e-6'

# What is used where nobody says so.
exits 0 section $single --t-end 20
has '^# integrator: verlet, dt = 0\.2 \(the scene.s first that fits\)'

# An angle is wrapped, the state is not: a pendulum that goes round.
exits 0 section pendulum-rotating --t-end 20 --integrators gauss6 --dt 0.05
counts 20
holds '$3 == 1 && abs($4) < 1e-12 && abs($5 - 8) < 1e-4'

# Stroboscopic: after each period, the last one being the end.
exits 0 section damped-driven-pendulum --t-end 94.24777960769379
counts 10
holds '$3 == 0 && abs($2 - NR*3*3.14159265358979) < 1e-12'
holds 'abs($4) <= 3.14159265358980'

# Several sections: one table, grouped; fields are empty where a section does
# not show an item.
cat >$work/several.nevh <<'END'
[coordinates]
x = 1
[effects]
kinetic = p_x^2/2
spring = x^2/2
[sections]
down  = when x = 0, falling: p_x
both  = when x = 0.5, both: x, x^2 + p_x^2
clock = every 1: x
[run]
t_end = 10
dt = 0.1
integrators = gauss8
END
exits 0 section $work/several.nevh
counts 15
has '^section,t,direction,p_x,x,x\^2 \+ p_x\^2$'
holds '$1 != "down" || ($3 == -1 && $4 < -0.9 && $5 == "" && $6 == "")'
holds '$1 != "both" || ($3^2 == 1 && $4 == "" && abs($5 - 0.5) < 1e-15 &&
       abs($6 - 1) < 1e-9)'
rows | cut -d, -f1 | uniq -c | tr -s ' \n' ' ' >$work/groups
grep -q '^ 2 down 3 both 10 clock' $work/groups || fails "is not grouped"
exits 0 section $work/several.nevh --section clock,down --format json
has '"section": "down"'
has '"section": "clock".* "p_x": null'
lacks '"section": "both"'
exits 0 section $work/several.nevh --section both --format table --quiet
has '^ both +1\.047197551'
lacks 'integrator:'

# A file, as a whole.
exits 0 section $work/several.nevh -o $work/points.csv
test "$(grep -c '^clock,' $work/points.csv)" = 10 || fails "wrote no file"

# A run that stops, and one that fails: the points until then.
sed 's/^t_end = 10/&\nstop = x < -0.9/' $work/several.nevh >$work/stops.nevh
exits 0 section $work/stops.nevh
has '^# stopped at t = 2\.7: x < -0\.9$'
counts 4
sed 's/^clock.*/edge = when sqrt(x + 0.5) = 2, both: x/' $work/several.nevh \
    >$work/fails.nevh
exits 1 section $work/fails.nevh
says 'failed: the value of section edge is not finite at t = 2\.1'
has '^# failed: '
has '^down,1\.57079632'
has '^both,1\.04719755'

# Without the transient: the same points, but for those before that time.
driven="section damped-driven-pendulum --t-end 94.2"
exits 0 $driven
rows | awk -F, '$2 >= 47' >$work/late
exits 0 $driven --after '5*2*pi/w'
has '^# section strobe: 5 points after t = 47'
rows | cmp -s - $work/late || fails "has other points"
exits 0 $driven --after 94.1
has '^# section strobe: 0 points after t = 94\.1$'
exits 2 $driven --after 95
says 'the run is from t = 0 to 94\.2'
exits 2 $driven --after x
says '^nevh: --after: '

# What is no use.
exits 2 section kepler
says 'no \[sections\]'
exits 2 section henon-heiles --section crosing
says 'did you mean crossing'
exits 2 section double-pendulum --integrators verlet
says 'needs H = T\(p\) \+ V\(q\)'
exits 2 section henon-heiles --every 3
says 'no option of nevh section'
exits 2 compare henon-heiles --section crossing
says 'no option of nevh compare'


# A column is there once, whatever a section shows.
printf '%s\n' '[coordinates]' 'x = 1' 'direction = 0' '[effects]' \
    'K = (p_x^2 + p_direction^2)/2' 'V = x^2/2' '[sections]' \
    'c = when x = 0, rising: t, x, (direction)' '[run]' 't_end = 20' 'dt = 0.1' \
    >$work/twice.nevh
exits 0 section $work/twice.nevh
test "$(grep -v '^#' $work/out | head -n 1)" = 'section,t,direction,x,(direction)' ||
    { fails "has a column twice"; cat $work/out; }
holds '$2 > 4.7 && $4 < 1e-12 && $5 == 0'
sed 's/(direction)$/direction/' $work/twice.nevh >$work/again.nevh
exits 2 section $work/again.nevh
says ':8:31: error: direction is a column of every section: write \(direction\)'

# Half a period is one number, on whichever side of it rounding puts the point.
printf '%s\n' '[coordinates]' 'phi = pi, 0.3 ; period 2*pi' 'x = 1' '[effects]' \
    'K = (p_phi^2 + p_x^2)/2' 'V = x^2/2' '[sections]' \
    's = when phi = pi, both: phi, x' '[run]' 't_end = 200' 'dt = 0.1' \
    >$work/half.nevh
exits 0 section $work/half.nevh
counts 9
holds '$4 > 3.14159 && $4 < 3.1416'

# Orbits of several energies are told of, those of one are not.
printf '%s\n' '[coordinates]' 'x = 0' 'y = 0.1' 'p_x = 0.1' '[effects]' \
    'K = (p_x^2 + p_y^2)/2' 'V = (x^2 + y^2)/2 + x^2*y - y^3/3' '[sections]' \
    's = when x = 0, rising: y, p_y' '[run]' 't_end = 20' 'dt = 0.1' >$work/surface.nevh
exits 0 section $work/surface.nevh --vary 'y = range(-0.2, 0.3, 4)'
has '^# energies: H = 0.* of the 4 orbits: .*solve'
exits 0 section $work/surface.nevh --vary 'y = range(-0.2, 0.3, 4)' \
    --vary 'p_x = solve(H = 1/12, from 0.3)'
lacks 'energies:'

# A start that the ensemble replaces is refused; that of another variable is not.
exits 2 section henon-heiles --start p_x=0.3
says "--start p_x=0.3: \[ensemble\] or --vary gives it to each orbit; --vary 'p_x=0.3'"
exits 2 section henon-heiles --start v_y=0.3
exits 2 sweep henon-heiles --vary 'y = range(0.1, 0.2, 2)' --start y=3
exits 2 sweep pendulum --vary 'g = 9, 10' --set g=3
exits 0 section henon-heiles --start x=0 --t-end 20
printf '%s\n' '[coordinates]' 'x[1..3] = 0.1' '[effects]' 'k = sum(i = 1..3, p_x[i]^2)' \
    'v = sum(i = 1..3, x[i]^4)' '[ensemble]' 'x[2] = 0.1, 0.2' '[run]' 't_end = 1' \
    'dt = 0.1' '[sections]' 's = when x[1] = 0, both: x[2]' >$work/array.nevh
for start in x[2]=0 x=0 'x[1..3] = 0' p_x[1]=0; do
    case $start in p*) code=0 ;; *) code=2 ;; esac
    exits $code sweep $work/array.nevh --start "$start"
done
exits 0 sweep $work/array.nevh --start x[1]=0
exits 0 run henon-heiles --start p_x=0.3 --t-end 1
exit $status
