"""Scenes of functions of Python, by tracing; else a warning that says why not.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ctypes as c
import linecache
import math
import os
import re
import time
import warnings
import weakref

from ._library import _lib, _Options, Refused
from ._arrays import _numbers
from ._scene import Scene
from ._trace import Calls, array, guess, seconds_a_call, still_holds, trace
from ._symbol import Untraceable

_warned, _factors, _scenes = {}, {}, weakref.WeakKeyDictionary()


def calls_of(function, y0, args, parameters):
    odd = [name for name in parameters or () if not isinstance(name, str)]
    if odd:
        raise Refused("parameters has the key %.80r; it takes {name: value}" % (odd[0],))
    return Calls(function, len(y0) // 2, args, parameters)


def has_value(calls, t0, y0):
    """Whether a function has a value where it starts; else its error is its own."""
    try:
        return all(map(math.isfinite, y0)) and math.isfinite(calls(t0, array(y0)))
    except Exception:
        return False


def scene_of(calls, t0, y0, coordinates=None):
    """A Scene of a function; raises Untraceable.  The last of each function is kept, and
    taken again while the function has the same values: it may read what has changed."""
    key = calls.key()
    if key is not None:
        key += tuple(coordinates or ())
        known, traced, scene = _scenes.get(calls.function, (None, None, None))
        if known == key and still_holds(traced, calls, t0, y0):
            return scene
    traced = _traced_of(calls, t0, y0, coordinates)
    scene = _parsed(traced.text)
    _compare(scene, calls, t0, y0)
    if key is not None:
        _scenes[calls.function] = key, traced, scene
    return scene


def _traced_of(calls, t0, y0, coordinates):
    sizes = [re.search(r"\[(\d+)\]$", one) for one in coordinates or ()]
    named = sum(int(size.group(1)) if size else 1 for size in sizes)
    if coordinates and named != calls.n:
        raise Refused("coordinates = %.80r names %d of the %d that y0 has"
                      % (coordinates, named, calls.n))
    name = getattr(calls.function, "__name__", type(calls.function).__name__)
    title = "the function " + name if name.isidentifier() else "a function"
    return trace(calls, t0, y0, coordinates, title)


def text_of(function, y0, parameters=None, coordinates=None):
    """The text of a scene of a function, for what takes no values; refused where there
    is none."""
    if isinstance(function, c._CFuncPtr):
        raise Refused("H is a function in C, and is needed as a formula here")
    if y0 is None or isinstance(y0, dict):
        raise Refused("a function needs y0: its coordinates, then its momenta")
    y0, _ = _numbers(y0, "y0")
    if len(y0) < 2 or len(y0) % 2:
        raise Refused("y0 takes as many momenta as coordinates, not %d in all" % len(y0))
    calls = calls_of(function, y0, (), parameters)
    calls(0.0, array(y0))  # its own error is the best
    try:
        text = _traced_of(calls, 0.0, y0, coordinates).text
        _compare(_parsed(text), calls, 0.0, y0)
    except Untraceable as error:
        raise Refused("H is no formula, and is needed as one here: %s"
                      % reason(error, calls)) from None
    return text


def _parsed(text):
    try:
        scene = Scene(text)
    except Refused as error:
        said = re.sub(r"^\w*:\d+:\d+: error: ", "", str(error)).split("\n")[0]
        raise Untraceable("its formula is refused: " + said) from None
    scene.is_formula = True
    return scene


def _compare(scene, calls, t0, y0):
    """Fails where the scene and the function differ: a check of what is written."""
    known = calls(t0, array(y0))
    field = _field(scene, t0, y0)
    start, at = _numbers(y0)
    h = c.c_double()
    _lib.field_value(field, 1, c.byref(c.c_double(t0)), at, at + 4 * len(y0), c.byref(h))
    _lib.field_free(field)
    if not abs(h.value - known) <= 1e-6 * max(abs(known), abs(h.value)) + 1e-9:
        raise Untraceable("it is %r where it starts, and its formula %r"
                          % (known, h.value))


def _field(scene, t0, y0, **options):
    start, at = _numbers(y0)
    o = _Options(t=t0, q=at, p=at + 4 * len(y0), gradient_step=1, **options)
    return _lib.field_new(_lib.scene_system(scene._made), c.byref(o))


def place_of(untraceable, calls):
    """File and line of the reason."""
    place = untraceable.place
    if place is None:
        code = getattr(calls.function, "__code__", None)
        place = (code.co_filename, code.co_firstlineno) if code else ("H", 0)
    return place


def reason(untraceable, calls):
    file, line = place_of(untraceable, calls)
    text = linecache.getline(file, line).strip()
    what = untraceable.what if untraceable.what.endswith(")") else untraceable.what + (
        " (write H as one formula of operators, math and numpy, or in C)")
    return "%s, line %d: %s%s" % (os.path.basename(file), line, what,
                                  ": " + text if text else "")


def warn(untraceable, calls, t0, y0):
    """Says why H is not a formula, and what that costs; once for each place."""
    place = place_of(untraceable, calls)
    if place not in _factors:
        _factors[place] = _factor(calls, t0, y0)
    slower, took = _factors[place]
    cost = "about %.0f times slower than as a formula" % slower if slower else \
        "slowly, %.1g ms a gradient" % (1e3 * took)
    warnings.warn_explicit(
        "H runs as a function of Python, %s: %s" % (cost, reason(untraceable, calls)),
        RuntimeWarning, place[0], place[1], registry=_warned)


def _factor(calls, t0, y0):
    """How many times as long a gradient of a function takes, by differences of order
    4, as that of a formula of its size: one digit of it, or None; and its seconds."""
    took = 4 * len(y0) * seconds_a_call(calls, t0, y0)
    traced = guess(calls, t0, y0)
    try:
        scene = traced and _parsed(traced.text)
    except Untraceable:
        scene = None
    if scene is None:
        return None, took
    return float("%.1g" % (took / _seconds_a_gradient(scene, t0, y0))), took


def _seconds_a_gradient(scene, t0, y0):
    """Of blocks of 4 states: that is what it costs within a step."""
    width = 4
    field = _field(scene, t0, y0, gradient=_lib.gradient_named(b"exact"))
    rows, at = _numbers([x for x in y0 for _ in range(width)])
    times, times_at = _numbers([t0] * width)
    out, out_at = _numbers([0.0] * (width * len(y0)))
    half, best = 4 * len(y0) * width, math.inf
    for _ in range(50):
        start = time.perf_counter()
        _lib.field_gradient(field, width, times_at, at, at + half, out_at, out_at + half)
        best = min(best, time.perf_counter() - start)
    _lib.field_free(field)
    return best / width
