"""Dense output, and events: states between steps, and where functions pass zero.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import bisect
import ctypes as c
import math

from ._library import _lib, Refused
from ._arrays import np, _numbers, _real, _table


class DenseOutput:
    """The orbit at any time of a run: sol(t) is the state, a row a variable, or several
    of them for times in a row.  From the last step before, a shorter step of the scheme
    leads there: it is as accurate as the run."""

    def __init__(self, plan, h, times, states):
        self._plan, self._h = plan, h
        self._times = list(times)
        self._states = [list(row) for row in states]
        ahead = h > 0
        self._keys = self._times if ahead else [-t for t in self._times]
        self.t_min, self.t_max = min(times), max(times)

    def __call__(self, t):
        single = not hasattr(t, "__len__") or getattr(t, "ndim", 1) == 0
        times = [_real("t", one) for one in ([t] if single else t)]
        found = [self._at(one) for one in times]
        if single:
            return np.array(found[0]) if np is not None else found[0]
        rows = [list(row) for row in zip(*found)]
        return np.array(rows) if np is not None else rows

    def _state(self, k):
        return [row[k] for row in self._states]

    def _at(self, t):
        if not self.t_min <= t <= self.t_max:
            raise Refused("t = %g is not within the run, %g ... %g"
                          % (t, self._times[0], self._times[-1]))
        k = bisect.bisect_right(self._keys, t if self._h > 0 else -t) - 1
        if self._times[k] == t:
            return self._state(k)
        return self._step(k, t)

    def _step(self, k, t):
        plan, n = self._plan, self._plan.subject.n
        start, at = _numbers(self._state(k))
        one, one_at = _numbers([t])
        _, state_at = _table(2 * n, 1)
        kept = c.c_size_t()
        status = _lib.run_at(plan.stepper, self._times[k], self._h, t, one_at, 1, state_at,
                             c.byref(kept), at, at + 8 * n, None, 0)
        plan.subject.trap.spring()
        plan.check(status)
        return [float(x) for x in start]


class Events:
    """The functions g(t, y, *args) whose zeros are asked for, as SciPy has them:
    g.terminal ends the run at the first zero, or at that of its number; g.direction
    above 0 counts rising passages alone, below 0 falling ones."""

    def __init__(self, given, args=()):
        several = isinstance(given, (list, tuple))
        self.functions = list(given) if several else [] if given is None else [given]
        for g in self.functions:
            if not callable(g):
                raise TypeError("an event is a function of t and y, not %r" % (g,))
        self.args = tuple(args or ())
        self._left = [int(getattr(g, "terminal", False) or 0) for g in self.functions]
        self._before = None

    def __bool__(self):
        return bool(self.functions)

    def value(self, k, t, y):
        got = _real("event %d at t = %g" % (k, t), self.functions[k](
            t, np.array(y) if np is not None else y, *self.args))
        if math.isnan(got):
            raise Refused("event %d is nan at t = %g" % (k, t))
        return got

    def _passes(self, k, before, now):
        direction = getattr(self.functions[k], "direction", 0) or 0
        if before == 0 or before * now > 0:
            return False
        return direction * (now - before) >= 0

    def watch(self, t, y):
        """For `observe`: whether the run ends here."""
        now = [self.value(k, t, y) if left else 0.0 for k, left in enumerate(self._left)]
        before, self._before = self._before or now, now
        ends = False
        for k, left in enumerate(self._left):
            if left and self._passes(k, before[k], now[k]):
                self._left[k] -= 1
                ends = ends or not self._left[k]
        return ends

    def find(self, sol):
        """The times and states of all zeros in a run, a list for each function, and the
        first time at which one ends it, or None."""
        times, states, end = [], [], None
        for k, g in enumerate(self.functions):
            values = [self.value(k, t, sol._state(i)) for i, t in enumerate(sol._times)]
            zeros = [self._zero(k, sol, i, values) for i in range(len(values) - 1)
                     if self._passes(k, values[i], values[i + 1])]
            last = int(getattr(g, "terminal", False) or 0)
            if last and len(zeros) >= last:
                zeros = zeros[:last]
                if end is None or (zeros[-1] - end) * sol._h < 0:
                    end = zeros[-1]
            times.append(zeros)
        if end is not None:
            times = [[t for t in row if (t - end) * sol._h <= 0] for row in times]
        for row in times:
            states.append([list(sol(t)) for t in row])
        if np is not None:
            times = [np.array(row) for row in times]
            states = [np.array(row) for row in states]
        return times, states, end

    def _zero(self, k, sol, i, values):
        """The zero within a step, by regula falsi with bisection, to rounding."""
        a, b, fa, fb = sol._times[i], sol._times[i + 1], values[i], values[i + 1]
        side = 0
        for _ in range(200):
            if fb == 0 or abs(b - a) <= 4e-16 * max(abs(a), abs(b)):
                break
            t = b - fb * (b - a) / (fb - fa)
            if not min(a, b) < t < max(a, b) or _ % 3 == 2:
                t = a + (b - a) / 2
            if t in (a, b):
                break
            f = self.value(k, t, sol(t))
            if f * fb <= 0:
                a, fa, side = b, fb, 0
            elif side:
                fa /= 2
            else:
                side = 1
            b, fb = t, f
        return b if abs(fb) <= abs(fa) else a
