"""What benches of nevh's promises share: commands, their tables, and a row for each.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import csv
import os
import subprocess
import sys
import tempfile
import time

nevh, mpi, broken = None, None, []
work = tempfile.mkdtemp(prefix="promises.")


def row(what, goal, here, kept):
    print(" %-44s %-22s %-26s %s" % (what, goal, here, "" if kept else "MISSED"),
          flush=True)
    if not kept:
        broken.append(what)


def command(*words, allowed=(0,)):
    done = subprocess.run([nevh, *words, "--quiet"], capture_output=True, text=True)
    if done.returncode not in allowed:
        raise SystemExit("%s: %s" % (" ".join(words), done.stderr))
    return done.stdout


def table(*words, allowed=(0,)):
    text = command(*words, "--format", "csv", allowed=allowed)
    return list(csv.DictReader(line for line in text.splitlines()
                               if not line.startswith("#")))


def seconds(*words, allowed=(0,)):
    begin = time.time()
    command(*words, allowed=allowed)
    return time.time() - begin


def main(document, parts, takes_mpi=False):
    """Runs the parts that are named, or all; ends with the exit status."""
    global nevh, mpi
    names = {part.__name__: part for part in parts}
    words = sys.argv[1:]
    try:
        if not words:
            raise SystemExit(document)
        nevh = words.pop(0)
        if takes_mpi and words and words[0] not in names:
            mpi = words.pop(0)
        for word in words or names:
            if word not in names:
                raise SystemExit("%s is none of %s" % (word, ", ".join(names)))
            names[word]()
    finally:
        for name in os.listdir(work):
            os.unlink(os.path.join(work, name))
        os.rmdir(work)
    sys.exit(1 if broken else 0)
