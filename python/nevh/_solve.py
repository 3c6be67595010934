"""solve: one orbit.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ctypes as c
import math
import os
import signal
import threading
import warnings
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Mapping, Sequence

from ._library import (_check, Failed, _gradient, _integrator, _JudgedRun, _lib,
                       _observe_fn, _Observer, _Options, Refused, _STOPPED, _text, verdicts)
from ._arrays import _cut, np, _numbers, _positive, _real, Result, _table, _whole_from_one
from ._scene import Scene
from ._functions import _Subject
from ._events import DenseOutput, Events
from ._own import Integrator, run_steps


def _set_gradient_steps(o, scene, given, n, what):
    """The half-spreads of differences in options: those given, a number or one for
    each of y; else the scene's.  Returns what must be kept while the options are used."""
    if given is None and scene:
        settings = scene._settings()
        o.gradient_step = settings.gradient_step
        o.gradient_steps = settings.gradient_steps
        return None
    if not hasattr(given, "__len__"):
        o.gradient_step = 0 if given is None else _real(what, given)
        return None
    steps, o.gradient_steps = _numbers(given, what)
    if len(steps) != 2 * n:
        raise Refused("%s has %d numbers; it takes one, or %d" % (what, len(steps), 2 * n))
    return steps


class _Plan:
    """A stepper and what watches it."""

    def __init__(self, subject, name, gradient, y, t0, tolerance, gradient_step):
        self.subject = subject
        integrator, transformed = _integrator(name)
        o = self.options = _Options(t=t0, q=y[1], p=y[1] + 8 * subject.n,
                                    tolerance=tolerance)
        if gradient is None:  # none is taken: nothing is to be planned
            o.gradient, gradient_step = _gradient("central2"), 1
        else:
            o.gradient = _gradient(gradient)
        if transformed:
            o.transform = subject.scene and _lib.scene_transform(subject.scene._made)
            if not o.transform:
                raise Refused("%s: there is no scene with a transform" % name)
        self.steps = _set_gradient_steps(o, subject.scene, gradient_step, subject.n,
                                         "gradient_step")
        o.balance = subject.reads_time(t0, y) or subject.friction() is not None
        self.integrator = integrator
        self.stepper = _lib.stepper_new(subject.system, integrator, c.byref(o))
        status = _lib.stepper_status(self.stepper)
        subject.trap.planned(status)
        self.check(status)
        self.observe_energy()

    def observe_energy(self):
        """An observer of the energy that has seen nothing yet."""
        _lib.energy_free(getattr(self, "energy", None))
        self.energy = _lib.energy_new(self.subject.system, c.byref(self.options))
        if self.options.balance:
            _lib.energy_follow(self.energy, self.stepper)
        _lib.energy_expect(self.energy, self.stepper)
        scene = self.subject.scene
        if scene and scene._settings().energy_scale > 0:
            _lib.energy_set_scale(self.energy, scene._settings().energy_scale)

    def __del__(self):
        _lib.energy_free(getattr(self, "energy", None))
        if hasattr(self, "stepper"):
            _lib.stepper_free(self.stepper)

    def check(self, status):
        _check(status, _lib.stepper_message(self.stepper))


class _Interrupt:
    """While the library runs, the interrupt key is noted, to be raised after."""

    def __init__(self):
        self.pressed = False
        self.before = None

    def __enter__(self):
        main = threading.current_thread() is threading.main_thread()
        if main and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            self.before = signal.signal(signal.SIGINT, self.note)
        return self

    def note(self, *_):
        self.pressed = True

    def __exit__(self, *_):
        if self.before is not None:
            signal.signal(signal.SIGINT, self.before)


def _watcher(observe, n, trap, interrupt):
    """An observer that calls `observe`, and looks for the interrupt key."""
    view = c.c_double * n

    def watch(_, step, t, q, p):
        try:
            if interrupt.pressed:
                raise KeyboardInterrupt
            if observe is None:
                return 0
            y = list(view.from_address(q)) + list(view.from_address(p))
            return bool(observe(t, np.array(y) if np is not None else y))
        except BaseException as error:
            trap.error = error
            return 1
    return _observe_fn(watch)


def _times_of_steps(t0, t_end, h):
    count = round((t_end - t0) / h)
    if count > 0 and abs((t_end - t0) / h - count) <= 1e-9 * count:
        h = (t_end - t0) / count
        count -= 1
    else:
        count = int((t_end - t0) / h)
    if np is not None:
        times = np.empty(count + 2)
        np.multiply(np.arange(count + 1), h, out=times[:-1])
        times[:-1] += t0
        times[-1] = t_end
        return times
    return [t0 + i * h for i in range(count + 1)] + [t_end]


def _steps(method, dt, rtol, atol, span, y0):
    """The step and the tolerance of a method."""
    integrator, _ = _integrator(method)
    if not _lib.integrator_adaptive(integrator):
        if rtol is not None or atol is not None:
            raise Refused("%s takes steps of dt and no tolerance: leave out rtol and "
                          "atol" % method)
        if dt is None:
            raise Refused("%s takes steps of dt: give it" % method)
        return dt, 0.0
    rtol = 1e-9 if rtol is None else _positive("rtol", rtol)
    if atol is not None:
        least = min(_numbers(atol, "atol")[0])
        if least > 0:
            rtol = min(rtol, least / max(1.0, max(map(abs, y0))))
        elif not least == 0:
            raise Refused("atol = %g: it takes 0 or a number above it" % least)
    return abs(span) / 256 if dt is None else dt, rtol


def _choose(subject, dt, t0, y):
    """Methods, of which the first that is not refused is taken."""
    if dt is None:
        return ["dop853"] if subject.own else ["taylor", "dop853"]
    return ["verlet" if subject.separable(t0, y) else "gauss4"]


def _takes_none(method):
    """Whether a method takes no gradient."""
    return _lib.integrator_needs_formulas(_integrator(method)[0])


def _stops(scene):
    """The observers, none or one, that stop a run where the scene says."""
    if scene and _lib.scene_stops(scene._made):
        return [(_lib.address("scene_stop_observe"), scene._made, 1)]
    return []


def _settler(plan, t0, h, t_end, start, report):
    """A function that gives the verdict on a run to the end, of a longer one."""
    counts = _lib.stepper_counts(plan.stepper)
    seconds = _lib.counts_seconds(c.byref(counts), plan.subject.n, plan.integrator,
                                  _lib.stepper_order(plan.stepper),
                                  _lib.stepper_taken(plan.stepper))

    def settle():
        subject = plan.subject
        y, at = _numbers(start)
        plan.observe_energy()
        with _Interrupt() as interrupt:
            watch = _watcher(None, subject.n, subject.trap, interrupt)
            stops = _stops(subject.scene) + [(c.cast(watch, c.c_void_p).value, None, 64)]
            run = _JudgedRun(t0, h, t_end, at, at + 8 * subject.n,
                             (_Observer * len(stops))(*stops), len(stops), seconds)
            status = _lib.verdict_settle(plan.stepper, plan.energy, c.byref(run),
                                         c.byref(report))
        subject.trap.spring()
        _check(status, b"")
        return verdicts[report.verdict]
    return settle


def _run_plan(plan, t0, t_end, h, times, y, observe, every):
    """The orbit as a Result, and the status of the library."""
    subject, n = plan.subject, plan.subject.n
    start = list(y[0])
    times, times_at = _numbers(times)
    states, states_at = _table(2 * n, len(times))
    kept, trap = c.c_size_t(), subject.trap
    watched = [(_lib.address("energy_observe"), plan.energy, 1)]
    watched += _stops(subject.scene)
    with _Interrupt() as interrupt:
        watch = _watcher(observe, n, trap, interrupt)
        watched.append((c.cast(watch, c.c_void_p).value, None, every))
        observers = (_Observer * len(watched))(*watched)
        status = _lib.run_at(plan.stepper, t0, h, t_end, times_at, len(times),
                             states_at, c.byref(kept), y[1], y[1] + 8 * n, observers,
                             len(watched))
    report = _lib.energy_result(plan.energy, 0)
    counts = _lib.stepper_counts(plan.stepper)
    message = _lib.stepper_message(plan.stepper).decode()
    if status == _STOPPED and _lib.energy_status(plan.energy):
        status = _lib.energy_status(plan.energy)
        message = _lib.energy_message(plan.energy).decode()
    if status == _STOPPED and subject.scene and _lib.scene_stops(subject.scene._made):
        message += ": " + _lib.scene_stop_text(subject.scene._made).decode()
    reached = t_end if not status else (
        _lib.stepper_time(plan.stepper) if _lib.stepper_taken(plan.stepper) else t0)
    effect = c.c_char_p()
    passed = _lib.energy_passed(plan.energy, c.byref(effect))
    if not math.isnan(passed) and status in (0, _STOPPED):
        status = -1
        message = (f"A step before t = {passed:.6g} passes a pole of "
                   f"{effect.value.decode()}: what follows is not the orbit of H.")
    count = kept.value
    result = Result(
        t=times[:count] if count < len(times) else times,
        y=_cut(states, 2 * n, len(times), count),
        nfev=counts.gradients, hamiltonian_evals=counts.hamiltonians,
        status=0 if not status else 1 if status == _STOPPED else -1,
        message=message or "The end of t_span was reached.",
        success=status in (0, _STOPPED), energy_error=report.max,
        energy_drift=report.drift,
        energy_scale=report.scale, t_reached=reached,
        y_reached=y[0].copy() if np is not None else list(y[0]), sol=None)
    verdict = verdicts[report.verdict]
    if verdict == "unstable" and not status and report.max > 1:
        warnings.warn(
            f"The energy changes by up to {report.max:.2g} times its scale: these "
            "steps are no measure of the orbit; take a smaller dt, or another "
            "integrator.", RuntimeWarning, stacklevel=4)
    if verdict == "undecided" and not status and not subject.calls_python:
        result._settle = _settler(plan, t0, h, t_end, start, report)
    else:
        result["verdict"] = verdict
    return status, result


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
    if np is not None and (least <= times).all() and (times <= most).all() and (
            np.diff(times) * ahead >= 0).all():
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


def _solve_members(H, t_span, y0, given):
    """The orbits of an ensemble: y has the shape (2n, members, times)."""
    if np is None:
        raise ImportError("an ensemble needs NumPy")
    try:
        y0 = np.asarray(y0, float)
    except (TypeError, ValueError):
        raise Refused("y0 takes real numbers, 2n or (2n, members), not %.80r"
                      % (y0,)) from None
    if given["events"] is not None or given["dense_output"]:
        raise Refused("events and dense_output are of one orbit: y0 has the shape %s"
                      % (y0.shape,))
    if isinstance(H, (str, os.PathLike)):  # it is read once
        H = Scene(H, *(given.pop(name) for name in ("parameters", "coordinates",
                                                    "with_effects", "without_effects")))
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        # A function of Python is traced once: the first orbit is made alone.
        runs = [solve(H, t_span, y0[:, 0], **given)] if y0.shape[1] else []
        runs += pool.map(lambda start: solve(H, t_span, start, **given), y0.T[1:])
    if not runs:
        raise Refused("y0 has the shape %s: there is no member" % (y0.shape,))
    kept = min(len(run.t) for run in runs)
    same = {name: runs[0][name] for name in ("method", "dt", "tolerance", "gradient",
                                             "names")}
    first = next((run for run in runs if run.status < 0), runs[0])
    result = Result(
        t=runs[0].t[:kept], y=np.stack([run.y[:, :kept] for run in runs], 1),
        nfev=sum(run.nfev for run in runs), status=first.status, success=first.success,
        message=first.message, energy_error=np.array([run.energy_error for run in runs]),
        energy_drift=np.array([run.energy_drift for run in runs]),
        t_reached=np.array([run.t_reached for run in runs]),
        y_reached=np.stack([run.y_reached for run in runs], 1), members=runs, sol=None,
        **same)
    result._settle = lambda: np.array([run.verdict for run in runs])
    return result


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
    if getattr(y0, "ndim", 1) == 2 or (isinstance(y0, (list, tuple)) and y0 and
                                       isinstance(y0[0], (list, tuple))):
        given = dict(locals())
        del given["H"], given["t_span"], given["y0"]
        return _solve_members(H, t_span, y0, given)
    if method is not None and not isinstance(method, (type, Integrator)):
        _text("method", method)
    start, found = None, Events(events, args)
    if hasattr(H, "_problem"):  # a HGrad
        H, gradient, gradient_step, given = H._problem(gradient, gradient_step)
        parameters, args, coordinates, with_effects, without_effects, params = given
    if not isinstance(H, (Scene, str, os.PathLike)):
        if y0 is None or t_span is None:
            raise Refused("a function needs t_span and y0")
        y0, _ = _numbers(y0, "y0")
        if len(y0) < 2 or len(y0) % 2:
            raise Refused("y0 takes as many momenta as coordinates, not %d in all"
                          % len(y0))
        start = _span(None, t_span)[0], y0
    if observe is not None and not callable(observe):
        raise TypeError("observe is a function, not %r" % type(observe).__name__)
    every = _whole_from_one("every", every)
    subject = _Subject(H, start, parameters, args,
                       coordinates, with_effects, without_effects, params)
    scene = subject.scene
    if args and not found and isinstance(H, (Scene, str, os.PathLike)):
        raise Refused("args are those of a function: give parameters={name: value}")
    if scene and scene.is_formula and (y0 is None or t_span is None):
        raise Refused("a formula needs t_span and y0")
    y = scene.start(y0) if scene else y0
    t0, t_end = _span(scene, t_span)
    y = _numbers(y)
    if not all(map(math.isfinite, y[0])):
        k = next(k for k, number in enumerate(y[0]) if not math.isfinite(number))
        raise Refused("y0[%d]%s is %g" % (
            k, ", the start of %s," % scene.names[k] if scene else "", y[0][k]))
    if not abs(t_end - t0) < math.inf or t_end == t0:
        raise Refused("t_span = %g, %g is no time to go" % (t0, t_end))
    if gradient:
        _gradient(gradient)
    if getattr(method, "step", None):
        if found or dense_output or dt is None or any(one is not None for one in (
                observe, t_eval, rtol, atol, gradient_step, max_step)):
            raise Refused("%s is a function: it takes dt, and neither t_eval, observe, "
                          "events, dense_output, rtol, atol, gradient_step nor max_step"
                          % method.name)
        h = math.copysign(_positive("dt", dt), t_end - t0)
        result = run_steps(method, subject, gradient or ("exact" if scene else "central4"),
                           y, t0, h, list(_times_of_steps(t0, t_end, h)))
        if check and result.status:
            error = Failed(result.message)
            error.result = result
            raise error
        return result
    if scene:
        settings = scene._settings()
        if method is None and settings.integrators:
            method = settings.integrator[0].decode()
        adapts = method is not None and _lib.integrator_adaptive(_integrator(method)[0])
        if dt is None and settings.dts and not adapts:
            dt = settings.dt[0]
        if (rtol is None and settings.tolerances and adapts and
                not scene.is_formula):
            rtol = settings.tolerance[0]
        gradient = gradient or settings.gradient[0].decode()
    dt = None if dt is None else _positive("dt", dt)
    methods = [method] if method is not None else _choose(subject, dt, t0, y)
    dt, tolerance = _steps(methods[0], dt, rtol, atol, t_end - t0, y[0])
    if max_step is not None and _real("max_step", max_step) != math.inf and (
            dt > _positive("max_step", max_step)):
        if not tolerance:
            raise Refused("dt = %g is above max_step = %g" % (dt, max_step))
        dt = float(max_step)
    h = dt if t_end > t0 else -dt
    for name in methods:
        of = None if _takes_none(name) else gradient or "central4"
        try:
            plan = _Plan(subject, name, of, y, t0, tolerance, gradient_step)
        except Refused:
            if name == methods[-1]:
                raise
        else:
            method, gradient = name, of
            break
    if t_eval is None:
        t_eval = _times_of_steps(t0, t_end, h)
    else:
        t_eval = _times_to_keep(t_eval, t0, t_end)
    if found:
        observe, every = _watch_both(found, observe, every), 1
    elif observe is None:
        every = 16 if tolerance else 512
    keeps_steps = bool(found) or dense_output
    kept = _with_steps(t_eval, _times_of_steps(t0, t_end, h)) if keeps_steps else t_eval
    status, result = _run_plan(plan, t0, t_end, h, kept, y, observe, every)
    names = scene.names if scene else None
    result.update(method=getattr(method, "name", method), dt=dt, tolerance=tolerance,
                  gradient=gradient, names=names)
    try:
        subject.trap.spring()
        if keeps_steps and len(result.t):
            _find(result, plan, h, t_eval, found, dense_output)
        if check and status not in (0, _STOPPED):
            _check(status, result.message)
    except BaseException as error:
        result["success"], result["status"] = False, -1
        result["message"] = str(error) or type(error).__name__
        error.result = result
        raise
    return result
