#!/bin/sh
# The package nevh over the library just built, with NumPy and without.

srcdir=${srcdir:-.}
. "$srcdir/tests/python/find_python.sh"

status=0
"$python" -c 'import numpy' 2>/dev/null || echo "there is no NumPy"
for check in module traced; do
    "$python" "$srcdir/tests/python/$check.py" || status=1
    NEVH_TEST_WITHOUT_NUMPY=1 "$python" "$srcdir/tests/python/$check.py" || status=1
done
"$python" "$srcdir/tests/python/programs.py" "$srcdir" || status=1

# The commands as functions; what they make goes to a folder of their own.
"$python" "$srcdir/tests/python/commands.py" "$top" || status=1
"$python" -c 'import numpy' 2>/dev/null &&
    for check in own wrong_calls; do
        "$python" "$srcdir/tests/python/$check.py" || status=1
    done

# The same states by all ways to take steps.
folder=$PWD/same.$$
trap 'rm -rf "$folder"' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$folder" && "$python" "$srcdir/tests/python/same_states.py" "$folder" || status=1

# A library of another kind is refused, as is one that is not there.
NEVH_LIBRARY=$PWD/no-such-library "$python" -c 'import nevh' 2>&1 |
    grep -q 'set NEVH_LIBRARY' || { echo "a missing library is not named"; status=1; }
cp -R "$srcdir/python/nevh" "$folder/nevh" && chmod -R u+w "$folder/nevh"
sed 's/("tolerance", c.c_double),/("tolerance", c.c_float),/' \
    "$srcdir/python/nevh/_library.py" >"$folder/nevh/_library.py"
PYTHONPATH=$folder "$python" -c 'import nevh' 2>&1 | grep -q 'was built for another' ||
    { echo "other structures are not noticed"; status=1; }
exit $status
