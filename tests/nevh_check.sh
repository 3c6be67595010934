#!/bin/sh
# nevh check: what is said before a run.

. "${srcdir:-.}/tests/nevh_support.sh"

# A pendulum with w = 1 at most; dt = 0.1 and 2.5 against the limits.
exits 0 check pendulum --dt 0.1
has '^Fastest along the orbit: w = '
has '^ verlet +2 +yes +2 '
exits 0 check "$srcdir/tests/hard/elastic-pendulum.nevh" --dt 0.05 --t-end 5
has '^Fastest along the orbit: w = 100 '
has '^ verlet +2 +yes +2 +5 +unstable'
has '^ gauss4 +4 +yes +- +5 +not resolved'
exits 0 check "$srcdir/tests/hard/elastic-pendulum.nevh" --dt 0.005 --t-end 1
has '^ verlet +2 +yes +2 +0.5 +$|^ verlet +2 +yes +2 +0.5$'

# Chaos has a horizon, order has none.
exits 0 check "$srcdir/tests/hard/double-pendulum.nevh" --t-end 1000
lacks 'cannot be foretold'
printf '%s\n' 's/^phi = .*/phi = 0/' 's/^p2 = .*/p2 = 3.873/' >$work/edit
sed -f $work/edit "$srcdir/tests/hard/double-pendulum.nevh" >$work/chaos.nevh
exits 0 check $work/chaos.nevh --t-end 1000 --format csv
has 'cannot be foretold beyond t = [0-9]+'

# The floor of the gradient, and where H ends.
exits 0 check pendulum --dt 0.1
has '^Gradient: .* energy error of [0-9.]+e-[0-9]+'
exits 0 check "$srcdir/tests/hard/edge.nevh" --t-end 0.1
has '^H ends at x = '
exits 0 check pendulum
lacks '^H ends'
exits 0 check pendulum --format json
if command -v python3 >/dev/null 2>&1; then
    python3 -m json.tool $work/out >/dev/null || fails "is no JSON"
fi
exit $status
