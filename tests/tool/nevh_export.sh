#!/bin/sh
# Programs that nevh export writes: they compile without a warning, need nothing
# else, and print the digits of nevh run.

. "${srcdir:-.}/tests/support/nevh_support.sh"

# same SCENE N INTEGRATOR GRADIENT DT T_END EVERY: the columns of N coordinates
# and momenta, of a program compiled with $flags, or -O2.
same() {
    scene=$1 last=$((1 + 2 * $2)) rows=$7
    set -- "$scene" --integrators $3 --gradient $4 --dt $5 --t-end $6 --every $7
    exits 0 export "$@" -o $work/prog.c
    test $status = 0 || return
    ${CC:-cc} -std=c11 ${flags:--O2} -Wall -Wextra -Werror -ffp-contract=off \
        -o $work/prog $work/prog.c -lm 2>$work/err ||
        { fails 'does not compile'; cat $work/err; return; }
    $work/prog | cut -d, -f 2-$last >$work/prog.csv
    exits 0 run "$@" --quiet --native never
    cut -d, -f 2-$last $work/out | all_digits >$work/run.csv
    cmp -s $work/run.csv $work/prog.csv || {
        fails 'prints other digits than nevh run'
        diff $work/run.csv $work/prog.csv | head -n 6
    }
    test "$(wc -l <$work/prog.csv)" -gt 5 || fails 'prints no rows'
}

exits 0 export pendulum
has '^#include <math\.h>'
lacks 'nevh/'
# Names are shorter than in the library, and lines go on below their parentheses.
exits 0 export pendulum --integrators blanes-moan4
awk '/\*\// { exit } length > 80' $work/out | grep . && fails 'begins with long lines'
awk '/^static .*\([^()]*,$/ { column = index($0, "("); next }
     column && match($0, /[^ ]/) != column + 1 { print; wrong = 1 }
     { column = 0 }
     END { exit !wrong }' $work/out && fails 'has lines that are not aligned'
if ${CC:-cc} --version >/dev/null 2>&1; then
    same pendulum 1 verlet central4 0.1 30 7
    same pendulum 1 forest-ruth complex-step 0.05 10 10
    same kepler 2 rkn11b exact 0.05 20 40
    same double-pendulum 2 rk4 central4 0.01 2 20
    same damped-driven-pendulum 1 rk4 central4 0.05 5 20
    # Loops, as long for a thousand masses as for thirty-two.
    same fput 32 verlet exact 0.3 90 30
    same fput-1000 1000 rk4 exact 0.1 20 20
    same fput-1000 1000 verlet central4 0.1 20 20
    exits 0 export fput-1000 --header --integrators verlet --gradient exact
    has 'springs: 999 times, the first of x_2, x_1'
    test "$(wc -l <$work/out)" -lt 500 || fails 'is long'
    same henon-heiles 2 symplectic-euler-b central2 0.05 10 10
    # The end is no whole number of steps away.
    same pendulum 1 verlet central4 0.03 10 50
    same double-pendulum 2 gauss4 central4 0.07 10 20
    same kepler 2 adaptive-verlet central4 0.05 20 20
    same pendulum 1 naive-adaptive-verlet exact 0.05 20 40
    same double-pendulum 2 gauss6 central4 0.01 2 20
    # gcc 12 makes one vector of a*b - c and d*e + f, contracted, where there is FMA.
    flags='-O2 -march=native'
    ${CC:-cc} $flags -E - </dev/null >/dev/null 2>&1 &&
        same double-pendulum 2 midpoint exact 0.02 4 10
    flags=
    # Of a scene whose names are meant to get out of a comment or a string.
    cat >$work/hostile.nevh <<'END'
[coordinates]
main = 1
for = 0
x1 = 0
y[i = 1..2] = i
y_2 = 1/3
[effects]
system = (p_main^2 + p_for^2 + p_x1^2 + p_y[1]^2 + p_y[2]^2 + p_y_2^2)/2
exit = main^2/2 + for^4 + cos(main - for*x1) + sum(i = 1..2, y[i]^2)*y_2^2
[run]
dt = 0.1
t_end = 1
END
    same $work/hostile.nevh 6 verlet central4 0.1 1 1
    same $work/hostile.nevh 6 gauss4 central2 0.1 1 1
    # Of a scene whose coordinates have the names that the program has.
    for scheme in gauss4 rk4; do
        exits 0 export pendulum --integrators $scheme -o $work/prog.c
        sed 's/"[^"]*"//g; s/^ *\/\*.*//' $work/prog.c |
            grep -o '[A-Za-z_][A-Za-z0-9_]*' | sort -u | grep -v '^_\|^[pv]_' >$work/own
        printf '%s\n' t pi phi energy if sum abs min max sign mod sin cos sqrt fabs \
            floor fmod exp log rint cbrt >$work/refused
        grep -vxFf $work/refused $work/own >$work/names
        awk '{ name[NR] = $1 }
            END { print "[coordinates]"
                  for (i = 1; i <= NR; i++) print name[i] " = 1"
                  printf "[effects]\nwhole = tan(%s/9)^2.5", name[1]
                  for (i = 1; i <= NR; i++)
                      printf " + p_%s^2/2 + %s^4", name[i], name[i]
                  print "\n[run]\nt_end = 1\ndt = 0.1" }' $work/names >$work/own.nevh
        exits 0 export $work/own.nevh --integrators $scheme -o $work/prog.c
        ${CC:-cc} -std=c11 -Wall -Wextra -Werror -fsyntax-only $work/prog.c 2>$work/err ||
            { fails 'does not compile'; head -n 5 $work/err; }
    done
    # Functions for another program.
    exits 0 export kepler --header --integrators adaptive-verlet -o $work/steps.h
    cat >$work/own.c <<'END'
#include "steps.h"
int main(void) {
    double t = 0, q[] = {1, 0}, p[] = {0, 1}, memory[MEMORY] = {0};
    size_t done = advance(&t, 1.2, 0.05, 10, q, p, memory);
    if (done != 10 || !(t > 0.4 && t < 0.6))
        return 1;
    done = advance(&t, 1.2, 0.05, 100, q, p, memory);
    return done == 100 || t != 1.2 || fabs(q[0] - cos(1.2)) > 1e-3;
}
END
    ${CC:-cc} -Wall -Wextra -Werror -o $work/own $work/own.c -lm && $work/own ||
        fails 'writes functions that do not work'
    exits 0 export pendulum --header --integrators verlet -o $work/steps.h
    cat >$work/own.c <<'END'
#include <stdio.h>
#include "steps.h"
int main(void) {
    double q = 2, p = 0, memory[MEMORY] = {0};
    return advance(0, 0.1, 0, 10, &q, &p, memory) != 10 || !(q < 2);
}
END
    ${CC:-cc} -Wall -Wextra -Werror -o $work/own $work/own.c -lm && $work/own ||
        fails 'writes functions that do not work'
    exits 0 export pendulum --header --integrators gauss4 -o $work/steps.h
    ${CC:-cc} -Wall -Wextra -Werror -o $work/own $work/own.c -lm && $work/own ||
        fails 'writes functions that do not work'
fi
exits 2 export pendulum --integrators gonzalez
says 'no program of such steps: only splitting, Tao, Runge-Kutta, Nystroem, Gauss, Lobatto, adaptive Verlet steps and steps by parts can be'
exits 2 export charged-chain --integrators respa
says 'no program of such steps: flows of parts are functions of the library'
exits 2 export damped-driven-pendulum --integrators midpoint
says 'no program of such steps: friction is put around its steps'
exits 2 export no-such-scene

exit $status
