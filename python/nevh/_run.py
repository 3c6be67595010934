"""Plans and runs of the library: one stepper, and what watches it.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ctypes as c
import math
import signal
import threading
import warnings

from ._library import (_check, _gradient, _integrator, _JudgedRun, _lib, _observe_fn,
                       _Observer, _Options, Refused, _STOPPED, _substeps, verdicts)
from ._arrays import _cut, np, _numbers, _positive, Result, _table
from ._functions import _set_gradient_steps
from ._progress import Progress


class _Plan:
    """A stepper and what watches it."""

    def __init__(self, subject, name, gradient, y, t0, tolerance, gradient_step, width=1,
                 steps=0):
        self.subject = subject
        self._made_of = (subject, name, gradient, list(y[0]), t0, tolerance, gradient_step)
        integrator, transformed = _integrator(name)
        o = self.options = _Options(t=t0, q=y[1], p=y[1] + 8 * subject.n * width,
                                    tolerance=tolerance, width=width, steps_foreseen=steps,
                                    substeps=_substeps(name))
        if subject.scene and not o.substeps:
            o.substeps = subject.scene._settings().substeps
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

    def __reduce__(self):  # to copy and to pickle it
        return _plan_again, self._made_of

    def check(self, status):
        _check(status, _lib.stepper_message(self.stepper))


def _plan_again(subject, name, gradient, y, t0, tolerance, gradient_step):
    return _Plan(subject, name, gradient, _numbers(y), t0, tolerance, gradient_step)


_signals = [getattr(signal, name) for name in (
    "SIGINT", "SIGALRM", "SIGTERM", "SIGHUP", "SIGUSR1", "SIGUSR2") if hasattr(signal, name)]


class _Interrupt:
    """While the library runs, signals are noted: what their handlers raised as a callback
    begins would be lost."""

    def __init__(self):
        self.pressed = False  # other threads are to end
        self.before, self.noted = {}, []

    def __enter__(self):
        if threading.current_thread() is threading.main_thread():
            for one in _signals:
                handler = signal.getsignal(one)
                if callable(handler):
                    self.before[one] = handler
                    signal.signal(one, self.note)
        return self

    def note(self, *given):
        self.noted.append(given)

    def handle(self):
        """Calls the handlers of what was noted, in the main thread."""
        if self.pressed:
            raise KeyboardInterrupt
        while self.noted and threading.current_thread() is threading.main_thread():
            number, frame = self.noted.pop(0)
            self.before[number](number, frame)

    def __exit__(self, kind, *_):
        if threading.current_thread() is threading.main_thread() and self.before:
            for one, handler in self.before.items():
                signal.signal(one, handler)
            if kind is None:
                self.handle()
            self.before = {}


def _watcher(observe, n, trap, interrupt, progress=None):
    """An observer that calls `observe`, looks for the interrupt key, and tells
    `progress` the time."""
    view = c.c_double * n

    def watch(_, step, t, q, p):
        try:
            interrupt.handle()
            if progress is not None:
                progress(t)
            if observe is None:
                return 0
            y = list(view.from_address(q)) + list(view.from_address(p))
            return bool(observe(t, np.array(y) if np is not None else y))
        except BaseException as error:
            trap.error = error
            return 1
    return _observe_fn(watch)


def _times_of_steps(t0, t_end, h):
    if abs((t_end - t0) / h) > 1e12:
        raise Refused("steps of %g are %.2g until t = %g, more than can be kept: give "
                      "t_eval, or a longer dt" % (abs(h), abs((t_end - t0) / h), t_end))
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


def _run_watched(plan, t0, t_end, h, times, states_at, y, observe, every, interrupt):
    """Runs a plan from y, which moves with it; the status, and how many states are kept."""
    subject, n = plan.subject, plan.subject.n
    times, times_at = _numbers(times)
    kept = c.c_size_t()
    with Progress("solve") as progress, interrupt or _Interrupt() as interrupt:
        watch = _watcher(observe, n, subject.trap, interrupt,
                         (lambda t: progress.at((t - t0) / (t_end - t0)))
                         if progress.looks else None)
        watched = [(_lib.address("energy_observe"), plan.energy, 1),
                   *_stops(subject.scene), (c.cast(watch, c.c_void_p).value, None, every)]
        status = _lib.run_at(plan.stepper, t0, h, t_end, times_at, len(times), states_at,
                             c.byref(kept), y[1], y[1] + 8 * n,
                             (_Observer * len(watched))(*watched), len(watched))
        try:
            interrupt.handle()
        except BaseException as error:
            subject.trap.error = subject.trap.error or error
    return status, kept.value


def _end_of(plan, status):
    """The status of a run, and what there is to say about its end."""
    scene = plan.subject.scene
    message = _lib.stepper_message(plan.stepper).decode()
    if status == _STOPPED and _lib.energy_status(plan.energy):
        status = _lib.energy_status(plan.energy)
        message = _lib.energy_message(plan.energy).decode()
    if status == _STOPPED and scene and _lib.scene_stops(scene._made):
        message += ": " + _lib.scene_stop_text(scene._made).decode()
    effect = c.c_char_p()
    passed = _lib.energy_passed(plan.energy, c.byref(effect))
    if not math.isnan(passed) and status in (0, _STOPPED):
        status = -1
        message = (f"A step before t = {passed:.6g} passes a pole of "
                   f"{effect.value.decode()}: what follows is not the orbit of H.")
    return status, message or "The end of t_span was reached."


def _run_plan(plan, t0, t_end, h, times, y, observe, every, interrupt=None):
    """The orbit as a Result, and the status of the library."""
    n, start = plan.subject.n, list(y[0])
    states, states_at = _table(2 * n, len(times))
    ran, count = _run_watched(plan, t0, t_end, h, times, states_at, y, observe, every,
                              interrupt)
    status, message = _end_of(plan, ran)
    report = _lib.energy_result(plan.energy, 0)
    counts = _lib.stepper_counts(plan.stepper)
    result = Result(
        t=times[:count] if count < len(times) else times,
        y=_cut(states, 2 * n, len(times), count),
        nfev=counts.gradients, hamiltonian_evals=counts.hamiltonians,
        status=0 if not status else 1 if status == _STOPPED else -1,
        message=message, success=status in (0, _STOPPED), energy_error=report.max,
        energy_drift=report.drift, energy_scale=report.scale,
        t_reached=t_end if not ran else _lib.stepper_time(plan.stepper)
        if _lib.stepper_taken(plan.stepper) else t0,
        y_reached=y[0].copy() if np is not None else list(y[0]), sol=None,
        t_events=None, y_events=None)
    _judge(result, plan, report, status, (t0, h, t_end, start))
    return status, result


def warn_of(verdict, report, level):
    """Warns where errors of the energy are as large as the energy."""
    if verdict == "unstable" and report.max > 1:
        warnings.warn(
            f"The energy changes by up to {report.max:.2g} times its scale: these "
            "steps are no measure of the orbit; take a smaller dt, or another "
            "integrator.", RuntimeWarning, stacklevel=level)


def _judge(result, plan, report, status, run):
    """Adds the verdict to a result, or how it is found; warns of large errors."""
    t0, h, t_end, start = run
    verdict = verdicts[report.verdict]
    if not status:
        warn_of(verdict, report, 6)
    if verdict == "undecided" and not status and not plan.subject.calls_python:
        result._settle = _settler(plan, t0, h, t_end, start, report)
    else:
        result["verdict"] = verdict
