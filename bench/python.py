"""nevh.solve and nevh.sweep beside SciPy's solve_ivp: seconds of one processor, and
how many times faster.  Rounds are interleaved; medians are given.

    python3 bench/python.py [ROUNDS]

SPDX-License-Identifier: GPL-3.0-or-later
"""

import math
import os
import statistics
import sys
import time

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "..", "python"))
import nevh  # noqa: E402
import numpy as np  # noqa: E402
from scipy.integrate import solve_ivp  # noqa: E402

H = ("(p_a^2 + 2*p_b^2 - 2*p_a*p_b*cos(a - b))/(2*(1 + sin(a - b)^2)) "
     "- g*(2*cos(a) + cos(b))")
START = [math.pi / 2, 0, 0, 0]
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


def medians(rounds, runs):
    times = {name: [] for name in runs}
    for _ in range(rounds):
        for name, run in runs.items():
            begin = time.process_time()
            run()
            times[name].append(time.process_time() - begin)
    return {name: statistics.median(all) for name, all in times.items()}


def error(orbit, exact):
    return max(abs(orbit.y[k][-1] - exact[k]) for k in range(len(exact)))


def loosest(run, exact, aim):
    """The largest tolerance that ends within `aim` of the exact state."""
    for k in range(32, 120):
        tolerance = 10 ** (-k / 8)
        orbit = run(tolerance)
        if error(orbit, exact) <= aim:
            return tolerance, orbit
    raise SystemExit("no tolerance keeps %g" % aim)


def show(title, times, slow, notes):
    print(title)
    for name, seconds in times.items():
        print("  %-34s %10.6f s  %8.1f   %s" % (name, seconds, times[slow] / seconds,
                                              notes.get(name, "")))
    print()


def one_orbit(rounds):
    span, aim = (0, 20), 1e-9
    fixed = {"parameters": {"g": G}}
    exact = nevh.solve(H, span, START, "taylor", rtol=1e-16, **fixed).y[:, -1]
    runs = {
        "solve_ivp DOP853, by hand": lambda r: solve_ivp(
            by_hand, span, START, "DOP853", rtol=r, atol=r),
        "nevh.solve taylor": lambda r: nevh.solve(H, span, START, rtol=r, **fixed),
        "nevh.solve DOP853": lambda r: nevh.solve(H, span, START, "DOP853", rtol=r,
                                                  **fixed),
        "nevh.solve DOP853, function": lambda r: nevh.solve(value, span, START,
                                                            "DOP853", rtol=r),
        "solve_ivp DOP853, HGrad of text": lambda r: solve_ivp(
            nevh.HGrad(H, gradient="exact", **fixed), span, START, "DOP853", rtol=r,
            atol=r),
    }
    notes = {}
    for name, run in list(runs.items()):
        tolerance, orbit = loosest(run, exact, aim)
        notes[name] = "error %.1e, tolerance %.1e, %d gradients" % (
            error(orbit, exact), tolerance, orbit.nfev)
        runs[name] = lambda run=run, tolerance=tolerance: run(tolerance)
    show("double pendulum, t = 0 ... 20, to 1e-9 (times; of solve_ivp; what it took)",
         medians(rounds, runs), "solve_ivp DOP853, by hand", notes)


def many_orbits(rounds):
    count, some, span, g = 10000, 50, (0, 20), 9.8
    angles = np.linspace(0.1, 3, count)

    def solve(angle, tolerance=1e-6):
        return solve_ivp(lambda t, y: (y[1], -g * math.sin(y[0])), span, [angle, 0],
                         rtol=tolerance, atol=tolerance).y[0][-1]

    def loop():
        return [solve(angle) for angle in angles[::count // some]]

    def sweep(**named):
        return nevh.sweep("p_phi^2/2 - g*cos(phi)", {"phi": angles}, "last(phi)",
                          parameters={"g": g}, t_end=20, threads=1, **named)

    exact = sweep(integrator="blanes-moan6", dt=0.02)["last(phi)"]
    slow = "solve_ivp RK45 1e-6"
    runs = {slow: loop}
    for name, dt in (("verlet", 0.05), ("blanes-moan4", 0.1), ("blanes-moan6", 0.1)):
        runs["nevh.sweep %s %g" % (name, dt)] = (
            lambda name=name, dt=dt: sweep(integrator=name, dt=dt)["last(phi)"])
    notes = {}
    for name, run in runs.items():
        ends = run()
        wrong = np.abs(ends - exact[::count // len(ends)])
        notes[name] = "median error %.1e" % np.median(wrong)
    times = medians(rounds, runs)
    times[slow] *= count / some
    notes[slow] += ", from %d of them" % some
    show("pendulums, t = 0 ... 20, %d of them (times; of solve_ivp)" % count, times,
         slow, notes)


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    print(nevh.library())
    one_orbit(rounds)
    many_orbits(rounds)


if __name__ == "__main__":
    main()
