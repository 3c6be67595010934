"""nevh tests: calls that are wrong raise exceptions that say so, and crash nothing.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import ctypes
import math
import sys
import warnings

sys.dont_write_bytecode = True
import numpy as np  # noqa: E402
import nevh  # noqa: E402

warnings.simplefilter("ignore")
PENDULUM = "p_phi^2/2 - cos(phi)"
inf, nan, huge = math.inf, math.nan, 10**400
thing = object()


class Odd(Exception):
    """What the user's own functions raise."""


def raises(*_):
    raise Odd


numbers = ["x", [], {}, thing, nan, inf, -inf, huge, 1j, b"1", -1, 0, [1, 2], np.array([]),
           np.array([[1.]]), np.float32(nan), np.datetime64("2020"), raises]
of_solve = {
    "dt": numbers,
    "max_step": numbers[:5] + numbers[6:],
    "t_span": [nan, "x", (1,), (1, 2, 3), (0, 0), (nan, 1), (0, inf), ("a", "b"), 5,
               [None, 1], (0, huge), (0, 1j), thing],
    "y0": [5, "ab", [1], [1, 2, 3], [], [nan, 0], [inf, 0], [None, 0], ["1", "x"],
           {"phi": nan}, {"phy": 1}, {1: 2}, np.ones((2, 2, 2)), np.zeros((3, 2)),
           np.array(["a", "b"]), [1j, 0], thing, [[1], [2, 3]], np.zeros((2, 0)),
           {"phi": [1, 2]}, [huge, 0], (i for i in [1, 0])],
    "method": ["verlat", 5, b"verlet", ["verlet"], "verlet+transform", "verlet+x", "",
               thing, int, "rk4 "],
    "H": ["a^2", "p_phi^2/2 +", "p_phi^2/2 - cos(phi", "1", 5, b"p^2", None, thing,
          ctypes.c_void_p(0), ctypes.c_void_p(8), int, "pendulumm", "p_phi^2/2 - k", "\0",
          "x" * 100000, "p_phi^2/2 # c", "p_phi^2/2\n[run]", "[scene", "p_phi^2/2 - phi!",
          [PENDULUM], {"H": PENDULUM}, "p_phi/0", "(" * 3000 + "p_phi" + ")" * 3000,
          raises],
    "gradient": ["exactt", 5, b"x", ["exact"], thing],
    "gradient_step": [-1, nan, "x", [1], [1, 2, 3], [nan, nan], 0j, thing, huge, [-1, 1]],
    "t_eval": [[2], [0.5, 0.2], [nan], ["x"], 5j, thing, [[.1, .2]], -1, [None]],
    "events": [5, "x", [5], [lambda t: 1], lambda t, y: nan, lambda t, y: "x",
               lambda t, y: y, raises, thing],
    "observe": [5, "x", lambda t: 1, raises, thing],
    "parameters": [5, "x", [1], {"k": nan}, {"k": "x y"}, {"k": thing}, {5: 1}, {"a b": 1},
                   {"k": "1\n[run]"}, {"k": []}, {"k": np.ones((2, 2))}, {"": 1},
                   {"k": 1j}],
    "coordinates": [5, "x", ["y"], [5], ["phi", "phi"], ["a b"], [""], ["x[0]"], ["x[-1]"],
                    ["x[99999999999]"]],
    "with_effects": [5, "x", [5], thing],
    "without_effects": [5, "x", [5], thing],
    "first_step": [1], "rtol": [1e-3], "atol": [1e-3],
}
calls = [(nevh.solve, (), dict(dict(H=PENDULUM, t_span=(0, 1), y0=[1, 0], method="verlet",
                                    dt=0.1, gradient="central2"), **{name: value}))
         for name, values in of_solve.items() for value in values]
calls += [(nevh.solve, (PENDULUM, (0, 1), [1, 0], "dop853"), {name: value})
          for name in ("rtol", "atol") for value in ("x", -1, nan, thing)]
for name in "compare cost check effects section chaos portrait frequencies flow reference " \
        "run export page report gradients".split():
    function = getattr(nevh, name)
    calls += [(function, (scene,), {}) for scene in ("no-such-scene", 5, PENDULUM)]
    calls += [(function, ("pendulum",), {"nonsense": 1})]
    if name not in ("page", "report", "export"):
        calls += [(function, ("pendulum",), {one: value}) for one, value in (
            ("t_end", nan), ("t_end", -1), ("y0", {"x": 1}), ("parameters", {"gg": 1}))]
calls += [(nevh.compare, ("pendulum",), {name: value}) for name, value in (
    ("dt", thing), ("dt", []), ("dt", nan), ("integrators", 5), ("integrators", []),
    ("repeat", 0), ("repeat", 1.5), ("match", "x"), ("diagnostics", "x"), ("options", 5),
    ("plot", "/no/such/folder/a.svg"), ("options", ["--nonsense"]), ("options", "--all"))]
calls += [(nevh.fit, ("pendulum",), dict(vary="g", data=data)) for data in (
    None, "no.csv", {}, {"t": ["a"], "phi": [1]}, {"t": [1, 2], "q": [1, 2]},
    {"t": [1, 2], "phi": [1]})]
calls += [(function, arguments, {}) for function, arguments in (
    (nevh.recommend, ("pendulum",)), (nevh.hard, ("no such case",)), (nevh.hard, (5,)),
    (nevh.list, ("nothing",)), (nevh.list, ()), (nevh.new, ("/no/such/folder/a.nevh",)),
    (nevh.new, (5,)), (nevh.export, ("pendulum", "no-such-scheme")),
    (nevh.compare, ("pendulum", "verlet", 0.1, 1, 5)))]
calls += [(nevh.sweep, ("pendulum", vary), {}) for vary in (
    None, {"phi": "x"}, {"phi": [nan]}, 5, {"phi": np.ones((2, 2))}, {"phi": thing},
    {5: [1]}, {"phi": "range(0, 1, 99999999999999)"})]
calls += [(nevh.sweep, ("pendulum", {"phi": [1]}), {name: value}) for name, value in (
    ("outcomes", "no_such"), ("outcomes", 5), ("integrator", "verlat"), ("count", "x"),
    ("threads", 0), ("threads", "x"), ("seed", "x"), ("combine", "x"), ("dt", nan),
    ("t_end", "x"), ("gradient", "x"))]
calls += [(lambda y, H=PENDULUM, **named: nevh.HGrad(H, **named)(0, y), (y,), named)
          for y, named in (
    ([1], {}), ([], {}), ([1, 2, 3], {}), ("x", {}), ([nan, 0], {}), ([inf, 0], {}),
    (np.ones((2, 2, 2)), {}), ([1, "x"], {}), (None, {}), ([1, 0], {"gradient": "x"}),
    ([1, 0], {"ds": -1}), ([1, 0], {"ds": "x"}), ([1, 0], {"ds": [1, 2, 3]}),
    ([1, 0], {"H": 5}), ([1, 0], {"H": raises}), ([1, 0], {"H": lambda t: 1}),
    ([1, 0], {"H": lambda t, y: "x"}), ([1, 0], {"H": lambda t, y: None}))]
calls += [(nevh.solve, (lambda t, y: y[1]**2 + y[0]**2, (0, 1), [1, 0]), named) for named in (
    {"coordinates": ["a", "b"]}, {"coordinates": ["a[2]"]}, {"parameters": {1: 2}})]
calls += [(nevh.Scene, arguments, named) for arguments, named in (
    ((), {}), ((5,), {}), ((b"pendulum",), {}), (("",), {}), (("/",), {}),
    (("/dev/null",), {}), (("pendulum",), {"effects": {}}), ((), {"effects": 5}),
    ((), {"effects": {}}), ((), {"effects": {"a b": "p_x"}}), ((), {"effects": {"a": 5}}),
    ((), {"effects": {"a": "p_x"}, "definitions": 5}), (("pendulum", {"gg": 1}), {}),
    ((), {"effects": {"a": "p_x"}, "coordinates": 5}),
    (("pendulum",), {"with_effects": "no_such"}))]

wrong = 0
for function, arguments, named in calls:
    try:
        found = repr(function(*arguments, **named))
    except (nevh.Error, TypeError, ValueError, AttributeError) as error:
        # Errors that come from within Python would name no argument.
        found = "" if str(error) and "has no attribute" not in str(error) else repr(error)
    except Odd:
        found = ""
    except BaseException as error:
        found = repr(error)
    if found:
        wrong += 1
        print("%s %.150r %.150r: %.200s" % (getattr(function, "__name__", function), arguments,
                                            named, found))
# What the caller wrote has a name, and no line.
for outcomes in ("period", "no_such", "last(", "state, state"):
    try:
        nevh.sweep("kepler", {"e": [.1, .5]}, outcomes)
    except nevh.Error as error:
        found = str(error)
        if "assignment" in found or not found.startswith("outcomes"):
            wrong += 1
            print("sweep: outcomes %r: %.200s" % (outcomes, found))
print("%d wrong calls, %d without an exception of their own" % (len(calls), wrong))
sys.exit(wrong > 0)
