"""Numbers in and out: arrays of NumPy, or lists; results.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ctypes as c
import math
import re
from typing import Any

try:
    import numpy as np
except ImportError:
    np = None

from ._library import Refused


# Arrays: NumPy's, or lists.

def _numbers(values, what="the array"):
    """An array of doubles, and what its memory is passed as."""
    try:
        if np is not None:
            if np.ma.is_masked(values):
                raise Refused("%s has masked values; it takes a number in each place"
                              % what)
            array = np.array(values, ndmin=1)
            if array.dtype.kind not in "biufO":
                raise TypeError
            array = array.astype(float, order="C", copy=False)
            if array.ndim != 1:
                raise Refused("%s has the shape %s; it takes numbers in a row"
                              % (what, array.shape))
            return array, array.ctypes.data
        if isinstance(values, (int, float)):
            values = [values]
        array = (c.c_double * len(values))(*values)
        return array, c.addressof(array)
    except (TypeError, ValueError, OverflowError) as error:
        if isinstance(error, Refused):
            raise
        raise Refused("%s takes real numbers in a row, not %.80r"
                      % (what, values)) from None


def _real(what, value):
    """A number as a float: of Python or NumPy, no text."""
    try:
        if isinstance(value, (str, bytes)) or getattr(value, "ndim", 0) or \
                (np is not None and np.ma.is_masked(value)):
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise Refused("%s = %.80r is not a real number" % (what, value)) from None


def _positive(what, value):
    number = _real(what, value)
    if not 0 < number < math.inf:
        raise Refused("%s = %g: it takes a number above 0" % (what, number))
    return number


def _whole_from_one(what, value):
    number = _real(what, value)
    if number < 1 or number % 1:
        raise Refused("%s = %g: it takes a whole number from 1" % (what, number))
    return int(number)


def _table(rows, columns):
    if np is not None:
        array = np.empty((rows, columns))
        return array, array.ctypes.data
    array = (c.c_double * (rows * columns))()
    return array, c.addressof(array)


def _cut(array, rows, columns, kept):
    if np is not None:
        return array if kept == columns else array[:, :kept].copy()
    return [array[k * columns:k * columns + kept] for k in range(rows)]


class Result(dict):
    """A dictionary whose items are attributes, too, as SciPy's results are.

    A verdict that the run leaves open is found when it is first asked for.
    """

    def __missing__(self, name):
        settle = self.__dict__.get("_settle") if name == "verdict" else None
        if not settle:
            raise KeyError(name)
        self["verdict"] = settle()
        del self._settle
        return self["verdict"]

    def get(self, name, default=None):
        return self[name] if name in self else default

    def __contains__(self, name):
        return dict.__contains__(self, name) or (
            name == "verdict" and "_settle" in self.__dict__)

    def __getattr__(self, name):
        try:
            return self[name]
        except KeyError:
            raise AttributeError(name) from None

    def plot(self, x: str | None = None, y: Any = None, ax: Any = None) -> Any:
        """Draw the orbit by matplotlib: names of variables, or "t"; returns its Axes.
        Default: the first two coordinates, or the only one and its momentum."""
        from ._plot import plot_orbit
        return plot_orbit(self, x, y, ax)

    def __dir__(self):
        return list(self) + ["plot"]

    def __repr__(self):
        width = max(map(len, self), default=0)
        return "\n".join("%*s: %s" % (width, key, re.sub(
            "\n", "\n" + " " * (width + 2), repr(value)[:300]))
                         for key, value in self.items())


def _whole(name):
    """A method of dictionaries that takes all items."""
    method = getattr(dict, name)

    def call(self, *arguments):
        self.get("verdict")
        return method(self, *arguments)
    return call


for _name in "__eq__ __iter__ __len__ __reduce_ex__ copy items keys values".split():
    setattr(Result, _name, _whole(_name))
