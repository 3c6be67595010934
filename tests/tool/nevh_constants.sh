#!/bin/sh
# nevh reference: a constant has all its digits, however it is written.

. "${srcdir:-.}/tests/support/nevh_support.sh"

command -v python3 >/dev/null 2>&1 || exit 77
exits 0 reference pendulum --at 1
if test $status != 0; then
    says 'libquadmath'
    exit 77
fi

for kind in spring minus factor parameter start velocity mass exponent drive \
    friction time; do
    command="reference ($kind)"
    python3 "$srcdir/tests/support/constants.py" "$nevh" $work $kind \
        >$work/false 2>&1 || fails 'is not to be checked'
    test -s $work/false && { fails 'has false digits'; head -5 $work/false; }
done
exit $status
