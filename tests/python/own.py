"""nevh tests: integrators of one's own, by numbers and as functions.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import os
import pickle
import re
import sys
from fractions import Fraction

sys.dont_write_bytecode = True
import numpy as np  # noqa: E402
import nevh  # noqa: E402

FORMULA = "p^2/2 - cos(q)"


def raised(kind, text, function, *arguments, **named):
    try:
        function(*arguments, **named)
    except kind as error:
        assert text in str(error), "%r is not in %r" % (text, str(error))
        return
    raise AssertionError("%s was not raised" % kind.__name__)


def leapfrog(force, t, q, p, h):
    p = p + h / 2 * force(t, q)
    q = q + h * p
    return q, p + h / 2 * force(t + h, q)


def trapezium(force, t, q, p, h):
    v, a = p, force(t, q)
    w, b = p + h * a, force(t + h, q + h * v)
    return q + h / 2 * (v + w), p + h / 2 * (a + b)


def midpoint(force, velocity, t, q, p, h):
    """Midpoint's rule by iteration, for any H."""
    x, y = q, p
    for _ in range(60):
        a, b = (q + x) / 2, (p + y) / 2
        x, y = q + h * velocity(t + h / 2, a, b), p + h * force(t + h / 2, a, b)
    return x, y


def test_numbers():
    """Order, symmetry and symplecticity of published tables; a copy gives the same bits."""
    mine = nevh.Integrator("mine", kick=["1/2", Fraction(1, 2)], drift=[1])
    assert (mine.order, mine.symmetric, mine.symplectic) == (2, True, True)
    cube = ["1/(2 - 2^(1/3))", "1 - 2/(2 - 2^(1/3))", "1/(2 - 2^(1/3))"]
    triple = nevh.Integrator("triple", compose={"verlet": cube})
    assert triple.order == 4 and triple.symplectic
    again = nevh.Integrator("again", compose={mine: cube})
    assert again.order == 4
    broken = nevh.Integrator("broken", compose={"verlet": [1.35, -1.7, 1.35]})
    assert broken.order == 2 and "digit may be wrong" in broken.shortfall
    classic = nevh.Integrator("classic", a=[[], [0.5], [0, 0.5], [0, 0, 1]],
                              b=["1/6", "1/3", "1/3", "1/6"])
    assert (classic.order, classic.symplectic) == (4, False)
    s = "sqrt(3)/6"
    gauss = nevh.Integrator("gauss", a=[["1/4", "1/4 - " + s], ["1/4 + " + s, "1/4"]],
                            b=[0.5, 0.5])
    assert (gauss.order, gauss.symmetric, gauss.symplectic) == (4, True, True)
    for own, name in ((mine, "verlet"), (classic, "rk4"), (triple, "forest-ruth")):
        a, b = (nevh.solve("pendulum", (0, 20), method=one, dt=0.05) for one in (own, name))
        assert name == "forest-ruth" or (a.y == b.y).all(), name
        assert abs(a.y - b.y).max() < 1e-9 and a.method == own.name
    copy = pickle.loads(pickle.dumps(triple))
    assert (copy.order, copy.text) == (4, triple.text)


def test_tables_take_them():
    mine = nevh.Integrator("mine", kick=[0.5, 0.5], drift=[1])
    step = nevh.Integrator("leapfrog", step=leapfrog)
    table = nevh.compare("pendulum", ["verlet", mine, step], dt=[0.1, 0.05], t_end=20)
    assert sorted(table["integrator"]) == ["leapfrog"] * 2 + ["mine"] * 2 + ["verlet"] * 2
    of = {(row["integrator"], row["dt"]): row for row in table}
    for dt in (0.1, 0.05):
        verlet = of["verlet", dt]
        for name in ("mine", "leapfrog"):
            for column in ("max_energy_error", "rms_energy_error", "state_error"):
                assert abs(of[name, dt][column] / verlet[column] - 1) < 1e-3, (name, column)
            assert of[name, dt]["order"] == 2 and of[name, dt]["symplectic"] == "yes"
    alone = nevh.compare("pendulum", step, dt=0.1, t_end=5)
    assert [row["integrator"] for row in alone] == ["leapfrog"]
    raised(nevh.Refused, "is a function", nevh.cost, "pendulum", step)
    array = nevh.sweep("pendulum", {"phi": [1, 2]}, "state", mine, dt=0.1, t_end=5)
    known = nevh.sweep("pendulum", {"phi": [1, 2]}, "state", "verlet", dt=0.1, t_end=5)
    assert (array == known).all()
    assert any("mine: order 2" in note for note in nevh.check("pendulum", mine).notes)


def test_functions():
    """Measured order, symmetry and symplecticity; Heun's method has neither."""
    one = nevh.Integrator("leapfrog", step=leapfrog)
    two = nevh.Integrator("trapezium", step=trapezium)
    three = nevh.Integrator("rule", step=midpoint)
    assert (one.order, one.symmetric, one.symplectic) == (2, True, True)
    assert (two.order, two.symmetric, two.symplectic) == (2, False, False)
    assert (three.order, three.symmetric, three.symplectic) == (2, True, True)
    for own, name in ((one, "verlet"), (two, "heun"), (three, "midpoint")):
        a, b = (nevh.solve(FORMULA, (0, 10), [1, 0], method, dt=0.1) for method in (own, name))
        assert abs(a.y - b.y).max() < 1e-9 and a.verdict in (b.verdict, "undecided")
    coarse = dict(dt=0.1, gradient="central2", gradient_step=0.5)
    a, b = (nevh.solve(FORMULA, (0, 10), [1, 0], method, **coarse) for method in
            (one, "verlet"))
    fine = nevh.solve(FORMULA, (0, 10), [1, 0], one, dt=0.1)
    assert abs(a.y - b.y).max() < 1e-9 < 1e-3 < abs(a.y - fine.y).max()
    given, chosen = (nevh.solve("pendulum", method=method) for method in (one, "verlet"))
    assert given.dt == chosen.dt and given.gradient == chosen.gradient
    mixed = "(1 + x^2)*p_x^2/2 + x^2/2"
    a, b = (nevh.solve(mixed, (0, 5), [1, 0], method, dt=0.05) for method in
            (three, "midpoint"))
    assert abs(a.y - b.y).max() < 1e-9
    raised(nevh.Refused, "is no sum", nevh.solve, mixed, (0, 1), [1, 0], one, dt=0.1)
    fails = nevh.Integrator("wild", step=lambda force, t, q, p, h: (q / 0.0, p))
    with np.errstate(all="ignore"):
        raised(nevh.Failed, "not finite", nevh.solve, FORMULA, (0, 1), [1, 0], fails, dt=0.1)


def test_arrays_are_weights():
    lists = nevh.Integrator("x", kick=[0.5, 0.5], drift=[1])
    arrays = nevh.Integrator("x", kick=np.array([0.5, 0.5]), drift=np.array([1.0]))
    assert lists.order == arrays.order == 2 and arrays.symplectic
    table = nevh.Integrator("x", a=np.array([[0, 0], [0.5, 0]]), b=np.array([0, 1]))
    assert table.order == 2 and not table.symplectic
    assert nevh.Integrator("x", a=[[]], b=[1]).order == 1


def test_compared_with_its_parts():
    leap = nevh.Integrator("leap", kick=["1/2", "1/2"], drift=[1])
    weight = "1/(2 - 2^(1/3))"
    triple = nevh.Integrator("triple", compose={leap: [weight, "1 - 2*" + weight, weight]})
    for own in ([leap, triple], [triple, leap], [leap, triple, leap]):
        table = nevh.compare("pendulum", own, dt=0.1, t_end=5)
        errors = dict(zip(table["integrator"], table["max_energy_error"]))
        assert list(errors) == [one.name for one in dict.fromkeys(own)]
        assert errors["triple"] < errors["leap"] / 5


def test_functions_refuse_what_they_do_not_take():
    mine = nevh.Integrator("mine", step=leapfrog)
    for named in ({"rtol": 1e-3}, {"atol": 1e-3}, {"max_step": 0.1}):
        raised(nevh.Refused, "takes dt", nevh.solve, FORMULA, (0, 1), [1, 0], mine, dt=0.1,
               **named)
    raised(nevh.Refused, "no gradient 'centrl2'", nevh.solve, FORMULA, (0, 1), [1, 0], mine,
           dt=0.1, gradient="centrl2")
    for end in (float("inf"), float("-inf"), float("nan"), 0):
        for method in (mine, "verlet"):
            raised(nevh.Refused, "no time to go", nevh.solve, FORMULA, (0, end), [1, 0],
                   method, dt=0.1)
    raised(nevh.Refused, "is a function", nevh.sweep, "pendulum", {"phi": [1, 2]},
           "energy_error", mine, dt=0.1, t_end=1)
    raised(nevh.Refused, "is a function", nevh.Integrator, "x", compose={mine: [1]})


def test_compositions_of_what_is_no_table():
    a = 1/(2 - 2**(1/3))
    for base, exact in (("avf", True), ("gonzalez", True), ("lobatto2", False)):
        made = nevh.Integrator("four", compose={base: [a, 1 - 2*a, a]})
        assert made.order == 4 and made.symmetric and made.symplectic == (not exact), made
        orbit = nevh.solve(FORMULA, (0, 20), [2, 0], made, dt=0.1)
        assert orbit.energy_error < (1e-13 if exact else 1e-3)
        rough = nevh.Integrator("two", compose={base: [0.6, -0.2, 0.6]})
        assert rough.order == 2, rough
    one = nevh.solve(FORMULA, (0, 5), [2, 0], nevh.Integrator("one", compose={"avf": ["1"]}),
                     dt=0.1)
    base = nevh.solve(FORMULA, (0, 5), [2, 0], "avf", dt=0.1)
    assert abs(one.y - base.y).max() < 1e-11
    again = pickle.loads(pickle.dumps(made))
    assert again.order == 4 and list(again.step.weights) == list(made.step.weights)
    for text, compose in (("add up to 1.1", {"avf": [0.5, 0.6]}), ("of numbers", {
            "avf": ["2^(1/3)"]}), ("of numbers", {"avf": ["1/0"]}), ("no table", {"taylor": [1]}), (
                "back to front", {"tao2": [0.5, 0.3, 0.2]}), (
                    "35 are possible", {"tao2": [1/37]*37})):
        raised(nevh.Refused, text, nevh.Integrator, "x", compose=compose)
    raised(nevh.Refused, "is a function", nevh.sweep, "pendulum", {"phi": [1]},
           "energy_error", made, dt=0.1, t_end=1)
    sol = nevh.solve(FORMULA, (0, 1), [1, 0], "verlet", dt=0.1, dense_output=True).sol
    raised(nevh.Refused, "not a real number", sol, "a")


def test_compositions_of_taos_steps():
    """Those of tao4 and tao6 from their own weights; one wrong digit tells."""
    mixed, a, b = "(1 + x^2)*p_x^2/2 + x^2/2", 1/(2 - 2**(1/3)), 1/(2 - 2**(1/5))
    four = nevh.Integrator("four", compose={"tao2": [a, 1 - 2*a, a]})
    six = nevh.Integrator("six", compose={"tao4": [b, 1 - 2*b, b]})
    wrong = nevh.Integrator("wrong", compose={"tao2": [a + 0.01, 0.98 - 2*a, a + 0.01]})
    assert (four.order, six.order, wrong.order) == (4, 6, 2)
    exact = nevh.solve(mixed, (0, 2), [1, 0.3], rtol=1e-14).y_reached

    def error(method, dt):
        return abs(nevh.solve(mixed, (0, 2), [1, 0.3], method, dt=dt).y_reached - exact).max()
    assert abs(error(four, 0.02)/error("tao4", 0.02) - 1) < 1e-6
    for method, order in ((four, 4), (six, 6), (wrong, 2)):
        slope = np.log2(error(method, 0.02)/error(method, 0.01))
        assert abs(slope - order) < 0.3, (method, slope)
    assert list(nevh.compare(mixed, [four, "tao4"], 0.02, 2, y0=[1, 0.3])["symplectic"]) == [
        "extended"]*2
    assert pickle.loads(pickle.dumps(four)).order == 4


def test_looks_are_those_of_the_command():
    from nevh import _plot
    for name in ("mine", "another", "heun-of-mine"):
        own = nevh.Integrator(name, kick=[0.5, 0.5], drift=[1])
        nevh.compare("pendulum", own, dt=[0.1, 0.05], t_end=5, plot="looks.svg")
        with open("looks.svg", encoding="utf-8") as file:
            colours = set(re.findall(r"#[0-9A-Fa-f]{6}", file.read()))
        here = _plot.style(name)["color"]
        assert here.lower() in {one.lower() for one in colours}, (name, here, colours)
        others = set(_plot._colours) - {here, "#000000"}
        assert not others & {one.upper() for one in colours}, colours
    os.remove("looks.svg")


def test_step_with_a_default():
    def step(force, t, q, p, h, parts=1):
        return leapfrog(force, t, q, p, h)
    made = nevh.solve(FORMULA, (0, 5), [1, 0], nevh.Integrator("x", step=step), dt=0.1)
    exact = nevh.solve(FORMULA, (0, 5), [1, 0], "verlet", dt=0.1)
    assert abs(made.y - exact.y).max() < 1e-13


def test_wrong():
    for kind, text, named in (
            (TypeError, "none of them", {}), (TypeError, "drift is a list", {"kick": [1]}),
            (nevh.Refused, "add up to 1.1", dict(kick=[.5, .6], drift=[1])),
            (TypeError, "kick is a list", dict(kick="x", drift=[1])),
            (nevh.Refused, "row 1 of a", dict(a=[[1, 2]], b=[1])),
            (TypeError, "compose is", dict(compose=5)),
            (TypeError, "b goes with a", dict(b=[1])),
            (nevh.Refused, "did you mean verlet", dict(compose={"verlat": [1]})),
            (TypeError, "step is a function", dict(step=5)),
            (nevh.Refused, "nan", dict(kick=[float("nan")], drift=[1])),
            (TypeError, "kick and drift and a and b", dict(kick=[1], drift=[1], b=[1]))):
        raised(kind, text, nevh.Integrator, "x", **named)
    raised(nevh.Refused, "take another name", nevh.Integrator, "verlet", kick=[1], drift=[1])
    for step, text in ((lambda force, t, q, p, h: None, "not q and p"),
                       (lambda force, t, q, p, h: (q,), "not q and p"),
                       (lambda force, t, q, p, h: ([1, 2], [1, 2]), "1 numbers each")):
        raised(nevh.Refused, text, nevh.solve, FORMULA, (0, 1), [1, 0],
               nevh.Integrator("x", step=step), dt=0.1)
    raised(TypeError, "step takes", nevh.solve, FORMULA, (0, 1), [1, 0],
           nevh.Integrator("x", step=lambda q: q), dt=0.1)


for name, test in sorted(globals().items()):
    if name.startswith("test_"):
        test()
        print("passed", name)
