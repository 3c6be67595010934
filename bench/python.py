"""What the package for Python is promised to do: a row for each promise.

    python3 bench/python.py NEVH [PART...]

The parts are listing, functions, pendulum, commands, sweep, members, schemes, wrong,
wheel and types; all of them take some five minutes of a processor that does nothing
else.  It needs NumPy and SciPy; wheel runs in the build tree, types needs mypy.  Times
are of the processor, the least of ROUNDS (15) that are interleaved.  It ends with exit
status 1 where a promise is not kept.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import glob
import inspect
import math
import os
import resource
import shutil
import statistics
import subprocess
import sys
import time
import warnings

here = os.path.dirname(os.path.abspath(__file__))
top = os.path.dirname(here)
sys.path[:0] = [os.path.join(top, "python"), os.path.join(top, "tests/python")]
import promises  # noqa: E402
from promises import row, work  # noqa: E402
import nevh  # noqa: E402
from hamiltonians import cases, np, scene_of_text  # noqa: E402

ROUNDS = int(os.environ.get("ROUNDS", 15))


def seconds(run):
    begin = time.process_time()
    run()
    return time.process_time() - begin


def least_of(rounds, *runs):
    """The least seconds of each, in rounds that are interleaved."""
    times = [[seconds(run) for run in runs] for _ in range(rounds)]
    return [min(column) for column in zip(*times)]


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


def listing():
    """Listing 1 until t = 3000, beside the paper's class."""
    from scipy.integrate import solve_ivp
    initial_state, ds, until = [1.0, 0.0], [0.1, 0.1], [0.0, 3000.0]
    kc, mc = 4 * PI**2, 1.0

    def of(gradient, solve):
        return lambda: solve(gradient(H, ds, k=kc, m=mc), until, initial_state)
    mine = of(nevh.HGrad, nevh.solve)
    mine()
    fast, = least_of(ROUNDS, mine)
    for name, gradient, goal in (("the paper's class", PapersGradient, 200),
                                 ("the same in NumPy", NumpyGradient, None)):
        slow, = least_of(1, of(gradient, solve_ivp))
        row("Listing 1, over %s in SciPy" % name, "%s times" % goal if goal else "",
            "%.0f times, %.1f ms" % (slow / fast, 1e3 * fast), not goal or slow / fast >= goal)
    row("  change of the energy, nevh and SciPy", "", "%.1e, %.1e" % (
        drift_of(mine()), drift_of(of(PapersGradient, solve_ivp)())), True)


# The forty functions.

def steps_of(scene, case, count):
    return nevh.solve(scene, (0, count * case.dt), case.start, "gauss4", dt=case.dt,
                      t_eval=[count * case.dt], check=False)


def functions():
    """The forty of tests/python/hamiltonians.py beside the same H as text."""
    ratios, traces = [], []
    for case in cases:
        if case.why:
            continue
        names = inspect.getfullargspec(case.H).args[2:] if case.args else ()
        given = dict(case.parameters, **dict(zip(names, case.args)))
        mine, text = nevh.Scene(case.H, given, y0=case.start), scene_of_text(nevh, case)
        traces += least_of(1, lambda: nevh.Scene(case.H, given, y0=case.start))
        count = 2000
        for _ in range(2):  # the second finds what was compiled
            took = seconds(lambda: steps_of(text, case, count))
            count = max(2000, int(count * 0.05 / took))
            steps_of(text, case, count)
            steps_of(mine, case, count)
        least = least_of(3 * ROUNDS, lambda: steps_of(text, case, count),
                         lambda: steps_of(mine, case, count))
        ratios.append((least[1] / least[0], case.name))
    row("traced, of %d functions" % len(cases), "38", str(len(ratios)), len(ratios) >= 38)
    middle = statistics.median(ratio for ratio, _ in ratios)
    slowest, name = max(ratios)
    row("  time of the text's, middle and most", "1.10", "%.2f, %.2f (%s)" % (
        middle, slowest, name), slowest <= 1.1)
    row("  ms of a trace, middle and most", "", "%.1f, %.1f" % (
        1e3 * statistics.median(traces), 1e3 * max(traces)), True)


# A double pendulum.

G = 9.8


def by_hand(t, y):
    """Hamilton's equations of the double pendulum, written out."""
    a, b, p, r = y
    s, c = math.sin(a - b), math.cos(a - b)
    d = 1 + s * s
    h1 = p * r * s / d
    h2 = s * c * (p * p + 2 * r * r - 2 * p * r * c) / (d * d)
    return [(p - r * c) / d, (2 * r - p * c) / d,
            -2 * G * math.sin(a) - h1 + h2, -G * math.sin(b) + h1 - h2]


def value(t, y):
    a, b, p, r = y
    s = math.sin(a - b)
    return ((p * p + 2 * r * r - 2 * p * r * math.cos(a - b)) / (2 * (1 + s * s))
            - G * (2 * math.cos(a) + math.cos(b)))


def error_of(orbit, exact):
    return max(abs(line[-1] - x) for line, x in zip(orbit.y, exact))


def pendulum():
    """A double pendulum to 1e-9 beside SciPy with a gradient written by hand."""
    from scipy.integrate import solve_ivp
    start, aim = [math.pi / 2, 0, 0, 0], 1e-9
    for until in (20, 40):
        exact = nevh.solve(value, (0, until), start, rtol=1e-16).y[:, -1]
        took = []
        for run in (lambda r: solve_ivp(by_hand, (0, until), start, "DOP853", rtol=r, atol=r),
                    lambda r: nevh.solve(value, (0, until), start, rtol=r, t_eval=[until])):
            k = next(k for k in range(24, 120)  # the loosest tolerance that will do
                     if error_of(run(10 ** (-k / 8)), exact) <= aim)
            took += least_of(ROUNDS, lambda: run(10 ** (-k / 8)))
        row("double pendulum to 1e-9, t = %d, over DOP853" % until, "50 times",
            "%.0f times, %.2f ms" % (took[0] / took[1], 1e3 * took[1]),
            took[0] / took[1] >= 50)


def commands():
    """All commands are functions whose docstring has an example; they run in a test."""
    names = sorted({*nevh._names(), "sweep"})
    have = [name for name in names if ">>> " in (getattr(nevh, name).__doc__ or "")]
    row("commands that are functions with a doctest", "all", "%d of %d" % (
        len(have), len(names)), have == names)


# A sweep.

def one_pendulum(t, y, g):
    return y[1]**2 / 2 - g * math.cos(y[0])


def sweep():
    """A hundred thousand pendulums, beside the command."""
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
    scene, out = os.path.join(work, "p.nevh"), os.path.join(work, "p.npy")
    with open(scene, "w", encoding="utf-8") as file:
        file.write(text)

    def command():
        """Its own seconds of the processor, which count its start, too."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([promises.nevh, "sweep", scene, "--threads", "1", "--output", out],
                       check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    command(), mine()
    pairs = [(command(), seconds(mine)) for _ in range(ROUNDS)]
    own, took = map(min, zip(*pairs))
    same = np.array_equal(np.load(out)["last(q)"], mine())
    row("100 000 pendulums, time of the command's", "1.10, its numbers", "%.2f, %s" % (
        took / own, "the same" if same else "OTHERS"), took <= 1.1 * own and same)


def members():
    """An ensemble by y0 of two dimensions."""
    count = 4000
    y0 = np.vstack([np.linspace(0.1, 3, count), np.zeros(count)])
    for method, goal in (("verlet", 0.25), ("gauss4", 0.5)):
        took, = least_of(ROUNDS, lambda: nevh.solve(
            "p_x^2/2 - 9.8*cos(x)", (0, 20), y0, method, dt=0.05, t_eval=[20]))
        row("ensemble by y0, %s, ms a member" % method, str(goal), "%.2f" % (
            1e3 * took / count), took < goal * count / 1e3)


# Tables of schemes, as published: what they are, and the place of a digit to spoil.

third = "1/(2 - 2^(1/3))"
fifth = "1/(4 - 4^(1/3))"
published = [
    ("Verlet", dict(kick=["0.5", "0.5"], drift=["1"]), 2, True, True, "kick", 0),
    ("Ruth 3", dict(kick=["7/24", "3/4", "-1/24"], drift=["2/3", "-2/3", "1"]), 3, False,
     True, "kick", 1),
    ("Forest and Ruth", dict(compose={"verlet": [third, "1 - 2*" + third, third]}), 4, True,
     True, "compose", 1),
    ("McLachlan and Atela 4", dict(
        drift=["0.5153528374311229364", "-0.085782019412973646", "0.4415830236164665242",
               "0.1288461583653841854"],
        kick=["0.1344961992774310892", "-0.2248198030794208058", "0.7563200005156682911",
              "0.3340036032863214255"]), 4, False, True, "drift", 1),
    ("PEFRL", dict(
        first="drift", drift=["0.1786178958448091", "-0.06626458266981849",
                              "0.77529337365001878", "-0.06626458266981849",
                              "0.1786178958448091"],
        kick=["0.7123418310626054", "-0.2123418310626054", "-0.2123418310626054",
              "0.7123418310626054"]), 4, True, True, "kick", 0),
    ("Suzuki 4", dict(compose={"verlet": [fifth, fifth, "1 - 4*" + fifth, fifth, fifth]}), 4,
     True, True, "compose", 2),
    ("Yoshida 6, A", dict(compose={"verlet": [
        "0.784513610477560", "0.235573213359357", "-1.17767998417887", "1.315186320683906",
        "-1.17767998417887", "0.235573213359357", "0.784513610477560"]}), 6, True, True,
     "compose", 1),
    ("Kutta 4", dict(a=[[], ["1/2"], ["0", "1/2"], ["0", "0", "1"]],
                     b=["1/6", "1/3", "1/3", "1/6"]), 4, False, False, "a", 2),
    ("Kutta 3/8", dict(a=[[], ["1/3"], ["-1/3", "1"], ["1", "-1", "1"]],
                       b=["1/8", "3/8", "3/8", "1/8"]), 4, False, False, "a", 3),
    ("Heun 3", dict(a=[[], ["1/3"], ["0", "2/3"]], b=["1/4", "0", "3/4"]), 3, False, False,
     "a", 2),
    ("Gauss 4", dict(a=[["1/4", "1/4 - sqrt(3)/6"], ["1/4 + sqrt(3)/6", "1/4"]],
                     b=["1/2", "1/2"]), 4, True, True, "a", 0),
    ("Radau IIA", dict(a=[["5/12", "-1/12"], ["3/4", "1/4"]], b=["3/4", "1/4"]), 3, False,
     False, "a", 0)]


def spoiled(numbers, what, place):
    """The same numbers with one wrong digit: the last of one of them but for that of a
    long one, whose sixth is wrong."""
    def wrong(text):
        k = max(k for k, one in enumerate(text[:9]) if one.isdigit())
        return text[:k] + str((int(text[k]) + 1) % 10) + text[k + 1:]
    made = {key: list(value) if isinstance(value, list) else value
            for key, value in numbers.items()}
    if what == "compose":
        (base, weights), = numbers["compose"].items()
        made["compose"] = {base: [wrong(one) if k == place else one
                                  for k, one in enumerate(weights)]}
    elif what == "a":
        made["a"][place] = [*made["a"][place][:-1], wrong(made["a"][place][-1])]
    else:
        made[what][place] = wrong(made[what][place])
    return made


def schemes():
    """Twelve published tables typed in, and each with a wrong digit."""
    right, named, missed = 0, 0, []
    for title, numbers, order, symmetric, symplectic, what, place in published:
        mine = nevh.Integrator("own", **numbers)
        right += (mine.order, mine.symmetric, mine.symplectic) == (order, symmetric,
                                                                   symplectic)
        try:
            wrong = nevh.Integrator("own", **spoiled(numbers, what, place))
            said = wrong.shortfall if wrong.order < order else ""
        except nevh.Refused as error:
            said = str(error)
        named += bool(said)
        missed += [] if said else [title]
    row("published tables: order, symmetry, symplecticity", "12 of 12", "%d of %d" % (
        right, len(published)), right == len(published))
    row("  wrong digits that are named", "12 of 12", "%d of %d %s" % (
        named, len(published), ", ".join(missed)), named == len(published))


def wrong():
    """Calls that are wrong, of tests/python/wrong_calls.py."""
    done = subprocess.run([sys.executable, os.path.join(top, "tests/python/wrong_calls.py")],
                          capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": os.path.join(top, "python")})
    said = done.stdout.strip().splitlines()[-1:]
    row("wrong calls: exceptions that say so, crashes", "200, 0", "%s, status %d" % (
        said[0].split(",")[0] if said else "?", done.returncode), done.returncode == 0)


def wheel():
    """A bare virtual environment: seconds from the wheel to the first table."""
    found = sorted(glob.glob("python/nevh-*.whl"))
    if not found:
        print(" there is no wheel here: run make wheel in the build tree")
        return
    place = os.path.join(work, "venv")
    clean = {name: text for name, text in os.environ.items()
             if not name.startswith(("NEVH", "PYTHON"))}
    begin = time.time()
    try:
        subprocess.run([sys.executable, "-m", "venv", place], check=True, env=clean)
        python = os.path.join(place, "bin/python")
        subprocess.run([python, "-m", "pip", "install", "--quiet", "--no-index", found[-1]],
                       check=True, env=clean)
        done = subprocess.run([python, "-c", "import nevh; print(nevh.compare('pendulum', "
                               "['verlet', 'rk4'], dt=0.1, t_end=20))"], env=clean,
                              capture_output=True, text=True)
        row("bare venv: seconds to the first table", "", "%.0f" % (time.time() - begin),
            done.returncode == 0 and "verlet" in done.stdout)
    finally:
        shutil.rmtree(place, ignore_errors=True)


def types():
    """mypy on the stub; docstrings of all public names."""
    stub = os.path.join(top, "python/nevh/__init__.pyi")
    done = subprocess.run([os.environ.get("MYPY", "mypy"), "--strict", stub],
                          capture_output=True, text=True)
    row("mypy --strict on the stub", "clean", done.stdout.strip().splitlines()[-1][:26],
        done.returncode == 0)
    names = [name for name in dir(nevh) if not name.startswith("_") and name != "verdicts"]
    bare = [name for name in names if not getattr(nevh, name).__doc__]
    row("public names with a docstring", "all", "%d of %d %s" % (
        len(names) - len(bare), len(names), " ".join(bare)), not bare)


PARTS = (listing, functions, pendulum, commands, sweep, members, schemes, wrong, wheel, types)

if __name__ == "__main__":
    warnings.simplefilter("ignore")
    promises.main(__doc__, PARTS)
