#!/bin/sh
# fit.sh NEVH ADD_NOISE [DRAWS [SYSTEMS [NOISES]]]: how often the 95 % intervals of
# nevh fit hold the truth, at the scenes' own schemes and steps.  Each draw is another
# noise over the same orbit, computed by Taylor series.  Prints a row a number; fails
# where a share is farther from 95 % than three standard deviations of that many draws,
# or 3 % if that is less.
#
# fit.sh scene SYSTEM prints a scene.

nevh=$1 add_noise=$2 draws=${3:-400}
systems=${4:-anharmonic filmed kepler driven coupled}
noises=${5:-1e-1 1e-2 1e-3 1e-4 1e-5 1e-6}
work=${TMPDIR:-/tmp}/fit.$$
trap 'rm -f $work.*' EXIT
trap 'exit 1' HUP INT TERM

sample_times() { # COUNT STEP
    awk -v n="$1" -v h="$2" 'BEGIN {
        for (i = 1; i <= n; i++) printf "%s%.10g", (i > 1 ? "," : ""), i*h }'
}

# The scene; then its true numbers, what is measured, and first guesses.
make() {
    case $1 in
    anharmonic) # order 2, for the friction
        cat <<'END'
[parameters]
k = 1.3
a = 0.5
b = 0.05
[coordinates]
x = 1
[effects]
K = p_x^2/2
V = k*x^2/2 + a*x^4/4
[friction]
drag = x: b
[run]
t_end = 15
dt = 0.1
integrators = verlet
END
        ;;
    filmed)
        sed 's/^t_end.*/t_end = 8/' "${srcdir:-.}/scenes/pendulum-filmed.nevh"
        ;;
    kepler)
        cat <<'END'
[parameters]
mu = 1
[coordinates]
x = 0.6
y = 0
p_y = 1.6
[effects]
K = (p_x^2 + p_y^2)/2
V = -mu/sqrt(x^2 + y^2)
[run]
t_end = 15
dt = 0.02
integrators = verlet
END
        ;;
    driven)
        cat <<'END'
[parameters]
k = 1
c = 0.2
F = 0.3
w = 0.6
[coordinates]
x = 0.5
[effects]
K = p_x^2/2
V = k*x^2/2 + c*x^4/4
D = -F*x*cos(w*t)
[run]
t_end = 15
dt = 0.1
integrators = verlet
END
        ;;
    coupled) # three columns, one of them a momentum
        cat <<'END'
[parameters]
k = 1
c = 0.3
[coordinates]
x = 1
y = 0
p_y = 0.4
[effects]
K = (p_x^2 + p_y^2)/2
V = k*(x^2 + y^2)/2 + c*x^2*y^2
[run]
t_end = 15
dt = 0.1
integrators = midpoint
END
        ;;
    esac
}

if test "$1" = scene; then
    make "$2"
    exit
fi

settings() {
    set= guess=
    case $1 in
    anharmonic) truth="k=1.3 a=0.5 b=0.05" columns=x at=$(sample_times 60 0.25)
        guess="--set k=1.27,a=0.52,b=0.06" ;;
    filmed) truth="l=0.874 g=9.812" columns="x y" at=$(sample_times 60 0.125)
        set="--set l=0.874,g=9.812,gamma=0.035,start=1.13"
        guess="--set l=0.9,g=9.5,gamma=0.035,start=1.13" ;;
    kepler) truth="mu=1 p_y=1.6" columns="x y" at=$(sample_times 40 0.375)
        guess="--set mu=1.01 --start p_y=1.59" ;;
    driven) truth="k=1 F=0.3 w=0.6" columns=x at=$(sample_times 60 0.25)
        guess="--set k=0.98,F=0.28,w=0.61" ;;
    coupled) truth="k=1 c=0.3 x=1" columns="x y p_x" at=$(sample_times 40 0.375)
        guess="--set k=0.99,c=0.32 --start x=0.97" ;;
    esac
    names=$(echo "$truth" | sed 's/=[^ ]*//g; s/ /,/g')
}

judge() { # SYSTEM NOISE
    awk -F, -v draws="$draws" -v scene="$1" -v noise="$2" -v truth="$truth" '
    BEGIN { count = split(truth, pair, " ")
        for (k = 1; k <= count; k++) {
            split(pair[k], part, "="); name[k] = part[1]; at[part[1]] = part[2] } }
    { x = $4; n[x]++; d = $6 - at[x]; z = d/$7
      inside[x] += ($8 == "" || $8 <= at[x]) && ($9 == "" || at[x] <= $9)
      one[x] += z > -1 && z < 1; sum[x] += z; squares[x] += z*z }
    END {
        most = 3*sqrt(0.95*0.05/draws)
        if (draws >= 400 && most < 0.03) most = 0.03
        for (k = 1; k <= count; k++) {
            x = name[k]; share = n[x] ? inside[x]/n[x] : 0
            bad = n[x] != draws || share < 0.95 - most || share > 0.95 + most + 1e-9
            printf " %-10s %6s %-6s %6d %17.1f %% %15.1f %% %7.3f %6.3f%s\n", scene,
                noise, x, n[x], 100*share, 100*one[x]/n[x], sum[x]/n[x],
                sqrt(squares[x]/n[x]), bad ? "  WRONG" : ""
            wrong = wrong || bad
        }
        exit wrong }' $work.rows
}

status=0 seed=0
echo " system      noise number  draws  in the 95 % interval  within one error  mean z  rms z"
for system in $systems; do
    settings $system
    make $system >$work.nevh
    "$nevh" run $work.nevh $set --integrators taylor --tolerance 1e-15 --at "$at" \
        --quiet -o $work.orbit || exit 1
    for noise in $noises; do
        : >$work.rows
        i=0
        while test $i -lt "$draws"; do
            i=$((i + 1)) seed=$((seed + 1))
            "$add_noise" $noise $seed $columns <$work.orbit >$work.data
            "$nevh" fit $work.nevh --data $work.data --vary $names --format csv \
                --quiet $guess >$work.out || exit 1
            tail -n +2 $work.out >>$work.rows
        done
        judge $system $noise || status=1
    done
done
exit $status
