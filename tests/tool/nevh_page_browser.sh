#!/bin/sh
# The live page in browsers: offline, without errors, with nevh run's digits.

. "${srcdir:-.}/tests/support/nevh_support.sh"

test -f web/kit.html || test -f "$srcdir/web/kit.html" || {
    echo "there is no web/kit.html: make page was not run"
    exit 77
}
command=page

exits 0 page pendulum -o $work/pendulum.html
exits 0 page kepler -o $work/kepler.html
exits 0 page pendulum kepler -o $work/both.html
exits 0 page fput -o $work/fput.html
exits 0 page kepler-0.9 -o $work/kepler-0.9.html
exits 0 page henon-heiles -o $work/henon-heiles.html
sed '/^\[picture\]/,/^$/d' "$srcdir/scenes/kapitza.nevh" >$work/kapitza.nevh
exits 0 page $work/kapitza.nevh -o $work/kapitza.html
printf '%s\n' '[coordinates]' 'x = 1e-6' '[effects]' 'K = p_x^2/(2*1e-6)' 'V = 1e-3*x^2/2' \
    '[friction]' 'drag = x: 2' '[labels]' 't = s' '[run]' 'dt = 0.01' 't_end = 6' \
    >$work/damped.nevh
exits 0 page $work/damped.nevh -o $work/damped.html
# Exact gradients: the page has other difference steps, as it does not look at gradients.
cp "$srcdir/scenes/double-pendulum.nevh" $work
printf '\n[run]\ngradient = exact\n' >>$work/double-pendulum.nevh
exits 0 page $work/double-pendulum.nevh -o $work/double-pendulum.html

# The states that the page is to have: SCENE SCHEME DT T_END [GRADIENT].
wanted() {
    exits 0 run $1 --integrators $2 --dt $3 --t-end $4 --samples 2 \
        ${5:+--gradient $5}
    tail -n 1 $work/out >$work/$1-$2.csv
}
wanted pendulum verlet 0.0625 6.25
wanted pendulum rk4 0.0625 6.25
wanted kepler verlet 0.03125 3.125
wanted double-pendulum gauss4 0.015625 1.5625 exact

command="page in a browser"
in_browsers try_page.mjs "$PWD/$work"
exit $status
