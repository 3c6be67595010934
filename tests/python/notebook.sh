#!/bin/sh
# Notebooks of worksheets: their cells run one after the other, and under nbconvert
# where Jupyter is there.

srcdir=${srcdir:-.}
. "$srcdir/tests/python/find_python.sh"
work=$PWD/notebook.$$
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$work" || exit 1
HOME=$work
MPLBACKEND=Agg
MPLCONFIGDIR=$work
export HOME MPLBACKEND MPLCONFIGDIR

status=0
for kept in "$srcdir"/python/*.ipynb "$srcdir"/python/sheets/sheet-9.ipynb; do
    notebook=$work/$(basename "$kept")  # some write a scene beside them
    cp "$kept" "$notebook" && chmod u+w "$notebook"
    "$python" - "$notebook" >"$work/out" 2>&1 <<'END' || { cat "$work/out"; status=1; }
import json
import os
import sys
os.chdir(os.path.dirname(sys.argv[1]))
names = {}
for cell in json.load(open(sys.argv[1], encoding="utf-8"))["cells"]:
    assert not cell.get("outputs"), "results are not kept in a notebook"
    if cell["cell_type"] == "code":
        exec(compile("".join(cell["source"]), cell["id"], "exec"), names)
END
    echo "$(basename "$notebook"): cells run"
    "$python" -c 'import nbconvert, ipykernel' 2>/dev/null ||
        { echo "there is no nbconvert"; continue; }
    "$python" -m nbconvert --to html --execute --output-dir "$work/html" \
        --ExecutePreprocessor.kernel_name=python3 "$notebook" >"$work/out" 2>&1 ||
        { cat "$work/out"; status=1; continue; }
    echo "$(basename "$notebook"): nbconvert runs it"
done
exit $status
