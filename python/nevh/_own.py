"""Integrators of one's own: by their numbers, or as a function that takes a step.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ctypes as c
import math
import time
from fractions import Fraction
from typing import Any, Callable, Sequence

from ._library import integrators, _lib, _Options, Refused, _text, verdicts
from ._arrays import np, _numbers, _real, Result, _table
from ._functions import _set_gradient_steps
from ._run import _Plan
from ._scene import Scene, _value


class _Facts(c.Structure):
    _fields_ = [("order", c.c_int), ("any_kinetic", c.c_int), ("symmetric", c.c_bool),
                ("symplectic", c.c_bool), ("condition", c.c_char * 120),
                ("value", c.c_longdouble), ("due", c.c_longdouble),
                ("needed_for", c.c_int)]


class Integrator:
    """An integrator by its numbers, or by a function.

        mine = nevh.Integrator("mine", kick=["1/6", "2/3", "1/6"], drift=[0.5, 0.5])
        nevh.compare("pendulum", ["verlet", mine], dt=0.1)

    kick, drift   weights of p -= w*h*dV/dq and q += w*h*dT/dp, in turn; first="drift"
                  begins with the other
    a, b, c       a Butcher table: rows of a, explicit or implicit; c may be left out
    compose       {name: weights}: steps of another integrator, of parts of h.  Those of
                  avf, gonzalez, itoh-abe and lobatto2 ..., which are no table, are taken
                  one after the other, as slowly as a function's
    step          a function step(force, t, q, p, h) that returns (q, p) after a step;
                  force(t, q) is -dH/dq.  With step(force, velocity, t, q, p, h) it gets
                  velocity(t, p) = dH/dp too, else masses are 1.  For H that is no sum
                  T(p) + V(q) both take (t, q, p).  It runs as Python, slowly

    Weights are numbers or formulas, as "1/(2 - 2^(1/3))".  Those that do not add up to 1
    are refused.

    order, symmetric, symplectic   follow from the numbers by algebra; of a function they
                                   are measured on a pendulum
    shortfall   the first condition of the next order that fails, and by how much
    text        the section of a scene file that says the same
    """

    def __init__(self, name: str = "own", *, kick: Sequence[Any] | None = None,
                 drift: Sequence[Any] | None = None, first: str = "kick",
                 a: Sequence[Sequence[Any]] | None = None, b: Sequence[Any] | None = None,
                 c: Sequence[Any] | None = None, compose: Any = None,
                 step: Callable[..., Any] | None = None) -> None:
        self.name, self.step = _text("name", name), step
        given = [what for what, values in (
            ("kick and drift", (kick, drift)), ("a and b", (a, b)), ("compose", (compose,)),
            ("step", (step,))) if any(value is not None for value in values)]
        if len(given) != 1:
            raise TypeError("an integrator has kick and drift, or a and b, or compose, or "
                            "step; given are %s" % (" and ".join(given) or "none of them"))
        if step is not None:
            if not callable(step) and not isinstance(step, _Parts):
                raise TypeError("step is a function, not %r" % (step,))
            self.text = ""
            return
        if given[0] == "kick and drift":
            lines = ["first = " + _text("first", first), _line("kick", kick),
                     _line("drift", drift)]
        elif given[0] == "compose":
            lines = _composition(compose)
            if next(iter(compose)) in _without_table():
                self.step, self.text = _Parts(*next(iter(compose.items()))), ""
                return
        else:
            lines = _tableau(a, b, c)
        before = getattr(next(iter(compose or ()), None), "text", "")
        self._take("%s[integrator %s]\n%s\n" % (before, name, "\n".join(lines)))

    def _take(self, text):
        """The scheme of a section of this name, and what follows from its numbers."""
        self.text = text
        self._scene = Scene("[coordinates]\nq = 0\n[effects]\nT = p_q^2/2\n" + text)
        self._pointer = _lib.scene_integrator_named(self._scene._made, self.name.encode())
        self._read_facts()

    def _read_facts(self):
        facts, text = _Facts(), c.create_string_buffer(400)
        if _lib.integrator_facts(self._pointer, c.byref(facts)):  # Tao's have no table
            self.order = _lib.integrator_order(self._pointer)
            self.symmetric = self.symplectic = True
            self.shortfall = ""
            return
        self.order, self.symmetric = facts.order, facts.symmetric
        self.symplectic = facts.symplectic
        self.shortfall = _lib.scheme_shortfall(c.byref(facts), text, len(text)).decode()

    def __getattr__(self, name):
        if name in ("order", "symmetric", "symplectic", "shortfall") and self.__dict__.get(
                "step"):
            self.order, self.symmetric, self.symplectic = _measured(self)
            self.shortfall = ""
            return self.__dict__[name]
        raise AttributeError(name)

    def __reduce__(self):
        if self.step:
            return _function_again, (self.name, self.step)
        return _again, (self.name, self.text)

    def __repr__(self):
        return "<Integrator %s: order %s%s%s%s>" % (
            self.name, self.order, ", symmetric" if self.symmetric else "",
            ", symplectic" if self.symplectic else "",
            "; " + self.shortfall if self.shortfall else "")


def _again(name, text):
    made = Integrator.__new__(Integrator)
    made.name, made.step = name, None
    made._take(text)
    return made


def _function_again(name, step):
    return Integrator(name, step=step)


def _composition(compose):
    """The line of {name of an integrator, or an Integrator: weights}."""
    if not hasattr(compose, "items") or len(compose) != 1:
        raise TypeError("compose is {name of an integrator: weights}, not %.80r"
                        % (compose,))
    (base, weights), = compose.items()
    if getattr(base, "step", None):
        raise Refused("%s is a function: a composition takes integrators by numbers"
                      % base.name)
    return ["compose = %s: %s" % (getattr(base, "name", base), _weights("step", weights))]


def _without_table():
    """Integrators of one step that are neither splittings nor tables of Runge and Kutta."""
    return [name for name in integrators()
            if name.split("-")[0].rstrip("0123456789") in ("avf", "gonzalez", "itoh",
                                                           "lobatto")]


class _Parts:
    """Steps of another integrator, of parts of a step, one after the other."""

    def __init__(self, name, weights):
        try:
            self.name, self.weights = name, [float(Fraction(one)) if isinstance(one, str)
                                             else _real("step", one) for one in weights]
        except (ValueError, ZeroDivisionError) as error:
            if isinstance(error, Refused):
                raise
            raise Refused("%s is composed of numbers, not of formulas: %.80r"
                          % (name, weights)) from None
        if not abs(sum(self.weights) - 1) < 1e-12:
            raise Refused("the weights of step add up to %.17g, not to 1"
                          % sum(self.weights))

    def stepper(self, subject, field, t, y):
        """As that of a function: step(t, q, p, h)."""
        n = subject.n
        plan = _Plan(subject, self.name, field.gradient, _numbers(list(y[0])), t, 0.0,
                     field.gradient_step)
        state, at = _numbers(list(y[0]))
        end, end_at = _numbers([t])
        kept, (_, kept_at) = c.c_size_t(), _table(2 * n, 1)

        def step(t, q, p, h):
            state[:n], state[n:] = q, p
            for weight in self.weights:
                end[0] = t + weight * h
                status = _lib.run_at(plan.stepper, t, weight * h, end[0], end_at, 1,
                                     kept_at, c.byref(kept), at, at + 8 * n, None, 0)
                subject.trap.spring()
                plan.check(status)
                t = end[0]
            field.evaluations = _lib.stepper_counts(plan.stepper).gradients
            return state[:n].copy(), state[n:].copy()
        return step


def _tableau(a, b, c):
    """The lines of a Butcher table."""
    if a is None:
        raise TypeError("b goes with a, the rows of the table: a=[[0]] is Euler's")
    rows = " ; ".join(_weights("a", row) for row in a)
    return ["a = " + (rows or "0"), _line("b", b)] + (
        [_line("c", c)] if c is not None else [])


def _line(name, values):
    return "%s = %s" % (name, _weights(name, values))


def _weights(name, values):
    if isinstance(values, str) or not hasattr(values, "__iter__"):
        raise TypeError("%s is a list of weights, not %.80r" % (name, values))
    return ", ".join(
        one if isinstance(one, str) else str(one) if hasattr(one, "numerator") and
        not isinstance(one, float) else _value(name, one) for one in values)


# Steps by a function.

class _Field:
    """Values and gradients of H at states of Python."""

    def __init__(self, subject, gradient, t0, y, gradient_step=None):
        self.n, self.gradient, self.gradient_step = subject.n, gradient, gradient_step
        self._state, self._at = _numbers(y)
        o = _Options(gradient=_lib.gradient_named(gradient.encode()), t=t0, q=self._at,
                     p=self._at + 8 * self.n)
        self._steps = _set_gradient_steps(o, subject.scene, gradient_step, self.n,
                                          "gradient_step")
        self._field = _lib.field_new(subject.system, c.byref(o))
        self._out, self._out_at = _numbers([0.0] * (2 * self.n))
        self.evaluations = 0

    def __del__(self):
        _lib.field_free(self._field)

    def _take(self, t, q, p):
        half = 8 * self.n
        self._state[:self.n], self._state[self.n:] = q, p
        self.evaluations += 1
        return _lib.field_gradient(self._field, 1, c.byref(c.c_double(t)), self._at,
                                   self._at + half, self._out_at, self._out_at + half)

    def _half(self, part, t, q, p):
        if self._take(t, q, p):
            raise Refused("H has no gradient at t = %g, q = %s, p = %s" % (t, q, p))
        row = self._out[:self.n] if part == "q" else self._out[self.n:]
        return row.copy() if np is not None else list(row)


def _stepper(mine, field, subject, t, y):
    """The user's function as step(t, q, p, h); checks what it returns."""
    import inspect
    if isinstance(mine.step, _Parts):
        return mine.step.stepper(subject, field, t, y)
    n, separable = subject.n, subject.separable(t, y)
    zeros = [0.0] * n

    def force(t, q, p=None):
        return -_rows(field._half("q", t, q, need(p)))

    def velocity(t, *state):
        q, p = state if len(state) == 2 else (None, state[0])
        return _rows(field._half("p", t, need(q), p))

    def need(part):
        if part is None and not separable:
            raise Refused("H is no sum T(p) + V(q): %s takes force(t, q, p) and "
                          "velocity(t, q, p)" % mine.name)
        return zeros if part is None else part
    takes = sum(one.default is one.empty and one.kind is not one.VAR_KEYWORD
                for one in inspect.signature(mine.step).parameters.values())
    if takes not in (5, 6):
        raise TypeError("step takes (force, t, q, p, h) or (force, velocity, t, q, p, h), "
                        "not %d arguments" % takes)
    given = (force,) if takes == 5 else (force, velocity)

    def step(t, q, p, h):
        made = mine.step(*given, t, q, p, h)
        try:
            q, p = made
            q, p = _rows(q), _rows(p)
            if len(q) != n or len(p) != n:
                raise ValueError
        except (TypeError, ValueError):
            raise Refused("%s returns %.80r, not q and p with %d numbers each"
                          % (mine.name, made, n)) from None
        return q, p
    return step


def _rows(values):
    if np is None:
        raise ImportError("a step as a function needs NumPy")
    return np.array(values, dtype=float).reshape(-1)


def run_steps(mine, subject, gradient, gradient_step, y, t0, h, times):
    """The orbit by a function, as a Result; `times` are those of its steps."""
    n, started = subject.n, time.process_time()
    field = _Field(subject, gradient, t0, y[0], gradient_step)
    state, at = _numbers(y[0])
    o = _Options(gradient=_lib.gradient_named(gradient.encode()), t=t0, q=at,
                 p=at + 8 * n)
    energy = _lib.energy_new(subject.system, c.byref(o))
    step = _stepper(mine, field, subject, t0, y)
    q, p = _rows(state[:n]), _rows(state[n:])
    states, error = [list(state)], None
    message, status = "The end of t_span was reached.", 0
    _lib.energy_observe(energy, 0, t0, at, at + 8 * n)
    try:
        for k in range(1, len(times)):
            q, p = step(times[k - 1], q, p, times[k] - times[k - 1])
            if not (np.isfinite(q).all() and np.isfinite(p).all()):
                message, status = "%s: a step from t = %g is not finite" % (
                    mine.name, times[k - 1]), -1
                break
            state[:n], state[n:] = q, p
            states.append(list(state))
            if _lib.energy_observe(energy, k, times[k], at, at + 8 * n):
                message, status = "%s: H is not finite after t = %g" % (
                    mine.name, times[k - 1]), -1
                break
    except (Exception, KeyboardInterrupt) as raised:
        error, status, message = raised, -1, str(raised)
    report = _lib.energy_result(energy, 0)
    result = Result(
        t=np.array(times[:len(states)]), y=np.array(states).T, nfev=field.evaluations,
        hamiltonian_evals=0, status=status, message=message, success=not status,
        energy_error=report.max, energy_drift=report.drift, energy_scale=report.scale,
        verdict=verdicts[report.verdict], t_reached=times[len(states) - 1],
        y_reached=np.array(states[-1]), sol=None, t_events=None,
        y_events=None, rms_energy_error=report.rms,
        final_energy_error=report.final, seconds=time.process_time() - started,
        method=mine.name, dt=abs(h), tolerance=0.0, gradient=gradient,
        names=subject.scene.names if subject.scene else None)
    _lib.energy_free(energy)
    if error is not None:
        error.result = result
        raise error
    return result


def _measured(mine):
    """Order, symmetry and symplecticity of a function, on a pendulum of unit mass."""
    from ._functions import _Subject
    subject = _Subject("p^2/2 - cos(q)")
    y = _numbers([1.1, 0.3])
    field = _Field(subject, "exact", 0.0, y[0])
    step = _stepper(mine, field, subject, 0.0, y)

    def flow(start, h, count):
        q, p = _rows(start[:1]), _rows(start[1:])
        for k in range(count):
            q, p = step(k * h, q, p, h)
        return np.concatenate([q, p])
    from ._solve import solve
    exact = solve("p^2/2 - cos(q)", (0, 1), [1.1, 0.3], "taylor", rtol=1e-15).y_reached
    errors = [max(abs(flow([1.1, 0.3], 1 / k, k) - exact)) for k in (8, 16, 32)]
    slopes = [math.log2(a / b) for a, b in zip(errors, errors[1:]) if b > 1e-14]
    there = flow([1.1, 0.3], 0.2, 1)
    back = max(abs(flow(there, -0.2, 1) - [1.1, 0.3]))
    d = 1e-5
    columns = [(flow(np.array([1.1, 0.3]) + d * e, 0.2, 1) -
                flow(np.array([1.1, 0.3]) - d * e, 0.2, 1)) / (2 * d) for e in np.eye(2)]
    area = columns[0][0] * columns[1][1] - columns[0][1] * columns[1][0]
    return round(slopes[-1]) if slopes else None, back < 1e-12, abs(area - 1) < 1e-8


def rows_of_functions(functions, table, given):
    """The rows of `nevh compare` for integrators that are functions, at the steps of the
    table of others."""
    from ._scene import _scene
    from ._solve import solve
    scene = _scene(given["scene"], given.get("parameters"), given.get("coordinates"),
                   given.get("with_effects") or (), given.get("without_effects") or (),
                   given.get("y0"))
    settings = scene._settings()
    t_end = given.get("t_end")
    try:
        span = settings.t_start, settings.t_end if t_end is None else float(t_end)
    except (TypeError, ValueError):
        raise Refused("t_end = %r: it takes a number, since %s is a function"
                      % (t_end, functions[0].name)) from None
    gradient = given.get("gradient") or settings.gradient[0].decode()
    rows = []
    for dt in dict.fromkeys(row["dt"] for row in table if row.get("dt")):
        for mine in functions:
            run = solve(scene, span, given.get("y0"), mine, dt=dt, check=False,
                        gradient=gradient if isinstance(gradient, str) else gradient[0],
                        gradient_step=given.get("gradient_step"))
            row = dict.fromkeys(table.columns)
            row.update(scene=scene.name, integrator=mine.name, order=mine.order,
                       symplectic="yes" if mine.symplectic else "no",
                       gradient=run.gradient, dt=dt, steps=len(run.t) - 1,
                       status="ok" if run.success else "failed: " + run.message,
                       max_energy_error=run.energy_error,
                       rms_energy_error=run.rms_energy_error,
                       final_energy_error=run.final_energy_error,
                       energy_drift=run.energy_drift, verdict=run.verdict,
                       state_error=_state_error(scene, span, given.get("y0"), run),
                       hamiltonian_evals=0, gradient_evals=run.nfev, sweeps=0,
                       seconds=run.seconds, native="no")
            rows.append(row)
    return rows


def _state_error(scene, span, y0, run):
    """The largest difference from a Taylor series, relative to the range of a variable;
    None where there is no such series."""
    from ._solve import solve
    if not run.success:
        return None
    try:
        exact = solve(scene, span, y0, "taylor", rtol=1e-14, t_eval=run.t)
    except (Refused, ArithmeticError):
        return None
    spread = exact.y.max(axis=1) - exact.y.min(axis=1)
    moves = spread > 0
    return float((abs(run.y - exact.y).max(axis=1)[moves] / spread[moves]).max()) \
        if moves.any() else None
