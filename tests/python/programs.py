"""nevh tests: the Python of README.md and of the manual runs as it is printed.  Each
block after the other, in one set of names, as a reader would type them.

    programs.py FOLDER, which has README.md and doc/nevh.texi

SPDX-License-Identifier: GPL-3.0-or-later
"""

import os
import re
import sys
import tempfile

sys.dont_write_bytecode = True
names, arrays = {}, True
try:
    from math import pi
    import numpy
    from scipy.integrate import solve_ivp
    names = {"numpy": numpy, "solve_ivp": solve_ivp, "PI": pi}
except ImportError:
    arrays = False
    print("there is no NumPy, or no SciPy: blocks that name them do not run")


def blocks_of(path):
    with open(path, encoding="utf-8") as file:
        text = file.read()
    if path.endswith(".md"):
        return re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)
    chapter = re.search(r"^@chapter Python$.*?^@chapter", text, re.M | re.S).group()
    blocks = re.findall(r"^@example\n(.*?)^@end example", chapter, re.M | re.S)
    return [re.sub(r"@([@{}])", r"\1", block) for block in blocks
            if re.search(r"\bnevh\.\w+\(|^import nevh", block) and "@dots" not in block]


os.environ.update((name, os.path.abspath(os.environ[name])) for name in
                  ("NEVH_LIBRARY", "NEVH_COMMAND", "NEVH_SCENES") if name in os.environ)
sources, ran = os.path.abspath(sys.argv[1]), 0
folder = tempfile.TemporaryDirectory()
os.chdir(folder.name)  # some of them write a file
for path in (os.path.join(sources, name) for name in ("README.md", "doc/nevh.texi")):
    for block in blocks_of(path):
        if not arrays and re.search(r"\b(numpy|solve_ivp)\b", block):
            continue
        exec(compile(block, path, "exec"), names)
        ran += 1
os.chdir(sources)
print("%d blocks of Python ran" % ran)
assert ran >= 3, "there are fewer than there were"
