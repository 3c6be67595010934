"""HGrad: Hamilton's equations of H as a function of t and y.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ctypes as c
import math
import os
from typing import Any, Mapping, Sequence

from ._library import _check, Failed, _gradient, _lib, _Options, Refused
from ._arrays import np, _numbers, _table
from ._scene import Scene
from ._functions import _set_gradient_steps, _Subject


def _hgrad(H, ds, named):
    return HGrad(H, ds, **named)


class HGrad:
    """The right-hand side f(t, y) of Hamilton's equations, for solve_ivp and others.

        G = nevh.HGrad(H, k=4, m=1)
        solve_ivp(G, (0, 3), [1, 0])

    H   as of solve; of a function's other parameters `constants` are the values
    ds  half the spread of the differences: a number, or one for each of y; default:
        chosen where the first state is
    gradient  default: central4 of values of H

    y may be of shape (2n,), or (2n, k) for k states.  `counts` says how often H was
    evaluated.  One thread at a time may call it.
    """

    def __init__(self, H: Any, ds: float | Sequence[float] | None = None, *,
                 gradient: str = "central4", args: Sequence[Any] = (),
                 coordinates: Sequence[str] | None = None,
                 with_effects: str | Sequence[str] = (),
                 without_effects: str | Sequence[str] = (), params: Any = None,
                 parameters: Mapping[str, Any] | None = None, **constants: Any) -> None:
        self._given = H, ds, dict(
            constants, gradient=gradient, args=args, coordinates=coordinates,
            with_effects=with_effects, without_effects=without_effects, params=params,
            parameters=parameters)
        self._gradient = _gradient(gradient)
        self._ds = ds
        constants = dict(parameters or {}, **constants)
        self._subject, self._field, self._width = None, None, 0
        self._of = (constants, args, coordinates, with_effects, without_effects, params)
        if isinstance(H, (Scene, str, os.PathLike)):
            self._subject = _Subject(H, None, *self._of)

    def _problem(self, gradient, gradient_step):
        """What solve takes instead of it."""
        return (self._given[0], gradient or self._given[2]["gradient"],
                self._ds if gradient_step is None else gradient_step, self._of)

    def __reduce__(self):  # to copy and to pickle it
        return _hgrad, self._given

    def __del__(self):
        if getattr(self, "_field", None):
            _lib.field_free(self._field)

    def _plan(self, t, y):
        size = len(y)
        if self._subject is None and size % 2:
            raise Refused("y has %d numbers; it takes as many momenta as coordinates"
                          % size)
        first = [row[0] if hasattr(row, "__len__") else row for row in y]
        start, at = _numbers(first)
        if self._subject is None:
            self._subject = _Subject(self._given[0], (float(t), start), *self._of)
        n = self._n = self._subject.n
        self._count(size)
        o = _Options(t=t, q=at, p=at + 8 * n, gradient=self._gradient)
        self._steps = _set_gradient_steps(o, self._subject.scene, self._ds, n, "ds")
        self._field = _lib.field_new(self._subject.system, c.byref(o))
        status = _lib.field_status(self._field)
        self._subject.trap.planned(status)
        _check(status, _lib.field_message(self._field))
        self._rates = self._subject.friction()

    def _count(self, size):
        if size != 2 * self._n:
            raise Refused("y has %d numbers; it takes %d" % (size, 2 * self._n))

    def _room(self, width):
        self._width = width
        half = 8 * self._n * width
        self._y, at = _table(2 * self._n, width)
        self._dy, out = _table(2 * self._n, width)
        self._t, times = _numbers([0.0] * width)
        self._call = (self._field, width, times, at, at + half, out + half, out)

    def __call__(self, t, y):
        if np is not None:
            y = np.asarray(y)
            if y.ndim not in (1, 2) or y.dtype.kind not in "biufO":
                raise Refused("y has the shape %s of %s; it takes real numbers, (2n,) or "
                              "(2n, k)" % (y.shape, y.dtype))
            if y.ndim == 2 and not y.shape[1]:
                return np.empty(y.shape)
        if self._field is None:
            self._plan(t, y)
        if np is None:
            return self._lists(t, y)
        width = y.shape[1] if y.ndim == 2 else 1
        if width != self._width:
            self._room(width)
        n = self._n
        if len(y) != 2 * n:
            self._count(len(y))
        self._t[:] = t
        self._y[:] = y if y.ndim == 2 else y[:, None]
        self._take()
        dy = self._dy.copy()
        np.negative(dy[n:], out=dy[n:])
        if self._rates is not None:
            dy[n:] -= np.asarray(self._rates)[:, None] * self._y[n:]
        return dy if y.ndim == 2 else dy[:, 0]

    def _lists(self, t, y):
        if self._width != 1:
            self._room(1)
        n = self._n
        self._count(len(y))
        self._t[0] = t
        self._y[:] = y
        self._take()
        rates = self._rates or [0.0] * n
        return self._dy[:n] + [-d - r * p for d, r, p in
                               zip(self._dy[n:], rates, self._y[n:])]

    def _take(self):
        status = _lib.field_gradient(*self._call)
        self._subject.trap.spring()
        if status:
            for k, number in enumerate(self._y if np is None else self._y.ravel()):
                if not math.isfinite(number):
                    raise Failed("y[%d] is %g" % (k // self._width, number))
            _check(status, _lib.field_message(self._field))
