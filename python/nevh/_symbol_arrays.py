"""Arrays of symbols: NumPy's, of objects, whose functions are those of `_symbol`.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import math
import operator

import numpy as np

from ._symbol import (Complex, ComplexNumber, Float, FUNCTIONS, NUMPY_NAMES, Symbol, apply,
                      extreme, has_symbol, refuse, total)


def _or_number(known, plain):
    """A function of symbols, or that of NumPy where all are numbers."""
    def function(*of):
        return known(*of) if has_symbol(of) else plain(*of)
    return function


def _heaviside(x, middle):
    if middle != 0.5:
        refuse("formulas have no heaviside but with 0.5 at 0", x)
    return (1 + apply("sign", x)) / 2


def _refused(name):
    def function(*of):
        refuse("formulas have no %s%s" % ("numpy." * hasattr(np, name), name), *of)
    return function


#: Functions of one element, or of one element of each argument, by a ufunc's name.
_ELEMENTS = {
    "add": operator.add, "subtract": operator.sub, "multiply": operator.mul,
    "divide": operator.truediv, "true_divide": operator.truediv,
    "negative": operator.neg, "positive": operator.pos, "remainder": operator.mod,
    "mod": operator.mod, "floor_divide": operator.floordiv, "power": operator.pow,
    "less": operator.lt, "less_equal": operator.le, "greater": operator.gt,
    "greater_equal": operator.ge, "equal": operator.eq, "not_equal": operator.ne,
    "divmod": divmod, "conjugate": lambda x: x.conjugate(),
    "square": lambda x: x * x, "reciprocal": lambda x: 1 / x,
    "maximum": extreme("max"), "minimum": extreme("min"), "fmax": extreme("max"),
    "fmin": extreme("min"),
    "logaddexp": lambda a, b: np.log(np.exp(a) + np.exp(b)),
    "clip": lambda x, low, high: extreme("min")(extreme("max")(x, low), high)}
_BY_SYMBOL = {"rint": round, "sign": lambda x: apply("sign", x), "heaviside": _heaviside,
              "j0": lambda x: apply("bessel_j0", x), "j1": lambda x: apply("bessel_j1", x)}
for _name, _known in NUMPY_NAMES.items():
    _BY_SYMBOL.setdefault(_name, FUNCTIONS[_known])


def _element(ufunc):
    name = ufunc.__name__
    if name in _ELEMENTS:
        return _ELEMENTS[name]
    return _or_number(_BY_SYMBOL.get(name) or _refused(name), ufunc)


def _plain(x):
    """x as NumPy's own array, of numbers where it has no symbol."""
    if isinstance(x, (list, tuple)):
        return type(x)(map(_plain, x)) if type(x) in (list, tuple) else x
    if not isinstance(x, Symbols):
        return x
    return x.view(np.ndarray) if has_symbol(x) else x.astype(float)


def _objects(x):
    """x as an array of objects, of which numbers are Python's."""
    if isinstance(x, (Symbol, Complex)):
        array = np.empty((), object)
        array[()] = x
        return array
    if isinstance(x, np.generic):
        x = x.item()  # whose operators do not call NumPy again
    return np.asarray(_plain(x), dtype=object)


def made(x):
    """A result: arrays of objects are symbols', a single one is itself."""
    if isinstance(x, tuple):
        return tuple(map(made, x))
    if isinstance(x, list):
        return list(map(made, x))
    if isinstance(x, np.ndarray) and x.dtype == object:
        return x.view(Symbols) if x.ndim else x.item()
    return x


def _ufunc(ufunc, method, *inputs, out=None, where=True, dtype=None, casting=None,
           order=None, subok=None, **named):
    if where is not True and (method != "reduce" or has_symbol([where])):
        refuse("it uses where= of numpy.%s" % ufunc.__name__, *inputs)
    if ufunc.__name__ == "matmul":
        result = _matmul(*inputs)
    elif method == "at":
        return _at(_element(ufunc), *inputs)
    else:
        of = [_objects(x) for x in inputs]
        lifted = np.frompyfunc(_element(ufunc), len(inputs) if method == "__call__" else 2,
                               ufunc.nout)
        result = made(_reduced(lifted, of[0], ufunc.identity, where, **named)
                      if method == "reduce" else getattr(lifted, method)(*of, **named))
        if all(kind.endswith("?") for kind in ufunc.types) and isinstance(
                result, Symbols):
            result = result.view(np.ndarray).astype(bool)
    if out is None or out[0] is None:
        return result
    if out[0].dtype != object:
        refuse("it writes a value into an array of numbers that was made before",
               *inputs)
    out[0][...] = result
    return out[0]


def _reduced(lifted, x, neutral, where, axis=0, initial=None, keepdims=False):
    """ufunc.reduce, one axis after the other."""
    if where is not True:
        x = np.where(where, x, neutral)
    axes = tuple(range(x.ndim)) if axis is None else axis if isinstance(axis, tuple) else \
        (axis,)
    for k in sorted((k % max(x.ndim, 1) for k in axes), reverse=True):
        x = lifted.reduce(x, axis=k, keepdims=keepdims)
    known = initial is not None and initial is not np._NoValue
    return lifted(_objects(x), initial) if known else x


def _array_ufunc(self, ufunc, method, *inputs, **named):
    return _ufunc(ufunc, method, *inputs, **named)


def _at(element, array, indices, *of):
    """ufunc.at: each index in its turn, also where it comes twice."""
    places = np.arange(array.size).reshape(array.shape)[indices]
    others = [np.broadcast_to(_objects(x), places.shape).ravel().tolist() for x in of]
    flat = array.reshape(-1)
    for k, place in enumerate(places.ravel().tolist()):
        flat[place] = element(flat[place], *(x[k] for x in others))
    array[...] = flat.reshape(array.shape)


Symbol.__array_ufunc__ = Complex.__array_ufunc__ = _array_ufunc
Float.dtype = np.dtype(float)  # what numpy.zeros(3, dtype=float) makes of it
ComplexNumber.dtype = np.dtype(complex)


#: Functions of NumPy for arrays of symbols, where NumPy's do not do: _symbol_functions's.
OWN = {}


class Symbols(np.ndarray):
    """An array of symbols and numbers."""

    __array_priority__ = 1000
    __array_ufunc__ = _array_ufunc

    def __array_function__(self, function, kinds, of, named):
        if not has_symbol([of, list(named.values())]):
            return function(*map(_plain, of), **{
                name: _plain(x) for name, x in named.items()})
        own = OWN.get(function)
        if own is not None:
            return made(own(*of, **named))
        if function.__module__ == "numpy.linalg" and function not in (
                np.linalg.matrix_power, np.linalg.multi_dot):
            refuse("formulas have no numpy.linalg.%s" % function.__name__, *_flat(of))
        return made(super().__array_function__(function, (Symbols,), of, named))

    def astype(self, dtype, *_, **__):
        if np.dtype(dtype).kind not in "fcO":
            if not has_symbol(self):
                return self.view(np.ndarray).astype(dtype)
            refuse("it makes numbers of the type %s" % np.dtype(dtype), *self.ravel())
        return self.copy() if has_symbol(self) or np.dtype(dtype).kind == "O" else \
            self.view(np.ndarray).astype(dtype)

    def dot(self, other):
        return _dot(self, other)

    def sum(self, axis=None, dtype=None, out=None, **named):
        return np.add.reduce(self, axis=axis, out=out, **named) if named or \
            axis is not None or out is not None else total(self.ravel().tolist())

    def mean(self, axis=None, **named):
        return _mean(self, axis, **named)

    def prod(self, axis=None, dtype=None, **named):
        return np.multiply.reduce(self, axis=axis, **named)

    def max(self, axis=None, **named):
        return np.maximum.reduce(self.ravel() if axis is None and not named else self,
                                 axis=axis or 0 if not named else axis, **named)

    def min(self, axis=None, **named):
        return np.minimum.reduce(self.ravel() if axis is None and not named else self,
                                 axis=axis or 0 if not named else axis, **named)

    def var(self, axis=None, **named):
        return _var(self, axis)

    def std(self, axis=None, **named):
        return np.sqrt(_var(self, axis))

    @property
    def real(self):
        return _each(lambda x: x.real, self)

    @property
    def imag(self):
        return _each(lambda x: x.imag, self)

    def conj(self):
        return np.conjugate(self)
    conjugate = conj


def _each(function, a):
    """A function of one element for an array, or for a symbol."""
    return made(np.frompyfunc(function, 1, 1)(_objects(a)))


def _matmul(a, b):
    return made(np.matmul(_objects(a), _objects(b)))


def _dot(a, b, out=None):
    return made(np.dot(_objects(a), _objects(b)))


def _sum(a, axis=None, **named):
    return symbols(a).sum(axis=axis, **named)


def _mean(a, axis=None, dtype=None, out=None, **named):
    a, axes = symbols(a), axis if isinstance(axis, tuple) else (axis,)
    if not set(named) <= {"keepdims"}:
        refuse("numpy.mean is known of all elements", *_flat(a))
    return a.sum(axis=axis, **named) / (
        a.size if axis is None else math.prod(a.shape[k] for k in axes))


def _flat(x):
    """The symbols of rows or arrays, in a row."""
    if isinstance(x, (list, tuple)):
        return [one for part in x for one in _flat(part)]
    return x.ravel().tolist() if isinstance(x, np.ndarray) and x.dtype == object else [x]


def _var(a, axis=None, **named):
    a = symbols(a)
    middle = _mean(a, axis)
    if axis is not None:
        middle = np.expand_dims(middle, axis)
    return _mean((a - middle) ** 2, axis)


def _round(a, decimals=0, **named):
    if decimals:
        refuse("it rounds to %r digits" % decimals, *symbols(a).ravel())
    return np.rint(symbols(a))


def _gradient_of(f, *spacing, axis=None, **named):
    """numpy.gradient in one dimension, with one spacing."""
    f = symbols(f)
    if f.ndim != 1 or named or len(spacing) > 1 or np.ndim((spacing or (1,))[0]):
        refuse("numpy.gradient is known of one axis with one spacing", *f.ravel())
    h = spacing[0] if spacing else 1.0
    ends = [(f[1] - f[0]) / h], [(f[-1] - f[-2]) / h]
    return np.concatenate([ends[0], (f[2:] - f[:-2]) / (2 * h), ends[1]])


def symbols(x):
    """x as an array of symbols and numbers."""
    return _objects(x).view(Symbols)
