#!/bin/sh
# make wheel: installed elsewhere, the module finds its own library, command and scenes.
# The version is that of configure.

srcdir=${srcdir:-.}
. "$srcdir/tests/python/find_python.sh"
version=$(sed -n 's/^#define PACKAGE_VERSION "\(.*\)"/\1/p' config.h)
for file in nevh/_library.py pyproject.toml; do
    grep -q "^_*version_* = \"$version\"" "$srcdir/python/$file" ||
        { echo "python/$file is of another version than $version"; exit 1; }
done
"$python" -c 'import setuptools.build_meta, wheel.bdist_wheel' 2>/dev/null ||
    python=/usr/bin/python3
"$python" -c 'import setuptools.build_meta, wheel.bdist_wheel' 2>/dev/null ||
    { echo "there is no setuptools, or no wheel"; exit 77; }
command -v ldd >/dev/null 2>&1 || { echo "there is no ldd"; exit 77; }

work=$PWD/wheel.$$
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$work" || exit 1
unset MAKEFLAGS MFLAGS MAKELEVEL
PYTHON=$python "${MAKE:-make}" wheel >"$work/log" 2>&1 ||
    { cat "$work/log"; exit 1; }
wheel=$(tail -n 1 "$work/log")
case $wheel in
nevh-"$version"-py3-none-manylinux_2_*.whl) ;;
*) echo "the wheel is called $wheel"; exit 1 ;;
esac
# A wheel is an archive; pip would put its files in the same places.
"$python" - "python/$wheel" "$work" <<'END' || exit 1
import os
import sys
import zipfile
with zipfile.ZipFile(sys.argv[1]) as archive:
    for info in archive.infolist():
        name = info.filename.split(".data/purelib/")[-1]
        path = os.path.join(sys.argv[2], name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "wb") as file:
            file.write(archive.read(info))
        os.chmod(path, info.external_attr >> 16 & 0o777 or 0o644)
END
test -e "$work/nevh/py.typed" || { echo "the wheel does not say that it has hints"; exit 1; }
unset NEVH_LIBRARY NEVH_COMMAND NEVH_SCENES LD_LIBRARY_PATH
PYTHONPATH=$work
export PYTHONPATH
cd "$work" && "$python" - "$work" <<'END'
import os
import sys
import nevh
for path in (nevh.library(), nevh.command(), nevh.Scene("pendulum").path):
    assert os.path.realpath(path).startswith(os.path.realpath(sys.argv[1])), path
scenes = os.listdir(os.path.dirname(nevh.Scene("pendulum").path))
assert "pendulum-filmed.csv" in scenes  # measured points come with their scene
assert nevh.solve("pendulum", (0, 100), dt=0.02).verdict == "bounded"
rows = nevh.compare("pendulum", ["verlet", "rk4"], dt=0.1, t_end=100)
assert rows["verdict"] == ["bounded", "drifts"]
END
