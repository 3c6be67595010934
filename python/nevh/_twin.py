"""Twins of functions: the same code, but `math`, NumPy and what else would ask a symbol
for its number are replaced by functions that take symbols.

`math.sin(x)` calls x.__float__, which can give nothing but a number, so that symbols
alone cannot be traced through it.  A twin is a new function over the same code object,
whose globals are a copy with replacements; helper functions, closures, methods, and
classes of the user's that it names become twins in turn.  The alternative, to replace
the functions in the modules themselves while a function is traced, would change what
other threads compute meanwhile, and nothing of the user's is changed here: counters and
caches that the function keeps in globals or objects are those of the copy.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import abc
import builtins
import cmath
import functools
import math
import sys
import types

from ._symbol import ComplexNumber, Float, Symbol, extreme, is_foreign, taking_symbols

try:
    import numpy as np
except ImportError:
    np = None

_HEAP = 1 << 9  # Py_TPFLAGS_HEAPTYPE: a class that is written in Python
_PLAIN = (int, float, complex, str, bytes, bool, type(None))
_MATH = {}
for _module in (math, cmath):
    for _name in dir(_module):
        _function = getattr(_module, _name)
        if callable(_function):
            _MATH[_function] = taking_symbols(_name, _function)


class _MathTwin(types.ModuleType):
    def __init__(self, module):
        super().__init__(module.__name__)
        self.__dict__["_module"] = module

    def __getattr__(self, name):
        value = getattr(self._module, name)
        return _MATH.get(value, value) if callable(value) else value


_BUILTINS = {max: extreme("max"), min: extreme("min"), float: Float,
             complex: ComplexNumber}


class Twins:
    """Twins by the identity of what they stand for."""

    def __init__(self):
        self.known, self.spaces, self.cells, self.kept = {}, {}, {}, []
        self.builtins = dict(vars(builtins), __import__=self._import, **{
            plain.__name__: own for plain, own in _BUILTINS.items()})

    def _import(self, name, *rest):
        return self.of(__import__(name, *rest))

    def of(self, x):
        """The twin of x, or x where it has none."""
        if isinstance(x, _PLAIN) or isinstance(x, Symbol):
            return x
        if id(x) not in self.known:
            self.kept.append(x)  # or another object could have its identity
            self.known[id(x)] = x
            self.known[id(x)] = self._made(x)
        return self.known[id(x)]

    def _made(self, x):
        if isinstance(x, types.ModuleType):
            return self._module(x)
        if isinstance(x, types.FunctionType):
            return self._function(x)
        if isinstance(x, type):
            return _BUILTINS.get(x) or self._class(x)
        if isinstance(x, types.MethodType):
            return types.MethodType(self.of(x.__func__), self.of(x.__self__))
        if isinstance(x, functools.partial):
            return functools.partial(self.of(x.func), *map(self.of, x.args), **{
                name: self.of(value) for name, value in x.keywords.items()})
        if isinstance(x, (list, tuple, dict)):
            return self._container(x)
        if np is not None and isinstance(x, np.vectorize):
            return self._vectorized(x)
        for name in ("py_func", "__wrapped__"):  # numba's, functools.lru_cache
            inner = getattr(x, name, None)
            if isinstance(inner, types.FunctionType) and not isinstance(x, type):
                return self.of(inner)
        if callable(x):
            try:
                known = self._library(x)
            except TypeError:
                known = None
            if known is not None:
                return known
        return self._instance(x)

    def _library(self, x):
        if np is not None:
            from ._symbol_functions import substitute
            return substitute(x) or _MATH.get(x) or _BUILTINS.get(x)
        return _MATH.get(x) or _BUILTINS.get(x)

    def _module(self, x):
        if x in (math, cmath):
            return _MathTwin(x)
        if np is not None and (x is np or x.__name__.startswith("numpy.")):
            from ._symbol_functions import NumpyTwin
            return NumpyTwin(x)
        file = getattr(x, "__file__", None)
        if not file or is_foreign(file):
            return x
        return _ModuleTwin(x, self)

    def _function(self, x):
        known = self._library(x)
        if known is not None:
            return known
        if is_foreign(x.__code__.co_filename):
            inner = getattr(x, "__wrapped__", None)
            return self.of(inner) if inner is not None else x
        space = self._space(x.__globals__)
        closure = x.__closure__ and tuple(map(self._cell, x.__closure__))
        twin = types.FunctionType(x.__code__, space, x.__name__, None, closure)
        self.known[id(x)] = twin  # it may name itself
        for name in _names(x.__code__) & set(x.__globals__):
            space[name] = self.of(x.__globals__[name])
        for cell, old in zip(closure or (), x.__closure__ or ()):
            try:
                cell.cell_contents = self.of(old.cell_contents)
            except ValueError:  # it is empty yet
                pass
        twin.__defaults__ = x.__defaults__ and tuple(map(self.of, x.__defaults__))
        twin.__kwdefaults__ = x.__kwdefaults__ and {
            name: self.of(value) for name, value in x.__kwdefaults__.items()}
        twin.__dict__.update(x.__dict__)
        return twin

    def _space(self, known):
        """A copy of globals, the same for all functions that share them."""
        if id(known) not in self.spaces:
            self.spaces[id(known)] = dict(known, __builtins__=self.builtins)
        return self.spaces[id(known)]

    def _cell(self, old):
        if id(old) not in self.cells:
            self.cells[id(old)] = (lambda value: lambda: value)(None).__closure__[0]
        return self.cells[id(old)]

    def _class(self, x):
        if not _is_users(x):
            return x
        own = {name: value for name, value in vars(x).items() if name not in
               ("__dict__", "__weakref__", "__slots__") and
               not isinstance(value, types.MemberDescriptorType)}
        twin = type(x)(x.__name__, tuple(map(self.of, x.__bases__)), own)
        self.known[id(x)] = twin
        for name, value in own.items():
            if isinstance(value, (staticmethod, classmethod)):
                value = type(value)(self.of(value.__func__))
            elif isinstance(value, property):
                value = property(*(f and self.of(f) for f in (
                    value.fget, value.fset, value.fdel)))
            elif isinstance(value, types.FunctionType):
                value = self.of(value)
            else:
                continue
            setattr(twin, name, value)
        return twin

    def _instance(self, x):
        kind = self.of(type(x))
        if kind is type(x):
            return x
        twin = object.__new__(kind)
        self.known[id(x)] = twin
        names = set(getattr(x, "__dict__", ()))
        for base in type(x).__mro__:
            names.update(name for name, value in vars(base).items()
                         if isinstance(value, types.MemberDescriptorType))
        twin.__dict__.update((name, self.of(getattr(x, name))) for name in names
                             if hasattr(x, name))
        return twin

    def _container(self, x):
        values = x.values() if isinstance(x, dict) else x
        if type(x) not in (list, tuple, dict) or len(x) > 1000 or all(
                isinstance(value, _PLAIN) for value in values):
            return x
        if isinstance(x, dict):
            return {key: self.of(value) for key, value in x.items()}
        return type(x)(map(self.of, x))

    def _vectorized(self, x):
        from ._symbol_functions import elementwise
        return elementwise(self.of(x.pyfunc))


def _names(code):
    """The names that code may look up, also in functions within it."""
    found = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            found |= _names(constant)
    return found


def _is_users(kind):
    """Whether a class is written in Python, by the user, and can be copied."""
    if issubclass(kind, (tuple, BaseException)) or not all(
            base is object or base is abc.ABC or base.__flags__ & _HEAP and
            type(base) in (type, abc.ABCMeta) for base in kind.__mro__):
        return False
    file = getattr(sys.modules.get(kind.__module__), "__file__", None)
    return not (file and is_foreign(file))


class _ModuleTwin(types.ModuleType):
    def __init__(self, module, twins):
        super().__init__(module.__name__)
        self.__dict__.update(_module=module, _twins=twins)

    def __getattr__(self, name):
        return self._twins.of(getattr(self._module, name))
