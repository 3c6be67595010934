"""Systems of functions: of Python, or addresses of functions in C.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ctypes as c
import numbers
import os

from ._library import _check, _lib, _Options, Refused, _Separability, _value_fn
from ._arrays import np, _numbers, _real
from ._scene import Scene, _scene
from ._symbol import Untraceable
from . import _traced


def _address(function):
    """The address of a C function double H(double t, const double q[], const double
    p[], const void *params), or None: of a ctypes function or c_void_p, of what
    numba's @cfunc gives, of a scipy.LowLevelCallable.  A plain number is refused:
    nobody could tell that it is an address."""
    if isinstance(function, numbers.Integral):
        raise TypeError("H = %r is a number; an address of a C function is given as "
                        "ctypes.c_void_p(address)" % (function,))
    if isinstance(function, c.c_void_p):
        if not function.value or function.value < 4096:
            raise TypeError("%r is not the address of a function" % function)
        return function.value
    if hasattr(function, "address"):
        return int(function.address)
    if isinstance(function, c._CFuncPtr):
        return c.cast(function, c.c_void_p).value
    if type(function).__name__ == "LowLevelCallable":
        capsule = tuple.__getitem__(function, 0)
        name, pointer = c.pythonapi.PyCapsule_GetName, c.pythonapi.PyCapsule_GetPointer
        name.restype, name.argtypes = c.c_char_p, [c.py_object]
        pointer.restype, pointer.argtypes = c.c_void_p, [c.py_object, c.c_char_p]
        return pointer(capsule, name(capsule))
    return None


class _Trap:
    """Keeps what a function of Python raised until the library has returned.  While
    it plans, H is tried at states where no orbit may come: there an error is but a
    value that is not finite."""

    def __init__(self):
        self.error = None
        self.planning = True

    def spring(self):
        error, self.error = self.error, None
        if error is not None:
            raise error

    def planned(self, status):
        self.planning = False
        if status or not isinstance(self.error, Exception):
            self.spring()
        self.error = None


class _PythonValue:
    """H(t, y, *args, **parameters) of Python as a C function."""

    def __init__(self, calls, n, trap):
        size = 8 * n
        state = np.empty(2 * n) if np is not None else (c.c_double * (2 * n))()
        at = state.ctypes.data if np is not None else c.addressof(state)
        move = c.memmove

        def value(t, q, p, _):
            if trap.error is not None and not trap.planning:
                return float("nan")
            try:
                move(at, q, size)
                move(at + size, p, size)
                return calls(t, state.copy() if np is not None else state[:])
            except BaseException as error:
                trap.error = error
                return float("nan")
        self.function = _value_fn(value)
        self.address = c.cast(self.function, c.c_void_p).value


class _Subject:
    """A system, with what belongs to it: of a scene, or of a function.  A function of
    Python is that of a scene, too, where it can be traced; `start` is a time and a state
    where it has a value."""

    def __init__(self, H, start=None, parameters=None, args=(), coordinates=None,
                 with_effects=(), without_effects=(), params=None):
        self.scene = self.own = None
        self._made_of = (H, start, parameters, args, coordinates, with_effects,
                         without_effects, params)
        self.calls_python = False
        self.trap = _Trap()
        address = None if isinstance(H, (Scene, str, os.PathLike)) else _address(H)
        if address is None and params is not None:
            raise Refused("params is for a function in C; give parameters={name: value}")
        if isinstance(H, (Scene, str, os.PathLike)):
            self._take(_scene(H, parameters, coordinates, with_effects,
                              without_effects))
            return
        if address is not None and (args or parameters):
            raise Refused("a function in C takes params=, neither args nor parameters")
        if address is None and not callable(H):
            raise TypeError("H is a text, a Scene, a function or the address of one, "
                            "not %r" % type(H).__name__)
        if with_effects or without_effects or coordinates and address is not None:
            raise Refused("a function has neither effects nor names of coordinates")
        t0, y0 = start
        self.n = len(y0) // 2
        self.kept = H
        if address is None:
            calls = _traced.calls_of(H, y0, args, parameters)
            if self._trace(calls, t0, y0, coordinates):
                return
            self.kept = _PythonValue(calls, self.n, self.trap)
            address = self.kept.address
            self.calls_python = True
        self.own = self.system = _lib.system_from(
            self.n, address, c.cast(params, c.c_void_p) if params is not None else None)
        _check(_lib.system_status(self.own), _lib.system_message(self.own))

    def _take(self, scene):
        self.scene = scene
        self.system = _lib.scene_system(scene._made)
        self.n = scene.n

    def _trace(self, calls, t0, y0, coordinates):
        """Whether a function of Python is that of a scene; else a warning says why."""
        if not _traced.has_value(calls, t0, y0):
            return False
        try:
            self._take(_traced.scene_of(calls, t0, y0, coordinates))
        except Untraceable as error:
            _traced.warn(error, calls, t0, y0)
        return self.scene is not None

    def __reduce__(self):  # to copy and to pickle it
        return _Subject, (self.scene,) if self.scene else self._made_of

    def __del__(self):
        if getattr(self, "own", None):
            _lib.system_free(self.own)

    def friction(self):
        rates, at = _numbers([0.0] * self.n)
        return rates if _lib.system_friction(self.system, at) else None

    def reads_time(self, t, y):
        """Whether H depends on t; of a function, whether some times differ."""
        if not self.own:
            return not _lib.system_traits(self.system) & 2
        field = _lib.field_new(self.system, c.byref(_Options(gradient_step=1)))
        h, found = c.c_double(), set()
        for later in (0.0, 0.1234, 0.777, 1.618, 31.4, 1234.5):
            _lib.field_value(field, 1, c.byref(c.c_double(t + later)), y[1],
                             y[1] + 8 * self.n, c.byref(h))
            found.add(h.value)
        _lib.field_free(field)
        return len(found) > 1

    def separable(self, t, y):
        if _lib.system_traits(self.system) & 1:
            return True
        found = _Separability()
        _, at = y
        _lib.system_probe(self.system, t, at, at + 8 * self.n, None, c.byref(found))
        return found.separable


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
