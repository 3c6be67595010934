"""nevh tests: functions of Python that are traced.  Each test is a function; without
NumPy those that need it are skipped.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import abc
import cmath
import copy
import functools
import math
import numbers
import os
import random
import sys
import threading
import warnings

sys.dont_write_bytecode = True
if os.environ.get("NEVH_TEST_WITHOUT_NUMPY"):
    sys.modules["numpy"] = None
import nevh  # noqa: E402
from hamiltonians import cases, np, scene_of_text  # noqa: E402
from module import Skip, close, last, main, raised  # noqa: E402


def needs_numpy():
    if np is None:
        raise Skip("there is no NumPy")


def solved(H, case, **named):
    return nevh.solve(H, (0, 1), case.start, "gauss4", dt=case.dt, **named)


def warned(call):
    """What a call gives, and the texts of its warnings."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = call()
    return result, ["%s:%d: %s" % (w.filename, w.lineno, w.message) for w in caught]


def line_of(text):
    with open(__file__, encoding="utf-8") as file:
        return next(k for k, line in enumerate(file, 1) if text in line)


def orbit_of(H, start=(1.0, 0.2), **named):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return nevh.solve(H, (0, 1), start, "gauss4", dt=0.05, **named)


def scene_text(H, start, **named):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return nevh.Scene(H, y0=start, **named).text


def test_orbits_are_those_of_text():
    for case in cases:
        if case.why:
            continue
        mine, said = warned(lambda: solved(case.H, case, parameters=case.parameters,
                                           args=case.args))
        text = solved(scene_of_text(nevh, case), case)
        assert not said and mine.gradient == "exact", (case.name, said)
        scale = max(abs(x) for row in text.y for x in row)
        for a, b in zip(mine.y, text.y):
            assert close(a, b, 1e-9 * scale), case.name
        wrong = solved(scene_of_text(nevh, case), case, observe=lambda t, y: t > 0.3)
        assert len(wrong.t) < len(mine.t), "a run that ends early is noticed"


def test_how_many_are_traced():
    count = len(cases), sum(1 for case in cases if not case.why)
    assert np is None or count == (40, 38), count


def test_what_is_refused_has_one_warning_with_the_line():
    for case in cases:
        if case.why:
            orbit, said = warned(lambda: solved(case.H, case))
            assert len(said) == 1 and case.why in said[0], said
            assert "hamiltonians.py, line" in said[0] and "times slower" in said[0]
            assert orbit.gradient == "central4" and orbit.success


def branch(t, y):
    if y[0] > 2 or y[0] < -2:  # the line of branch
        return y[1]**2
    return y[1]**2 / 2


def loop(t, y):
    x = y[0]
    while abs(x) > 1e-3:  # the line of loop
        x = x / 2
    return y[1]**2 / 2 + x


def whole(t, y):
    return y[1]**2 / 2 + int(y[0])  # the line of whole


def rounded(t, y):
    return y[1]**2 / 2 + round(y[0], 2)  # the line of rounded


def gamma(t, y):
    return y[1]**2 / 2 + math.lgamma(3 + y[0]**2)  # the line of gamma


def table(t, y):
    known = {1.0: 2.0}
    return y[1]**2 / 2 + known.get(y[0], y[0]**2)  # the line of table


def helper(x):
    return x if x > 0 else -x  # the line of helper


def by_helper(t, y):
    return y[1]**2 / 2 + helper(y[0])


def other_way(t, y):
    x = y[0]
    if hasattr(x, "is_integer"):  # the line of other_way
        return y[1]**2 / 2 + x**2
    return y[1]**2 / 2 + x**4


def random_force(t, y):  # the line of random_force
    return y[1]**2 / 2 + y[0] * random.random()


calls = []


def counted(t, y):  # the line of counted
    calls.append(t)
    return y[1]**2 / 2 + y[0] * len(calls)


def test_reasons_have_their_lines():
    for H in (branch, loop, whole, rounded, gamma, table, helper, other_way,
              random_force, counted):
        take = by_helper if H is helper else H
        said = warned(lambda: nevh.solve(take, (0, 0.1), [1.0, 0.5], "rk4", dt=0.05,
                                         gradient_step=1e-3))[1]
        said = [text for text in said if "function of Python" in text]
        wanted = "%s:%d: " % (__file__, line_of("# the line of " + H.__name__))
        assert len(said) == 1 and said[0].startswith(wanted), (H.__name__, said)
        error = raised(nevh.Refused, "traced.py, line %s" % wanted.split(":")[1],
                       nevh.compare, take, "rk4", dt=0.1, t_end=1, y0=[1.0, 0.5])
        assert "H is no formula" in str(error)


def test_values_of_what_is_refused():
    """The slow way is right, too."""
    orbit, _ = warned(lambda: nevh.solve(branch, (0, 1), [0.5, 0.2], "rk4", dt=0.05))
    assert close(last(orbit), [0.7, 0.2], 1e-9) and orbit.gradient == "central4"


def decorated(H):
    @functools.wraps(H)
    def wrapper(*of, **named):
        return H(*of, **named)
    return wrapper


def test_signatures():
    def split(t, q, p):
        return p[0]**2 / 2 + q[0]**2

    def default(t, y, k=2.0):
        return y[1]**2 / 2 + k * y[0]**2 / 2

    def by_name(t, y, *, k):
        return default(t, y, k)

    def rest(t, y, *more, **named):
        return default(t, y, more[0] * named["k"])

    class Called:
        def __call__(self, t, y):
            return default(t, y)

        def method(self, t, y, k):
            return default(t, y, k)
    known = last(orbit_of("p_q^2/2 + q^2", coordinates=["q"]))
    for H, named in ((default, {}), (by_name, {"parameters": {"k": 2}}),
                     (default, {"args": [2]}), (default, {"parameters": {"k": 2.0}}),
                     (rest, {"args": [1], "parameters": {"k": 2.0}}),
                     (split, {}), (Called(), {}), (Called().method, {"args": (2.0,)}),
                     (functools.partial(default, k=2), {}),
                     (decorated(default), {}),
                     (lambda t, y: y[1]**2 / 2 + y[0]**2, {})):
        assert close(last(orbit_of(H, **named)), known, 1e-12), H


class Slots:
    __slots__ = ("m",)

    def __init__(self):
        self.m = 2.0

    def potential(self, x):
        return self.m * math.cos(x)


class Abstract(abc.ABC):
    strength = 2.0

    @abc.abstractmethod
    def potential(self, x):
        """What is to be written."""

    @staticmethod
    def kinetic(p):
        return sum(x * x for x in p) / 2

    @classmethod
    def factor(cls):
        return cls.strength

    def __call__(self, t, y):
        return self.kinetic(y[1:]) + self.factor() * self.potential(y[0])


class Concrete(Abstract):
    def potential(self, x):
        return math.cos(x)


def recursive(x, n):
    return x if n == 0 else math.sin(recursive(x, n - 1)) + x


def test_kinds_of_code():
    slots, functions = Slots(), {"a": lambda x: x**2, "b": [math.sin, math.cos]}

    def with_slots(t, y):
        return y[1]**2 / 2 + slots.potential(y[0])

    def with_containers(t, y):
        return y[1]**2 / 2 + functions["a"](y[0]) + sum(f(y[0]) for f in functions["b"])

    def with_imports(t, y):
        import math
        from math import sqrt as root
        return y[1]**2 / 2 + math.sin(y[0]) + root(1 + y[0]**2) + float(abs(y[0]))

    def with_numbers(t, y):
        whole, rest = divmod(y[0], 1.0)
        return (y[1]**2 / 2 + rest**2 + max(y[0], 0.1, 0.2) + pow(y[0], 3) + y[0] % 2.5
                + (y[0] - round(y[0]))**2)

    def with_state(t, y):
        count = 0

        def power(x):
            nonlocal count
            count += 1
            return x**count
        return y[1]**2 / 2 + power(y[0]) + power(y[0]) + recursive(y[0], 3)
    for H in (with_slots, Concrete(), with_containers, with_imports, with_numbers,
              with_state):
        assert orbit_of(H).gradient == "exact"


def test_kinds_of_arrays():
    needs_numpy()
    tanh = np.vectorize(lambda x: math.tanh(x))

    def vectorized(t, y):
        return y[2:] @ y[2:] / 2 + tanh(y[:2]).sum()

    def lists(t, y):
        mixed = [y[0], 2.0]
        return (np.cos(mixed).sum() + np.prod(mixed) + y[2:] @ y[2:] / 2
                + np.sum(np.sqrt(np.array([y[1], 1.0])**2 + 1)))

    def filled(t, y):
        M, total = np.eye(2), np.zeros(1)
        M[0, 1] = M[1, 0] = 0.1 * y[0]
        total += y[2:] @ np.linalg.inv(M + np.eye(2)) @ y[2:]
        return total + np.linalg.det(M)

    def pairs(t, y):
        x = y[:2]
        apart = np.sqrt((x[:, None] - x[None, :])**2 + np.eye(2))
        others = ~np.eye(2, dtype=bool)
        return np.dot(y[2:], y[2:]) / 2 - np.sum(1 / apart[others]) / 2

    def selected(t, y):
        x = np.asarray(y, dtype=float)[[0, 1]]
        return (np.where(np.arange(2) > 0, x, 0).sum() + x.max() + np.clip(x, -1, 1).sum()
                + np.outer(x, x).trace() + np.polyval([1, 2, 3.0], x[0])
                + np.linalg.norm(y[2:])**2)
    for H in (vectorized, lists, filled, pairs, selected):
        assert "[effects]" in scene_text(H, [0.3, 0.8, 0.1, 0.4]), H


def same_values(H, start, **named):
    """Whether the formula has the values of the function, its gradient that of
    differences."""
    scene = nevh.Scene(H, y0=start, **named)
    draw = random.Random(7)
    field = nevh.HGrad(scene, gradient="exact")
    for _ in range(5):
        y = [x + draw.uniform(-0.3, 0.3) for x in start]
        slopes = field(0.0, np.array(y))
        n, d = len(y) // 2, 1e-6
        for k in range(2 * n):
            ahead, behind = np.array(y), np.array(y)
            ahead[k] += d
            behind[k] -= d
            slope = (H(0.0, ahead) - H(0.0, behind)) / (2 * d)
            mine = -slopes[k + n] if k < n else slopes[k - n]
            assert abs(slope - mine) < 1e-6 * (1 + abs(slope)), (H.__name__, k, slope, mine)
    return scene


def test_complex_numbers():
    needs_numpy()

    def planar(t, y):
        z, w = y[0] + 1j * y[1], complex(y[2], y[3])
        return abs(w)**2 / 2 + (z * z.conjugate()).real + 0.1 * (z**3).imag - 1 / abs(z - 3)

    def lattice(t, y):
        psi = (y[:3] + 1j * y[3:]) / np.sqrt(2)
        hops = np.sum(psi.conj() * np.roll(psi, 1))
        return np.sum(np.abs(psi)**4) - 2 * hops.real + np.vdot(psi, psi).real

    def polar(t, y):
        z = cmath.exp(1j * y[0]) * (2 + y[1]) / (1 + 1j * y[1])
        return (y[2:] @ y[2:]) / 2 + cmath.phase(z)**2 + np.linalg.norm([z, 1 + 2j]) + \
            np.angle(z) + cmath.sqrt(z).real + (z**-2).imag + np.real(z) * np.imag(z)
    same_values(planar, [0.5, 0.4, 0.1, 0.3])
    same_values(lattice, [0.5, 0.4, 0.1, 0.3, 0.2, -0.3])
    same_values(polar, [0.5, 0.4, 0.1, 0.3])
    for wrong, text in ((lambda t, y: y[1]**2 + (y[0] + 1j), "no real number"),
                        (lambda t, y: y[1]**2 if y[0] + 1j == 2 else 0.0, "compares")):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # NumPy's, of the numbers themselves
            raised((nevh.Refused, TypeError), text, nevh.Scene, wrong, y0=[0.5, 0.2])


def test_more_of_numpy():
    needs_numpy()

    def sums(t, y):
        q, p = y[:3], y[3:]
        some = np.zeros(3)
        np.add.at(some, [0, 0, 2], q)
        return (np.einsum("...i,...i", p, p) / 2 + np.einsum(q, [0], q, [0], []) +
                np.sum(q**4, where=[True, False, True]) + np.sum(q, initial=2.0) +
                np.sum(np.outer(q, q), axis=(0, 1), keepdims=True)[0, 0] + some @ some +
                np.nansum(q) + np.mean(np.outer(q, q), axis=(0, 1)) + np.prod(1 + q))

    def matrices(t, y):
        q, p = y[:2], y[2:]
        M = np.array([[2 + q[0]**2, 0.3 * q[1]], [0.3 * q[1], 1.5]])
        return (p @ p / 2 + np.linalg.eigvalsh(M)[0] + np.linalg.slogdet(M)[1] +
                q @ np.linalg.matrix_power(M, 2) @ q + np.linalg.multi_dot([q, M, q]))

    def elements(t, y):
        q, p = y
        assert np.isfinite(y).all() and not math.isnan(q)
        q, p = copy.deepcopy([q, p])
        return (p**2 / 2 + np.interp(q, [-9, 0, 0.3, 9], [5.0, 0.1, 1, 20]) + np.sinc(q) +
                math.copysign(q**2, q) + math.fmod(q, 5.0) + np.copysign(p, q))
    for H, start in ((sums, [0.5, 0.4, 0.1, 0.3, 0.2, -0.3]),
                     (matrices, [0.5, 0.4, 0.1, 0.3]), (elements, [0.7, 0.4])):
        same_values(H, start)
    raised(nevh.Refused, "formulas have no numpy.linalg.eigh", nevh.Scene,
           lambda t, y: y[1]**2 + np.linalg.eigh(np.array([[y[0], 1], [1, 2]]))[0][0],
           y0=[1, 0])
    for alien in (lambda y: math.erf(y[0]), lambda y: int(y[0]), lambda y: round(y[0], 2),
                  lambda y: float("%g" % y[0]), lambda y: 0 if y[0] > 0 else 1):
        said = str(raised(nevh.Refused, "", nevh.Scene,
                          lambda t, y, alien=alien: y[1]**2 + alien(y), y0=[1, 0]))
        assert "(write H as one formula of " in said or "(formulas have " in said, said


def test_names_are_those_of_the_function():
    def unpacked(t, y):
        r, phi, p_r, p_phi = y
        return p_r**2 / 2 + p_phi**2 / (2 * r**2) - math.cos(phi)

    def indexed(t, y):
        theta = y[0]
        return y[1]**2 / 2 - math.cos(theta)

    def halves(t, y):
        (x, z), (px, pz) = y[:2], y[2:]
        return px**2 / 2 + pz**2 / 2 + x**2 * z

    def clashes(t, y, x=1.0):
        sin, p = y
        return p**2 / 2 + x * sin**2

    def partly(t, y):
        a = y[0]
        return (y[2]**2 + y[3]**2) / 2 + a * y[1]

    def rows(t, x, p):
        return sum(v**2 for v in p) / 2 + x[0]**2 * x[1]
    for H, names in ((unpacked, ["r", "phi"]), (indexed, ["theta"]), (halves, ["x", "z"]),
                     (clashes, ["q"]), (partly, ["q[1]", "q[2]"]), (rows, ["x[1]", "x[2]"])):
        start = [1.0, 0.5] * len(names)
        for _ in range(12):  # code that has run often is another
            H(0.0, start[:2], start[2:]) if H is rows else H(0.0, start)
        assert nevh.Scene(H, y0=start).names[:len(names)] == names, H.__name__


def test_parameters_stay_parameters():
    def H(t, y, k, n, power=2, **more):
        return y[1]**2 / 2 + k * sum(y[0]**power / n for _ in range(n)) + more["c"] * y[0]
    text = scene_text(H, [1, 0], parameters={"k": 3.5, "n": 4, "c": 0.25})
    assert "k = 3.5" in text and "c = 0.25" in text and "\nn = " not in text
    needs_numpy()
    given = {"k": 3.5, "n": 4, "c": 0.25}
    swept = nevh.sweep(H, {"k": [1.0, 2.0]}, "last(q)", "verlet", dt=0.01, t_end=1,
                       y0=[1, 0], parameters=given)["last(q)"]
    for k, q in zip((1.0, 2.0), swept):
        given["k"] = k
        assert last(nevh.solve(H, (0, 1), [1, 0], "verlet", dt=0.01,
                               parameters=given))[0] == q


def test_names_that_scenes_have_taken():
    def H(t, y, pi=3.0, sin=2.0, q=1.5, p_q=0.5):
        return y[1]**2 / 2 + pi * y[0]**2 + math.sin(sin * y[0]) * q + p_q * y[0]
    text = "p_x^2/2 + 3*x^2 + 1.5*sin(2*x) + x/2"
    assert close(last(orbit_of(H)), last(orbit_of(text)), 1e-12)
    named = orbit_of(lambda t, y, east=0.5: y[1]**2 / 2 + east * y[0]**2, [1, 0],
                     coordinates=["east"])
    assert close(last(named), last(orbit_of("p_x^2/2 + x^2/2", [1, 0])), 1e-12)

    def asking(t, y):
        x = y[0]
        return y[1]**2 / 2 + (x**2 if isinstance(x, (float, numbers.Real)) else math.nan)
    orbit_of(asking)
    named = orbit_of(lambda t, y: y[2]**2 / 2 + y[3]**2 / 2 + y[0] * y[1],
                     [1, 0, 0, 1], coordinates=["east", "north"])
    assert named.names == ["east", "north", "p_east", "p_north"]


def test_a_chain_is_one_sum():
    """The text does not grow with the chain, and definitions do not explode."""
    def chain(t, y):
        n = len(y) // 2
        return sum(y[n + i]**2 / 2 for i in range(n)) + sum(
            (y[i + 1] - y[i])**4 / 4 for i in range(n - 1))
    effects = scene_text(chain, [0.1] * 400).split("[effects]")[1]
    assert effects.count("sum(") == 2 and len(effects) < 300

    def nested(t, y):
        x = y[0]
        for _ in range(60):
            x = math.sin(x + x * x) + math.cos(x)
        return y[1]**2 / 2 + x
    assert len(scene_text(nested, [0.3, 0])) < 5000
    orbit_of(nested, (0.3, 0.1))


def test_zeros_join_no_variables():
    needs_numpy()
    springs = np.diag([1.0, 2.0, 3.0])

    def H(t, y):
        return 0.5 * y[3:] @ y[3:] + 0.5 * y[:3] @ springs @ y[:3]
    effects = scene_text(H, [0.1] * 6).split("[effects]")[1]
    assert "q[1]*q[2]" not in effects and "0*" not in effects.replace("10*", "")


def test_time_and_dependence():
    orbit = orbit_of(lambda t, y: y[1]**2 / 2 - y[0] * math.cos(t))
    text = orbit_of("p_x^2/2 - x*cos(t)")
    assert close(last(orbit), last(text), 1e-13)
    assert orbit.energy_error == text.energy_error


def test_nothing_of_the_users_changes():
    seen = []

    class H:
        count = 0

        def __call__(self, t, y):
            self.count += 1
            return y[1]**2 / 2 + math.cos(y[0])
    before = math.sin, math.cos, globals()["math"], abs, max
    stop, wrong = threading.Event(), []

    def watch():
        while not stop.is_set():
            if math.cos is not before[1] or globals()["math"] is not before[2]:
                wrong.append(1)
    thread = threading.Thread(target=watch)
    thread.start()
    h = H()
    for _ in range(5):
        seen.append(orbit_of(h).energy_error)
    stop.set()
    thread.join()
    assert not wrong and (math.sin, math.cos, math, abs, max) == before
    assert h.__class__ is H and isinstance(h.count, int)


strength = 2.0


def reads_a_global(t, y):
    return y[1]**2 / 2 + strength * y[0]**2 / 2


def test_a_function_that_reads_something_else_is_traced_again():
    global strength
    for strength in (2.0, 3.0, 3.0, 2.0):
        known = orbit_of("p_q^2/2 + %r*q^2/2" % strength, coordinates=["q"])
        assert close(last(orbit_of(reads_a_global)), last(known), 1e-12)
    box = [1.0]

    def H(t, y, k=1.0):
        return y[1]**2 / 2 + box[0] * k * y[0]**2 / 2
    for box[0], k in ((1.0, 1.0), (4.0, 1.0), (4.0, 2), (1.0, 2.0), (1.0, 1)):
        known = orbit_of("p_q^2/2 + %r*q^2/2" % (box[0] * k), coordinates=["q"])
        mine = orbit_of(H, parameters={"k": k})
        assert close(last(mine), last(known), 1e-12), (box, k)
    assert orbit_of(H, coordinates=["x"]).names == ["x", "p_x"]
    assert orbit_of(H, [1, 0.1]).names == ["q", "p_q"]


def test_the_papers_listing():
    """Listing 1 and solve, which takes the object as well."""
    def H(t, s, k, m):
        x, p = s
        return 0.5 * k * x**2 + 0.5 * p**2 / m
    G = nevh.HGrad(H, [0.1, 0.1], k=4 * math.pi**2, m=1.0)
    assert close(list(G(0.0, [1.0, 0.0])), [0, -4 * math.pi**2], 1e-12)
    assert not G._subject.calls_python
    orbit = nevh.solve(G, [0.0, 3.0], [1.0, 0.0])
    assert close(last(orbit), [1, 0], 1e-6)
    with open(os.path.join(os.path.dirname(__file__), "..", "..", "examples", "paper",
                           "listing1.py"), encoding="utf-8") as file:
        listing = {}
        exec(compile(file.read(), file.name, "exec"), listing)
    assert listing["long"].energy_error < 1e-6 and listing["long"].success
    steps = nevh.solve(G, [0.0, 3.0], [1.0, 0.0], "rk4", dt=0.01)
    assert steps.gradient == "central4" and close(last(steps), [1, 0], 1e-3)


def test_commands_take_functions():
    """With the numbers of the same H as text."""
    def H(t, y, k=2.0):
        return y[1]**2 / 2 - k * math.cos(y[0])
    mine = nevh.compare(H, ["verlet", "rk4"], dt=0.1, t_end=5, y0=[1, 0])
    text = nevh.compare("p_q^2/2 - k*cos(q)", ["verlet", "rk4"], dt=0.1, t_end=5,
                        y0=[1, 0], parameters={"k": 2.0}, coordinates=["q"])
    for name in ("max_energy_error", "state_error", "gradient_evals", "verdict"):
        assert list(mine[name]) == list(text[name]), name
    assert "but q" not in " ".join(mine.notes)
    if np is not None:
        given = dict(dt=0.1, t_end=5, y0=[1, 0])
        swept = nevh.sweep(H, {"q": [0.5, 1.0]}, "last(q)", "verlet", **given)
        other = nevh.sweep("p_q^2/2 - k*cos(q)", {"q": [0.5, 1.0]}, "last(q)", "verlet",
                           parameters={"k": 2.0}, coordinates=["q"], **given)
        assert list(swept["last(q)"]) == list(other["last(q)"])


def test_errors_of_the_function_are_its_own():
    def H(t, y):
        return 1 / 0 if y[1] == 0 else y[1]
    raised(ZeroDivisionError, "", nevh.solve, H, (0, 1), [1.0, 0.0], "rk4", dt=0.1)
    raised(ZeroDivisionError, "", nevh.compare, H, "rk4", dt=0.1, t_end=1, y0=[1, 0])
    raised(TypeError, "missing", nevh.compare, lambda t, y, k: y[1]**2, dt=0.1, t_end=1,
           y0=[1, 0])


if __name__ == "__main__":
    sys.exit(main(globals()))
