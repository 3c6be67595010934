"""Functions of NumPy for arrays of symbols, and the module numpy with them.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import functools
import math
import types

import numpy as np

from ._symbol import (Complex, ComplexNumber, Float, Symbol, apply, has_symbol, length,
                      product, refuse, total)
from ._symbol_arrays import (OWN, Symbols, _dot, _each, _flat, _gradient_of, _mean,
                             _objects, _plain, _round, _sum, _var, made, symbols)


def _norm(a, ord=None, axis=None, keepdims=False):
    a = symbols(a)
    if ord not in (None, 2, "fro") or (a.ndim > 1 and axis is None and ord == 2):
        if ord == 1 and a.ndim == 1:
            return _sum(abs(a))
        refuse("formulas have no numpy.linalg.norm with ord=%r" % ord, *a.ravel())
    if axis is None:
        found = length(a.ravel().tolist())
        return made(np.reshape(_objects(found), (1,) * a.ndim)) if keepdims else found
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


def _eigvalsh(a, UPLO="L"):
    a = _square(a, "eigvalsh")
    if len(a) != 2:
        refuse("numpy.linalg.eigvalsh is known of 2 rows", *_flat(a))
    middle = (a[0, 0] + a[1, 1]) / 2
    apart = apply("hypot", (a[0, 0] - a[1, 1]) / 2, a[1, 0] if UPLO == "L" else a[0, 1])
    return symbols([middle - apart, middle + apart])


def _cross(a, b, **named):
    a, b = symbols(a), symbols(b)
    if named or not a.shape[-1:] == b.shape[-1:] == (3,):
        if named or not a.shape[-1:] == b.shape[-1:] == (2,):
            refuse("numpy.cross is known of vectors in the last axis", *a.ravel())
        return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return np.stack([a[..., i] * b[..., j] - a[..., j] * b[..., i]
                     for i, j in ((1, 2), (2, 0), (0, 1))], axis=-1)


def _rule_of(rule, of):
    """The letters of an einsum, in place of dots and of lists of numbers."""
    if not isinstance(rule, str):
        rows = [rule, *of]
        of, lists = rows[:len(rows) // 2 * 2:2], rows[1::2]
        letters = ["".join("..." if k is Ellipsis else chr(97 + k) for k in one)
                   for one in lists]
        rule = ",".join(letters) + ("->" + "".join(
            chr(97 + k) for k in rows[-1]) if len(rows) % 2 else "")
    left, arrow, right = rule.replace(" ", "").partition("->")
    of, free, parts = [symbols(x) for x in of], "ZYXWVU", []
    for part, x in zip(left.split(","), of):
        count = x.ndim - len(part.replace("...", ""))
        parts.append(part.replace("...", free[len(free) - count:]) if "..." in part else part)
    dots = max(((x.ndim - len(part.replace("...", ""))) for part, x in
                zip(left.split(","), of) if "..." in part), default=0)
    right = right.replace("...", free[len(free) - dots:])
    if not arrow:
        letters = "".join(parts)
        right = free[len(free) - dots:] + "".join(
            sorted(c for c in set(letters) - set(free) if letters.count(c) == 1))
    return parts, right, of


def _einsum(rule, *of, **named):
    """Products of all elements whose letters agree, summed."""
    parts, right, of = _rule_of(rule, of)
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


def _interp(x, xp, fp, left=None, right=None, period=None):
    """Straight lines between points: a constant and a kink at each of them."""
    if left is not None or right is not None or period is not None or has_symbol([xp, fp]):
        refuse("numpy.interp is known between fixed points, without left, right and period",
               *_flat(symbols(x)))
    xp, fp = np.asarray(xp, float), np.asarray(fp, float)
    slopes = np.concatenate([[0.0], np.diff(fp) / np.diff(xp), [0.0]])
    return total((d * np.maximum(symbols(x) - place, 0.0)
                  for place, d in zip(xp.tolist(), np.diff(slopes).tolist()) if d),
                 float(fp[0]))


def _constructor(plain):
    """A function that makes arrays, for what will hold symbols: of objects."""
    @functools.wraps(plain)
    def function(*of, **named):
        if has_symbol(of):
            named.pop("dtype", None)
            return made(plain(*map(_plain, of), dtype=object, **named))
        array = plain(*of, **named)
        if array.dtype.kind not in "fc":
            return array
        return made(array.astype(object)) if array.ndim else array
    return function


def _like(value):
    def function(a, dtype=None, **named):
        return _full(np.shape(a), value, dtype)
    return function


def _full(shape, value, dtype=None, **named):
    if dtype is not None and np.dtype(dtype).kind not in "fcO":
        return np.full(shape, value, dtype)
    array = np.empty(shape, object)
    array[...] = value if isinstance(value, (Symbol, Complex, complex)) else float(value)
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
    np.float64: Float, np.complex128: ComplexNumber, np.eye: _constructor(np.eye), np.identity: _constructor(np.identity)}


def _substitute(own, plain):
    """An own function where there are symbols, also in lists."""
    @functools.wraps(plain)
    def function(*of, **named):
        if has_symbol(of):
            return made(own(*of, **named))
        return plain(*map(_plain, of), **named)
    return function


OWN.update({
    np.dot: _dot, np.inner: lambda a, b: _dot(a, np.transpose(symbols(b))),
    np.vdot: lambda a, b: _dot(np.ravel(symbols(a).conj()), np.ravel(symbols(b))),
    np.sum: _sum, np.mean: _mean, np.var: _var,
    np.average: lambda a, axis=None, weights=None: _mean(a, axis) if weights is None else
    _sum(symbols(a) * weights, axis) / np.sum(weights),
    np.std: lambda a, axis=None, **n: np.sqrt(_var(a, axis)),
    np.prod: lambda a, axis=None, **n: symbols(a).prod(axis, **n),
    np.max: lambda a, axis=None, **n: symbols(a).max(axis, **n),
    np.min: lambda a, axis=None, **n: symbols(a).min(axis, **n),
    np.clip: lambda a, low, high, **n: np.minimum(np.maximum(a, low), high),
    np.around: _round, np.gradient: _gradient_of, np.linalg.norm: _norm,
    np.linalg.eigvalsh: _eigvalsh, np.linalg.inv: _inv, np.linalg.det: _determinant, np.linalg.solve: _solve,
    np.cross: _cross, np.einsum: _einsum, np.real: lambda a: _each(lambda x: x.real, a),
    np.imag: lambda a: _each(lambda x: x.imag, a), np.angle: lambda a: _each(
        lambda x: apply("atan2", x.imag, x.real), a), np.nansum: _sum, np.interp: _interp,
    np.sinc: lambda a: np.sin(math.pi * symbols(a)) / (math.pi * symbols(a)),
    np.linalg.slogdet: lambda a: (np.sign(_determinant(a)), np.log(abs(_determinant(a))))})
OWN.update({np.amax: OWN[np.max], np.amin: OWN[np.min], np.round: _round})
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
