#!/bin/sh
# Integrable motion that nothing may call chaotic, by check, compare and chaos at three
# steps each.
#
#     bench/integrable.sh NEVH [few]
#
# `few` takes every eighth system, at one step.  All of them take some ten minutes.  The
# exit status is 1 where one is called chaotic.
# SPDX-License-Identifier: GPL-3.0-or-later

nevh=$1
every=1 steps='1 0.5 0.25'
test "$2" != few || { every=8 steps=1; }
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
count=0 runs=0 wrong=0

# is_chaotic COMMAND...: whether its words or its verdict are those of chaos.
is_chaotic() {
    "$nevh" "$@" >"$work/out" 2>&1
    grep -qE '^(# )?Chaotic:|until chaos|chaos, where|,chaotic|are chaotic' "$work/out"
}

says() {
    runs=$((runs + 1))
    if is_chaotic "$@"; then
        wrong=$((wrong + 1))
        echo "called chaotic: $name: nevh $*"
    fi
}

# try NAME COORDINATES EFFECTS T_END DT SCHEME
try() {
    count=$((count + 1))
    test $((count % every)) -eq 0 || return 0
    name=$1
    printf '[coordinates]\n%b\n[effects]\n%b\n[run]\nt_end = %s\ndt = %s\nintegrators = %s\n' \
        "$2" "$3" "$4" "$5" "$6" >"$work/one.nevh"
    for part in $steps; do
        dt=$(echo "$5 $part" | awk '{ printf "%.9g", $1*$2 }')
        says check "$work/one.nevh" --dt "$dt" --integrators "$6"
        says compare "$work/one.nevh" --dt "$dt" --format csv
        says chaos "$work/one.nevh" --dt "$dt" --t-end "$4" --starts 4 --format csv
    done
}

# What is chaotic is found by each command.
for command in check compare chaos; do
    is_chaotic $command double-pendulum-chaotic --t-end 80 --integrators midpoint \
        --format csv || { echo "$command does not see chaos"; wrong=1; }
done

plane='K = (p_x^2 + p_y^2)/2\nV = '
space='K = (p_x^2 + p_y^2 + p_z^2)/2\nV = '
line='K = p_x^2/2\nV = '

# Kepler's problem, from the pericentre.
kepler() {
    try "Kepler $1" "x = 1 - $1\ny = 0\np_y = sqrt((1 + $1)/(1 - $1))" \
        "$plane-1/sqrt(x^2 + y^2)" "$2" "$3" "$4"
}
kepler 0 200 0.3 verlet
kepler 0.5 200 0.05 verlet
kepler 0.9 100 0.009 gauss8
kepler 0.95 60 0.005 blanes-moan4
kepler 0.97 60 0.0026 blanes-moan4
kepler 0.99 40 0.0005 blanes-moan4
kepler 0.999 40 0.0001 blanes-moan4
try 'Kepler, radial nearly' 'x = 1\ny = 0\np_y = 0.05' "$plane-1/sqrt(x^2 + y^2)" 20 0.001 blanes-moan4
try 'hyperbola' 'x = 10\ny = 1\np_x = -1' "$plane-1/sqrt(x^2 + y^2)" 60 0.02 verlet
try 'Kepler in space' 'x = 1\ny = 0.1\nz = 0\np_y = 0.8\np_z = 0.3' \
    "$space-1/sqrt(x^2 + y^2 + z^2)" 100 0.02 verlet

# Central forces in the plane.
central() {
    try "central $1" "x = 1\ny = 0.2\np_x = 0.1\np_y = $2" "$plane$1" 200 "$3" blanes-moan4
}
central '(x^2 + y^2)^2/4' 0.7 0.1
central '(x^2 + y^2)^1.5/3' 0.4 0.1
central 'log(1 + x^2 + y^2)' 0.5 0.1
central '-1/sqrt(1 + x^2 + y^2)' 0.3 0.1
central '-exp(-(x^2 + y^2))' 0.6 0.1
central '-exp(-sqrt(x^2 + y^2))/sqrt(x^2 + y^2)' 0.45 0.05
central '((x^2 + y^2) - 1)^2' 0.3 0.05
central '1/(x^2 + y^2)^3 - 2/(x^2 + y^2)^1.5 + 0.1*(x^2 + y^2)' 0.5 0.02

# Separable in Cartesian, elliptic or other coordinates.
try 'anharmonic pair' 'x = 1\ny = 0.7' "${plane}x^4/4 + y^4" 300 0.1 blanes-moan4
try 'double well, spring' 'x = 1e-6\ny = 1' "${plane}x^4/4 - x^2/2 + 0.85*y^2" 200 0.1 verlet
try 'double well, spring, near' 'x = 1e-12\ny = 1' "${plane}x^4/4 - x^2/2 + 0.85*y^2" 100 0.1 verlet
try 'pendulum, spring' 'x = 3.14159\ny = 1' "${plane}-cos(x) + 0.35*y^2" 200 0.1 verlet
try 'two pendulums apart' 'x = 3.1\ny = 3.1415' "${plane}-cos(x) - 2*cos(y)" 200 0.1 verlet
try 'Morse, quartic' 'x = 0.4\ny = 0.8' "$plane(1 - exp(-x))^2 + y^4" 200 0.1 verlet
try 'two fixed centres' 'x = 1\ny = 0.3\np_y = 0.4' \
    "$plane-1/sqrt((x - 1.5)^2 + y^2) - 0.7/sqrt((x + 1.5)^2 + y^2)" 80 0.01 blanes-moan4
try 'two fixed centres, wide' 'x = 0\ny = 4\np_x = 0.5' \
    "$plane-1/sqrt((x - 1)^2 + y^2) - 1/sqrt((x + 1)^2 + y^2)" 200 0.05 blanes-moan4
try 'two fixed centres, spring' 'x = 0.3\ny = 0.8\np_x = 0.7' \
    "$plane-1/sqrt((x - 1)^2 + y^2) - 1/sqrt((x + 1)^2 + y^2) + 0.2*(x^2 + y^2)" 80 0.02 blanes-moan4
try 'Garnier' 'x = 0.6\ny = 0.8\np_x = 0.3' "$plane(x^2 + y^2)^2 + x^2 + 2*y^2" 200 0.05 verlet
try 'Garnier, saddle' 'x = 0.3\ny = 0.001\np_x = 0.2' "$plane(x^2 + y^2)^2 - x^2/2 - y^2" 200 0.05 verlet
try 'quartic 1:6:1' 'x = 0.7\ny = 0.4\np_x = 0.2' "${plane}x^4 + 6*x^2*y^2 + y^4" 200 0.05 verlet
try 'quartic 1:6:8' 'x = 0.7\ny = 0.4\np_x = 0.2' "${plane}x^4 + 6*x^2*y^2 + 8*y^4" 200 0.05 verlet
try 'quartic 1:12:16' 'x = 0.7\ny = 0.4\np_y = 0.2' "${plane}x^4 + 12*x^2*y^2 + 16*y^4" 200 0.05 verlet
try 'isotropic sextic' 'x = 0.7\ny = 0.4\np_y = 0.2' "$plane(x^2 + y^2)^3" 200 0.05 verlet
try 'Smorodinsky-Winternitz' 'x = 1\ny = 0.8\np_x = 0.3' "$plane(x^2 + y^2)/2 + 0.3/x^2 + 0.1/y^2" 200 0.05 verlet
try 'isotonic' 'x = 1\ny = 0.8' "$plane(x^2 + 4*y^2)/2 + 0.5/x^2" 200 0.05 verlet

# Henon and Heiles's, where it is integrable.
try 'Henon-Heiles 1' 'x = 0.1\ny = 0.2\np_x = 0.2' "$plane(x^2 + y^2)/2 + x^2*y + y^3/3" 500 0.2 verlet
try 'Henon-Heiles 6' 'x = 0.1\ny = 0.2\np_x = 0.2' "$plane(x^2 + 3*y^2)/2 + x^2*y + 2*y^3" 500 0.2 verlet
try 'Henon-Heiles 16' 'x = 0.05\ny = 0.05\np_x = 0.1' "$plane(x^2 + 16*y^2)/2 + x^2*y + 16*y^3/3" 500 0.1 verlet
try 'Holt' 'x = 1\ny = 0.4\np_x = 0.2' "${plane}0.75*x^(4/3) + (y^2 + 1)*x^(-2/3)" 100 0.02 verlet
try 'Fokas-Lagerstrom' 'x = 1\ny = 0.4' "$plane(x^2 + y^2)/2 + 0.2*(x^2 - y^2)^(-2/3)" 100 0.02 verlet

# Chains and particles on a line.
try 'Toda, three' 'x = 0.5\ny = -0.2\nz = 0\np_x = 1\np_y = -0.3\np_z = -0.7' \
    "${space}exp(x - y) + exp(y - z) + exp(z - x)" 300 0.1 verlet
try 'Toda, three, hot' 'x = 2\ny = -1\nz = 0\np_x = 3\np_y = -1\np_z = -2' \
    "${space}exp(x - y) + exp(y - z) + exp(z - x)" 200 0.05 verlet
try 'Toda, relative' 'x = 0.2\ny = 0.5\np_x = 0.7' \
    "$plane(exp(2*x + 2*sqrt(3)*y) + exp(2*x - 2*sqrt(3)*y) + exp(-4*x))/24 - 1/8" 300 0.1 verlet
try 'Toda, open' 'x = 0.5\ny = -0.2\nz = 0\np_x = 1\np_z = -0.7' "${space}exp(x - y) + exp(y - z)" 100 0.1 verlet
try 'Calogero' 'x = -1\ny = 0.1\nz = 1.2\np_x = 0.3' \
    "$space(x^2 + y^2 + z^2)/2 + 1/(x - y)^2 + 1/(y - z)^2 + 1/(x - z)^2" 200 0.02 verlet
try 'Sutherland' 'x = -1\ny = 0.1\nz = 1.2\np_x = 0.3' \
    "${space}0.3/sin((x - y)/2)^2 + 0.3/sin((y - z)/2)^2 + 0.3/sin((x - z)/2)^2" 200 0.02 verlet
try 'springs, three' 'x = 0.5\ny = -0.2\nz = 0.1' "${space}x^2 + y^2 + z^2 + (x - y)^2 + (y - z)^2/3" 300 0.2 verlet

# Quadratic forms, fields, and rotating frames.
try 'saddle, spring' 'x = 1e-6\ny = 1' "$plane-x^2/2 + 2*y^2" 30 0.1 verlet
try 'saddle, two springs' 'x = 1e-3\ny = 1\nz = 0.5' "$space-x^2/8 + 2*y^2 + z^2/3" 60 0.1 verlet
try 'uniform field' 'x = 1\ny = 0\np_y = 0.4' 'K = ((p_x + y/2)^2 + (p_y - x/2)^2)/2' 300 0.2 gauss4
try 'fields across' 'x = 1\ny = 0\np_y = 0.4' 'K = ((p_x + y)^2 + (p_y - x)^2)/2\nE = 0.1*x' 300 0.1 gauss4
try 'Penning trap' 'x = 1\ny = 0\nz = 0.3\np_y = 0.1' \
    'K = ((p_x + y)^2 + (p_y - x)^2 + p_z^2)/2\nV = 0.2*(2*z^2 - x^2 - y^2)' 200 0.1 gauss4
try 'L4 of mu = 0.2, escape' 'x = 1e-6\ny = 0\np_x = 0\np_y = 1e-6' \
    'K = (p_x^2 + p_y^2)/2 + y*p_x - x*p_y\nV = x^2/8 - 5*y^2/8 - 0.7794228634*x*y' 60 0.05 gauss4
try 'Euler top' 'a = 0.3\nb = 1\nc = 0.2\np_a = 0.4\np_b = 0.5\np_c = 0.7' \
    'K = ((p_a - p_c*cos(b))*sin(c)/sin(b) + p_b*cos(c))^2/2 + ((p_a - p_c*cos(b))*cos(c)/sin(b) - p_b*sin(c))^2/4 + p_c^2/6' \
    100 0.05 gauss4
try 'Lagrange top' 'b = 0.8\na = 0\nc = 0\np_a = 1.2\np_c = 2' \
    'K = p_b^2/2 + (p_a - p_c*cos(b))^2/(2*sin(b)^2) + p_c^2/4\nV = cos(b)' 100 0.05 gauss4
try 'Kovalevskaya top' 'a = 0\nb = 1.1\nc = 0.3\np_a = 0.7\np_b = 0.2\np_c = 0.4' \
    'K = p_b^2/4 + (p_a - p_c*cos(b))^2/(4*sin(b)^2) + p_c^2/2\nV = 0.5*sin(b)*cos(c)' 100 0.05 gauss4
try 'spherical pendulum' 'b = 1\na = 0\np_a = 0.4' 'K = p_b^2/2 + p_a^2/(2*sin(b)^2)\nV = cos(b)' 200 0.05 gauss4
try 'Neumann' 'b = 1\na = 0.3\np_a = 0.4\np_b = 0.3' \
    'K = p_b^2/2 + p_a^2/(2*sin(b)^2)\nV = (sin(b)^2*cos(a)^2 + 2*sin(b)^2*sin(a)^2 + 3.5*cos(b)^2)/2' 200 0.05 gauss4
try 'swinging Atwood, mu = 3' 'r = 1\na = 1.2\np_r = 0\np_a = 0' \
    'K = p_r^2/8 + p_a^2/(2*r^2)\nV = 3*r - r*cos(a)' 30 0.005 gauss4
try 'surface of revolution' 'x = 0.5\na = 0\np_a = 0.6\np_x = 0.2' \
    'K = (p_x^2 + p_a^2/(1 + x^2))/2\nV = x^4/4' 200 0.05 gauss4
try 'relativistic oscillator' 'x = 1\ny = 0.4\np_y = 0.3' 'K = sqrt(1 + p_x^2 + p_y^2)\nV = (x^2 + y^2)/2' 200 0.1 verlet

# One degree of freedom, and drives of linear motion.
try 'Duffing' 'x = 1e-6' "${line}x^4/4 - x^2/2" 200 0.1 verlet
try 'pendulum, upright' 'x = 3.1415926' "$line-cos(x)" 200 0.1 verlet
try 'driven spring' 'x = 1' "${line}x^2/2 - 0.3*x*cos(1.7*t)" 300 0.1 verlet
try 'driven at resonance' 'x = 1' "${line}x^2/2 - 0.3*x*cos(t)" 100 0.1 verlet
try 'Mathieu, stable' 'x = 1' "$line(1 + 0.2*cos(3*t))*x^2/2" 300 0.1 verlet
try 'Mathieu, unstable' 'x = 0.1' "$line(1 + 0.3*cos(2*t))*x^2/2" 300 0.1 verlet
try 'driven pair' 'x = 1\ny = 0.2' "${plane}x^2/2 + y^2 + 0.2*x*y - 0.3*x*cos(1.7*t)" 200 0.1 verlet

echo "integrable systems: $count; $runs runs, $wrong called chaotic"
test "$wrong" -eq 0
