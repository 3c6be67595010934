#!/bin/sh
# Integrators of a scene's own: in tables and counts, compiled and not, in sweeps.

. "${srcdir:-.}/tests/support/nevh_support.sh"

cat >$work/own.nevh <<'END'
[parameters]
w = 1/(2 - 2^(1/3))
[coordinates]
q = 1, 0.2
[effects]
kinetic = p_q^2/2
potential = -cos(q)
[integrator jump]
compose = verlet: w, 1 - 2*w, w
[integrator copy]
compose = verlet: 1/(2 - 2^(1/3)), 1 - 2/(2 - 2^(1/3)), 1/(2 - 2^(1/3))
[integrator classic]
a = ; 1/2 ; 0, 1/2 ; 0, 0, 1
b = 1/6, 1/3, 1/3, 1/6
[integrator radau]
a = 5/12, -1/12 ; 3/4, 1/4
b = 3/4, 1/4
[integrator unweighted]
a = 0, 0, 0 ; 1/2, 1/2, 0 ; 1/4, 0, 1/4
b = 0, 0, 1
[run]
t_end = 50
dt = 0.1
gradient = exact
integrators = copy, forest-ruth, classic, rk4, radau
END
own=$work/own.nevh

# Copies are equal in all but names and times; so are compiled steps.
numbers='NR > 1 { print $2, $4, $9, $10, $11, $13, $14, $15 }'
for native in never always; do
    exits 0 compare $own --native $native --format csv --quiet
    grep -v '^#' $work/out | awk -F, "$numbers" >$work/$native
    for pair in 'copy forest-ruth' 'classic rk4'; do
        set -- $pair
        grep "^$1 " $work/$native | sed "s/^$1 //" >$work/a
        grep "^$2 " $work/$native | sed "s/^$2 //" >$work/b
        test -s $work/a || fails "has no row of $1"
        cmp -s $work/a $work/b || fails "$1 is not $2 with --native $native"
    done
done
cmp -s $work/never $work/always || fails 'compiled steps give other digits'
grep -q '^radau ' $work/always || fails 'has no radau'

# What follows from the tables: as text, CSV and JSON.
exits 0 check $own
has '^  jump: order 4, symmetric, symplectic; sum of .* is needed for order 6'
has '^  radau: order 3, not symmetric, not symplectic; sum of b_i '
has '^ copy +4 +yes +1\.57 '
exits 0 check $own --format csv --quiet
has '^jump,4,yes,,1\.57[0-9]*,0\.1[0-9]*,,yes,yes,"?sum of kick_i '
has '^verlet,2,yes,,2,[^,]*,,yes,yes,$'
exits 0 check $own --format json --quiet
has '"integrator": "classic", "order": 4, .*"symplectic": "no", "symmetric": "no", "shortfall": "sum of b_i '
exits 0 check $own --set w=1.35
has '^  jump: order 2, .*1/3 is needed for order 4 \(off by .*: a digit may be wrong\)'
exits 0 compare $own --integrators unweighted,midpoint --dt 0.05 --quiet
has '^ unweighted +2 '

# Other commands take the names.
exits 0 cost $own --integrators jump,classic --quiet --format csv
has 'jump'
exits 0 flow $own --integrators jump --at 0,10 --format csv
has ',jump,yes,'
exits 2 compare $own --integrators jmup
says 'did you mean jump'
printf '%s\n' '[ensemble]' 'q = range(0.5, 1, 9)' 'outcomes = energy_error' |
    cat $own - >$work/many.nevh
for scheme in copy forest-ruth; do
    exits 0 sweep $work/many.nevh --integrators $scheme --format csv --quiet
    grep -v '^#' $work/out >$work/$scheme
done
cmp -s $work/copy $work/forest-ruth || fails 'a sweep of a copy differs'
printf '%s\n' '[ensemble]' 'w = range(1, 2, 3)' 'outcomes = energy_error' |
    cat $own - >$work/vary.nevh
"$nevh" sweep $work/vary.nevh --integrators jump >$work/out 2>$work/err
says 'the weights of jump depend on a parameter that is varied'
exit $status
