"""Ensembles: orbits from many starts, with steps of equal length side by side.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ctypes as c
import math
import os
from concurrent.futures import ThreadPoolExecutor

from ._library import _integrator, _lib, _observe_fn, _Observer, Refused, verdicts
from ._arrays import np, _numbers, _positive, Result
from ._run import (_choose, _Interrupt, _Plan, _steps, _stops, _takes_none,
                   _times_of_steps, _watcher, warn_of)
from ._progress import Progress

_WIDTH = 256  # orbits side by side
_EXTENDED = 3  # a nevh_claim: Tao's
_NUMBERS = 65536  # of their states together


class _Lanes:
    """Orbits side by side by one plan: each is the one that it would be alone."""

    def __init__(self, problem, first, members):
        """Sets `fits`: whether they can be."""
        self.problem, self.fits = problem, False
        scene, subject, t0 = problem.scene, problem.subject, problem.t0
        if not (problem.shares() and scene) or _stops(scene) or problem.max_step or (
                members < 16):
            return
        y = _numbers(first)
        self.method = problem.method or _choose(subject, problem.dt, t0, y)[0]
        found, transformed = _integrator(self.method)
        if _lib.integrator_adaptive(found) or _lib.integrator_own_time(found) or (
                transformed or problem.dt is None or
                _lib.integrator_symplectic(found) == _EXTENDED):
            return  # these plan by the state where an orbit starts
        dt, _ = _steps(self.method, _positive("dt", problem.dt), *problem.tolerances,
                       problem.t_end - t0, y[0])
        self.h = math.copysign(dt, problem.t_end - t0)
        self.gradient = None if _takes_none(self.method) else problem.gradient or "exact"
        if self.gradient not in (None, "exact") or subject.friction() is not None:
            return  # differences are chosen where each orbit starts
        self.steps = _times_of_steps(t0, problem.t_end, self.h)
        self.times = self.steps if problem.times is None else problem._times(self.h)[0]
        self.fits = self._places()

    def _places(self):
        """Whether all times that are asked for are those of steps; their numbers."""
        at = np.abs(self.steps[:, None] - self.times).argmin(0) if self.times.size < 64 else \
            np.rint((self.times - self.steps[0]) / self.h).astype(int).clip(
                0, self.steps.size - 1)
        at[self.times == self.steps[-1]] = self.steps.size - 1
        size = np.abs(self.steps[[0, -1]]).max()
        self.at = at
        return bool((np.abs(self.steps[at] - self.times) <= 1e-15 * size).all())

    def width(self, members):
        share = -(-members // (8 * (os.cpu_count() or 1))) * 8
        most = max(8, _NUMBERS // (16 * self.problem.subject.n) * 8)
        return min(_WIDTH, share, most)

    def _keeper(self, states, n, width):
        """An observer that keeps the states of steps that are asked for."""
        places = {}
        for k, step in enumerate(self.at.tolist()):
            places.setdefault(step, []).append(k)
        half, last = 8 * n * width, self.steps.size - 1
        every = math.gcd(*(step for step in places if step != last), 0) or last

        def keep(_, step, t, q, p):
            for k in places.get(step, ()):
                place = states[k].ctypes.data
                c.memmove(place, q, half)
                c.memmove(place + half, p, half)
            return 0
        return _observe_fn(keep), every

    def block(self, starts, width, interrupt):
        """The results of some members, or None where one of them fails."""
        problem, n = self.problem, self.problem.subject.n
        count = starts.shape[1]
        padded = np.concatenate([starts, np.repeat(starts[:, -1:], width - count, 1)], 1)
        y = np.ascontiguousarray(padded).ravel(), 0
        y = y[0], y[0].ctypes.data
        plan = _Plan(problem.subject, self.method, self.gradient, y, problem.t0, 0.0, None,
                     width, self.steps.size * 1e3)
        states = np.empty((self.times.size, 2 * n, width))
        keep, every = self._keeper(states, n, width)
        watch = _watcher(None, n, problem.subject.trap, interrupt)
        watched = [(_lib.address("energy_observe"), plan.energy, 1),
                   (c.cast(keep, c.c_void_p).value, None, every),
                   (c.cast(watch, c.c_void_p).value, None, 512)]
        with interrupt:
            status = _lib.run_until(plan.stepper, problem.t0, self.h, problem.t_end, y[1],
                                    y[1] + 8 * n * width, (_Observer * 3)(*watched), 3)
        problem.subject.trap.spring()
        effect = c.c_char_p()
        if status or not math.isnan(_lib.energy_passed(plan.energy, c.byref(effect))):
            return None
        gradients = _lib.stepper_counts(plan.stepper).gradients // width
        orbits, ends = np.ascontiguousarray(states.transpose(2, 1, 0)), y[0].reshape(-1, width)
        return [self._result(plan, lane, orbits[lane], ends[:, lane].copy(), gradients,
                             starts[:, lane]) for lane in range(count)]

    def _result(self, plan, lane, y, end, gradients, start):
        problem, report = self.problem, _lib.energy_result(plan.energy, lane)
        result = Result(
            t=self.times, y=y, nfev=gradients, hamiltonian_evals=0.0, status=0,
            message="The end of t_span was reached.", success=True,
            energy_error=report.max, energy_drift=report.drift, energy_scale=report.scale,
            t_reached=problem.t_end, y_reached=end, sol=None, t_events=None, y_events=None,
            method=getattr(self.method, "name", self.method), dt=abs(self.h),
            tolerance=0.0, gradient=self.gradient, names=problem.scene.names)
        verdict = verdicts[report.verdict]
        warn_of(verdict, report, 8)
        if verdict == "undecided":
            result._settle = lambda: problem.orbit(start).verdict
        else:
            result["verdict"] = verdict
        return result


def runs_of_members(problem, y0, alone):
    """The orbits of members, on all processors; alone(start, interrupt) is one of them."""
    members, interrupt = y0.shape[1], _Interrupt()
    lanes = _Lanes(problem, y0[:, 0], members)
    width = lanes.width(members) if lanes.fits else 1

    def run(k):
        if interrupt.pressed:
            raise KeyboardInterrupt
        starts = y0[:, k:k + width]
        made = lanes.block(starts, width, interrupt) if lanes.fits else None
        return made or [alone(start, interrupt) for start in starts.T]
    runs = run(0)  # a function is compiled alone
    rest = range(width, members, width)
    with Progress("solve") as progress, ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        try:
            try:
                all_made = pool.map(run, rest)
            except RuntimeError:  # the interpreter ends: no thread begins
                all_made = map(run, rest)
            for made in all_made:
                runs += made
                progress.at(len(runs) / members)
        except BaseException:
            interrupt.pressed = True
            raise
    return runs


def starts_of(y0, given):
    """The starts of an ensemble, (2n, members)."""
    if np is None:
        raise ImportError("an ensemble needs NumPy")
    try:
        if np.ma.is_masked(y0) or np.asarray(y0).dtype.kind not in "biufO":
            raise TypeError
        y0 = np.asarray(y0, float)
    except (TypeError, ValueError, OverflowError):
        raise Refused("y0 takes real numbers, 2n or (2n, members), not %.80r"
                      % (y0,)) from None
    if given["events"] is not None or given["dense_output"]:
        raise Refused("events and dense_output are of one orbit: y0 has the shape %s"
                      % (y0.shape,))
    if not y0.shape[1]:
        raise Refused("y0 has the shape %s: there is no member" % (y0.shape,))
    return y0


def together(runs):
    """The Result of an ensemble: y has the shape (2n, members, times)."""
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
        t_events=None, y_events=None, **same)
    result._settle = lambda: np.array([run.verdict for run in runs])
    return result
