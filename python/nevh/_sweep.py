"""sweep: many orbits into an array.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ctypes as c
import math
import os
import re
import threading
import warnings
from typing import Any, Mapping, Sequence

from ._library import (_check, _gradient, _integrator, _lib, _Records, Refused,
                       _substeps, _SweepOptions)
from ._arrays import np, _positive, _real, _whole_from_one
from ._scene import _assign, Scene, _scene, _starts
from ._progress import Progress
from ._run import _Interrupt


def _lines(vary):
    if isinstance(vary, str):
        return [vary]
    return [_assign(name, value) for name, value in vary.items()] \
        if isinstance(vary, dict) else list(vary)


def sweep(scene: str | os.PathLike | Scene, vary: Any = None,
          outcomes: str | Sequence[str] | None = None, integrator: str | None = None, *,
          dt: float | None = None, t_end: float | None = None, rtol: float | None = None,
          gradient: str | None = None, threads: int | None = None,
          count: int | None = None, seed: int | None = None, combine: str | None = None,
          y0: Sequence[float] | Mapping[str, float | str] | None = None,
          parameters: Mapping[str, Any] | None = None,
          coordinates: Sequence[str] | None = None,
          with_effects: str | Sequence[str] = (),
          without_effects: str | Sequence[str] = ()) -> Any:
    """Many orbits of a scene, side by side, into a structured array of NumPy.

    scene     as of Scene; a formula and a function need t_end, a function y0, too
    vary      {name: what}: an array of values, or a text as "range(0, pi, 1000)",
              "normal(1, 0.1)", as [ensemble] of a scene has them; default: the scene's
    outcomes  as "state, last(x), period, verdict" (a number of nevh.verdicts);
              default: the scene's, or state and energy_error
    integrator, dt, t_end, rtol   default: the scene's
    threads   default: all processors

    Returns an array with a field for each name that is varied and each outcome, and
    `status`: 1 where a member is done, 2 where it failed, 3 where it has no start.
    A warning says how many members failed, and why the first did.  The interrupt key
    ends the sweep; the exception's `result` is the array, with status 0 of members that
    are not done.

    >>> made = nevh.sweep("pendulum", {"phi": [1, 2]}, "period", dt=0.05, t_end=20)
    >>> len(made) > 0
    True
    """
    if np is None:
        raise ImportError("nevh.sweep needs NumPy")
    made = _scene(scene, parameters, coordinates, with_effects, without_effects, y0)
    if made is scene:  # the caller's is not changed
        made = Scene(made.text)
    made._set_start(_starts(made, y0))
    lines = _lines(vary) if vary is not None else []
    lines += [_assign(name, value) if isinstance(value, str) else "%s = %d" % (
        name, value) for name, value in (("count", count), ("seed", seed),
                                         ("combine", combine)) if value is not None]
    if lines:
        encoded = (c.c_char_p * len(lines))(*(line.encode() for line in lines))
        made._check(_lib.scene_vary(made._made, encoded, len(lines)))
    if outcomes is not None:
        text = outcomes if isinstance(outcomes, str) else ", ".join(outcomes)
        status = _lib.scene_set_outcomes(made._made, text.encode())
        _check(status, re.sub(r"^assignment:\d+:(\d+): error: ", r"outcomes, column \1: ",
                              _lib.scene_message(made._made).decode()))
    settings = made._settings()
    if integrator is None and settings.integrators:
        integrator = settings.integrator[0].decode()
    found, transformed = _integrator(integrator or "verlet")
    adapts = _lib.integrator_adaptive(found)
    if made.is_formula and (t_end is None or dt is None and not adapts):
        raise Refused("a formula needs t_end, and dt but for methods that adapt")
    if rtol is not None and not adapts:
        raise Refused("%s takes steps of dt and no tolerance: leave out rtol"
                      % (integrator or "verlet"))
    o = _SweepOptions(integrator=found, transformed=transformed,
                      substeps=_substeps(integrator),
                      dt=0 if dt is None else _positive("dt", dt),
                      t_end=0 if t_end is None else _ends(settings, t_end),
                      threads=(os.cpu_count() or 1) if threads is None else
                      _whole_from_one("threads", threads),
                      gradient=_gradient(gradient or settings.gradient[0].decode()),
                      gradient_step=settings.gradient_step,
                      gradient_steps=settings.gradient_steps,
                      tolerance=0 if not adapts else _tolerance(made, rtol))
    with _Interrupt() as interrupt:
        made_sweep = _lib.sweep_new(made._made, c.byref(o))
        try:
            return _sweep(made_sweep, interrupt)
        finally:
            _lib.sweep_free(made_sweep)


def _tolerance(scene, rtol):
    """rtol, else the first of the scene's, else 1e-9."""
    settings = scene._settings() if scene and not scene.is_formula else None
    if rtol is None:
        return settings.tolerance[0] if settings and settings.tolerances else 1e-9
    return _positive("rtol", rtol)


def _ends(settings, t_end):
    t_end = _real("t_end", t_end)
    if not settings.t_start < t_end < math.inf:
        raise Refused("t_end = %g: it takes a time after the start, %g"
                      % (t_end, settings.t_start))
    return t_end


def _sweep(s, interrupt):
    def check(status):
        _check(status, _lib.sweep_message(s))
    check(_lib.sweep_status(s))
    members, columns = _lib.sweep_members(s), _lib.sweep_columns(s)
    names = [_lib.sweep_column(s, k).decode() for k in range(columns)]
    size = 8 + 8 * columns
    kind = np.dtype({"names": ["status"] + names, "formats": ["u1"] + ["f8"] * columns,
                     "offsets": [0] + [8 + 8 * k for k in range(columns)],
                     "itemsize": size})
    array = np.zeros(members, kind)
    records = _Records(records=array.ctypes.data, count=members, columns=columns)
    status, done = [], threading.Event()

    def run():
        status.append(_lib.sweep_run(s, 0, members, None, _lib.address("sweep_keep"),
                                     c.byref(records)))
        done.set()
    # In a thread of its own, for that of the caller takes the interrupt key.
    threading.Thread(target=run).start()
    pressed = None
    with Progress("sweep") as progress:
        while True:
            try:
                interrupt.handle()
                if done.wait(0.1):
                    break
                progress.at(np.count_nonzero(array["status"]) / members)
            except BaseException as error:
                pressed = error
                _lib.sweep_stop(s)
    if pressed is not None:
        pressed.result = array
        raise pressed
    check(status[0])
    if records.failed:
        warnings.warn("%d of %d members failed; member %d: %s" % (
            records.failed, members, records.failed_member,
            records.message.decode()), stacklevel=3)
    return array
