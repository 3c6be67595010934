#!/bin/sh
# The module nevh.py over the library just built, with NumPy and without.  PYTHON
# names the interpreter; else the first that has NumPy is taken.

srcdir=${srcdir:-.}
test -z "$SANITIZE_FLAGS" || { echo "sanitizers are on"; exit 77; }
library=
for name in .libs/libnevh.so .libs/libnevh.dylib; do
    test -f $name && library=$PWD/$name
done
test -n "$library" || { echo "there is no shared library here"; exit 77; }

python=
for name in ${PYTHON:-python3 /usr/bin/python3}; do
    "$name" -c 'import ctypes' >/dev/null 2>&1 || continue
    : "${python:=$name}"
    if "$name" -c 'import numpy' >/dev/null 2>&1; then
        python=$name
        break
    fi
done
test -n "$python" || { echo "there is no Python 3"; exit 77; }

NEVH_LIBRARY=$library
NEVH_COMMAND=${NEVH:-$PWD/tools/nevh}
NEVH_SCENES=$srcdir/scenes
PYTHONPATH=$srcdir/python
PYTHONDONTWRITEBYTECODE=1
export NEVH_LIBRARY NEVH_COMMAND NEVH_SCENES PYTHONPATH PYTHONDONTWRITEBYTECODE
check=$srcdir/tests/python/module.py

status=0
"$python" -c 'import numpy' 2>/dev/null || echo "there is no NumPy"
"$python" "$check" || status=1
NEVH_TEST_WITHOUT_NUMPY=1 "$python" "$check" || status=1

# A library of another kind is refused, as is one that is not there.
NEVH_LIBRARY=$PWD/no-such-library "$python" -c 'import nevh' 2>&1 |
    grep -q 'set NEVH_LIBRARY' || { echo "a missing library is not named"; status=1; }
sed 's/("tolerance", c.c_double),/("tolerance", c.c_float),/' \
    "$srcdir/python/nevh.py" >other.$$.py
"$python" other.$$.py 2>&1 | grep -q 'was built for another' ||
    { echo "other structures are not noticed"; status=1; }
rm -f other.$$.py
exit $status
