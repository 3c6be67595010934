#!/bin/sh
# nevh sweep: columns, order, the same bytes for any width and threads, and what
# it refuses.

. "${srcdir:-.}/tests/support/nevh_support.sh"

rows() { grep -v '^#' $work/out | tail -n +2; }

exits 0 sweep pendulum-periods --gradient exact
has '^# integrator: gauss10, dt = 0\.05 \(the scene.s first that fits\)'
has '^# members: 61$'
test "$(grep -v '^#' $work/out | head -n 1)" = \
    member,status,phi,period,energy_error || fails "has other columns"
rows | awk -F, '
    function K(k, a, b, c, i) { # by arithmetic and geometric means
        a = 1; b = sqrt((1 - k)*(1 + k))
        for (i = 0; i < 20; i++) { c = (a + b)/2; b = sqrt(a*b); a = c }
        return 2*atan2(1, 1)/a
    }
    {
        exact = 4*sqrt(1/9.8)*K(sin($3/2))
        if ($1 != NR - 1 || $2 != "ok" || ($4/exact - 1)^2 > 1e-18) {
            print; wrong = 1
        }
    }
    END { exit wrong || NR != 61 }' || fails "has other periods"

# Members end, and others begin, at different times: what is found of a method of two
# steps, whose balance of friction is of both, does not depend on the width.
cat >$work/damped.nevh <<'SCENE'
[coordinates]
x = 1
[effects]
T = p_x^2/2
V = x^2/2 + x^4/4
[friction]
drag = x: 0.1
[run]
t_end = 20
stop = x^2 < 0.01
SCENE
for width in 1 8; do
    exits 0 sweep $work/damped.nevh --vary 'x = range(0.5, 2, 40)' --dt 0.05 \
        --integrators adams-bashforth2 --outcomes energy_error,t --quiet --width $width
    cp $work/out $work/width$width
done
cmp -s $work/width1 $work/width8 || fails "depends on the width"

# Bytes do not depend on widths, threads, or where they go.
many="--vary phi=range(-3,3,40) --vary p_phi=range(-8,8,30)
    --integrators verlet --t-end 20"
set -- $many --outcomes \
    'first(abs(phi) > pi), energy_error, verdict, mean(v_phi), state'
exits 0 sweep pendulum-periods "$@" --width 1 --threads 1
cp $work/out $work/one
exits 0 sweep pendulum-periods "$@" --width 8 --threads 2
cmp -s $work/out $work/one || fails "depends on the width"
exits 0 sweep pendulum-periods "$@" --width 32 --threads 3
cmp -s $work/out $work/one || fails "depends on the threads"
exits 0 sweep pendulum-periods "$@" -o $work/file.csv
cmp -s $work/file.csv $work/one || fails "writes other bytes to a file"
exits 0 sweep pendulum-periods "$@" --quiet
grep -v '^#' $work/one | cmp -s - $work/out || fails "is not quiet"
# What never happens is empty.
has ',first\(abs\(phi\) > pi\),'
awk -F, '$5 == ""' $work/out | grep -q . || fails "has no empty field"
XDG_CACHE_HOME=$work/cache exits 0 sweep pendulum-periods "$@" --native always
XDG_CACHE_HOME=$work/cache exits 0 sweep pendulum-periods "$@"
cmp -s $work/out $work/one || fails "depends on the cache of compiled steps"

# A parameter that changes the step changes it for its members alone.
exits 0 sweep pendulum-periods --vary 'g = 1.6, 9.8' --vary 'phi = 1' \
    --outcomes period --quiet
rows | awk -F, 'NR == 1 { slow = $5 } NR == 2 { fast = $5 }
    END { ratio = slow/fast - sqrt(9.8/1.6); exit ratio^2 > 1e-16 || NR != 2 }' ||
    fails "has other periods on the moon"

# A double pendulum at rest flips where its energy suffices, and nowhere else.
exits 0 sweep double-pendulum-chaotic --vary 'phi1 = range(-3.1, 3.1, 25)' \
    --vary 'phi2 = range(-3.1, 3.1, 25)' --outcomes 'first(abs(phi2) > pi)' \
    --integrators gauss4 --gradient exact --dt 0.02 --t-end 12 --quiet
rows | awk -F, '$2 != "ok" || (2*cos($3) + cos($4) > 1 && $5 != "") {
        print; wrong = 1 }
    $5 != "" { flips++ }
    END { exit wrong || NR != 625 || flips < 300 }' ||
    fails "flips where the energy forbids it, or hardly ever"

# Chaos and order, as nevh chaos has them, whatever the threads and the width.
chaos="--integrators blanes-moan4 --dt 0.2 --t-end 500 --outcomes sali,megno"
exits 0 sweep henon-heiles --vary 'y = -0.25, 0.1, 0.2' $chaos --quiet
cp $work/out $work/one
rows | awk -F, '($6 < 1e-8) != (NR == 1) || ($7 > 4) != (NR == 1) {
        print; wrong = 1 } END { exit wrong || NR != 3 }' ||
    fails "finds chaos elsewhere"
exits 0 sweep henon-heiles --vary 'y = -0.25, 0.1, 0.2' $chaos --quiet \
    --width 8 --threads 2
cmp -s $work/out $work/one || fails "finds other displacements in other lanes"
# Frequencies: pi sqrt(9.8)/(2 K(sin(start/2))) of the pendulum; of an angle that
# goes round that of its cosine, as nevh frequencies has it; none at rest.
pendulum="pendulum --integrators gauss16 --gradient exact --t-end 200 --quiet"
lines="--outcomes frequency(phi),frequency(p_phi)"
exits 0 sweep $pendulum --vary 'start = 0, 1, 2, 3' $lines
cp $work/out $work/lines
rows | awk -F, '
    function off(x) { x = x/w[NR] - 1; return x > 1e-9 || x < -1e-9 }
    BEGIN { w[2] = 2.9357541328863244; w[3] = 2.3556962007225665
            w[4] = 1.2175069363870312 }
    NR == 1 ? $4 $5 != "" : off($4) || off($5) { print; wrong = 1 }
    END { exit wrong || NR != 4 }' || fails "has other frequencies"
exits 0 sweep $pendulum --vary 'start = 0, 1, 2, 3' $lines --width 1 \
    --threads 2
cmp -s $work/out $work/lines || fails "has other frequencies in other lanes"
exits 0 sweep $pendulum --vary 'p_phi = 8' --outcomes 'frequency(phi)'
turning=$(rows | cut -d, -f 4)
exits 0 frequencies $pendulum --start p_phi=8 --format csv
rows | awk -F, -v w="$turning" '$4 == 1 { d = $5/w - 1
    exit d > 1e-9 || d < -1e-9 }' || fails "has another frequency of rotation"

exits 0 chaos henon-heiles --integrators blanes-moan4 --dt 0.2 --t-end 500 \
    --starts 1 --format csv --quiet
# The same numbers, which the two print in 17 digits and in the fewest.
{ rows | cut -d , -f 8-9 && sed -n 3p $work/one | cut -d , -f 6-7; } |
    awk -F, 'NR == 1 { sali = $1; megno = $2 }
        END { exit !(NR == 2 && $1 + 0 == sali + 0 && $2 + 0 == megno + 0) }' ||
    fails "does not find what nevh chaos finds"

# Draws: the same for the same seed.
exits 0 sweep pendulum --vary 'phi = normal(1, 0.1)' --vary 'count = 20' \
    --vary 'seed = 5' --t-end 1 --outcomes t --quiet
cp $work/out $work/one
exits 0 sweep pendulum --vary 'count = 20' --vary 'seed = 5' \
    --vary 'phi = normal(1, 0.1)' --t-end 1 --outcomes t --quiet
cmp -s $work/out $work/one || fails "draws other numbers"

# Members that cannot be run are told of, and the others are there.
cat >$work/well.nevh <<'END'
[parameters]
a = 1
[coordinates]
x = 1
[effects]
kinetic = p_x^2/2
well = -log(x)
[run]
t_end = 1
dt = 0.01*a
END
exits 1 sweep $work/well.nevh --vary 'x = -1, 1' --quiet
says '1 of 2 members have no start; the first, member 0: well is not finite'
has '^0,no start,-1,,,$'
has '^1,ok,1,'
exits 1 sweep $work/well.nevh --vary 'a = 0, 1' --quiet
says '1 of 2 members failed; the first, member 0'
has '^0,failed,0,,,$'
has '^1,ok,1,'

few='--vary phi=range(-3,3,50) --t-end 5 --gradient exact'
# Compiled steps change no byte but the note; what cannot be compiled says so.
if ${CC:-cc} --version >/dev/null 2>&1; then
    exits 0 sweep pendulum $few --integrators verlet --native never
    rows >$work/never.csv
    exits 0 sweep pendulum $few --integrators verlet --native always --no-cache
    has '^# native: steps are compiled'
    rows | cmp - $work/never.csv || fails 'compiled steps have other bits'
fi
exits 0 sweep pendulum $few --native always --no-cache \
    --integrators gonzalez
says 'steps are not compiled'

refuses() {
    words=$1
    shift
    exits 2 sweep "$@"
    says "$words"
}
refuses 'nothing is varied' pendulum
refuses 'there is no outcome frist; did you mean first' pendulum-periods \
    --outcomes 'frist(phi > 1)'
# Refusals, help and the manual have the same outcomes.
exits 0 help sweep
sed -n '/^Outcomes:/,$s/^  \([a-z][a-z_]*\).*/\1/p' $work/out >$work/outcomes
test "$(wc -l <$work/outcomes)" -ge 15 || fails 'lists few outcomes'
refuses "there is no outcome zzzzzzzz; there are $(paste -sd, $work/outcomes |
    sed 's/,/, /g')" pendulum-periods --outcomes zzzzzzzz
awk '/^@section/ { on = /Outcomes/ } on && sub(/^@item /, "") {
        gsub(/\([^)]*\)/, ""); gsub(/, /, "\n"); print }' "$srcdir/doc/nevh.texi" |
    sort >$work/items
sort $work/outcomes | diff - $work/items ||
    fails 'has other outcomes than doc/nevh.texi'
refuses 'sali stands alone' pendulum-periods --outcomes 'sali(phi)'
refuses 'needs samples at equal times' kepler-0.9 --vary 'x = 1, 1.1' \
    --outcomes 'frequency(x)' --integrators adaptive-verlet
refuses 'this is written frequency\(FORMULA\)' pendulum --vary 'phi = 1, 2' \
    --outcomes frequency
refuses 'take a scheme of fixed steps' henon-heiles --outcomes megno \
    --integrators adaptive-verlet
refuses 'from 2 to 1e\+11, not 0' pendulum --vary 'phi = range(0, 1, 0)'
refuses '1e\+12 members' pendulum --vary 'phi = range(0, 1, 1e6)' \
    --vary 'p_phi = range(0, 1, 1e6)'
refuses 'psi is no coordinate' pendulum --vary 'psi = 1'
refuses 'writes CSV' pendulum-periods --format json
refuses 'needs H = T\(p\) \+ V\(q\)' double-pendulum --vary 'phi1 = 1, 2' \
    --integrators verlet
refuses 'cannot be written' pendulum-periods -o $work/no/such/folder.csv
exits 2 sweep pendulum --vary phi=0.5 --outcomes 'max(phi),mean(log(-1))'
says 'pendulum: log.-1.: this is not a number'
exits 2 run pendulum --vary 'phi = 1'
says '--vary is no option of nevh run; it is for .*sweep'

# What escapes makes no turn, and has no frequency.
printf '%s\n' '[coordinates]' 'x = 0' '[effects]' 'kinetic = p_x^2/2' \
    'morse = 10*(1 - exp(-x))^2' '[run]' 'dt = 0.02' 't_end = 100' >$work/morse.nevh
exits 0 sweep $work/morse.nevh --vary 'p_x = 2, 5' --quiet --outcomes 'frequency(x)'
has '^0,ok,2,4\.0005'
has '^1,ok,5,$'
# An outcome that is undefined along part of an orbit has no value, and is told.
exits 0 sweep pendulum --vary 'phi=1, 2' --t-end 5 --quiet \
    --outcomes 'mean(log(phi)),max(log(phi)),min(sqrt(phi)),max(phi)'
has '^0,ok,1,,,,1$'
says 'pendulum: 2 of 2 members have no value of an outcome; the first, mean\(log\(phi\)\), is undefined'
exits 0 sweep pendulum --vary 'phi=1, 2' --t-end 5 --quiet \
    --outcomes 'max( log(phi) )' -o $work/undefined.npy
says 'pendulum: 2 of 2 members have no value of an outcome; the first, max'
exits 0 sweep pendulum --vary 'phi=1' --t-end 5 --quiet \
    --outcomes 'first(phi > 9),period' -o $work/never.npy
test -s $work/err && fails "says that something is undefined"

# Members take as many substeps as the name says, as a run does.
for name in respa+2 respa+16; do
    exits 0 run charged-chain --integrators $name --t-end 1 --samples 2 --quiet
    tail -n 1 $work/out | cut -d, -f2 >$work/$name
    exits 0 sweep charged-chain --vary c=1 --integrators $name --t-end 1 --quiet \
        --outcomes 'last(x[1])'
    tail -n 1 $work/out | cut -d, -f4 | cmp - $work/$name ||
        fails "takes other substeps than $name"
done
cmp -s $work/respa+2 $work/respa+16 && fails "does not tell substeps apart"
exit $status
