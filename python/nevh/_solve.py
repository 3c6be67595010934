"""solve: one orbit.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import math
import os
from typing import Any, Callable, Mapping, Sequence

from ._library import (_check, Failed, _gradient, _integrator, _lib, Refused, _STOPPED,
                       _text)
from ._arrays import np, _numbers, _positive, _real, Result, _whole_from_one
from ._scene import Scene
from ._functions import _Subject
from ._events import DenseOutput, Events
from ._own import Integrator, run_steps
from ._members import runs_of_members, starts_of, together
from ._run import _choose, _Plan, _run_plan, _steps, _takes_none, _times_of_steps


def _span(scene, t_span):
    if t_span is None:
        settings = scene._settings()
        return settings.t_start, settings.t_end
    try:
        t0, t_end = t_span
    except (TypeError, ValueError):
        raise Refused("t_span = %.80r: it takes two times" % (t_span,)) from None
    return _real("t_span[0]", t0), _real("t_span[1]", t_end)


def _times_to_keep(t_eval, t0, t_end):
    times, _ = _numbers(t_eval, "t_eval")
    least, most = min(t0, t_end), max(t0, t_end)
    ahead = math.copysign(1, t_end - t0)
    if len(times) > 32 and np is not None and (least <= times).all() and (
            times <= most).all() and (np.diff(times) * ahead >= 0).all():
        return times
    before = t0
    for k, t in enumerate(times):
        if not least <= t <= most:
            raise Refused("t_eval[%d] = %g is not within t_span = %g, %g"
                          % (k, t, t0, t_end))
        if (t - before) * ahead < 0:
            raise Refused("t_eval[%d] = %g is not in the order of the run: it comes after "
                          "%g" % (k, t, before))
        before = t
    return times


def _start_of_function(t_span, y0):
    """The time and the state where a function starts."""
    if y0 is None or t_span is None:
        raise Refused("a function needs t_span and y0")
    y0, _ = _numbers(y0, "y0")
    if len(y0) < 2 or len(y0) % 2:
        raise Refused("y0 takes as many momenta as coordinates, not %d in all" % len(y0))
    return _span(None, t_span)[0], y0


def _finite_start(scene, y0):
    """The start as an array and its address; refused where a number is not finite."""
    y = _numbers(scene.start(y0) if scene else y0)
    for k, number in enumerate(y[0]):
        if not math.isfinite(number):
            raise Refused("y0[%d]%s is %g" % (
                k, ", the start of %s," % scene.names[k] if scene else "", number))
    return y


def _of_scene(scene, method, dt, tolerances, gradient):
    """Method, dt, (rtol, atol) and gradient, where not given those of the scene."""
    if not scene:
        return method, dt, tolerances, gradient
    settings = scene._settings()
    if method is None and settings.integrators:
        method = settings.integrator[0].decode()
    adapts = method is not None and not getattr(method, "step", None) and \
        _lib.integrator_adaptive(_integrator(method)[0])
    if dt is None and settings.dts and not adapts:
        dt = settings.dt[0]
    if tolerances[0] is None and settings.tolerances and adapts and not scene.is_formula:
        tolerances = settings.tolerance[0], tolerances[1]
    return method, dt, tolerances, gradient or settings.gradient[0].decode()


def _at_most(dt, max_step, tolerance):
    """The step, where the method adapts at most max_step."""
    if max_step is None or _real("max_step", max_step) == math.inf or (
            dt <= _positive("max_step", max_step)):
        return dt
    if not tolerance:
        raise Refused("dt = %g is above max_step = %g" % (dt, max_step))
    return float(max_step)


def _first_plan(subject, methods, gradient, y, t0, tolerance, gradient_step):
    """The plan of the first method that is not refused, its name and its gradient."""
    for name in methods:
        of = None if _takes_none(name) else gradient or "central4"
        try:
            return _Plan(subject, name, of, y, t0, tolerance, gradient_step), name, of
        except Refused:
            if name == methods[-1]:
                raise


def _solve_by_function(method, subject, y, span, dt, gradient, gradient_step, check):
    """The orbit by an integrator that is a function."""
    if dt is None:
        raise Refused("%s takes steps of dt: give it" % method.name)
    t0, t_end = span
    h = math.copysign(_positive("dt", dt), t_end - t0)
    result = run_steps(method, subject, gradient or "central4", gradient_step, y, t0, h,
                       list(_times_of_steps(t0, t_end, h)))
    if check and result.status:
        error = Failed(result.message)
        error.result = result
        raise error
    return result


def _watch_both(events, observe, every):
    """An observer of both: events see all steps, `observe` what it asked for."""
    taken = [-1]

    def watch(t, y):
        taken[0] += 1
        stops = observe is not None and not taken[0] % every and observe(t, y)
        return events.watch(t, y) or stops
    return watch


def _with_steps(t_eval, steps):
    """The times of both in the order of a run."""
    ahead = len(steps) < 2 or steps[1] > steps[0]
    return sorted({float(t) for t in t_eval} | {float(t) for t in steps},
                  reverse=not ahead)


def _find(result, plan, h, t_eval, events, dense_output):
    """Adds sol and the zeros of events to a result; leaves the times that were asked."""
    sol = DenseOutput(plan, h, result.t, result.y)
    end = None
    result["t_events"] = result["y_events"] = None
    if events:
        result["t_events"], result["y_events"], end = events.find(sol)
    asked = {float(t) for t in t_eval}
    rows = [k for k, t in enumerate(sol._times) if t in asked and
            (end is None or (t - end) * h < 0)]
    times = [sol._times[k] for k in rows]
    states = [[row[k] for k in rows] for row in sol._states]
    if end is not None:
        final = list(sol(end))
        times.append(end)
        states = [row + [x] for row, x in zip(states, final)]
        result.update(status=1, success=True, t_reached=end, y_reached=final,
                      message="A termination event occurred.")
    if np is not None:
        times, states = np.array(times), np.array(states).reshape(len(states), -1)
        result["y_reached"] = np.array(result["y_reached"])
    result.update(t=times, y=states, sol=sol if dense_output else None)


class _Problem:
    """What solve is asked for, checked once; orbit(y0) is one answer."""

    def __init__(self, H, t_span, y0, method, *, dt, rtol, atol, t_eval, gradient,
                 gradient_step, parameters, args, coordinates, with_effects,
                 without_effects, params, observe, every, events, dense_output, max_step,
                 check):
        if method is not None and not isinstance(method, (type, Integrator)):
            _text("method", method)
        if observe is not None and not callable(observe):
            raise TypeError("observe is a function, not %r" % type(observe).__name__)
        self.events, self.observe, self.check = Events(events, args), observe, check
        self.every, self.dense_output = _whole_from_one("every", every), dense_output
        self.times, self.max_step = t_eval, max_step
        if hasattr(H, "_problem"):  # a HGrad
            H, gradient, gradient_step, given = H._problem(gradient, gradient_step)
            parameters, args, coordinates, with_effects, without_effects, params = given
        is_text = isinstance(H, (Scene, str, os.PathLike))
        self.subject = _Subject(H, None if is_text else _start_of_function(t_span, y0),
                                parameters, args, coordinates, with_effects,
                                without_effects, params)
        scene = self.scene = self.subject.scene
        if args and not self.events and is_text:
            raise Refused("args are those of a function: give parameters={name: value}")
        if scene and scene.is_formula and (y0 is None or t_span is None):
            raise Refused("a formula needs t_span and y0")
        _finite_start(scene, y0)
        self.t0, self.t_end = _span(scene, t_span)
        if not abs(self.t_end - self.t0) < math.inf or self.t_end == self.t0:
            raise Refused("t_span = %g, %g is no time to go" % (self.t0, self.t_end))
        if gradient:
            _gradient(gradient)
        self.gradient_step = gradient_step
        self.method, self.dt, self.tolerances, self.gradient = _of_scene(
            scene, method, dt, (rtol, atol), gradient)
        self._check_function()

    def _check_function(self):
        """Refuses what an integrator that is a function does not take."""
        if getattr(self.method, "step", None) and (
                self.events or self.dense_output or any(one is not None for one in (
                    self.observe, self.times, self.max_step, *self.tolerances))):
            raise Refused("%s is a function: it takes dt, and neither t_eval, observe, "
                          "events, dense_output, rtol, atol nor max_step"
                          % self.method.name)

    def shares(self):
        """Whether orbits from several starts, in several threads, may share it."""
        return not (self.subject.calls_python or self.observe or
                    getattr(self.method, "step", None))

    def orbit(self, y0, interrupt=None):
        """The orbit from y0."""
        subject, t0, t_end = self.subject, self.t0, self.t_end
        y = _finite_start(self.scene, y0)
        if getattr(self.method, "step", None):
            return _solve_by_function(self.method, subject, y, (t0, t_end), self.dt,
                                      self.gradient, self.gradient_step, self.check)
        dt = None if self.dt is None else _positive("dt", self.dt)
        methods = [self.method] if self.method is not None else _choose(
            subject, dt, t0, y)
        dt, tolerance = _steps(methods[0], dt, *self.tolerances, t_end - t0, y[0])
        dt = _at_most(dt, self.max_step, tolerance)
        h = dt if t_end > t0 else -dt
        plan, method, gradient = _first_plan(subject, methods, self.gradient, y, t0,
                                             tolerance, self.gradient_step)
        t_eval, kept = self._times(h)
        observe, every = self._watched(tolerance)
        status, result = _run_plan(plan, t0, t_end, h, kept, y, observe, every, interrupt)
        result.update(method=getattr(method, "name", method), dt=dt, tolerance=tolerance,
                      gradient=gradient, names=self.scene.names if self.scene else None)
        return self._finish(plan, status, result, h, t_eval)

    def _times(self, h):
        """The times that are asked for, and those at which states are kept."""
        keeps_steps = bool(self.events) or self.dense_output
        steps = _times_of_steps(self.t0, self.t_end, h) if keeps_steps or \
            self.times is None else None
        t_eval = steps if self.times is None else _times_to_keep(self.times, self.t0,
                                                                 self.t_end)
        return t_eval, _with_steps(t_eval, steps) if keeps_steps else t_eval

    def _watched(self, tolerance):
        """What looks at the run, and after how many steps."""
        if self.events:
            return _watch_both(self.events, self.observe, self.every), 1
        if self.observe is None:
            return None, 16 if tolerance else 512
        return self.observe, self.every

    def _finish(self, plan, status, result, h, t_eval):
        """Adds what was found on the way; raises what ended the run."""
        try:
            self.subject.trap.spring()
            if (self.events or self.dense_output) and len(result.t):
                _find(result, plan, h, t_eval, self.events, self.dense_output)
            if self.check and status not in (0, _STOPPED):
                _check(status, result.message)
        except BaseException as error:
            result["success"], result["status"] = False, -1
            result["message"] = str(error) or type(error).__name__
            error.result = result
            raise
        return result


def _solve_members(H, t_span, y0, given):
    """The orbits of an ensemble, whose problem is found once, but for functions that run
    as Python."""
    y0 = starts_of(y0, given)
    problem = _Problem(H, t_span, y0[:, 0], **given)

    def alone(start, interrupt):
        return problem.orbit(start, interrupt) if problem.shares() else \
            _Problem(H, t_span, start, **given).orbit(start)
    return together(runs_of_members(problem, y0, alone))


def solve(H: Any, t_span: Sequence[float] | None = None,
          y0: Sequence[float] | Mapping[str, float | str] | None = None,
          method: str | type | None = None, *, dt: float | None = None,
          rtol: float | None = None, atol: float | Sequence[float] | None = None,
          t_eval: Sequence[float] | None = None, gradient: str | None = None,
          gradient_step: float | Sequence[float] | None = None,
          parameters: Mapping[str, Any] | None = None, args: Sequence[Any] = (),
          coordinates: Sequence[str] | None = None,
          with_effects: str | Sequence[str] = (),
          without_effects: str | Sequence[str] = (), params: Any = None,
          observe: Callable[[float, Any], Any] | None = None, every: int = 1,
          events: Any = None, dense_output: bool = False,
          max_step: float | None = None, check: bool = True) -> Result:
    """Follow the orbit of a Hamiltonian from t_span[0] to t_span[1].

    H        H as text ("p_x^2/2 + k*x^2/2"), a scene (see Scene), a function of Python
             H(t, y, *args, **parameters), where y has coordinates, then momenta, or
             H(t, q, p), a HGrad, or a pointer of ctypes to a C function H(t, q, p,
             params).  A function of Python is traced: it runs as a formula.  One that
             cannot be, for it compares values or is no formula, runs as values,
             slowly, with a warning that names the line
    y0       coordinates, then momenta; of scenes also {name: value}, None: as they say.
             An array (2n, members) is an ensemble: y has the shape (2n, members, times)
    method   a name of nevh.integrators() or of SciPy's DOP853 and RK45.  None: the
             first of the scene; else with dt verlet, or gauss4 where H is no sum of
             T(p) and V(q); without dt taylor, or dop853 for functions in C and for
             formulas that are not analytic
    dt       the step.  Of methods that adapt it is where their steps end; None: a
             256th of the time
    rtol     of methods that adapt, relative to the larger of |y| and the length over
             which H varies; default 1e-9.  atol can make it smaller only:
             min(rtol, atol/max(1, |y0|))
    t_eval   times to keep; default: all steps of dt.  They do not change the orbit
    gradient default: of scenes what they say, exact of other texts and functions,
             central4 of what is no formula
    gradient_step   half the spread of differences, a number or one for each of y;
             default: the scene's, else chosen where the orbit starts
    parameters, coordinates, with_effects, without_effects: see Scene
    observe  called with (t, y) after `every` steps; what is true ends the run
    events   a function g(t, y, *args), or several, whose zeros are found: g.terminal =
             True ends the run there, g.direction = 1 or -1 counts passages up or down
    dense_output   True: sol(t) of the result is the state at any time of the run
    max_step       the longest step, where the method adapts
    check    False: a step that fails gives a result with status -1, as SciPy's

    Returns t, y (a row a variable), nfev (gradients), status (0: the end; 1: stopped;
    -1: failed), message, success, as SciPy does; energy_error (the largest over the
    run, relative to energy_scale), verdict (of nevh.verdicts; what the run leaves open
    is found as nevh compare finds it, by a longer run, when it is first asked for; but
    for functions that are no formula), energy_drift (a unit of time), hamiltonian_evals,
    t_reached and y_reached (the last good state), method, dt, tolerance, gradient (None
    where none is taken), names; t_events and y_events, a list for each event, and sol.

    Raises Refused for input that is wrong, Failed where a step fails, and what
    `observe` or H raised; the orbit so far is then the exception's `result`.
    """
    given = dict(locals())
    del given["H"], given["t_span"], given["y0"]
    if getattr(y0, "ndim", 1) == 2 or (isinstance(y0, (list, tuple)) and y0 and
                                       isinstance(y0[0], (list, tuple))):
        return _solve_members(H, t_span, y0, given)
    return _Problem(H, t_span, y0, **given).orbit(y0)
