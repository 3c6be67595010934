"""Forty Hamiltonians as people write them in Python, each beside the same one as a scene
formula: what tests/python/traced.py and bench/python.py try.

`cases` is a list of Case: name, H, start, text and more.  Coordinates of the texts are
q for one degree of freedom, else q[1..n].

SPDX-License-Identifier: GPL-3.0-or-later
"""

import functools
import math
from math import cos, exp, sqrt

try:
    import numpy as np
    from numpy import linalg as LA
except ImportError:
    np = None

cases = []


class Case:
    def __init__(self, name, H, start, text, dt, parameters, args, why):
        self.name, self.H, self.start, self.text, self.dt = name, H, start, text, dt
        self.parameters, self.args, self.why = parameters, args, why


def scene_of_text(nevh, case):
    n = len(case.start) // 2
    return nevh.Scene(case.text, case.parameters, ["q" if n == 1 else "q[%d]" % n])


def case(start, text, dt=0.01, parameters=None, args=(), why=None):
    """Adds what it decorates.  why: a part of what is said where H cannot be traced."""
    def add(H):
        made = H() if isinstance(H, type) else H
        cases.append(Case(H.__name__, made, start, text, dt, parameters or {}, args, why))
        return H
    return add


def with_numpy(*of, **named):
    """A case that NumPy is needed for."""
    return case(*of, **named) if np is not None else lambda H: H


# One degree of freedom.

@case([1.0, 0.0], "0.5*k*q^2 + 0.5*p_q^2/m", parameters={"k": 4 * math.pi**2, "m": 1.0})
def paper_oscillator(t, s, k, m):
    x, p = s
    return 0.5 * k * x**2 + 0.5 * p**2 / m


@case([2.0, 0.0], "p_q^2/(2*m*l^2) - m*g*l*cos(q)", dt=0.02,
      parameters={"m": 1.0, "l": 1.0, "g": 9.8})
def pendulum_of_math(t, y, m, l, g=9.81):
    theta = y[0]
    ptheta = y[1]
    kinetic = ptheta**2 / (2 * m * l**2)
    potential = -m * g * l * math.cos(theta)
    return kinetic + potential


@case([0.1, 0.5], "p_q^2/2 - q^2/2 + q^4/4", dt=0.02)
def duffing(t, y):
    q, p = y
    return p * p / 2 + (-q**2 / 2 + q**4 / 4)


@case([0.3, 0.0], "p_q^2/2 + q^4/4 - q^2/2 - a*q*cos(w*t)", dt=0.02,
      parameters={"a": 0.3, "w": 1.4})
def driven_duffing(t, state, a, w):
    q, p = state
    return 0.5 * p**2 + 0.25 * q**4 - 0.5 * q**2 - a * q * cos(w * t)


@case([1.2, 0.0], "p_q^2/2 + d*(1 - exp(-b*(q - 1)))^2", dt=0.02,
      parameters={"d": 2.0, "b": 1.5})
def morse(t, y, d=2.0, b=1.5):
    def V(r):
        return d * (1 - exp(-b * (r - 1)))**2
    return y[1]**2 / 2 + V(y[0])


kapitza_length, kapitza_drive = 1.0, 40.0


@case([3.0, 0.0], "p_q^2/2 - (9.8 + 0.1*40^2*cos(40*t))*cos(q)", dt=0.002)
def kapitza(t, y):
    """The pivot shakes; the constants are globals."""
    g = 9.8 + 0.1 * kapitza_drive**2 * math.cos(kapitza_drive * t)
    return y[1]**2 / (2 * kapitza_length**2) - g * kapitza_length * math.cos(y[0])


@case([1.0, 0.2], "p_q^2/(2*(1 + q^2)) + log(1 + q^2)", dt=0.02)
def mass_that_depends_on_place(t, y):
    metric = lambda q: 1 + q * q  # noqa: E731
    return y[1]**2 / (2 * metric(y[0])) + math.log(metric(y[0]))


@case([0.7, 0.3], "sqrt(1 + p_q^2) + q^2/2", dt=0.02)
def relativistic_oscillator(t, y):
    q, p = y
    return sqrt(1 + p**2) + 0.5 * q**2


@case([1.0, 1.0], "(exp(q) - 1.5*q) + (exp(p_q) - 0.8*p_q)", dt=0.02, args=(1.5, 0.8))
def lotka_volterra(t, y, a, b):
    """In the logarithms of prey and predators."""
    return (exp(y[0]) - a * y[0]) + (exp(y[1]) - b * y[1])


@case([1.5, 0.0], "p_q^2/2 + abs(q)", dt=0.02)
def wedge(t, y):
    return y[1]**2 / 2 + abs(y[0])


@case([1.1, 0.0], "p_q^2/2 + 4*((1/q)^12 - (1/q)^6)", dt=0.002)
class LennardJones:
    """An object that is called."""

    def __init__(self, epsilon=1.0, sigma=1.0):
        self.epsilon, self.sigma = epsilon, sigma

    def potential(self, r):
        x = (self.sigma / r)**6
        return 4 * self.epsilon * (x**2 - x)

    def __call__(self, t, y):
        return y[1]**2 / 2 + self.potential(y[0])


@case([0.3, 0.4], "w/2*(p_q^2 + q^2)", parameters={"w": 1.3}, dt=0.02)
def centre_with_a_list(t, u, w, parameters=[1.0]):
    x, y = u
    scale, = parameters
    return scale * w / 2 * (y**2 + x**2)


def perturbed(base, strength):
    """A closure over another Hamiltonian."""
    def H(t, y):
        return base(t, y) + strength * sum(c * y[0]**k for k, c in enumerate(weights))
    weights = [0.0, 0.0, 0.1, 0.02, 0.3]
    H.__name__ = "closure_over_" + base.__name__
    return H


case([0.5, 0.1], "p_q^2/2 - q^2/2 + q^4/4 + 0.05*(0.1*q^2 + 0.02*q^3 + 0.3*q^4)",
     dt=0.02)(perturbed(duffing, 0.05))


# Two and more, without NumPy.

@case([math.pi / 2, 0.0, 0.0, 0.0],
      "(p_q[1]^2 + 2*p_q[2]^2 - 2*p_q[1]*p_q[2]*cos(q[1] - q[2]))/"
      "(2*(1 + sin(q[1] - q[2])^2)) - g*(2*cos(q[1]) + cos(q[2]))",
      parameters={"g": 9.8})
def double_pendulum(t, y, g):
    a, b, pa, pb = y
    s = math.sin(a - b)
    numerator = pa * pa + 2 * pb * pb - 2 * pa * pb * math.cos(a - b)
    return numerator / (2 * (1 + s * s)) - g * (2 * math.cos(a) + math.cos(b))


@case([0.0, 0.1, 0.35, 0.1], "(p_q[1]^2 + p_q[2]^2)/2 + (q[1]^2 + q[2]^2)/2 + "
      "lam*(q[1]^2*q[2] - q[2]^3/3)", dt=0.05, parameters={"lam": 1.0})
def henon_heiles(t, state, lam=1.0):
    x, y, px, py = state
    T = 0.5 * (px**2 + py**2)
    V = 0.5 * (x**2 + y**2) + lam * (x**2 * y - y**3 / 3)
    return T + V


@case([0.4, 0.0, 0.0, 2.0], "(p_q[1]^2 + p_q[2]^2)/2 - mu/sqrt(q[1]^2 + q[2]^2)",
      parameters={"mu": 1.0})
def kepler(t, q, p, mu):
    r = (q[0]**2 + q[1]**2)**0.5
    return (p[0]**2 + p[1]**2) / 2 - mu / r


@case([1.1, 0.2, 0.0, 0.3], "p_q[1]^2/2 + p_q[2]^2/(2*q[1]^2) + k*(q[1] - 1)^2/2 - "
      "9.8*q[1]*cos(q[2])", parameters={"k": 40.0})
def elastic_pendulum(t, s, **constants):
    r, phi, pr, pphi = s
    return (pr**2 / 2 + pphi**2 / (2 * r**2) + constants["k"] * (r - 1)**2 / 2
            - 9.8 * r * cos(phi))


@case([0.5, 0.0, 0.0, 0.9],
      "((p_q[1] + q[2])^2 + (p_q[2] - q[1])^2)/2 - (q[1]^2 + q[2]^2)/2 - "
      "(1 - mu)/hypot(q[1] + mu, q[2]) - mu/hypot(q[1] - 1 + mu, q[2])",
      dt=0.001, parameters={"mu": 0.01215})
def restricted_three_bodies(t, y, mu):
    x, yy, px, py = y
    r1 = math.hypot(x + mu, yy)
    r2 = math.hypot(x - 1 + mu, yy)
    return (((px + yy)**2 + (py - x)**2) / 2 - (x**2 + yy**2) / 2
            - (1 - mu) / r1 - mu / r2)


@case([1.0, 0.5, 0.2, 0.0], "(p_q[1] + b*q[2]/2)^2/2 + (p_q[2] - b*q[1]/2)^2/2 + "
      "(q[1]^2 + q[2]^2)/8", dt=0.02, parameters={"b": 2.0})
def magnetic_field(t, y, b):
    ax, ay = -b * y[1] / 2, b * y[0] / 2
    return (y[2] - ax)**2 / 2 + (y[3] - ay)**2 / 2 + (y[0]**2 + y[1]**2) / 8


def _toda(n, q, p):
    total = 0.0
    for i in range(n):
        total += p[i]**2 / 2
        total += math.exp(q[i] - q[(i + 1) % n]) - 1
    return total


@case([0.1, 0.2, -0.3, 0.0, 0.3, -0.3, 0.1, -0.1],
      "sum(i = 1..4, p_q[i]^2/2) + sum(i = 1..4, exp(q[i] - q[mod(i, 4) + 1])) - 4",
      dt=0.05)
def toda_by_a_helper(t, y):
    n = len(y) // 2
    return _toda(n, y[:n], y[n:])


@case([math.sin(math.pi * (i + 1) / 33) for i in range(32)] + [0.0] * 32,
      "sum(i = 1..32, p_q[i]^2/2) + q[1]^2/2 + q[32]^2/2 + sum(i = 1..31, (q[i+1] - "
      "q[i])^2/2) + a/3*(q[1]^3 - q[32]^3 + sum(i = 1..31, (q[i+1] - q[i])^3))",
      dt=0.1, parameters={"a": 0.25})
def fput_with_loops(t, y, a=0.25):
    N = len(y) // 2
    q = [0.0] + [y[i] for i in range(N)] + [0.0]
    energy = sum(y[N + i]**2 for i in range(N)) / 2
    for i in range(N + 1):
        d = q[i + 1] - q[i]
        energy += d**2 / 2 + a * d**3 / 3
    return energy


@case([0.1, 0.0, 0.2, 0.3, 0.0, 0.1], "sum(i = 1..3, p_q[i]^2/2 - cos(q[i])) + "
      "0.1*((q[1] - q[2])^2 + (q[2] - q[3])^2)/2", dt=0.05, args=(0.1,))
def pendulums_with_springs(t, y, k):
    q, p = y[:3], y[3:]
    H = sum(pi * pi for pi in p) / 2 - sum(map(math.cos, q))
    return H + k * sum((a - b)**2 for a, b in zip(q, q[1:])) / 2


# With NumPy.

if np is not None:
    masses = np.array([1.0, 0.5, 0.25])
    stiffness = np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 2.0]])
    wide = np.diag(2.0 * np.ones(8)) - np.eye(8, k=1) - np.eye(8, k=-1)
    bodies = np.array([1.0, 1.0, 1.0])
    eight = [0.97000436, -0.24308753, -0.97000436, 0.24308753, 0.0, 0.0,
             0.466203685, 0.43236573, 0.466203685, 0.43236573, -0.93240737, -0.86473146]
    ring = np.array([0.1, 0.3, -0.2, 0.4, 0.0, -0.1])

_three = ("sum(i = 1..6, p_q[i]^2/2) - 1/sqrt((q[1] - q[3])^2 + (q[2] - q[4])^2) - "
          "1/sqrt((q[1] - q[5])^2 + (q[2] - q[6])^2) - "
          "1/sqrt((q[3] - q[5])^2 + (q[4] - q[6])^2)")


@with_numpy([0.4, 1.1], "p_q^2 + 3*(1 - cos(q))", dt=0.02)
def pendulum_of_split(t, coords):
    q, p = np.split(coords, 2)
    H = 3 * (1 - np.cos(q)) + p**2
    return H


@with_numpy([0.5, 0.2, 0.1, 0.0, 0.1, 0.2],
            "p_q[1]^2/2 + p_q[2]^2 + 2*p_q[3]^2 + q[1]^2 + q[2]^2 + q[3]^2 - "
            "q[1]*q[2] - q[2]*q[3]", dt=0.05)
def matrices(t, y):
    n = y.size // 2
    q, p = y[:n], y[n:]
    return 0.5 * p @ (p / masses) + 0.5 * q @ stiffness @ q


@with_numpy(eight if np is not None else None, _three)
def figure_eight_with_norms(t, q, p):
    q, p = q.reshape(3, 2), p.reshape(3, 2)
    T = sum(np.dot(p[i], p[i]) / (2 * bodies[i]) for i in range(3))
    U = 0.0
    for i in range(3):
        for j in range(i + 1, 3):
            U -= bodies[i] * bodies[j] / np.linalg.norm(q[i] - q[j])
    return T + U


@with_numpy(eight if np is not None else None, _three)
def figure_eight_by_broadcasting(t, y):
    q, p = y.reshape(2, 3, 2)
    i, j = np.triu_indices(3, k=1)
    distance = np.sqrt(((q[i] - q[j])**2).sum(axis=-1))
    return (p**2 / bodies[:, None]).sum() / 2 - np.sum(bodies[i] * bodies[j] / distance)


@with_numpy(eight if np is not None else None, _three)
def figure_eight_filled(t, y):
    """Arrays are made first, then filled."""
    positions = np.zeros((3, 2))
    for k in range(3):
        positions[k] = y[2 * k:2 * k + 2]
    potential = np.zeros(3)
    for n, (a, b) in enumerate([(0, 1), (0, 2), (1, 2)]):
        potential[n] = -1 / LA.norm(positions[a] - positions[b])
    return 0.5 * np.sum(np.square(y[6:])) + potential.sum()


@with_numpy([0.1, 0.0, -0.2, 0.1] * 4, "sum(i = 1..8, p_q[i]^2/2) + sum(i = 1..8, "
            "q[i]^2 + q[i]^4/4) - sum(i = 1..7, q[i]*q[i + 1])", dt=0.05)
def lattice_by_einsum(t, y):
    q, p = y[:8], y[8:]
    return (np.einsum("i,i->", p, p) / 2 + np.einsum("i,ij,j", q, wide, q) / 2
            + np.sum(q**4) / 4)


@with_numpy([0.1 * i for i in range(20)] + [0.0] * 20,
            "sum(i = 1..20, p_q[i]^2/2) + sum(i = 1..20, 1 - cos(q[mod(i, 20) + 1] - "
            "q[i]))", dt=0.05)
def rotors_rolled(t, y):
    theta, omega = np.split(y, 2)
    return 0.5 * np.sum(omega**2) + np.sum(1 - np.cos(np.roll(theta, -1) - theta))


@with_numpy([0.3 * i for i in range(10)] + [0.1] * 10,
            "sum(i = 1..10, p_q[i]^2/2) + 10/2*(1 - (sum(i = 1..10, cos(q[i]))/10)^2 - "
            "(sum(i = 1..10, sin(q[i]))/10)^2)", dt=0.05)
def mean_field(t, y):
    q, p = y[:10], y[10:]
    mx, my = np.mean(np.cos(q)), np.mean(np.sin(q))
    return np.sum(p**2) / 2 + len(q) / 2 * (1 - mx**2 - my**2)


@with_numpy([math.pi / 2, 0.3, 0.0, 0.0],
            "(p_q[1]^2 + 2*p_q[2]^2 - 2*p_q[1]*p_q[2]*cos(q[1] - q[2]))/"
            "(2*(2 - cos(q[1] - q[2])^2)) - 9.8*(2*cos(q[1]) + cos(q[2]))")
def double_pendulum_with_a_mass_matrix(t, q, p):
    c = np.cos(q[0] - q[1])
    M = np.array([[2.0, c], [c, 1.0]])
    return 0.5 * p @ np.linalg.solve(M, p) - 9.8 * (2 * np.cos(q[0]) + np.cos(q[1]))


@with_numpy([1.0, 0.2, 0.1, 0.1, 0.9, 0.4],
            "((p_q[1] + q[2])^2 + (p_q[2] - q[1])^2 + p_q[3]^2)/2 + "
            "0.5/sqrt(q[1]^2 + q[2]^2 + q[3]^2)")
def charge_with_cross(t, y):
    r, p = y[:3], y[3:]
    A = np.cross(np.array([0.0, 0.0, 2.0]), r) / 2
    return np.dot(p - A, p - A) / 2 + 0.5 / np.linalg.norm(r)


@with_numpy([0.5, -0.3, 0.2, 0.1], "p_q[1]^2/2 + p_q[2]^2/2 + tanh(q[1])^2 + "
            "log(1 + exp(q[2])) + log(1 + exp(-q[2])) + 0.1*atan2(q[2], 3 + q[1]^2)",
            dt=0.05)
def functions_of_numpy(t, y):
    a, b = y[:2]
    return (np.square(y[2:]).sum() / 2 + np.tanh(a)**2 + np.log1p(np.exp(b))
            + np.logaddexp(0, -b) + 0.1 * np.arctan2(b, 3 + a**2))


@with_numpy([0.5, 0.1, 0.4, -0.2, 0.0, 0.1, 0.1, 0.2, -0.1, 0.0, 0.3, 0.0],
            "sum(i = 1..6, p_q[i]^2/2 + max(abs(q[i]) - 0.2, 0)^2) + "
            "sum(i = 1..5, (q[i+1] - q[i])^2/2)", dt=0.05)
def soft_walls(t, y):
    q, p = y[:6], y[6:]
    return (p**2 / 2 + np.maximum(np.abs(q) - 0.2, 0)**2).sum() + 0.5 * np.sum(
        np.diff(q)**2)


@with_numpy([1.0, 0.0, -1.0, 0.2, 0.0, 1.5, 0.0, 0.4, 0.0, -0.4, -0.3, 0.0],
            "sum(i = 1..6, p_q[i]^2/2) - g*(1/sqrt((q[1] - q[3])^2 + (q[2] - q[4])^2 + "
            "0.01) + 1/sqrt((q[1] - q[5])^2 + (q[2] - q[6])^2 + 0.01) + "
            "1/sqrt((q[3] - q[5])^2 + (q[4] - q[6])^2 + 0.01))", parameters={"g": 1.0})
def softened_bodies(t, y, g, softening=0.1):
    """All pairs in square arrays, of which the upper triangle counts."""
    x, z = y[:6].reshape(3, 2).T
    mass = np.ones((3, 1))
    dx, dz = x[None, :] - x[:, None], z[None, :] - z[:, None]
    inverse = 1.0 / np.sqrt(dx**2 + dz**2 + softening**2)
    return 0.5 * np.sum(y[6:]**2) + g * np.sum(np.triu(-(mass * mass.T) * inverse, 1))


@with_numpy([0.7, 0.4, 0.1, 0.3],
            "((1 + q[2]^2)*p_q[1]^2 - q[1]*p_q[1]*p_q[2] + (1 + q[1]^2)*p_q[2]^2)/"
            "(2*((1 + q[1]^2)*(1 + q[2]^2) - q[1]^2/4)) + "
            "log((1 + q[1]^2)*(1 + q[2]^2) - q[1]^2/4)/2 + (q[1]^2 + q[2]^2)/2", dt=0.05)
def metric_of_a_surface(t, q, p):
    """Kinetic energy by the inverse of a metric, and its determinant."""
    G = np.array([[1 + q[0]**2, q[0] / 2], [q[0] / 2, 1 + q[1]**2]])
    kinetic = np.dot(p, np.dot(LA.inv(G), p)) / 2 + np.log(LA.det(G)) / 2
    return np.squeeze(kinetic + np.linalg.norm(q)**2 / 2)


class _Body:
    def __init__(self, mass):
        self.mass = mass

    @property
    def inverse(self):
        return 1 / self.mass


class _System:
    """A base class, a property, and super()."""

    def __init__(self):
        self.bodies = [_Body(1.0), _Body(2.0)]

    def kinetic(self, p):
        return sum(0.5 * x**2 * body.inverse for x, body in zip(p, self.bodies))

    def energy(self, q, p):
        return self.kinetic(p)


@case([0.3, 0.1, 0.0, 0.5], "p_q[1]^2/2 + p_q[2]^2/4 + (q[1] - q[2])^2/2 + "
      "0.1*sin(q[1])", dt=0.05)
class Springs(_System):
    def energy(self, q, p):
        kinetic = super().energy(q, p)
        return kinetic + (q[0] - q[1])**2 / 2 + 0.1 * math.sin(q[0])

    def __call__(self, t, y):
        half = len(y) // 2
        return self.energy(y[:half], y[half:])


def _central(t, y, potential, m=1.0):
    """Rays and angles by functools.partial, with a potential that is a parameter."""
    r, phi, pr, pphi = y
    return pr**2 / (2 * m) + pphi**2 / (2 * m * r**2) + potential(r)


_yukawa = functools.partial(_central, potential=lambda r: -math.exp(-r / 2) / r)
_yukawa.__name__ = "yukawa_partial"
case([1.0, 0.0, 0.0, 0.8], "p_q[1]^2/2 + p_q[2]^2/(2*q[1]^2) - exp(-q[1]/2)/q[1]",
     dt=0.01)(_yukawa)


# What cannot be traced, for a branch changes what is computed.

@case([0.5, 0.0], None, why="it compares (<)")
def kink_by_a_branch(t, y):
    x, p = y
    if x < 0:
        return p**2 / 2 + x**2
    return p**2 / 2 + 2 * x**2


@with_numpy([0.3, 0.0], None, why="it compares (>)")
def kink_by_where(t, y):
    return y[1]**2 / 2 + np.where(y[0] > 0, y[0]**2, 2 * y[0]**2)
