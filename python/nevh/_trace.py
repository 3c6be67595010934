"""A function of Python as a formula: it is called once with symbols in place of
numbers, and what it does is checked against itself at random points.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import inspect
import itertools
import math
import operator
import random
import re
import sys
import time

from ._graph import EPSILON, Graph
from ._graph_text import may_be_named, scene_text
from ._names import noting
from ._symbol import Symbol, Untraceable, frames_of, has_symbol, is_foreign, is_number
from ._twin import Twins

try:
    import numpy as np
except ImportError:
    np = None

_CHECKS = 16
_CHECKED_OPERATIONS = 150000  # of all checks together
_FEWEST = 3  # points where the function has to have a value


class Calls:
    """How a function wants its state: H(t, y, ...), or H(t, q, p, ...) with two rows,
    where its arguments are named so: it takes three that nothing else gives.

    args, parameters   what it is given besides
    """

    def __init__(self, function, n, args=(), parameters=None):
        self.function, self.n = function, n
        self.args, self.parameters = tuple(args), dict(parameters or {})
        self.names, self.defaults, self.splits, self.rows = [], {}, False, []
        try:
            known = list(inspect.signature(function).parameters.values())
        except (TypeError, ValueError):
            return
        row = [p for p in known if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
        required = [p for p in row if p.default is p.empty and
                    p.name not in self.parameters]
        self.splits = len(required) - len(self.args) == 3 and len(row) > 2 and (
            row[1].name.lower()[:1] in "qxr" and row[2].name.lower()[:1] in "pmv")
        first = 3 if self.splits else 2
        self.rows = [row[1].name, row[2].name] if self.splits else []
        self.names = [p.name for p in row[first:first + len(self.args)]]
        self.defaults = {
            p.name: p.default for p in known if p.default is not p.empty and
            p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY) and
            p.name not in self.names and p.name not in self.parameters}

    def state(self, y):
        """The arguments that a state is, of numbers or symbols; not copied."""
        if not self.splits:
            return [y]
        return [y[:self.n], y[self.n:]]

    def __call__(self, t, y):
        return as_number(self.function(t, *self.state(y), *self.args,
                                       **self.parameters))

    def with_values(self, values, function=None):
        """A function (t, y) with other values of the parameters that are named."""
        args = list(self.args)
        for k, name in enumerate(self.names):
            args[k] = values.get(name, args[k])
        named = dict(self.parameters)
        named.update((name, x) for name, x in values.items() if name not in self.names)
        function = function or self.function
        return lambda t, y: function(t, *self.state(y), *args, **named)

    def key(self):
        """What is equal for calls that compute the same, else None."""
        given = [*self.args, *itertools.chain(*sorted(self.parameters.items()))]
        if type(self.function) is not type(_quiet) or not all(
                isinstance(x, (int, float, str, type(None))) for x in given):
            return None
        return (self.n, len(self.args)) + tuple((type(x), x) for x in given)

    def given(self):
        """{name: value} of all that is given by name, position or default."""
        return dict(itertools.chain(self.defaults.items(), zip(self.names, self.args),
                                    self.parameters.items()))


def as_number(x):
    """What a function returned, as a float: arrays of one number are one."""
    try:
        if np is not None and np.ma.is_masked(x):
            raise TypeError
        return float(x.item() if hasattr(x, "dtype") and x.size == 1 else x)
    except (TypeError, ValueError, OverflowError):
        raise TypeError("H returns %.80r, which is no real number" % (x,)) from None


def array(values):
    return np.array(values, float) if np is not None else list(values)


class Traced:
    """A function as the text of a scene, and its graph."""

    def __init__(self, text, graph, root):
        self.text, self.graph, self.root = text, graph, root


def trace(calls, t0, y0, coordinates=None, title="H"):
    """The Traced of Calls near a state; raises Untraceable, with the file and the line
    in `place`."""
    return _Trace(calls, t0, list(map(float, y0)), coordinates, title).traced()


def still_holds(traced, calls, t0, y0):
    """Whether a function still has the values that were traced, at a few states."""
    try:
        _Trace(calls, t0, list(map(float, y0)), None, "").check(traced.graph, traced.root, 4)
    except Untraceable:
        return False
    return True


class _Trace:
    def __init__(self, calls, t0, y0, coordinates, title):
        self.calls, self.t0, self.y0, self.title = calls, t0, y0, title
        self.given = coordinates
        names = {re.sub(r"\[.*", "", text) for text in coordinates or ()}
        self.symbolic = {
            name: float(x) for name, x in calls.given().items()
            if is_number(x) and not isinstance(x, bool) and may_be_named(name) and
            math.isfinite(x) and name not in names}

    def traced(self):
        while True:
            try:
                graph, root = self.followed()
                break
            except Untraceable as refused:
                if not refused.parameters & set(self.symbolic):
                    raise
                self.drop(refused.parameters)
            except Exception as error:
                if not self.symbolic:
                    raise self.foreign(error) from None
                self.symbolic = {}
        self.check(graph, root)
        try:
            text = scene_text(graph, root, self.coordinates(graph), self.y0, self.symbolic,
                              self.title)
        except (ValueError, RecursionError) as error:
            raise Untraceable(str(error), self.definition()) from None
        return Traced(text, graph, root)

    def drop(self, names):
        """Makes plain numbers of parameters."""
        for name in names:
            self.symbolic.pop(name, None)

    def coordinates(self, graph):
        """The coordinates' names, each with an index where they are an array: those that
        the function gives to them, to all of them; else that of its argument, or q."""
        if self.given is None:
            own = [graph.names.get(k) for k in range(self.calls.n)]
            if len(set(own)) == self.calls.n and all(map(self.is_free, own)):
                return [(name, None) for name in own]
            name = next(filter(self.is_free, (*self.calls.rows[:1], "q", "x", "u",
                                              "position")))
            return [(name, None)] if self.calls.n == 1 else \
                [(name, k + 1) for k in range(self.calls.n)]
        found = []
        for text in self.given:
            at = re.match(r"(.*)\[(\d+)\]$", text)
            found += [(at.group(1), k + 1) for k in range(int(at.group(2)))] if at else \
                [(text, None)]
        return found

    def is_free(self, name):
        """Whether a coordinate may have that name."""
        return name is not None and may_be_named(name) and name not in self.symbolic and \
            name not in ("i", "p")

    def followed(self, decide=None):
        """The graph of the function, and the node of what it returns."""
        graph = Graph()
        graph.decide = decide and decide(graph)
        n = self.calls.n

        def symbol(*leaf):
            return Symbol(graph, graph.leaf(*leaf))
        state = [symbol("q", k) for k in range(n)] + [symbol("p", k) for k in range(n)]
        if np is not None:
            from ._symbol_arrays import Symbols, symbols
            row = np.empty(2 * n, object)
            row[:] = state
            state = symbols(row).view(noting(Symbols))
        else:
            state = noting(list)(state)
        values = {name: symbol("parameter", name) for name in self.symbolic}
        twins = Twins()
        function = twins.of(self.calls.function)
        if function is self.calls.function and not inspect.isroutine(function):
            function = twins.of(type(function).__call__.__get__(function))
        call = self.calls.with_values(values, function)
        result = call(symbol("t"), state)
        if hasattr(result, "dtype") and result.size == 1:
            result = result.item()
        if is_number(result):
            result = Symbol(graph, graph.leaf("number", float(result)))
        if not isinstance(result, Symbol):
            raise Untraceable("it returns %s, which is no number" % (
                "a row" if has_symbol(result) else type(result).__name__),
                self.definition())
        return graph, result.node

    def definition(self):
        """File and line where the function begins."""
        function = self.calls.function
        for name in ("func", "__func__", "__wrapped__", "py_func", "pyfunc"):
            function = getattr(function, name, function)
        code = getattr(function, "__code__", None) or getattr(
            getattr(type(function), "__call__", None), "__code__", None)
        return (code.co_filename, code.co_firstlineno) if code else None

    def foreign(self, error):
        """Untraceable for an exception that symbols led to."""
        places = [place for place in frames_of(error.__traceback__)
                  if not is_foreign(place[0])]
        what = "symbols are refused: %s: %s" % (type(error).__name__, error)
        return Untraceable(what, places[-1] if places else self.definition())

    # Checks.

    def points(self, count):
        """States and times near the start, at its scale, and beyond."""
        draw = random.Random(41)
        largest = max(map(abs, self.y0)) or 1.0
        for k in range(count):
            far = (1e-3, 0.1, 1.0, 3.0)[k % 4]
            y = [x + far * draw.uniform(-1, 1) * (abs(x) if x and k % 2 else largest)
                 for x in self.y0]
            t = self.t0 + (far * draw.uniform(0, 10) if k else 0)
            parameters = {name: x * (1 + 0.2 * draw.uniform(-1, 1)) if k % 2 else x
                          for name, x in self.symbolic.items()}
            yield t, y, parameters

    def check(self, graph, root, count=_CHECKS):
        """Fails where the function and its graph differ by more than rounding."""
        needed = graph.below([root])
        count = max(4, min(count, _CHECKED_OPERATIONS // (1 + len(needed))))
        compared = 0
        for t, y, parameters in self.points(count):
            known = self.value(t, y, parameters)
            if not math.isfinite(known):
                continue
            value = graph.values(needed, t, y, parameters)
            apart = abs(value[root] - known)
            compared += 1
            if not apart <= 64 * EPSILON * abs(known) and not (
                    apart <= 8 * graph.error(needed, value)):
                raise self.differs(t, y, parameters, known, value[root])
        if compared < _FEWEST:
            raise Untraceable("it has a value at %d of %d states near the start"
                              % (compared, count), self.definition())

    def value(self, t, y, parameters):
        """What the function gives, NaN where it raises an exception."""
        try:
            with _quiet():
                return as_number(self.calls.with_values(parameters)(t, array(y)))
        except Exception:
            return math.nan

    def differs(self, t, y, parameters, known, value):
        """Untraceable, with the place where the reason is."""
        call = self.calls.with_values(parameters)
        again = self.value(t, y, parameters)
        if again != known:
            return Untraceable("two calls with the same arguments give %r and %r"
                               % (known, again), self.definition())
        plain = _lines(lambda: call(t, array(y)))
        traced = _lines(self.followed)
        common = [a for a, b in zip(plain, traced) if a == b]
        place = next((plain[k - 1] for k, (a, b) in enumerate(zip(plain, traced))
                      if a != b and k), None) if len(common) < len(plain) else None
        return Untraceable(
            "it takes another way with numbers than with symbols" if place else
            "it gives %r at t = %g, y = %s, and what it did with symbols %r"
            % (known, t, ["%g" % x for x in y], value), place or self.definition())

    # Cost.

    def guess(self):
        """A Traced that is right near the start: branches go as they do there.  It
        tells what a formula of that size costs.  None: even that cannot be traced."""
        def decide(graph):
            def decided(sign, a, b):
                if sign not in _DECISIONS:  # a number would hide what it depends on
                    raise Untraceable(sign)
                return _DECISIONS[sign](*(self.value_of(graph, x) for x in (a, b)))
            return decided
        try:
            graph, root = self.followed(decide)
            text = scene_text(graph, root, self.coordinates(graph), self.y0,
                              dict(self.symbolic), self.title)
        except Exception:
            return None
        return Traced(text, graph, root)

    def value_of(self, graph, x):
        if not isinstance(x, Symbol):
            return x
        needed = graph.below([x.node])
        return graph.values(needed, self.t0, self.y0, self.symbolic)[x.node]


_DECISIONS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge,
              "==": operator.eq, "!=": operator.ne, "is it true?": lambda a, _: bool(a)}


def guess(calls, t0, y0, coordinates=None):
    return _Trace(calls, t0, list(map(float, y0)), coordinates, "H").guess()


def _quiet():
    if np is not None:
        return np.errstate(all="ignore")
    import contextlib
    return contextlib.suppress()


def _lines(call):
    """The lines of the user's that a call executes, in order."""
    lines = []

    def step(frame, event, _):
        file = frame.f_code.co_filename
        if is_foreign(file):
            return None
        if event == "line":
            lines.append((file, frame.f_lineno))
        return step
    before = sys.gettrace()
    sys.settrace(step)
    try:
        call()
    except Exception:
        pass
    finally:
        sys.settrace(before)
    return lines


def seconds_a_call(calls, t0, y0):
    """What a value of a function takes."""
    y, best, start = array(y0), math.inf, time.perf_counter()
    while time.perf_counter() - start < 0.005:
        before = time.perf_counter()
        calls(t0, y)
        best = min(best, time.perf_counter() - before)
    return best
