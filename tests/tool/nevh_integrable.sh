#!/bin/sh
# A sample of integrable systems, which check, compare and chaos never call chaotic.

. "${srcdir:-.}/tests/support/nevh_support.sh"

sh "$srcdir/bench/integrable.sh" "$nevh" few >$work/out || {
    fails "calls integrable motion chaotic"
    cat $work/out
}
has '^integrable systems: [6-9][0-9]; 24 runs, 0 called chaotic$'
exit $status
