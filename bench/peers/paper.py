# nevh: the paper's method, from its description: solve_ivp over the central
# differences of H, in Python; and SciPy with derivatives by hand.
#
# Reads lines "problem method tolerance", and answers each with the CPU seconds
# that it took and the state at the end.
# SPDX-License-Identifier: GPL-3.0-or-later
import sys
import time

import numpy as np
import scipy
from scipy.integrate import solve_ivp

masses = np.array([1.00000597682, 0.000954786104043, 0.000285583733151,
                   0.0000437273164546, 0.0000517759138449, 1 / 1.3e8])
gravity = 2.95912208286e-4
first, second = np.triu_indices(6, 1)
weights = gravity * masses[first] * masses[second]


def pendulum(q, p):
    return p[0]**2 / 2 - np.cos(q[0])


def pendulum_slopes(q, p):
    return [p[0], -np.sin(q[0])]


def double_pendulum(q, p):
    d = q[0] - q[1]
    return ((p[0]**2 + 2 * p[1]**2 - 2 * p[0] * p[1] * np.cos(d))
            / (2 * (1 + np.sin(d)**2))
            - 9.8 * (2 * np.cos(q[0]) + np.cos(q[1])))


def double_pendulum_slopes(q, p):
    s, c = np.sin(q[0] - q[1]), np.cos(q[0] - q[1])
    root = 1 + s * s
    form = p[0]**2 + 2 * p[1]**2 - 2 * p[0] * p[1] * c
    both = s * (p[0] * p[1] - form * c / root) / root
    return [(p[0] - p[1] * c) / root, (2 * p[1] - p[0] * c) / root,
            -both - 19.6 * np.sin(q[0]), both - 9.8 * np.sin(q[1])]


def kepler(q, p):
    return (p[0]**2 + p[1]**2) / 2 - 1 / np.sqrt(q[0]**2 + q[1]**2)


def kepler_slopes(q, p):
    square = q[0]**2 + q[1]**2
    factor = -1 / (square * np.sqrt(square))
    return [p[0], p[1], factor * q[0], factor * q[1]]


def henon_heiles(q, p):
    return ((p[0]**2 + p[1]**2 + q[0]**2 + q[1]**2) / 2
            + q[0]**2 * q[1] - q[1]**3 / 3)


def henon_heiles_slopes(q, p):
    return [p[0], p[1], -q[0] - 2 * q[0] * q[1], -q[1] - q[0]**2 + q[1]**2]


def outer_sun(q, p):
    x = q.reshape(6, 3)
    kinetic = (p.reshape(6, 3)**2).sum(axis=1) / (2 * masses)
    away = np.sqrt(((x[first] - x[second])**2).sum(axis=1))
    return kinetic.sum() - (weights / away).sum()


def outer_sun_slopes(q, p):
    x = q.reshape(6, 3)
    d = x[first] - x[second]
    pull = (weights / (d**2).sum(axis=1)**1.5)[:, None] * d
    force = np.zeros((6, 3))
    np.add.at(force, first, -pull)
    np.add.at(force, second, pull)
    return np.concatenate([(p.reshape(6, 3) / masses[:, None]).ravel(),
                           force.ravel()])


systems = {
    "pendulum": (pendulum, pendulum_slopes),
    "double-pendulum": (double_pendulum, double_pendulum_slopes),
    "kepler": (kepler, kepler_slopes),
    "henon-heiles": (henon_heiles, henon_heiles_slopes),
    "outer-sun": (outer_sun, outer_sun_slopes),
}


def differences(hamiltonian, y0):
    """The paper's field; spreads are 2^-17 of the largest coordinate and of
    the largest momentum."""
    n = len(y0) // 2
    largest = [np.abs(y0[:n]).max() or 1, np.abs(y0[n:]).max() or 1]
    spread = 2.0**-17 * np.repeat(largest, n)

    def slopes(t, y):
        slope = np.empty(2 * n)
        for k in range(2 * n):
            up, down = y.copy(), y.copy()
            up[k] += spread[k]
            down[k] -= spread[k]
            slope[k] = ((hamiltonian(up[:n], up[n:])
                         - hamiltonian(down[:n], down[n:]))
                        / (up[k] - down[k]))
        return np.concatenate([slope[n:], -slope[:n]])
    return slopes


def by_hand(derivatives, n):
    return lambda t, y: derivatives(y[:n], y[n:])


def main():
    np.seterr(all="ignore")  # far from the orbit H may overflow
    print(scipy.__version__, flush=True)
    for line in sys.stdin:
        name, method, tolerance, t_end, size, *start = line.split()
        y0 = np.array([float(x) for x in start])
        hamiltonian, derivatives = systems[name]
        rtol = max(float(tolerance), 3e-14)
        slopes = (differences(hamiltonian, y0) if method == "paper"
                  else by_hand(derivatives, len(y0) // 2))
        began = time.process_time()
        result = solve_ivp(slopes, (0, float(t_end)), y0, rtol=rtol,
                           atol=rtol * float(size),
                           method="RK45" if method == "paper" else "DOP853")
        took = time.process_time() - began
        print(took, *(x.hex() for x in result.y[:, -1]), flush=True)


main()
