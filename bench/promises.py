"""What benches of nevh's promises share: commands, their tables, and a row for each.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import csv
import subprocess
import time

nevh, broken = None, []


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
