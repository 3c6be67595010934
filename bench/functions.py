"""H as a function of Python: what tracing it is worth.  Seconds of the processor.

    python3 bench/functions.py [ROUNDS [functions|listing|pendulum|sweep]...]

functions   the forty of tests/python/hamiltonians.py beside the same H as text: time to
            trace, time of the same steps; rounds are interleaved, the least is taken
listing     Listing 1 of the paper until t = 3000, beside the paper's class
pendulum    a double pendulum to 1e-9 beside SciPy with a gradient written by hand
sweep       100 000 pendulums, beside the command

listing and pendulum need SciPy.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import inspect
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
import warnings

here = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(here, "..", "python"), os.path.join(here, "..", "tests/python")]
import nevh  # noqa: E402
from hamiltonians import cases, np, scene_of_text  # noqa: E402


def seconds(run):
    begin = time.process_time()
    run()
    return time.process_time() - begin


def least_of(rounds, *runs):
    """The least seconds of each, in rounds that are interleaved."""
    times = [[seconds(run) for run in runs] for _ in range(rounds)]
    return [min(column) for column in zip(*times)]


def show(name, took, slow, note=""):
    print("  %-44s %12.6f s %9.1f   %s" % (name, took, slow / took, note), flush=True)


# The forty functions.

def steps_of(scene, case, count):
    return nevh.solve(scene, (0, count * case.dt), case.start, "gauss4", dt=case.dt,
                      t_eval=[count * case.dt], check=False)


def functions(rounds):
    ratios = []
    print("%-36s %10s %10s %10s %6s" % ("H", "trace ms", "text s", "function s", "ratio"))
    for case in cases:
        if case.why:
            print("%-36s not traced: %s" % (case.name, case.why))
            continue
        names = inspect.getfullargspec(case.H).args[2:] if case.args else ()
        given = dict(case.parameters, **dict(zip(names, case.args)))
        traced, = least_of(rounds, lambda: nevh.Scene(case.H, given, y0=case.start))
        mine = nevh.Scene(case.H, given, y0=case.start)
        text = scene_of_text(nevh, case)
        count = 2000
        for _ in range(2):  # the second finds what was compiled
            took = seconds(lambda: steps_of(text, case, count))
            count = max(2000, int(count * 0.05 / took))
            steps_of(text, case, count)
            steps_of(mine, case, count)
        least = least_of(3 * rounds, lambda: steps_of(text, case, count),
                         lambda: steps_of(mine, case, count))
        ratios.append(least[1] / least[0])
        print("%-36s %10.2f %10.4f %10.4f %6.2f" % (
            case.name, 1e3 * traced, *least, ratios[-1]), flush=True)
    print("%d of %d are traced; ratio: median %.3f, largest %.3f" % (
        len(ratios), len(cases), statistics.median(ratios), max(ratios)))


# The paper's listing.

PI = 3.141592653589793


def H(t, s, k, m):
    x, p = s
    return 0.5 * k * x**2 + 0.5 * p**2 / m


class PapersGradient:
    """The paper's class, from its description: differences of two values of H for each
    of y."""

    def __init__(self, H, ds, **constants):
        self.H, self.ds, self.constants = H, ds, constants

    def __call__(self, t, y):
        slopes = []
        for i, d in enumerate(self.ds):
            ahead, behind = list(y), list(y)
            ahead[i] += d
            behind[i] -= d
            slopes.append((self.H(t, ahead, **self.constants)
                           - self.H(t, behind, **self.constants)) / (2 * d))
        n = len(slopes) // 2
        return slopes[n:] + [-slope for slope in slopes[:n]]


class NumpyGradient(PapersGradient):
    """The same with arrays of NumPy in place of lists."""

    def __call__(self, t, y):
        steps = np.diag(self.ds)
        slopes = np.array([self.H(t, y + s, **self.constants)
                           - self.H(t, y - s, **self.constants) for s in steps])
        slopes /= 2 * np.array(self.ds)
        n = len(slopes) // 2
        return np.concatenate([slopes[n:], -slopes[:n]])


def drift_of(trajectory):
    constants = dict(k=4 * PI**2, m=1.0)
    energies = [H(0, s, **constants) for s in np.asarray(trajectory.y).T]
    return abs(energies[-1] / energies[0] - 1)


def listing(rounds):
    from scipy.integrate import solve_ivp
    initial_state, ds, until = [1.0, 0.0], [0.1, 0.1], [0.0, 3000.0]
    kc, mc = 4 * PI**2, 1.0

    def of(gradient, solve, *method, **named):
        return lambda: solve(gradient(H, ds, k=kc, m=mc), until, initial_state, *method,
                             **named)
    fine = {"rtol": 1e-9, "atol": 1e-9}
    runs = {
        "the paper's class, SciPy": of(PapersGradient, solve_ivp),
        "the same in NumPy, SciPy": of(NumpyGradient, solve_ivp),
        "nevh.HGrad, SciPy": of(nevh.HGrad, solve_ivp),
        "nevh.HGrad, nevh.solve": of(nevh.HGrad, nevh.solve),
        "nevh.HGrad, nevh.solve verlet 0.01": of(nevh.HGrad, nevh.solve, "verlet",
                                                 dt=0.01),
        "the paper's class, SciPy DOP853 1e-9": of(PapersGradient, solve_ivp, "DOP853",
                                                   **fine),
        "nevh.HGrad, SciPy DOP853 1e-9": of(nevh.HGrad, solve_ivp, "DOP853", **fine)}
    print("Listing 1 until t = 3000 (times; change of the energy)")
    slow = None
    for name, run in runs.items():
        took, = least_of(1 if "SciPy" in name else rounds, run)
        slow = slow or took
        show(name, took, slow, "%.1e" % drift_of(run()))


# A double pendulum.

def pendulum(rounds):
    from scipy.integrate import solve_ivp
    from python import by_hand, value as double_pendulum
    start, aim = [math.pi / 2, 0, 0, 0], 1e-9
    for until in (20, 40):
        exact = nevh.solve(double_pendulum, (0, until), start, "taylor",
                           rtol=1e-16).y[:, -1]
        runs = {
            "SciPy DOP853, by hand": lambda r: solve_ivp(
                by_hand, (0, until), start, "DOP853", rtol=r, atol=r),
            "nevh.solve of the function": lambda r: nevh.solve(
                double_pendulum, (0, until), start, rtol=r, t_eval=[until]),
            "nevh.solve of its scene": lambda r, made=nevh.Scene(
                double_pendulum, y0=start): nevh.solve(
                    made, (0, until), start, rtol=r, t_eval=[until])}
        print("double pendulum to 1e-9 until t = %d (times; error)" % until)
        slow = None
        for name, run in runs.items():
            k = next(k for k in range(24, 120)  # the loosest tolerance that will do
                     if error_of(run(10 ** (-k / 8)), exact) <= aim)
            took, = least_of(rounds, lambda: run(10 ** (-k / 8)))
            slow = slow or took
            show(name, took, slow, "%.1e" % error_of(run(10 ** (-k / 8)), exact))


def error_of(orbit, exact):
    return max(abs(row[-1] - x) for row, x in zip(orbit.y, exact))


# A sweep.

def one_pendulum(t, y, g):
    return y[1]**2 / 2 - g * math.cos(y[0])


def sweep(rounds):
    angles = "range(0.1, 3, 100000)"
    text = """[parameters]
g = 9.8
[coordinates]
q = 1
[effects]
H = p_q^2/2 - g*cos(q)
[run]
t_end = 20
dt = 0.05
integrators = blanes-moan4
gradient = exact
[ensemble]
q = range(0.1, 3, 100000)
outcomes = last(q)
"""

    def mine():
        return nevh.sweep(one_pendulum, {"q": angles}, "last(q)", "blanes-moan4", dt=0.05,
                          t_end=20, y0=[1, 0], parameters={"g": 9.8}, threads=1)["last(q)"]
    with tempfile.TemporaryDirectory() as folder:
        scene, out = os.path.join(folder, "p.nevh"), os.path.join(folder, "p.npy")
        with open(scene, "w", encoding="utf-8") as file:
            file.write(text)

        def command():
            """Its own seconds of the processor, which count its start, too."""
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([nevh.command(), "sweep", scene, "--threads", "1", "--output", out],
                           check=True, stdout=subprocess.DEVNULL,
                           stderr=subprocess.DEVNULL)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        command(), mine()
        own = min(command() for _ in range(rounds))
        took, = least_of(rounds, mine)
        same = np.array_equal(np.load(out)["last(q)"], mine())
    print("100 000 pendulums until t = 20 (times; array)")
    show("nevh sweep", own, own)
    show("nevh.sweep of the function", took, own,
         "the command's numbers" if same else "OTHER numbers than the command's")


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    warnings.simplefilter("ignore")
    parts = [functions, listing, pendulum, sweep]
    for part in parts:
        if part.__name__ in sys.argv[2:] or not sys.argv[2:]:
            part(rounds)


main()
