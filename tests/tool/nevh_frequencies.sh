#!/bin/sh
# nevh frequencies: rows, agreement between schemes, and what it refuses.

. "${srcdir:-.}/tests/support/nevh_support.sh"

rows() { grep -v '^#' $work/out | tail -n +2; }

# The pendulum of 2 rad: pi sqrt(9.8)/(2 K(sin 1)), and three times that.
exits 0 frequencies pendulum --integrators gauss16 --gradient exact \
    --dt 0.1 --t-end 1000 --format csv
test "$(grep -v '^#' $work/out | head -n 1)" = \
    scene,integrator,observable,rank,frequency,error,amplitude,phase,drift,period,resolution ||
    fails "has other columns"
rows | awk -F, 'function abs(x) { return x < 0 ? -x : x }
    $4 == 1 && abs($5/2.3556962007225665 - 1) < 1e-12 { first++ }
    $4 == 2 && abs($5/2.3556962007225665/3 - 1) < 1e-12 { second++ }
    END { exit first != 1 || second != 1 }' || fails "has other frequencies"

# A torus of Henon and Heiles: two schemes agree.
exits 0 frequencies henon-heiles --integrators gauss16,sofroniou-spaletta10 \
    --gradient exact --dt 0.05 --t-end 2000 --observable x --format csv
rows | awk -F, '$4 == 1 { if (n++) { d = $5 - last; d = d < 0 ? -d : d
        exit d > 1e-10 }; last = $5 } END { if (n != 2) exit 1 }' ||
    fails "two schemes do not agree"

# The error is that of the frequency: the scheme's own is in it, and far above what the
# length of the run resolves.
exits 0 frequencies pendulum --integrators verlet,rkn6b,midpoint --dt 0.05 --t-end 500 --format csv
rows | awk -F, 'function abs(x) { return x < 0 ? -x : x }
    $4 == 1 { d = abs($5 - 2.3556962007225665); n++
        if (d > 2*$6 || $6 > 2*d + 1e-9 || $2 != "rkn6b" && $6 < 100*$11) wrong = 1 }
    END { exit wrong || n != 3 }' || fails "errors are others"

# H with a kink: errors are no powers of the step, and steps of which an integer number
# is a period give the same frequency as their halves, which is a wrong one.
cat >$work/kink.nevh <<'END'
[coordinates]
x = 0.7
[effects]
kinetic = p_x^2/2
well = abs(x)
[run]
t_end = 400
dt = 0.1
END
for dt in 0.1 0.13; do
    exits 0 frequencies $work/kink.nevh --dt $dt --integrators midpoint,gauss4,verlet \
        --format csv
    rows | awk -F, 'function abs(x) { return x < 0 ? -x : x }
        $4 == 1 { d = abs($5 - 6.283185307179586/(4*sqrt(1.4))); n++
            if (!(d <= 1.1*$6)) wrong = 1 }
        END { exit wrong || n != 3 }' || fails "errors do not hold the frequency"
done
# One that goes round: what is quasi-periodic is its cosine.
exits 0 frequencies pendulum-rotating --integrators gauss8 --t-end 200
has '^ gauss8  .*cos\(phi\)  *1 '
# Energy that is lost moves the frequency; a mistake is told.
exits 0 frequencies pendulum --integrators rk4 --dt 0.1 --t-end 500
has 'rk4, phi: the first frequency moves by '
exits 0 frequencies double-pendulum --integrators gauss8 --t-end 400
has 'phi2: a half of the run does not show the first frequency'
lacks ' -?nan'
exits 0 frequencies pendulum --integrators verlet --start phi=0 --t-end 50
has 'verlet, phi: it does not move'
exits 0 frequencies kepler-0.9 --integrators adaptive-verlet,gauss8 --t-end 20
has 'adaptive-verlet refused: it chooses times of its own'

exits 2 frequencies pendulum --t-end 1
says 'samples are too few'
exits 2 frequencies pendulum --observable 'psi'
says 'psi'
exits 2 frequencies pendulum --plot a.svg
says 'no option of nevh frequencies'
cat >$work/edge.nevh <<'END'
[coordinates]
x = 1
[effects]
kinetic = p_x^2/2
push = -x - sqrt(9 - x)
[run]
t_end = 10
dt = 0.05
END
exits 1 frequencies $work/edge.nevh --integrators verlet
has '^verlet failed: '
exits 1 frequencies pendulum --observable 'sqrt(phi)' --t-end 50
has 'failed: it is not finite'
lacks ' -?nan'

# What grows is no sum of oscillations.
printf '[coordinates]\nx = 0, 1\n[effects]\nK = p_x^2/2\n[run]\nt_end = 20
dt = 0.1\nintegrators = verlet\n' >$work/free.nevh
exits 0 frequencies $work/free.nevh
has '^verlet, x: no frequencies: it changes along a straight line, by 1 a unit of'
test "$(grep -c '^ verlet' $work/out)" = 0 || fails "has lines of a straight motion"
lacks 'chaotic'
# Nor is what falls, or goes on while it oscillates, on no straight line.
printf '[coordinates]\nx = 0\n[effects]\nK = p_x^2/2\nV = 9.81*x\n[run]\nt_end = 10
dt = 0.1\nintegrators = verlet\n' >$work/fall.nevh
exits 0 frequencies $work/fall.nevh
has '^verlet, x: no frequencies: it goes one way all the time, from 0 to -49[01]'
lacks 'straight'
printf '[coordinates]\nx = 0, 1\n[effects]\nK = p_x^2/2 - p_x/5\nV = x*0 - 0.2*x*sin(t)
[run]\nt_end = 100\ndt = 0.1\nintegrators = verlet\n' >$work/sway.nevh
exits 0 frequencies $work/sway.nevh
has '^verlet, x: no frequencies: it goes one way all the time'
exits 0 frequencies $work/sway.nevh --start p_x=0.1
has '^verlet, x: no frequencies: it changes by 0\.[01][0-9]* a unit of time in'
lacks 'straight'
# Nor is what goes one way all the time.
printf '[coordinates]\nx = 0.1, 0.1\n[effects]\nK = p_x^2/2\nV = -x^2/2\n[run]\nt_end = 8
dt = 0.1\nintegrators = verlet\n' >$work/escape.nevh
exits 0 frequencies $work/escape.nevh
has '^verlet, x: no frequencies: it goes one way all the time'
# Nor what rounding does to a coordinate that rests.
printf '[coordinates]\nx = 1\ny = 0\n[effects]\nK = ((p_x+p_y)^2 + (p_x-p_y)^2)/4
V = ((x+0.1*y)^2+(0.1*x-y)^2)/2 + x*0.3*0\n[run]\nt_end = 200
dt = 0.1\nintegrators = gauss4\n' >$work/rest.nevh
exits 0 frequencies $work/rest.nevh --format csv
rows | awk -F, '$3 == "y" || $7 < 1e-9 { exit 1 }' || fails "has lines of rounding"
exits 0 frequencies henon-heiles --integrators verlet
lacks 'straight line'
exit $status
