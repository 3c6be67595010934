"""nevh tests: the package python/nevh.  Each test is a function; without NumPy or SciPy those
that need it are skipped.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import copy
import ctypes
import math
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

sys.dont_write_bytecode = True
if os.environ.get("NEVH_TEST_WITHOUT_NUMPY"):
    sys.modules["numpy"] = None
import nevh  # noqa: E402

from nevh._arrays import np  # noqa: E402
try:
    import scipy.integrate as scipy_integrate
except ImportError:
    scipy_integrate = None

PENDULUM = "p_phi^2/2 - cos(phi)"


def needs(what):
    missing = np is None if what == "NumPy" else scipy_integrate is None
    if missing:
        raise Skip("there is no " + what)


class Skip(Exception):
    pass


def raised(kind, text, function, *arguments, **named):
    try:
        function(*arguments, **named)
    except kind as error:
        assert text in str(error), "%r is not in %r" % (text, str(error))
        return error
    raise AssertionError("%s was not raised" % kind.__name__)


def close(a, b, tolerance):
    return all(abs(x - y) <= tolerance for x, y in zip(a, b)) and len(a) == len(b)


def last(orbit):
    return [row[-1] for row in orbit.y]


def rows_of(array):
    return [list(row) for row in array]


def command_rows(*arguments):
    done = subprocess.run([nevh.command(), *arguments], stdout=subprocess.PIPE,
                          check=True, text=True)
    return [line.split(",") for line in done.stdout.splitlines()
            if not line.startswith("#")][1:]


# H as text, and scenes.

def test_orbit_is_that_of_the_command():
    orbit = nevh.solve("pendulum", (0, 5), method="rk4", dt=0.1)
    rows = command_rows("run", "pendulum", "--integrators", "rk4", "--dt", "0.1",
                        "--t-end", "5")
    assert len(rows) == len(orbit.t) == 51
    for i, row in enumerate(rows):
        wanted = [float(cell) for cell in row[:3]]
        assert [orbit.t[i], orbit.y[0][i], orbit.y[1][i]] == wanted
    assert orbit.names == ["phi", "p_phi"] and orbit.nfev == 200


def test_times_between_steps_are_those_of_the_command():
    times = [0.0, 0.05, 0.7, 3.33, 5.0]
    orbit = nevh.solve("pendulum", (0, 5), method="verlet", dt=0.1, t_eval=times)
    rows = command_rows("run", "pendulum", "--integrators", "verlet", "--dt", "0.1",
                        "--t-end", "5", "--at", ",".join(map(repr, times)))
    assert [[float(cell) for cell in row[1:3]] for row in rows] == \
        [[orbit.y[0][i], orbit.y[1][i]] for i in range(5)]


def test_taylor_reads_states_off_its_series():
    """Forward and back, in time or not; rounding is all that differs from runs that
    end at these times."""
    for H, y0 in ((PENDULUM, [2, 0]), ("p_x^2/2 - cos(x)*(1 + 0.3*cos(t))", [2, 0.1])):
        for span in ((0, 12), (3, -9)):
            count = 400
            times = [span[0] + (span[1] - span[0]) * i / count for i in range(count + 1)]
            named = {"method": "taylor", "rtol": 1e-12}
            plain = nevh.solve(H, span, y0, dt=0.5, t_eval=[span[1]], **named)
            dense = nevh.solve(H, span, y0, dt=0.5, t_eval=times, **named)
            assert len(dense.t) == count + 1
            # None more; where H reads t, not more than again as many.
            most = plain.nfev if H == PENDULUM else 2 * plain.nfev
            assert plain.nfev <= dense.nfev <= most, (plain.nfev, dense.nfev)
            assert last(dense) == last(plain)
            for i in range(7, count, 57):
                alone = nevh.solve(H, (span[0], times[i]), y0, dt=0.5, t_eval=[times[i]],
                                   **named)
                assert close([row[i] for row in dense.y], last(alone), 1e-13)


def test_taylor_keeps_what_comes_before_a_failure():
    times = [0.05 * i for i in range(101)]
    orbit = nevh.solve("p_x^2/2 - 1/x", (0, 5), [1, -0.5], "taylor", dt=5, rtol=1e-6,
                       t_eval=times, check=False)
    assert orbit.status == -1 and "the step of 5 " in orbit.message
    assert list(orbit.t) == times[:16] and times[15] < 0.759 < times[16]
    assert all(math.isfinite(x) for row in orbit.y for x in row)


def test_result_has_scipy_names():
    orbit = nevh.solve(PENDULUM, (0, 10), [2, 0])
    for name in ("t", "y", "nfev", "status", "message", "success", "sol",
                 "energy_error", "verdict"):
        assert name in orbit and getattr(orbit, name) is orbit[name]
    assert orbit.status == 0 and orbit.success and orbit.method == "taylor"
    assert orbit.energy_error < 1e-12
    raised(AttributeError, "nothing", lambda: orbit.nothing)


def test_verdicts_differ():
    arguments = (PENDULUM, (0, 500), [2, 0])
    verlet = nevh.solve(*arguments, "verlet", dt=0.1)
    rk4 = nevh.solve(*arguments, "rk4", dt=0.1)
    assert verlet.verdict == "bounded" and rk4.verdict == "drifts"
    assert verlet.energy_error < 0.02


def test_verdicts_are_those_of_the_command():
    """Of runs that are too short to tell, too: both take a longer one."""
    methods = ["verlet", "gauss4", "rk4", "euler"]
    longer = 0
    for scene, dt, t_end in (("pendulum", 0.1, 8), ("pendulum", 0.4, 30),
                             ("henon-heiles", 0.3, 30), ("kepler", 0.05, 12),
                             ("double-pendulum", 0.02, 5)):
        rows = nevh.compare(scene, methods, dt=dt, t_end=t_end)
        for row in rows:
            if row["status"].startswith("refused"):
                continue
            orbit = nevh.solve(scene, (0, t_end), method=row["integrator"], dt=dt,
                               t_eval=[t_end], check=False)
            longer += not dict.__contains__(orbit, "verdict")
            assert orbit.verdict == row["verdict"], (scene, row, orbit.verdict)
            assert dict.__contains__(orbit, "verdict")
    assert longer >= 6, longer


def test_verdict_is_an_item_also_where_a_longer_run_finds_it():
    import pickle

    def short(H="pendulum"):
        return nevh.solve(H, (0, 8), [2, 0], "verlet", dt=0.1)
    known = nevh.compare("pendulum", ["verlet"], dt=0.1, t_end=8)["verdict"][0]
    assert known != "undecided"
    for take in (lambda o: o.verdict, lambda o: o["verdict"], lambda o: o.get("verdict"),
                 lambda o: dict(o.items())["verdict"], lambda o: dict(**o)["verdict"],
                 lambda o: np is None or pickle.loads(pickle.dumps(o)).verdict == known,
                 lambda o: o.copy()["verdict"], lambda o: known in repr(o)):
        assert take(short()) in (known, True)
    assert "verdict" in short() and "verdict" in list(short())
    assert short().get("nothing", 3) == 3 and "nothing" not in short()
    assert nevh.solve(PENDULUM, (0, -8), [2, 0], "verlet", dt=0.1).verdict == known

    def slow(t, y):
        return y[1]**2/2 - (9.8*math.cos(y[0]) if t < 100 else 0)
    assert short(slow).verdict == "undecided"


def test_backwards():
    there = nevh.solve(PENDULUM, (0, 3), [2, 0], "blanes-moan6", dt=0.01)
    back = nevh.solve(PENDULUM, (3, 0), last(there), "blanes-moan6", dt=0.01)
    assert close(last(back), [2, 0], 1e-12) and back.t[0] == 3 and back.t[-1] == 0


def test_parameters_and_names():
    H = "p_x^2/(2*m) + k/2*x^2 - E*x"
    orbit = nevh.solve(H, (0, math.pi), {"x": 1, "p_x": 0}, "gauss12", dt=0.1,
                       parameters={"m": 1, "k": 4, "E": "k/2"})
    assert close(last(orbit), [1, 0], 1e-11)
    q = nevh.solve("p^2/2 + q^2/2", (0, math.pi), [1, 0])
    assert close(last(q), [-1, 0], 1e-9)
    two = nevh.solve("p_b^2/2 + p_a^2/2 + a*b", (0, 1), [1, 2, 3, 4])
    assert two.names == ["b", "a", "p_b", "p_a"]
    array = nevh.solve("sum(i = 1..3, p_x[i]^2/2 + c[i]*x[i]^2/2)", (0, math.pi),
                       [1, 1, 1, 0, 0, 0], parameters={"c": [1, 4, 9]},
                       coordinates=["x[3]"])
    assert close(last(array), [-1, 1, -1, 0, 0, 0], 1e-8)


def test_effects():
    free = nevh.solve("pendulum", (0, 1), [0, 1], "verlet", dt=0.1,
                      without_effects="gravity")
    assert close(last(free), [1, 1], 1e-14)
    raised(nevh.Refused, "gravitation", nevh.solve, "pendulum", (0, 1),
           with_effects=["gravitation"])


def test_scene_starts():
    scene = nevh.Scene("pendulum", parameters={"start": 1})
    assert list(scene.start()) == [1, 0]
    assert list(scene.start({"p_phi": 2})) == [1, 2]
    assert list(scene.start()) == [1, 0]  # as before
    assert nevh.solve(scene, (0, 1), {"phi": 0.5}).y[0][0] == 0.5
    assert nevh.solve(scene, (0, 1)).y[0][0] == 1
    raised(nevh.Refused, "when a Scene is made", nevh.solve, scene, (0, 1),
           parameters={"g": 1})
    assert "start = 1.0" in scene.text
    assert nevh.Scene(scene.text).names == ["phi", "p_phi"]


def test_a_formula_has_the_default_tolerance():
    assert nevh.solve(PENDULUM, (0, 1), [1, 0], "dop853").tolerance == 1e-9


def test_defaults_without_a_method():
    assert nevh.solve(PENDULUM, (0, 1), [1, 0], dt=0.1).method == "verlet"
    mixed = nevh.solve("p_x^2*(1 + x^2)", (0, 1), [1, 1], dt=0.1)
    assert mixed.method == "gauss4"
    assert nevh.solve("pendulum", (0, 1)).method == "verlet"


def test_formulas_that_are_not_analytic_need_no_method():
    period = 4 * math.sqrt(3)
    orbit = nevh.solve("p_x^2/2 + abs(x)", (0, period), [1.5, 0])
    assert orbit.method == "dop853" and orbit.gradient == "exact", orbit
    assert close(last(orbit), [1.5, 0], 1e-4), last(orbit)
    for text in ("p_x^2/2 + max(x, 1)^2", "p_x^2/2 + min(x, 2)^2", "p_x^2/2 + bessel_j0(x)",
                 "abs(p_x)^3 + x^2", "p_x^2/2 + abs(x)*cos(t)"):
        assert nevh.solve(text, (0, 1), [1.5, 0.1]).method == "dop853", text
    raised(nevh.Refused, "abs", nevh.solve, "p_x^2/2 + abs(x)", (0, 1), [1, 0], "taylor")


def test_tolerances():
    exact = last(nevh.solve("double-pendulum", (0, 5), method="taylor", rtol=1e-15))
    errors = [max(abs(x - y) for x, y in zip(exact, last(nevh.solve(
        "double-pendulum", (0, 5), method="DOP853", dt=1, **named))))
        for named in ({"rtol": 1e-5}, {"rtol": 1e-9}, {"rtol": 1e-5, "atol": 1e-9})]
    assert errors[0] > 1e-6 and errors[1] < 1e-7 and errors[2] < 1e-7, errors


def test_a_scene_may_stop():
    text = nevh.Scene("pendulum").text + "stop = phi < 0\n"
    orbit = nevh.solve(text, (0, 10), method="verlet", dt=0.01)
    assert orbit.status == 1 and orbit.success and "phi < 0" in orbit.message
    assert orbit.y[0][-1] < 0 <= orbit.y[0][-2] and orbit.t_reached == orbit.t[-1]


def test_friction_and_time_have_a_balance():
    orbit = nevh.solve("damped-driven-pendulum", (0, 20), method="rk4", dt=0.01)
    assert orbit.energy_error < 1e-6


# What is refused.

def test_refusals():
    solve = nevh.solve
    error = raised(nevh.Refused, "H, column 9: there is no function coss", solve, "p^2/2 - coss(q)", (0, 1), [1, 0])
    assert "did you mean cos" in str(error) and isinstance(error, ValueError)
    raised(nevh.Refused, "length 3; it takes 2 numbers: phi, p_phi", solve, PENDULUM,
           (0, 1), [1, 0, 0])
    raised(nevh.Refused, "no method 'verlett'", solve, PENDULUM, (0, 1), [1, 0],
           "verlett", dt=0.1)
    raised(nevh.Refused, "give it", solve, PENDULUM, (0, 1), [1, 0], "verlet")
    raised(nevh.Refused, "no tolerance", solve, PENDULUM, (0, 1), [1, 0], "verlet",
           dt=0.1, rtol=1e-9)
    raised(nevh.Refused, "mixes coordinates and momenta", solve, "double-pendulum",
           (0, 1), method="verlet", dt=0.1)
    raised(nevh.Refused, "no time to go", solve, PENDULUM, (1, 1), [1, 0])
    raised(nevh.Refused, "no gradient", solve, PENDULUM, (0, 1), [1, 0],
           gradient="central3")
    raised(nevh.Refused, "t_eval[1] = 2 is not within", solve, PENDULUM, (0, 1), [1, 0],
           t_eval=[0, 2])
    raised(nevh.Refused, "no momentum", solve, "x^2", (0, 1), [1, 0])
    raised(nevh.Refused, "nowhere.nevh", solve, "nowhere.nevh")
    raised(nevh.Refused, "dt = -0.1", solve, PENDULUM, (0, 1), [1, 0], "rk4", dt=-0.1)
    raised(nevh.Refused, "dt = nan", solve, PENDULUM, (0, 1), [1, 0], "rk4",
           dt=math.nan)
    raised(nevh.Refused, "as many momenta", solve, lambda t, y: 0, (0, 1), [1, 0, 2])
    raised(TypeError, "H is a text", solve, 3.5, (0, 1), [1, 0])


def test_arguments_are_named_where_they_are_wrong():
    """All of them raise what Python has for it, and say which argument it was."""
    def of(H=PENDULUM, t_span=(0, 3), y0=(2, 0), method="verlet", dt=0.1, **named):
        return lambda: nevh.solve(H, t_span, y0, method, dt=dt, **named)

    def value(t, y):
        return 0.0
    refused = nevh.Refused
    for kind, text, call in (
            (refused, "t_eval[1] = 2 is not in the order", of(t_eval=[3, 2, 1])),
            (refused, "it comes after 0", of(t_span=(3, 0), t_eval=[0, 1])),
            (refused, "t_eval[1] = nan", of(t_eval=[1, math.nan])),
            (refused, "t_eval takes real numbers", of(t_eval="1,2")),
            (refused, "t_eval takes real numbers", of(t_eval=iter([1, 2]))),
            (refused, "y0[0], the start of phi, is nan", of(y0=[math.nan, 0])),
            (refused, "y0[1] is inf", of(value, y0=[0, math.inf])),
            (refused, "y0 takes real numbers", of(y0=[1 + 1j, 0])),
            (refused, "y0 takes real numbers", of(y0=["a", "b"])),
            (refused, "length 1; it takes 2 numbers", of(y0=2.0)),
            (refused, "as many momenta", of(value, y0=2.0)),
            (refused, "psi", of(y0={"psi": 1})),
            (refused, "a formula needs t_span and y0", of(y0=None)),
            (refused, "a formula needs t_span and y0", of(t_span=None)),
            (refused, "t_span = 5: it takes two times", of(t_span=5)),
            (refused, "t_span = (0, 1, 2)", of(t_span=(0, 1, 2))),
            (refused, "t_span[1] = 'b'", of(t_span=(0, "b"))),
            (refused, "dt = '0.1' is not a real number", of(dt="0.1")),
            (refused, "did you mean verlet?", of(method="verlat")),
            (refused, "DOP853 and RK45", of(method="Radau", dt=None)),
            (TypeError, "method is a text, not 7", of(method=7)),
            (refused, "rtol = 0", of(method="RK45", rtol=0)),
            (refused, "atol = -1", of(method="RK45", atol=[1, -1])),
            (TypeError, "gradient is a text", of(gradient=3)),
            (refused, "g = nan is not finite", of(parameters={"g": math.nan})),
            (refused, "there is no value for g", of(parameters={"g": []})),
            (refused, "no scene 'pendulumm' (did you mean pendulum?)",
             of("pendulumm")),
            (TypeError, "one of without_effects is a text", of("pendulum", without_effects=[3])),
            (refused, "neither effects", of(value, without_effects=["gravity"])),
            (TypeError, "H = True is a number", of(True)),
            (TypeError, "H = 12345 is a number", of(12345)),
            (TypeError, "is not the address", of(ctypes.c_void_p(0))),
            (refused, "takes printable text", of(parameters={"g\nh": 1})),
            (refused, "takes printable text", of(parameters={"g": "1 # 2"})),
            (refused, "the name 'g = 2' has a =", of(parameters={"g = 2": 1})),
            (refused, "is not a real number", of(rtol=10 ** 400, method="RK45")),
            (refused, "takes real numbers", of(y0=[10 ** 400, 0])),
            (TypeError, "not 'bytes'", of(b"p^2/2")),
            (refused, "every = 0", of(observe=print, every=0)),
            (TypeError, "observe is a function", of(observe=3)),
            (refused, "a function needs y0", lambda: nevh.compare(value)),
            (TypeError, "not 'int'", lambda: nevh.compare(3)),
            (refused, "needs y0 and t_end", lambda: nevh.compare(PENDULUM, "verlet"))):
        raised(kind, text, call)
    for y0 in ((2, 0), [2, 0], {"phi": 2}):
        assert nevh.solve(PENDULUM, (0, 1), y0, "verlet", dt=0.1).y[0][0] == 2
    once = nevh.solve(PENDULUM, (0, 3), [2, 0], "verlet", dt=0.1, t_eval=2)
    twice = nevh.solve(PENDULUM, (0, 3), [2, 0], "verlet", dt=0.1, t_eval=[1, 2, 2])
    assert last(once) == last(twice) == [row[1] for row in twice.y]
    none = nevh.solve(PENDULUM, (0, 3), [2, 0], "verlet", dt=0.1, t_eval=[])
    assert len(none.t) == 0 and [len(row) for row in none.y] == [0, 0]
    assert "pendulum" in nevh.scenes() and len(nevh.scenes()) >= 28


def test_arrays_of_any_kind():
    needs("NumPy")
    asked = [nevh.solve(PENDULUM, span, y0, "verlet", dt=dt, t_eval=times,
                        parameters={"g": np.array(9.8)})
             for span, y0, dt, times in (
                 ((0, 3), [2, 0], 0.25, [0, 1, 2, 3]),
                 (np.array([0, 3]), np.array([2, 9, 0, 9], np.float32)[::2],
                  np.float32(0.25), np.arange(4)))]
    for orbit in asked:
        assert orbit.y.dtype == orbit.t.dtype == float and orbit.y.shape == (2, 4)
        assert (orbit.y == asked[0].y).all()
    none = nevh.solve(PENDULUM, (0, 3), [2, 0], "verlet", dt=0.1, t_eval=[])
    assert none.y.shape == (2, 0)
    raised(nevh.Refused, "y0 has the shape (2, 1, 1)", nevh.solve, PENDULUM, (0, 1),
           np.ones((2, 1, 1)), "verlet", dt=0.1)
    loose = nevh.solve(PENDULUM, (0, 3), [2, 0], "RK45", rtol=1e-3, atol=[1e-7, 1e-8])
    assert loose.tolerance == 5e-9
    G = nevh.HGrad(PENDULUM)
    assert G(0, np.empty((2, 0))).shape == (2, 0)
    assert list(G(0, [1, 2])) == list(G(0, [1.0, 2.0]))
    raised(nevh.Refused, "(2, 2, 2) of float64", G, 0, np.ones((2, 2, 2)))
    raised(nevh.Refused, "complex128", G, 0, np.array([1j, 0]))
    raised(nevh.Failed, "y[1] is nan", G, 0, [0, math.nan])


def test_copies_have_a_library_object_of_their_own():
    import copy
    import pickle
    scene = nevh.Scene("p_x^2/2 + k*x^2/2", {"k": 4})
    G = nevh.HGrad("double-pendulum", gradient="exact", without_effects=())
    y = [1.0, 2.0, 3.0, 4.0]
    for take in (copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))):
        other = take(scene)
        assert other._made != scene._made and other.names == scene.names
        assert other.is_formula and last(nevh.solve(other, (0, 1), [1, 0])) == \
            last(nevh.solve(scene, (0, 1), [1, 0]))
        assert list(take(G)(0, y)) == list(G(0, y))
        assert take(nevh.Scene("pendulum")).path == nevh.Scene("pendulum").path


def test_threads():
    """Each has its own orbit; a scene may be shared."""
    scene = nevh.Scene("pendulum")

    def mine(t, y):
        return y[1] ** 2 / 2 - math.cos(y[0])
    ends = {}

    def run(k):
        try:
            ends[k] = [last(nevh.solve(H, (0, 20), [2, 0], "verlet", dt=0.05,
                                       t_eval=[20])) for H in (scene, PENDULUM, mine)]
        except BaseException as error:
            ends[k] = error
    threads = [threading.Thread(target=run, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    run("alone")
    assert all(ends[k] == ends["alone"] for k in range(4)), ends


def test_a_step_that_fails():
    wall = "p^2/2 + log(1 - q)"
    error = raised(nevh.Failed, "", nevh.solve, wall, (0, 50), [0, 1.0], "euler",
                   dt=0.5)
    orbit = error.result
    assert not orbit.success and orbit.status == -1 and orbit.message == str(error)
    assert 0 < len(orbit.t) and all(map(math.isfinite, orbit.y_reached))
    assert abs(orbit.t_reached - orbit.t[-1]) < 1e-12
    quiet = nevh.solve(wall, (0, 50), [0, 1.0], "euler", dt=0.5, check=False)
    assert quiet.status == -1 and list(quiet.t) == list(orbit.t)


# Functions.

def value(t, y):
    return y[1] ** 2 / 2 - math.cos(y[0])


def test_a_function_of_python():
    text = nevh.solve(PENDULUM, (0, 5), [2, 0], "verlet", dt=0.05)
    mine = nevh.solve(value, (0, 5), [2, 0], "verlet", dt=0.05)
    assert close(last(text), last(mine), 1e-9) and mine.gradient == "exact"
    assert mine.names == ["q", "p_q"]
    k = nevh.solve(lambda t, y, m, k=1: y[1]**2 / (2 * m) + k * y[0]**2 / 2,
                   (0, math.pi), [1, 0], args=(1,), parameters={"k": 4})
    assert close(last(k), [1, 0], 1e-6)


def test_masked_values():
    needs("NumPy")
    import numpy
    start = numpy.ma.masked_array([2.0, 0.0], [False, True])
    raised(nevh.Refused, "masked", lambda: nevh.solve(PENDULUM, (0, 1), start, "verlet",
                                                     dt=0.1))
    raised(nevh.Refused, "masked", lambda: nevh.solve(
        PENDULUM + "*k", (0, 1), [2, 0], "verlet", dt=0.1, parameters={"k": numpy.ma.masked}))
    for value in numpy.ma.masked, 10**400:
        raised(TypeError, "no real number", lambda v=value: nevh.solve(
            lambda t, q, p: v, (0, 1), [2, 0], "midpoint", dt=0.1))


def test_names():
    assert set(nevh.__all__) < set(dir(nevh)) and "compare" in dir(nevh)
    assert not [name for name in dir(nevh) if name[0] == "_" and name[1] != "_"]
    assert repr(nevh.Scene("pendulum")).startswith("<Scene pendulum: Pendulum released")
    rows = nevh.compare("pendulum", "verlet", t_end=1)
    assert set(rows["scene"]) == {"pendulum"}


def test_steps_of_the_scene():
    """Differences of a scene take its steps, as the command's do."""
    text = "[coordinates]\nx = 1\n[effects]\nH = p_x^2/2 + x^4/4\n[run]\nt_end = 1\n" \
        "dt = 0.1\nintegrators = verlet\ngradient = central2\ngradient_step = %g\n"
    fine, coarse = (nevh.solve(nevh.Scene(text % step)).y_reached[0] for step in
                    (1e-5, 0.3))
    assert abs(fine - coarse) > 1e-3
    same = nevh.solve(nevh.Scene(text % 1e-5), gradient_step=0.3).y_reached[0]
    assert same == coarse
    slope = [nevh.HGrad(nevh.Scene(text % step), gradient="central2")(0, [1, 0])[1]
             for step in (1e-5, 0.3)]
    assert abs(slope[0] - slope[1]) > 1e-3
    if np is not None:
        ends = [nevh.sweep(nevh.Scene(text % step), {"x": [1.0]}, "last(x)")["last(x)"][0]
                for step in (1e-5, 0.3)]
        assert ends == [fine, coarse]


def test_a_pointer():
    kind = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double,
                            ctypes.POINTER(ctypes.c_double),
                            ctypes.POINTER(ctypes.c_double), ctypes.c_void_p)
    mine = kind(lambda t, q, p, _: p[0] ** 2 / 2 - math.cos(q[0]))
    address = ctypes.cast(mine, ctypes.c_void_p).value
    text = nevh.solve(PENDULUM, (0, 1), [2, 0], "verlet", dt=0.1)

    class Compiled:  # as numba's
        pass
    Compiled.address = address
    for H in (mine, ctypes.c_void_p(address), Compiled()):
        orbit = nevh.solve(H, (0, 1), [2, 0], "verlet", dt=0.1)
        assert close(last(orbit), last(text), 1e-9)


def test_a_pointer_of_scipy():
    needs("SciPy")
    import scipy
    kind = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double,
                            ctypes.POINTER(ctypes.c_double),
                            ctypes.POINTER(ctypes.c_double), ctypes.c_void_p)
    H = scipy.LowLevelCallable(kind(lambda t, q, p, _: p[0] ** 2 / 2 + q[0] ** 2 / 2))
    assert close(last(nevh.solve(H, (0, math.pi), [1, 0])), [-1, 0], 1e-7)


class Mine(Exception):
    pass


def test_what_h_raises_stops_the_run():
    def H(t, y):
        if t > 1:
            raise Mine("too late")
        return value(t, y)
    error = raised(Mine, "too late", nevh.solve, H, (0, 50), [2, 0], "rk4", dt=0.05,
                   gradient_step=1e-3)
    orbit = error.result
    whole = nevh.solve(value, (0, 50), [2, 0], "rk4", dt=0.05)
    count = len(orbit.t)
    assert 18 < count < 23 and not orbit.success and orbit.status == -1
    for row, other in zip(orbit.y, whole.y):
        assert close(row, other[:count], 1e-9)
    assert list(orbit.y_reached) == last(orbit) and orbit.t_reached == orbit.t[-1]
    raised(Mine, "", nevh.solve, H, (2, 3), [0, 0], "rk4", dt=0.05)


def test_what_h_raises_elsewhere_is_no_matter():
    def H(t, y):  # planning tries y[0] < 0
        return y[1] ** 2 / 2 - math.sqrt(y[0])
    orbit = nevh.solve(H, (0, 5), [1, 0], "rk4", dt=0.05)
    assert orbit.energy_error < 1e-5


def test_what_an_observer_raises_stops_the_run():
    seen = []

    def watch(t, y):
        seen.append((t, list(y)))
        if t > 1:
            raise Mine("enough")
    error = raised(Mine, "enough", nevh.solve, PENDULUM, (0, 50), [2, 0], "verlet",
                   dt=0.1, observe=watch)
    assert len(seen) == 12 and seen[0] == (0, [2, 0])
    assert list(error.result.y_reached) == seen[-1][1]
    orbit = nevh.solve(PENDULUM, (0, 50), [2, 0], "verlet", dt=0.1, every=5,
                       observe=lambda t, y: t > 1)
    assert orbit.status == 1 and orbit.success and len(orbit.t) == 16


def interrupted(name, function, *arguments, **named):
    """The exception that the interrupt key makes of a call, once it is in that function
    of the library."""
    begun, real = threading.Event(), getattr(nevh._library._lib, name)

    def press():
        begun.wait(60)
        time.sleep(0.3)
        os.kill(os.getpid(), signal.SIGINT)

    def noted(*arguments):
        begun.set()
        return real(*arguments)
    setattr(nevh._library._lib, name, noted)
    before = signal.getsignal(signal.SIGINT)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    thread = threading.Thread(target=press)
    thread.start()
    try:
        return raised(KeyboardInterrupt, "", function, *arguments, **named)
    finally:
        thread.join()
        signal.signal(signal.SIGINT, before)
        setattr(nevh._library._lib, name, real)


def test_the_interrupt_key():
    error = interrupted("run_at", nevh.solve, PENDULUM, (0, 1e8), [2, 0],
                        "verlet", dt=0.1, t_eval=[0, 1e8])
    assert 0 < error.result.t_reached < 1e8
    assert all(map(math.isfinite, error.result.y_reached))


def test_the_interrupt_key_ends_a_sweep():
    needs("NumPy")
    begin = time.monotonic()
    error = interrupted("sweep_run", nevh.sweep, PENDULUM,
                        {"phi": np.linspace(0, 2, 1 << 16)}, "state", "verlet",
                        dt=0.001, t_end=300, threads=1)
    status = error.result["status"]
    assert (status[-100:] == 0).all() and set(status) <= {0, 1}
    assert time.monotonic() - begin < 60


def test_the_interrupt_key_before_a_sweep_begins():
    needs("NumPy")
    lib = nevh._library._lib
    real, before = lib.sweep_new, signal.getsignal(signal.SIGINT)

    def pressed(*arguments):
        signal.raise_signal(signal.SIGINT)
        return real(*arguments)
    lib.sweep_new = pressed
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        error = raised(KeyboardInterrupt, "", nevh.sweep, PENDULUM,
                       {"phi": np.linspace(0, 2, 1 << 16)}, "state", "verlet",
                       dt=0.001, t_end=300, threads=1)
    finally:
        lib.sweep_new = real
        signal.signal(signal.SIGINT, before)
    assert (error.result["status"][-100:] == 0).all()


# The paper's class.

def test_the_papers_listing():
    needs("SciPy")

    def H(t, s, k, m):
        x, p = s
        return 0.5 * k * x**2 + 0.5 * p**2 / m
    G = nevh.HGrad(H, [0.1, 0.1], k=4 * math.pi ** 2, m=1.0)
    assert close(G(0, [1.0, 0.0]), [0, -4 * math.pi ** 2], 1e-12)
    orbit = scipy_integrate.solve_ivp(G, [0.0, 3.0], [1.0, 0.0], rtol=1e-8, atol=1e-8)
    assert close(orbit.y[:, -1], [1, 0], 1e-5)


def test_hgrad():
    y = [1.0, 2.0, 3.0, 4.0]
    exact = nevh.HGrad("double-pendulum", gradient="exact")
    central = nevh.HGrad("double-pendulum")
    coarse = nevh.HGrad("double-pendulum", 0.1, gradient="central2")
    assert close(central(0, y), exact(0, y), 1e-9)
    assert not close(coarse(0, y), exact(0, y), 1e-9)
    damped = nevh.HGrad("[coordinates]\nx = 0\n[effects]\nH = p_x^2/2\n"
                        "[friction]\ndrag = x: 0.5\n")
    assert close(damped(0, [0, 2.0]), [2, -1], 1e-9)
    raised(nevh.Refused, "takes 4", central, 0, [1.0, 2.0])
    raised(nevh.Refused, "it takes 4", nevh.HGrad("double-pendulum"), 0, [1.0, 2.0])
    raised(nevh.Refused, "one, or 2", nevh.HGrad(value, [1, 2, 3]), 0, [1.0, 0])

    def bad(t, y):
        raise Mine("no value")
    raised(Mine, "no value", nevh.HGrad(bad), 0, [1.0, 2.0])


def test_hgrad_of_many_states():
    needs("NumPy")
    G = nevh.HGrad("double-pendulum", gradient="exact")
    y = np.random.default_rng(1).normal(size=(4, 13))
    together = G(0, y)
    assert together.shape == (4, 13)
    for k in range(13):
        assert list(G(0, y[:, k])) == list(together[:, k])


# Tables and sweeps.

def test_compare():
    table = nevh.compare("pendulum", ["verlet", "rk4"], dt=[0.1, 0.05], t_end=200)
    assert len(table) == 4 and table["integrator"] == ["verlet", "rk4"] * 2
    assert table["verdict"] == ["bounded", "drifts"] * 2
    assert isinstance(table[0]["max_energy_error"], float)
    text = table._repr_html_()
    assert text.count("<tr>") == 5 and "<th>verdict</th>" in text
    assert any("energy_scale" in note for note in table.notes)
    assert "bounded" in str(table)
    formula = nevh.compare("p_x^2/2 + x^4/4", ["verlet"], dt=0.1, t_end=50, y0=[1, 0])
    assert len(formula) == 1 and formula[0]["status"] == "ok"
    raised(nevh.Refused, "did you mean verlet", nevh.compare, "pendulum", ["verlat"])
    refused = nevh.compare("double-pendulum", ["verlet"], dt=0.1, t_end=5)
    assert refused[0]["status"].startswith("refused")
    assert refused[0]["max_energy_error"] is None


def test_sweep():
    needs("NumPy")
    values = np.linspace(0.1, 3, 50)
    arguments = "pendulum", {"phi": values}, "state, energy_error", "verlet"
    named = dict(dt=0.05, t_end=5, gradient="exact")
    array = nevh.sweep(*arguments, threads=1, **named)
    assert array.dtype.names == ("status", "phi", "last(phi)", "last(p_phi)",
                                 "energy_error")
    assert (array["status"] == 1).all() and (array["phi"] == values).all()
    for i in (0, 20, 49):
        orbit = nevh.solve("pendulum", (0, 5), [values[i], 0], "verlet", dt=0.05,
                           gradient="exact")
        assert [array["last(phi)"][i], array["last(p_phi)"][i]] == last(orbit)
    scene = nevh.Scene("pendulum")
    made = nevh.sweep(scene, *arguments[1:], **named)
    assert made.tobytes() == array.tobytes()
    raised(nevh.Refused, "nothing is varied", nevh.sweep, scene, t_end=1)
    for text, wrong in (("t_end = 0", dict(t_end=0)), ("dt = 0", dict(dt=0)),
                        ("threads = -1", dict(threads=-1)), ("no tolerance", dict(
                            rtol=1e-6)), ("there is no value", dict(vary={"phi": []})),
                        ("(2, 2)", dict(vary={"phi": np.ones((2, 2))}))):
        raised(nevh.Refused, text, nevh.sweep, scene, **dict(
            dict(vary={"phi": values}, integrator="verlet", t_end=1), **wrong))
    raised(nevh.Refused, "rtol = 0", nevh.sweep, scene, {"phi": values}, None, "DOP853",
           t_end=1, rtol=0)
    raised(nevh.Refused, "needs t_end", nevh.sweep, PENDULUM, {"phi": values})
    threads = nevh.sweep(*arguments, threads=4, **named)
    assert threads.tobytes() == array.tobytes()


def test_sweep_is_the_commands():
    needs("NumPy")
    import tempfile
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "a.npy")
        subprocess.run([nevh.command(), "sweep", "pendulum", "--vary",
                        "phi = range(0, 3, 40)", "--vary", "g = 9, 10", "--outcomes",
                        "period, verdict", "--integrators", "verlet", "--dt", "0.05",
                        "--t-end", "20", "-o", path, "--quiet"], check=True)
        file = np.load(path, mmap_mode="r")
        mine = nevh.sweep("pendulum", {"phi": "range(0, 3, 40)", "g": [9, 10]},
                          ["period", "verdict"], "verlet", dt=0.05, t_end=20)
        assert len(mine) == len(file) == 80
        for name in mine.dtype.names:
            assert np.array_equal(mine[name], file[name], equal_nan=True), name


def test_handlers_of_signals_may_raise():
    """What a handler raises ends the run; one that does not raise lets it go on."""
    called = []

    def late(*_):
        called.append(1)
        if len(called) > 1:
            raise TimeoutError("late")
    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, 0.2, 0.2)
    try:
        raised(TimeoutError, "late", nevh.solve, PENDULUM, (0, 1e7), [1, 0], "gauss4",
               dt=0.01, t_eval=[1e7])
        assert len(called) == 2 and signal.getsignal(signal.SIGALRM) is late
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_starts_that_are_no_numbers():
    needs("NumPy")
    ones = np.ones((2, 20))
    for y0 in (np.ma.masked_array(ones, mask=np.eye(2, 20)), ones * 1j, ones.astype(str)):
        raised(nevh.Refused, "real numbers", nevh.solve, PENDULUM, (0, 1), y0, "verlet",
               dt=0.1)
    for dt in (-1, math.nan, "a"):
        raised(nevh.Refused, "dt = ", nevh.solve, PENDULUM, (0, 1), ones, "verlet", dt=dt)
    raised(nevh.Refused, "give t_eval", nevh.solve, PENDULUM, (0, 1e18), [1, 0], "verlet",
           dt=1e-3)
    raised(TypeError, "H returns None", nevh.solve, lambda t, y: None, (0, 1), [1, 0],
           "rk4", dt=0.1)


def test_members_side_by_side():
    """They are the orbits that they are alone, whatever is between; few plans are made."""
    needs("NumPy")
    from nevh import _members
    plans, made = [], _members._Plan

    def counted(*of):
        plans.append(of)
        return made(*of)
    _members._Plan = counted
    starts = np.linspace(0.1, 1, 2 * 41).reshape(2, 41)
    given = (("verlet", 0.05, None), ("gauss4", 0.07, None), ("rk4", 0.05, [0, 0.5, 3]),
             ("verlet", 0.05, np.linspace(0, 3, 31)))
    try:
        for method, dt, times in given:
            del plans[:]
            many = nevh.solve("p_x^2/2 - cos(x)", (0, 3), starts, method, dt=dt, t_eval=times)
            assert 0 < len(plans) <= 1 + 41 // 8, len(plans)
            for k in (0, 7, 40):
                one = nevh.solve("p_x^2/2 - cos(x)", (0, 3), starts[:, k], method, dt=dt,
                                 t_eval=times)
                assert (one.y == many.y[:, k]).all() and (one.t == many.t).all(), (method, k)
                assert one.energy_error == many.energy_error[k]
                assert one.verdict == many.members[k].verdict
                assert set(one) == set(many.members[k])
        for other in (dict(t_eval=[0.03, 3]), dict(gradient="central4"), dict(method="tao2"),
                      dict(method="dop853", dt=None)):
            del plans[:]
            named = dict(dict(method="verlet", dt=0.05), **other)
            many = nevh.solve("p_x^2/2 - cos(x)", (0, 3), starts, **named)
            one = nevh.solve("p_x^2/2 - cos(x)", (0, 3), starts[:, 9], **named)
            assert not plans and (one.y[:, -1] == many.y[:, 9, -1]).all()
        pole = np.array([[1.0] * 20 + [0.0], [0.0] * 21])  # the last has no H
        raised(nevh.Error, "", nevh.solve, "p_x^2/2 + 1/x", (0, 1), pole, "verlet", dt=0.1)
    finally:
        _members._Plan = made


def test_sweep_of_members_that_fail():
    needs("NumPy")
    import warnings
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        array = nevh.sweep("p^2/2 - log(1 - q)", {"q": [0, 0.5, 2.0]}, "state",
                           "rk4", dt=0.1, t_end=1)
    assert list(array["status"]) == [1, 1, 3], array
    assert len(seen) == 1 and "1 of 3 members failed; member 2" in str(seen[0].message)
    raised(nevh.Refused, "phy", nevh.sweep, "pendulum", {"phy": [1, 2]})


def test_steps_thrown_about_warn():
    import warnings
    for H, dt in (("p^2/2 - 1/abs(q)^0.5", 0.05), ("p^2/2 - 1/abs(q - 0.3)^1.5", 0.05),
                  ("p^2/2 + q^2/2", 0.01)):
        with warnings.catch_warnings(record=True) as seen:
            warnings.simplefilter("always")
            result = nevh.solve(H, (0, 20), [1, 0], "rk4", dt=dt)
        assert result.success
        assert len(seen) == (result.energy_error > 1), (H, result.energy_error)
        assert all(one.category is RuntimeWarning for one in seen)


def passes_zero(t, y):
    return y[0]


def test_events_and_dense_output():
    """The harmonic oscillator, whose times are known; forwards, backwards, by a method
    that adapts and one that does not."""
    for span, named, tolerance in (((0, 20), dict(rtol=1e-12), 1e-9),
                                   ((0, -20), dict(rtol=1e-12), 1e-9),
                                   ((0, 20), dict(method="gauss8", dt=0.3), 1e-8)):
        passes_zero.direction, passes_zero.terminal = 0, False
        orbit = nevh.solve("p^2/2 + q^2/2", span, [1, 0], events=passes_zero,
                           dense_output=True, **named)
        sign = math.copysign(1, span[1])
        known = [sign * (k + 0.5) * math.pi for k in range(6)]
        assert close(list(orbit.t_events[0]), known, tolerance), orbit.t_events
        assert all(abs(state[0]) < tolerance for state in orbit.y_events[0])
        for t in (0.0, sign * 0.123, sign * 7.7, span[1]):
            assert close(list(orbit.sol(t)), [math.cos(t), -math.sin(t)], tolerance)
        assert len(orbit.sol([0, sign])) == 2 and len(orbit.sol([0, sign])[0]) == 2
        raised(nevh.Refused, "not within the run", orbit.sol, span[1] * 1.01)
        passes_zero.direction = 1
        rising = nevh.solve("p^2/2 + q^2/2", span, [1, 0], events=passes_zero, **named)
        assert close(list(rising.t_events[0]), known[1::2], tolerance)
        passes_zero.terminal = 2
        ended = nevh.solve("p^2/2 + q^2/2", span, [1, 0], events=[passes_zero], **named)
        assert ended.status == 1 and ended.success
        assert abs(ended.t[-1] - rising.t_events[0][1]) < tolerance
        assert abs(ended.y[0][-1]) < tolerance and ended.t_reached == ended.t[-1]
        assert ended.sol is None and orbit.status == 0
    few = nevh.solve("p^2/2 + q^2/2", (0, 20), [1, 0], events=passes_zero,
                     t_eval=[1, 9, 17])
    assert close(list(few.t), [1, 9, known[3]], 1e-8)
    raised(TypeError, "an event is a function", nevh.solve, PENDULUM, (0, 1), [1, 0],
           events=3)


def test_events_as_scipys():
    needs("NumPy")
    needs("SciPy")

    def over(t, y, k):
        return y[0] - 0.3 * k

    def pendulum(t, y, k):
        return [y[1], -math.sin(y[0])]
    for direction in (-1, 1):
        over.direction = direction
        for span in ((0, 30), (0, -30)):
            mine = nevh.solve(lambda t, y, k: y[1]**2 / 2 - np.cos(y[0]), span, [2, 0],
                              rtol=1e-12, events=over, args=(1,))
            its = scipy_integrate.solve_ivp(pendulum, span, [2, 0], "DOP853", rtol=1e-12,
                                            atol=1e-12, events=over, args=(1,))
            assert len(mine.t_events[0]) == len(its.t_events[0]) > 2
            assert np.allclose(mine.t_events[0], its.t_events[0], rtol=0, atol=1e-8)
            assert mine.y_events[0].shape == its.y_events[0].shape


def test_results_can_be_pickled():
    def of(H, **more):
        orbit = nevh.solve(H, (0, 20), [2, 0], dense_output=True, **more)
        again = pickle.loads(pickle.dumps(orbit))
        assert list(again.sol(3.33)) == list(orbit.sol(3.33)) == list(
            copy.deepcopy(orbit).sol(3.33))
        assert again.verdict == orbit.verdict and again.names == orbit.names
    of(PENDULUM, method="verlet", dt=0.1)
    of(PENDULUM)
    mine = nevh.Integrator("mine", kick=["1/2", "1/2"], drift=[1])
    of(PENDULUM, method=mine, dt=0.1, gradient="central2")
    if not np:
        return
    of(pendulum_of_pieces, method="verlet", dt=0.1)


def pendulum_of_pieces(t, y):
    return y[1]**2/2 - (math.cos(y[0]) if y[0] < 9 else 0)


def test_results_have_what_those_of_scipy_have():
    orbit = nevh.solve(PENDULUM, (0, 1), [1, 0])
    assert orbit.t_events is None and orbit.y_events is None and orbit.sol is None
    needs("SciPy")
    other = scipy_integrate.solve_ivp(lambda t, y: [y[1], -math.sin(y[0])], (0, 1), [1, 0])
    assert set(other) - set(orbit) == {"njev", "nlu"}


def test_progress_is_shown_to_persons_alone():
    program = """if True:
        import nevh, sys
        nevh._progress._first = nevh._progress._between = 0
        H = "p^2/2 - cos(q)"
        nevh.solve(H, (0, 1000), [1, 0], "verlet", dt=0.01, t_eval=[1000])
        print("long", file=sys.stderr)
        nevh._progress._first = 2
        nevh.solve(H, (0, 1), [1, 0], "verlet", dt=0.1)
        print("short", file=sys.stderr)
    """
    piped = subprocess.run([sys.executable, "-c", program], stderr=subprocess.PIPE)
    assert piped.stderr.split() == [b"long", b"short"], piped.stderr
    master, slave = os.openpty()
    process = subprocess.Popen([sys.executable, "-c", program], stderr=slave)
    os.close(slave)
    said = b""
    while True:
        try:
            read = os.read(master, 1000)
        except OSError:  # Linux says so at the end
            break
        if not read:
            break
        said += read
    os.close(master)
    assert process.wait() == 0
    long, short = said.split(b"long")
    assert b"nevh.solve: 0 s" in long and b"% " in long.replace(b"%,", b"% ") and \
        long.endswith(b"\r\033[K"), long[-200:]
    assert short.split() == [b"short"], short


def test_ensembles():
    needs("NumPy")
    starts = np.array([[0.5, 1, 2], [0, 0, 0.5]])
    for H in (PENDULUM, nevh.Scene("pendulum")):
        together = nevh.solve(H, (0, 5), starts, "verlet", dt=0.1)
        assert together.y.shape == (2, 3, 51)
        for k in range(3):
            one = nevh.solve(H, (0, 5), starts[:, k], "verlet", dt=0.1)
            assert np.array_equal(one.y, together.y[:, k])
            assert one.energy_error == together.energy_error[k]
    raised(nevh.Refused, "of one orbit", nevh.solve, PENDULUM, (0, 1), starts,
           dense_output=True)


def test_ensembles_have_verdicts():
    needs("NumPy")
    orbits = nevh.solve(PENDULUM, (0, 50), np.array([[0.5, 1], [0, 0]]), "rk4", dt=0.5)
    alone = [nevh.solve(PENDULUM, (0, 50), [phi, 0], "rk4", dt=0.5) for phi in (0.5, 1)]
    assert list(orbits.verdict) == [one.verdict for one in alone]
    assert "verdict" in orbits and list(orbits.energy_error) == [
        one.energy_error for one in alone]


def test_arguments_that_are_not_taken():
    at = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double, *[
        ctypes.POINTER(ctypes.c_double)] * 2, ctypes.c_void_p)(
            lambda t, q, p, _: p[0]**2 / 2 + q[0]**2 / 2)
    for H, named in ((PENDULUM, {"args": (4,)}), (at, {"args": (4,)}),
                     (at, {"parameters": {"k": 4}}), (PENDULUM, {"params": 5}),
                     (lambda t, y: y[1]**2 / 2, {"params": 5})):
        raised(nevh.Refused, "parameters", nevh.solve, H, (0, 1), [1, 0], "verlet", dt=0.1,
               **named)


def test_events_that_raise_have_the_orbit():
    def fails(t, y):
        raise KeyError("mine")
    try:
        nevh.solve(PENDULUM, (0, 1), [1, 0], "verlet", dt=0.1, events=fails)
    except KeyError as error:
        assert len(error.result.t) == 11 and not error.result.success
    else:
        raise AssertionError("nothing was raised")


def test_max_step_of_scipy():
    orbit = nevh.solve(PENDULUM, (0, 1), [1, 0], rtol=1e-9, max_step=math.inf)
    assert len(orbit.t) == 257
    raised(nevh.Refused, "max_step", nevh.solve, PENDULUM, (0, 1), [1, 0],
           max_step=math.nan)


def test_max_step():
    short = nevh.solve(PENDULUM, (0, 10), [1, 0], max_step=0.01)
    assert len(short.t) == 1001 and short.dt == 0.01
    raised(nevh.Refused, "max_step", nevh.solve, PENDULUM, (0, 1), [1, 0], "verlet",
           dt=0.1, max_step=0.01)


def main(tests):
    names = [name for name in sorted(tests) if name.startswith("test_")]
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    for name in names:
        try:
            tests[name]()
            counts["passed"] += 1
        except Skip as why:
            counts["skipped"] += 1
            print("skipped %s: %s" % (name, why))
        except BaseException:
            import traceback
            counts["failed"] += 1
            print("failed %s" % name)
            traceback.print_exc(file=sys.stdout)
    print("%(passed)d passed, %(failed)d failed, %(skipped)d skipped" % counts)
    return counts["failed"] > 0


if __name__ == "__main__":
    sys.exit(main(globals()))
