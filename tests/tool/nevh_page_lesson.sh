#!/bin/sh
# Live pages open where the schemes part: within half a minute, or they say why not.

. "${srcdir:-.}/tests/support/nevh_support.sh"

test -f web/kit.html || test -f "$srcdir/web/kit.html" || {
    echo "there is no web/kit.html: make page was not run"
    exit 77
}
command -v node >/dev/null 2>&1 || {
    echo "the page's module is run with node, which is not here"
    exit 77
}
pages=
for scene in pendulum kepler henon-heiles elastic-pendulum coupled-pendulums \
    double-pendulum figure-eight coupled-oscillators penning-trap; do
    exits 0 page $scene -o $work/$scene.html
    pages="$pages $work/$scene.html"
done
# Seconds that are too short for their motion, and too long: NAME FREQUENCY DT T_END.
in_seconds() {
    printf '%s\n' '[coordinates]' 'x = 1' '[effects]' 'K = p_x^2/2' "V = ($2*x)^2/2" \
        '[labels]' 't = s' '[run]' "dt = $3" "t_end = $4" >$work/$1.nevh
    exits 0 page $work/$1.nevh -o $work/$1.html
    pages="$pages $work/$1.html"
}
in_seconds ion 6.283e6 2.5e-8 1e-4
in_seconds satellite 1e-3 100 2000000
# Friction or a drive: none of the schemes keeps what it takes.
for scene in damped-driven-pendulum kapitza; do
    exits 0 page $scene -o $work/driven.html
    cp $work/driven.html $work/out
    has '"lesson":{"why":[1-3],'
done
# Settings that are given stay.
exits 0 page pendulum --dt 0.05 -o $work/given.html
cp $work/given.html $work/out
has '"dt":0\.05'
lacks '"lesson":'
command="page, its first half minute"
# The names have no blanks.
# shellcheck disable=SC2086
$limit node "$srcdir/tests/support/try_lesson.mjs" $pages >$work/tried 2>&1 ||
    fails "is wrong"
cat $work/tried
exit $status
