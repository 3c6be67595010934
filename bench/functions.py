"""The Hamiltonians of tests/python/hamiltonians.py as functions of Python beside the
same as text: seconds to trace, seconds of the same steps, and their ratio.  Rounds are
interleaved, the least is taken.

    python3 bench/functions.py [ROUNDS]

SPDX-License-Identifier: GPL-3.0-or-later
"""

import inspect
import os
import statistics
import sys
import time
import warnings

here = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(here, "..", "python"), os.path.join(here, "..", "tests/python")]
import nevh  # noqa: E402
from hamiltonians import cases, scene_of_text  # noqa: E402


def seconds(run):
    begin = time.process_time()
    run()
    return time.process_time() - begin


def steps_of(scene, case, count):
    return nevh.solve(scene, (0, count * case.dt), case.start, "gauss4", dt=case.dt,
                      t_eval=[count * case.dt], check=False)


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    warnings.simplefilter("ignore")
    ratios = []
    print("%-36s %10s %10s %10s %6s" % ("H", "trace ms", "text s", "function s", "ratio"))
    for case in cases:
        if case.why:
            print("%-36s not traced: it %s" % (case.name, case.why[3:]))
            continue
        names = inspect.getfullargspec(case.H).args[2:] if case.args else ()
        given = dict(case.parameters, **dict(zip(names, case.args)))
        traced = min(seconds(lambda: nevh.Scene(case.H, given, y0=case.start))
                     for _ in range(rounds))
        mine = nevh.Scene(case.H, given, y0=case.start)
        text = scene_of_text(nevh, case)
        count = 2000
        for _ in range(2):  # the second finds what was compiled
            took = seconds(lambda: steps_of(text, case, count))
            count = max(2000, int(count * 0.03 / took))
            steps_of(text, case, count)
            steps_of(mine, case, count)
        times = [(seconds(lambda: steps_of(text, case, count)),
                  seconds(lambda: steps_of(mine, case, count))) for _ in range(3 * rounds)]
        least = [min(column) for column in zip(*times)]
        ratios.append(least[1] / least[0])
        print("%-36s %10.2f %10.4f %10.4f %6.2f" % (
            case.name, 1e3 * traced, least[0], least[1], ratios[-1]), flush=True)
    print("%d of %d are traced; ratio: median %.3f, largest %.3f" % (
        len(ratios), len(cases), statistics.median(ratios), max(ratios)))


main()
