# To be sourced: $python, which finds the module nevh over the library just built; else the
# test is skipped.  PYTHON names the interpreter; else the first with NumPy is taken.

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
. "$srcdir/tests/support/nevh_command.sh"
NEVH_COMMAND=$nevh
test "${nevh#/}" != "$nevh" || NEVH_COMMAND=$PWD/$nevh
top=$(CDPATH= cd "$srcdir" && pwd)
NEVH_SCENES=$top/scenes
PYTHONPATH=$top/python
PYTHONDONTWRITEBYTECODE=1
export NEVH_LIBRARY NEVH_COMMAND NEVH_SCENES PYTHONPATH PYTHONDONTWRITEBYTECODE
