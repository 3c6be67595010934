"""Symbols: what a function computes with when it is traced, and the functions of
`math` that take them.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import math
import numbers
import os
import sys
import sysconfig

from ._graph import OPERATIONS

_here = os.path.join(os.path.dirname(os.path.abspath(__file__)), "")
_library = tuple(os.path.join(sysconfig.get_paths()[name], "")
                 for name in ("stdlib", "platstdlib"))
_packages = tuple(os.sep + os.path.join(kind, name, "") for name in ("numpy", "scipy")
                  for kind in ("site-packages", "dist-packages"))


class Untraceable(TypeError):
    """What a function does with a symbol that no formula can say.  It is a TypeError,
    which numbers of a foreign kind raise, too."""

    def __init__(self, what, place=None, parameters=frozenset()):
        super().__init__(what)
        self.what, self.place, self.parameters = what, place, parameters


def is_foreign(file):
    """Whether a file is nevh's, NumPy's, SciPy's, or of Python's library."""
    installed = "site-packages" in file or "dist-packages" in file
    return file.startswith(_here) or file.startswith("<frozen") or \
        file == "<__array_function__ internals>" or any(
            part in file for part in _packages) or (
                file.startswith(_library) and not installed)


def frames_of(traceback):
    while traceback is not None:
        yield traceback.tb_frame.f_code.co_filename, traceback.tb_lineno
        traceback = traceback.tb_next


def place_now():
    """File and line of the user's that are being executed, or None."""
    frame = sys._getframe(1)
    while frame is not None:
        if not is_foreign(frame.f_code.co_filename):
            return frame.f_code.co_filename, frame.f_lineno
        frame = frame.f_back
    return None


def is_number(x):
    return isinstance(x, numbers.Real) and not isinstance(x, Symbol) or (
        hasattr(x, "dtype") and getattr(x, "ndim", 1) == 0 and x.dtype.kind in "biuf")


def refuse(what, *symbols):
    """Raises Untraceable; names parameters where nothing else is at fault, for they can
    be numbers instead."""
    known = set()
    for s in symbols:
        if isinstance(s, Symbol):
            if s.graph.reads[s.node] & 3:
                known.clear()
                break
            known |= s.graph.parameters(s.node)
    raise Untraceable(what, place_now(), frozenset(known))


def _node(graph, x):
    if isinstance(x, Symbol):
        return x.node
    if is_number(x):
        return graph.leaf("number", float(x))
    if getattr(x, "ndim", None) == 0 and hasattr(x, "item"):
        return _node(graph, x.item())
    refuse("it computes with %s, which is no real number" % _kind(x))


def _kind(x):
    return "a complex number" if isinstance(x, (complex, Complex)) else \
        "a value of the type %s" % type(x).__name__


def apply(operation, *of):
    """A symbol for an operation of symbols and numbers, Complex where one is."""
    if any(isinstance(x, (complex, Complex)) for x in of):
        return _apply_complex(operation, *of)
    if not any(isinstance(x, Symbol) for x in of):
        return OPERATIONS[operation](*of)
    graph = next(x.graph for x in of if isinstance(x, Symbol))
    if len(graph.nodes) > graph.limit:
        refuse("it takes more than %d operations" % graph.limit)
    return Symbol(graph, graph.apply(operation, *(_node(graph, x) for x in of)))


def _takes(x):
    """Whether an operator may be tried with x, else it is x's to do."""
    return isinstance(x, (Symbol, Complex, complex)) or is_number(x)


def _operator(operation, reflected=False):
    def method(self, other):
        if not _takes(other):
            return NotImplemented
        return apply(operation, other, self) if reflected else \
            apply(operation, self, other)
    return method


def _compared(sign):
    def method(self, other=None):
        decided = self.graph.decide
        if decided is not None:
            return decided(sign, self, other)
        refuse("it compares (%s) a value that changes along the orbit (formulas have min, "
               "max, abs and sign, no branches)" % sign
               if self.changes or isinstance(other, Symbol) and other.changes else
               "it compares (%s) a parameter" % sign, self, other)
    return method


def _became(kind):
    def method(self, *_):
        if self.graph.decide is not None:
            return self.graph.decide(kind, self, None)
        refuse("it makes a plain number of a value, by %s" % kind, self)
    return method


class Symbol:
    """A value of a function that is traced: a node of its graph."""

    __slots__ = ("graph", "node")
    __array_priority__ = 1000
    ndim, shape, size, imag = 0, (), 1, 0.0

    def __init__(self, graph, node):
        self.graph, self.node = graph, node

    @property
    def changes(self):
        return bool(self.graph.reads[self.node] & 3)

    def __repr__(self):
        return "<symbol %d of the graph>" % self.node

    def __floordiv__(self, other):
        return apply("floor", self / other) if _takes(other) else NotImplemented

    def __rfloordiv__(self, other):
        return apply("floor", other / self) if _takes(other) else NotImplemented

    def __divmod__(self, other):
        return self // other, self % other

    def __rdivmod__(self, other):
        return other // self, other % self

    def __pow__(self, other, modulus=None):
        if modulus is not None or not _takes(other):
            return NotImplemented
        return apply("^", self, other)

    def __neg__(self):
        return apply("neg", self)

    def __pos__(self):
        return self

    def __abs__(self):
        return apply("abs", self)

    def __floor__(self):
        return apply("floor", self)

    def __ceil__(self):
        return -apply("floor", -self)

    def __round__(self, digits=0):
        """Halves go up, not to the even number; no orbit stays at one."""
        if digits:
            refuse("it rounds to %r digits" % digits, self)
        return apply("floor", self + 0.5)

    @property
    def real(self):
        return self

    def conjugate(self, *_):
        return self
    conj = copy = item = __copy__ = __deepcopy__ = conjugate

    __radd__ = _operator("+", True)
    __rsub__ = _operator("-", True)
    __rmul__ = _operator("*", True)
    __rtruediv__ = _operator("/", True)
    __rmod__ = _operator("mod", True)
    __rpow__ = _operator("^", True)
    __add__, __sub__, __mul__ = map(_operator, "+-*")
    __truediv__, __mod__ = _operator("/"), _operator("mod")
    __lt__, __le__, __gt__, __ge__, __eq__, __ne__ = map(
        _compared, ("<", "<=", ">", ">=", "==", "!="))
    __float__, __int__, __index__, __trunc__, __complex__ = map(
        _became, ("float", "int", "an index or a range", "trunc", "complex"))
    __bool__ = _compared("is it true?")

    def __hash__(self):
        refuse("it looks a value up in a table", self)

    def __iter__(self):
        raise TypeError("a number is no row of numbers")


numbers.Real.register(Symbol)  # as functions ask of their arguments


def _refuses(what):
    def method(self, *_):
        refuse("it %s" % what, self.real, self.imag)
    return method


class Complex:
    """A complex number whose parts are symbols or numbers."""

    __slots__ = ("real", "imag")
    __array_priority__ = 1000
    ndim, shape, size = 0, (), 1

    def __init__(self, real, imag):
        self.real, self.imag = real, imag

    def conjugate(self):
        return Complex(self.real, -self.imag)
    conj = conjugate

    def __pos__(self):
        return self

    def __neg__(self):
        return Complex(-self.real, -self.imag)

    def __abs__(self):
        return apply("abs", self)

    def item(self):
        return self
    copy = item
    __add__, __sub__, __mul__, __truediv__, __pow__ = map(_operator, "+-*/^")
    __radd__, __rsub__, __rmul__, __rtruediv__, __rpow__ = (
        _operator(sign, True) for sign in "+-*/^")
    __eq__, __ne__, __lt__, __le__, __gt__, __ge__, __bool__ = (
        _refuses("compares a complex number that changes along the orbit"),) * 7
    __float__, __int__, __complex__, __hash__ = (
        _refuses("makes a plain number of a complex value"),) * 4


def _complex_power(z, exponent):
    """Whole powers as products, others by modulus and angle."""
    if not is_number(exponent) or exponent % 1 or abs(exponent) > 32:
        return _apply_complex("exp", exponent * _apply_complex("log", z))
    found = product([z] * int(abs(exponent))) if exponent else 1.0
    return 1.0 / found if exponent < 0 else found


def _complex_quotient(a, b):
    if not has_imaginary(b):
        return Complex(a.real / b.real, a.imag / b.real)
    below = b.real * b.real + b.imag * b.imag
    return Complex((a.real * b.real + a.imag * b.imag) / below,
                   (a.imag * b.real - a.real * b.imag) / below)


def has_imaginary(z):
    return isinstance(z.imag, Symbol) or z.imag != 0


_OF_COMPLEX = {
    "+": lambda a, b: Complex(a.real + b.real, a.imag + b.imag),
    "-": lambda a, b: Complex(a.real - b.real, a.imag - b.imag),
    "*": lambda a, b: Complex(a.real * b.real - a.imag * b.imag,
                              a.real * b.imag + a.imag * b.real),
    "/": _complex_quotient, "^": _complex_power,
    "abs": lambda z: apply("hypot", z.real, z.imag),
    "phase": lambda z: apply("atan2", z.imag, z.real),
    "exp": lambda z: Complex(apply("exp", z.real) * apply("cos", z.imag),
                             apply("exp", z.real) * apply("sin", z.imag)),
    "log": lambda z: Complex(apply("log", abs(z)), _apply_complex("phase", z)),
    "sqrt": lambda z: _complex_power(z, 0.5),
    "sin": lambda z: (_exp_i(z) - _exp_i(-z)) / 2j,
    "cos": lambda z: (_exp_i(z) + _exp_i(-z)) / 2}


def _exp_i(z):
    return apply("exp", 1j * z)


def _apply_complex(operation, *of):
    if operation not in _OF_COMPLEX:
        refuse("it takes %s of a complex number" % operation,
               *(part for x in of for part in (x.real, x.imag)))
    return _OF_COMPLEX[operation](*of)


# What `math` has.

def _of(operation):
    def function(*of):
        return apply(operation, *of)
    return function


def _log(x, base=None):
    found = apply("log", x)
    return found if base is None else found / apply("log", base)


def square_root(x):
    return apply("sqrt", x)


def total(values, start=0):
    for x in values:
        start = start + x
    return start


def length(values):
    """The Euclidean length of a row."""
    return square_root(total(
        x.real * x.real + x.imag * x.imag if isinstance(x, (Complex, complex)) else x * x
        for x in values))


def product(values, start=1):
    for x in values:
        start = start * x
    return start


def extreme(operation):
    """min or max of a row or of arguments."""
    plain = {"min": min, "max": max}[operation]

    def function(*of, **named):
        if named or not has_symbol(of):
            return plain(*of, **named)
        values = list(of[0]) if len(of) == 1 else of
        found = values[0]
        for x in values[1:]:
            found = apply(operation, found, x) if has_symbol((found, x)) else \
                plain(found, x)
        return found
    return function


def has_symbol(x):
    """Whether x is a symbol or a row or an array with one."""
    if isinstance(x, (Symbol, Complex)):
        return True
    if getattr(x, "dtype", None) == object:
        x = x.ravel().tolist() if getattr(x, "ndim", 0) else [x.item()]
    return isinstance(x, (list, tuple)) and any(map(has_symbol, x))


def _no(name):
    def function(*of):
        refuse("formulas have no %s" % name, *of)
    return function


#: Functions of math that take symbols, by name.
FUNCTIONS = {name: _of(name) for name in (
    "sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp log10 sqrt "
    "cbrt floor").split()}
FUNCTIONS.update(
    log=_log, pow=_of("^"), fabs=_of("abs"), fsum=total, prod=product,
    log2=lambda x: apply("log", x) / math.log(2),
    expm1=lambda x: apply("exp", x) - 1, log1p=lambda x: apply("log", 1 + x),
    exp2=lambda x: apply("^", 2, x),
    ceil=lambda x: -apply("floor", -x),
    hypot=lambda *of: apply("hypot", *of) if len(of) == 2 else length(of),
    dist=lambda p, q: length(a - b for a, b in zip(p, q)),
    sumprod=lambda p, q: total(a * b for a, b in zip(p, q)),
    copysign=lambda x, y: abs(x) * apply("sign", y),
    fmod=lambda x, y: apply("sign", x) * apply("mod", abs(x), abs(y)),
    phase=lambda z: apply("atan2", z.imag, z.real),
    isfinite=lambda x: True, isnan=lambda x: False, isinf=lambda x: False,
    degrees=lambda x: x * (180 / math.pi), radians=lambda x: x * (math.pi / 180))


#: The same by NumPy's names where these differ.
NUMPY_NAMES = {
    "arcsin": "asin", "arccos": "acos", "arctan": "atan", "arctan2": "atan2",
    "arcsinh": "asinh", "arccosh": "acosh", "arctanh": "atanh", "power": "pow",
    "float_power": "pow", "absolute": "fabs", "deg2rad": "radians", "rad2deg": "degrees"}
for _name in FUNCTIONS:
    NUMPY_NAMES.setdefault(_name, _name)


def _method(function):
    return lambda self, *of: function(self, *of)


# Arrays of objects call a method of that name.
for _name, _known in NUMPY_NAMES.items():
    if not hasattr(Symbol, _name):
        setattr(Symbol, _name, _method(FUNCTIONS[_known]))


def taking_symbols(name, plain):
    """The function `name` of math, for symbols and numbers."""
    known = FUNCTIONS.get(name) or _no("math." + name)

    def function(*of, **named):
        of = tuple(list(x) if hasattr(x, "__next__") else x for x in of)
        return known(*(scalar(x) for x in of)) if has_symbol(of) else plain(*of, **named)
    return function


def scalar(x):
    """Of an array of one number, that number, as math takes it."""
    return x.item() if getattr(x, "size", 0) == 1 and hasattr(x, "item") else x


class _Kind(type):
    def __instancecheck__(cls, x):
        return isinstance(x, (cls.plain, cls.symbol))

    def __subclasscheck__(cls, kind):
        return issubclass(kind, cls.plain)


class Float(float, metaclass=_Kind):
    """float, of which a symbol is one already."""
    plain, symbol = float, Symbol

    def __new__(cls, x=0.0):
        x = scalar(x)
        return x if isinstance(x, Symbol) else float(x)


class ComplexNumber(complex, metaclass=_Kind):
    """complex, of symbols or numbers."""
    plain, symbol = complex, Complex

    def __new__(cls, real=0.0, imag=0.0):
        real, imag = scalar(real), scalar(imag)
        if not has_symbol([real, imag]):
            return complex(real, imag)
        made = Complex(real.real, real.imag)
        return made + 1j * imag if has_symbol(imag) or imag else made
