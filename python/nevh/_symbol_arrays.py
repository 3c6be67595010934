"""Arrays of symbols: NumPy's, of objects, whose functions are those of `_symbol`.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import functools
import operator
import types

import numpy as np

from ._symbol import (Float, FUNCTIONS, NUMPY_NAMES, Symbol, apply, extreme, has_symbol, length,
                     product, refuse, total)


def _or_number(known, plain):
    """A function of symbols, or that of NumPy where all are numbers."""
    def function(*of):
        return known(*of) if any(isinstance(x, Symbol) for x in of) else plain(*of)
    return function


def _heaviside(x, middle):
    if middle != 0.5:
        refuse("formulas have no heaviside but with 0.5 at 0", x)
    return (1 + apply("sign", x)) / 2


def _refused(name):
    def function(*of):
        refuse("formulas have no numpy.%s" % name, *of)
    return function


#: Functions of one element, or of one element of each argument, by a ufunc's name.
_ELEMENTS = {
    "add": operator.add, "subtract": operator.sub, "multiply": operator.mul,
    "divide": operator.truediv, "true_divide": operator.truediv,
    "negative": operator.neg, "positive": operator.pos, "remainder": operator.mod,
    "mod": operator.mod, "floor_divide": operator.floordiv, "power": operator.pow,
    "less": operator.lt, "less_equal": operator.le, "greater": operator.gt,
    "greater_equal": operator.ge, "equal": operator.eq, "not_equal": operator.ne,
    "divmod": divmod, "conjugate": lambda x: x, "square": lambda x: x * x, "reciprocal": lambda x: 1 / x,
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
    if isinstance(x, Symbol):
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
    if where is not True:
        refuse("it uses where= of numpy.%s" % ufunc.__name__, *inputs)
    if ufunc.__name__ == "matmul":
        result = _matmul(*inputs)
    else:
        of = [_objects(x) for x in inputs]
        lifted = np.frompyfunc(_element(ufunc), len(inputs) if method == "__call__" else 2,
                               ufunc.nout)
        result = made(getattr(lifted, method)(*of, **named))
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


def _array_ufunc(self, ufunc, method, *inputs, **named):
    return _ufunc(ufunc, method, *inputs, **named)


Symbol.__array_ufunc__ = _array_ufunc
Float.dtype = np.dtype(float)  # what numpy.zeros(3, dtype=float) makes of it


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
        return made(super().__array_function__(function, (Symbols,), of, named))

    def astype(self, dtype, *_, **__):
        if np.dtype(dtype).kind not in "fO":
            if not has_symbol(self):
                return self.view(np.ndarray).astype(dtype)
            refuse("it makes numbers of the type %s" % np.dtype(dtype), *self.ravel())
        return self.copy() if has_symbol(self) or np.dtype(dtype).kind == "O" else \
            self.view(np.ndarray).astype(dtype)

    def dot(self, other):
        return _dot(self, other)

    def sum(self, axis=None, **named):
        return np.add.reduce(self, axis=axis) if axis is not None else \
            total(self.ravel().tolist())

    def mean(self, axis=None, **named):
        return _mean(self, axis)

    def prod(self, axis=None, **named):
        return np.multiply.reduce(self.ravel() if axis is None else self, axis=axis or 0)

    def max(self, axis=None, **named):
        return np.maximum.reduce(self.ravel() if axis is None else self, axis=axis or 0)

    def min(self, axis=None, **named):
        return np.minimum.reduce(self.ravel() if axis is None else self, axis=axis or 0)

    def var(self, axis=None, **named):
        return _var(self, axis)

    def std(self, axis=None, **named):
        return np.sqrt(_var(self, axis))

    @property
    def real(self):
        return self

    def conj(self):
        return self


def _matmul(a, b):
    return made(np.matmul(_objects(a), _objects(b)))


def _dot(a, b, out=None):
    return made(np.dot(_objects(a), _objects(b)))


def _sum(a, axis=None, **named):
    return symbols(a).sum(axis=axis)


def _mean(a, axis=None, **named):
    a = symbols(a)
    return a.sum(axis=axis) / (a.size if axis is None else a.shape[axis])


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


def _norm(a, ord=None, axis=None, keepdims=False):
    a = symbols(a)
    if ord not in (None, 2, "fro") or (a.ndim > 1 and axis is None and ord == 2):
        if ord == 1 and a.ndim == 1:
            return _sum(abs(a))
        refuse("formulas have no numpy.linalg.norm with ord=%r" % ord, *a.ravel())
    if axis is None:
        return length(a.ravel().tolist())
    rows = np.moveaxis(a, axis, -1)
    found = np.empty(rows.shape[:-1], object)
    for index in np.ndindex(*found.shape):
        found[index] = length(rows[index].tolist())
    return made(np.expand_dims(found, axis) if keepdims else found)


def _minor(a, i, j):
    return [row[:j] + row[j + 1:] for k, row in enumerate(a) if k != i]


def _det(rows):
    if len(rows) == 1:
        return rows[0][0]
    return total((-1) ** j * rows[0][j] * _det(_minor(rows, 0, j))
                 for j in range(len(rows)) if not _is_zero(rows[0][j]))


def _is_zero(x):
    return not isinstance(x, Symbol) and x == 0


def _solve_rows(a, b):
    """Solves a x = b: up to three rows by Cramer's rule, which no small pivot spoils,
    else by elimination in the order given; the check of values tells if it was good."""
    a, b = [list(row) for row in a], [list(row) for row in b]
    n = len(a)
    if n <= 3:
        whole = _det(a)
        return [[total((-1) ** (i + j) * _det(_minor(a, j, i)) * b[j][k]
                       for j in range(n)) / whole if n > 1 else b[0][k] / whole
                 for k in range(len(b[0]))] for i in range(n)]
    for i in range(n):
        pivot = next((k for k in range(i, n) if not _is_zero(a[k][i])), i)
        a[i], a[pivot], b[i], b[pivot] = a[pivot], a[i], b[pivot], b[i]
        for k in range(i + 1, n):
            if not _is_zero(a[k][i]):
                factor = a[k][i] / a[i][i]
                a[k] = [x - factor * y for x, y in zip(a[k], a[i])]
                b[k] = [x - factor * y for x, y in zip(b[k], b[i])]
    for i in reversed(range(n)):
        for k in range(len(b[i])):
            known = total(a[i][j] * b[j][k] for j in range(i + 1, n))
            b[i][k] = (b[i][k] - known) / a[i][i]
    return b


def _square(a, what):
    a = symbols(a)
    if a.ndim != 2 or a.shape[0] != a.shape[1]:
        refuse("numpy.linalg.%s is known of one square matrix" % what, *a.ravel())
    return a


def _solve(a, b):
    a, b = _square(a, "solve"), symbols(b)
    rows = b.reshape(len(b), -1).tolist()
    found = np.empty((len(b), len(rows[0])), object)
    found[...] = _solve_rows(a.tolist(), rows)
    return made(found.reshape(b.shape))


def _inv(a):
    return _solve(a, np.eye(len(a)))


def _determinant(a):
    rows = _square(a, "det").tolist()
    if len(rows) > 6:
        refuse("numpy.linalg.det is known of up to 6 rows", *rows[0])
    return _det(rows)


def _cross(a, b, **named):
    a, b = symbols(a), symbols(b)
    if named or not a.shape[-1:] == b.shape[-1:] == (3,):
        if named or not a.shape[-1:] == b.shape[-1:] == (2,):
            refuse("numpy.cross is known of vectors in the last axis", *a.ravel())
        return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return np.stack([a[..., i] * b[..., j] - a[..., j] * b[..., i]
                     for i, j in ((1, 2), (2, 0), (0, 1))], axis=-1)


def _einsum(rule, *of, **named):
    """Products of all elements whose letters agree, summed."""
    rule = rule.replace(" ", "") if isinstance(rule, str) else "."
    if "." in rule:
        refuse("numpy.einsum is known with letters for all axes", *of)
    of = [symbols(x) for x in of]
    left, arrow, right = rule.partition("->")
    parts = left.split(",")
    if not arrow:
        right = "".join(sorted(c for c in set(left) - {","} if left.count(c) == 1))
    size = {c: n for part, x in zip(parts, of) for c, n in zip(part, x.shape)}
    summed = "".join(sorted(set(size) - set(right)))
    found = np.empty([size[c] for c in right], object)
    for index in np.ndindex(*found.shape):
        at = dict(zip(right, index))
        terms = []
        for inner in np.ndindex(*[size[c] for c in summed]):
            at.update(zip(summed, inner))
            factors = [x[tuple(at[c] for c in part)] for part, x in zip(parts, of)]
            if not any(map(_is_zero, factors)):
                terms.append(product(factors))
        found[index] = total(terms)
    return made(found)


def symbols(x):
    """x as an array of symbols and numbers."""
    return _objects(x).view(Symbols)


def _constructor(plain):
    """A function that makes arrays, for what will hold symbols: of objects."""
    @functools.wraps(plain)
    def function(*of, **named):
        if has_symbol(of):
            named.pop("dtype", None)
            return made(plain(*map(_plain, of), dtype=object, **named))
        array = plain(*of, **named)
        if array.dtype.kind != "f":
            return array
        return made(array.astype(object)) if array.ndim else array
    return function


def _like(value):
    def function(a, dtype=None, **named):
        return _full(np.shape(a), value, dtype)
    return function


def _full(shape, value, dtype=None, **named):
    if dtype is not None and np.dtype(dtype).kind not in "fO":
        return np.full(shape, value, dtype)
    array = np.empty(shape, object)
    array[...] = value if isinstance(value, Symbol) else float(value)
    return array.view(Symbols)


def _filled(value):
    return lambda shape, dtype=None, **named: _full(shape, value, dtype)


def _keep(a, dtype=None, **named):
    if isinstance(a, Symbols):
        return a
    return _array(a) if has_symbol([a]) else np.asarray(a, dtype, **named)


_array = _constructor(np.array)

#: What functions of NumPy are while a function is traced, whatever they are given.
SUBSTITUTES = {
    np.array: _array, np.asarray: _keep, np.asanyarray: _keep,
    np.ascontiguousarray: _keep, np.zeros: _filled(0), np.empty: _filled(0),
    np.ones: _filled(1), np.full: _full, np.zeros_like: _like(0),
    np.empty_like: _like(0), np.ones_like: _like(1),
    np.float64: Float, np.eye: _constructor(np.eye), np.identity: _constructor(np.identity)}


def _substitute(own, plain):
    """An own function where there are symbols, also in lists."""
    @functools.wraps(plain)
    def function(*of, **named):
        if has_symbol(of):
            return made(own(*of, **named))
        return plain(*map(_plain, of), **named)
    return function


#: Functions of NumPy for arrays of symbols, where NumPy's do not do.
OWN = {
    np.dot: _dot, np.inner: lambda a, b: _dot(a, np.transpose(symbols(b))),
    np.vdot: lambda a, b: _dot(np.ravel(symbols(a)), np.ravel(symbols(b))),
    np.sum: _sum, np.mean: _mean, np.var: _var,
    np.average: lambda a, axis=None, weights=None: _mean(a, axis) if weights is None else
    _sum(symbols(a) * weights, axis) / np.sum(weights),
    np.std: lambda a, axis=None, **n: np.sqrt(_var(a, axis)),
    np.prod: lambda a, axis=None, **n: symbols(a).prod(axis),
    np.max: lambda a, axis=None, **n: symbols(a).max(axis),
    np.min: lambda a, axis=None, **n: symbols(a).min(axis),
    np.clip: lambda a, low, high, **n: np.minimum(np.maximum(a, low), high),
    np.around: _round, np.gradient: _gradient_of, np.linalg.norm: _norm,
    np.linalg.inv: _inv, np.linalg.det: _determinant, np.linalg.solve: _solve,
    np.cross: _cross, np.einsum: _einsum,
    np.real: lambda a: a}
OWN[np.amax], OWN[np.amin], OWN[np.round] = OWN[np.max], OWN[np.min], _round
for _function in list(OWN):
    SUBSTITUTES[_function] = _substitute(OWN[_function], _function)


def elementwise(function):
    """A function of numbers for arrays, as numpy.vectorize has it."""
    def call(*of):
        return made(np.frompyfunc(function, len(of), 1)(*map(_objects, of)))
    return call


class _UfuncTwin:
    """A ufunc that takes lists of symbols, too."""

    def __init__(self, ufunc):
        self._ufunc = ufunc

    def __call__(self, *of, **named):
        return self._ufunc(*(symbols(x) if isinstance(x, (list, tuple)) and
                             has_symbol(x) else x for x in of), **named)

    def __getattr__(self, name):
        return getattr(self._ufunc, name)


def substitute(x):
    """What stands for a function of NumPy while a function is traced, or None."""
    try:
        return _UfuncTwin(x) if isinstance(x, np.ufunc) else SUBSTITUTES.get(x)
    except TypeError:
        return None


class NumpyTwin(types.ModuleType):
    """The module numpy, or one of its parts, with these functions."""

    def __init__(self, module):
        super().__init__(module.__name__)
        self.__dict__["_module"] = module

    def __getattr__(self, name):
        value = getattr(self._module, name)
        if isinstance(value, types.ModuleType) and value.__name__.startswith("numpy"):
            return NumpyTwin(value)
        return substitute(value) or value
