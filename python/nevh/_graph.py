"""The operations that a function does, as a graph: each once, in the order in which
they were done.

A node is a tuple (operation, argument, ...), where arguments are numbers of nodes but
of leaves: ("number", x), ("t",), ("q", k), ("p", k) with k from 0, ("parameter", name).

SPDX-License-Identifier: GPL-3.0-or-later
"""

import math

#: What a node reads.
STATE, TIME, PARAMETER = 1, 2, 4
_LEAVES = {"number": 0, "t": TIME, "q": STATE, "p": STATE, "parameter": PARAMETER}
EPSILON = 2.0 ** -52


def _sign(x):
    return math.copysign(1, x) if x else x


def _mod(a, b):
    return a - b * math.floor(a / b) if math.isinf(b) else a % b


def _cbrt(x):
    return math.copysign(abs(x) ** (1 / 3), x)


def _bessel(order):
    """By its integral, which trapezia give to rounding: only checks call it."""
    def value(x):
        count = 32 + 2 * int(abs(x))
        return sum(math.cos(order * s - x * math.sin(s)) for s in
                   (math.pi * (k + 0.5) / count for k in range(count))) / count
    return value


#: The operations of formulas: those that Python's numbers have no sign for by name.
OPERATIONS = {
    "+": lambda a, b: a + b, "-": lambda a, b: a - b, "*": lambda a, b: a * b,
    "/": lambda a, b: a / b, "^": math.pow, "neg": lambda a: -a,
    "abs": abs, "sign": _sign, "floor": math.floor, "mod": _mod, "cbrt": _cbrt,
    "min": min, "max": max, "hypot": math.hypot, "atan2": math.atan2,
    "bessel_j0": _bessel(0), "bessel_j1": _bessel(1)}
for _name in ("sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh exp log "
              "log10 sqrt").split():
    OPERATIONS[_name] = getattr(math, _name)
_SUMS = frozenset("+-")
_EXACT = frozenset(["neg", "abs", "sign", "min", "max"])


class Graph:
    """Nodes, and what they read; equal nodes are one."""

    def __init__(self, limit=400000):
        self.nodes, self.reads, self._known, self.limit = [], [], {}, limit
        self.names = {}  # of coordinates, as the function has them

    def leaf(self, *node):
        return self._add(node, _LEAVES[node[0]])

    def _add(self, node, reads):
        # 0.0 and -0.0 are equal and are not the same number.
        key = node if node[0] != "number" else ("number", node[1].hex())
        found = self._known.get(key)
        if found is None:
            found = self._known[key] = len(self.nodes)
            self.nodes.append(node)
            self.reads.append(reads)
        return found

    def number(self, k):
        """The number that the node k is, else None."""
        node = self.nodes[k]
        return node[1] if node[0] == "number" else None

    def apply(self, operation, *of):
        """The node of an operation, left out where it changes no value.  A product
        with 0 is 0, so that zeros of a matrix join no variables.  Signs, which round
        nothing, are moved out of products and into sums."""
        simple = self._simple(operation, of)
        if simple is not None:
            return simple
        if all(self.nodes[k][0] == "number" for k in of):
            try:
                value = float(OPERATIONS[operation](*(self.nodes[k][1] for k in of)))
            except (ArithmeticError, ValueError):
                value = math.nan
            return self.leaf("number", value)
        reads = 0
        for k in of:
            reads |= self.reads[k]
        return self._add((operation,) + of, reads)

    def _simple(self, operation, of):
        if len(of) == 1:
            inner = self.nodes[of[0]]
            return inner[1] if operation == "neg" and inner[0] == "neg" else None
        a, b = (self.number(k) for k in of)
        if operation in "+-*/^":
            signed = self._signed(operation, of, b)
            if signed is not None:
                return signed
        if operation == "+":
            return of[1] if a == 0 else of[0] if b == 0 else None
        if operation == "-":
            return self.apply("neg", of[1]) if a == 0 else of[0] if b == 0 else None
        if operation == "*":
            if a == 0 or b == 0:
                return self.leaf("number", 0.0)
            if a == 1 or b == 1:
                return of[1] if a == 1 else of[0]
            if a == -1 or b == -1:
                return self.apply("neg", of[1] if a == -1 else of[0])
        if operation == "*" and of[0] == of[1]:
            return self.apply("^", of[0], self.leaf("number", 2.0))
        if operation == "/" and (a == 0 or b == 1):
            return of[0]
        if operation == "^" and (b == 0 or b == 1):
            return of[0] if b else self.leaf("number", 1.0)
        return None

    def _negated(self, k):
        """The node of which k is the negative, else None."""
        node = self.nodes[k]
        if node[0] == "number":
            return self.leaf("number", -node[1]) if node[1] < 0 else None
        return node[1] if node[0] == "neg" else None

    def _signed(self, operation, of, exponent):
        """The node of an operation one of whose arguments is negated, else None."""
        if self.number(of[0]) is not None and self.number(of[1]) is not None:
            return None
        left, right = map(self._negated, of)
        if operation in "*/" and (left is not None or right is not None):
            both = left is not None and right is not None
            found = self.apply(operation, of[0] if left is None else left,
                               of[1] if right is None else right)
            return found if both else self.apply("neg", found)
        if operation in "+-" and right is not None:
            return self.apply("-" if operation == "+" else "+", of[0], right)
        if operation == "+" and left is not None:
            return self.apply("-", of[1], left)
        if operation == "^" and left is not None and exponent is not None and (
                exponent % 1 == 0):
            found = self.apply("^", left, of[1])
            return self.apply("neg", found) if exponent % 2 else found
        return None

    def parameters(self, k):
        """The names of the parameters that the node k reads."""
        return {self.nodes[j][1] for j in self.below([k])
                if self.nodes[j][0] == "parameter"}

    def below(self, roots):
        """The nodes that roots are made of, in order."""
        seen, ahead = set(), list(roots)
        while ahead:
            k = ahead.pop()
            if k not in seen:
                seen.add(k)
                if self.nodes[k][0] not in _LEAVES:
                    ahead.extend(self.nodes[k][1:])
        return sorted(seen)

    def values(self, needed, t, y, parameters):
        """{node: value} of nodes in order; NaN outside a domain."""
        value, nodes, half = {}, self.nodes, len(y) // 2
        for k in needed:
            node = nodes[k]
            kind = node[0]
            if kind not in _LEAVES:
                try:
                    value[k] = float(OPERATIONS[kind](*[value[j] for j in node[1:]]))
                except (ArithmeticError, ValueError):
                    value[k] = math.nan
            elif kind == "t":
                value[k] = t
            elif kind == "number":
                value[k] = node[1]
            elif kind == "parameter":
                value[k] = parameters[node[1]]
            else:
                value[k] = y[node[1] + (half if kind == "p" else 0)]
        return value

    def error(self, needed, value):
        """A bound of the rounding error of the last of nodes in order.  It is that of
        any order of the same sums, since formulas are summed in another: the error of a
        sum counts the moduli of what is added."""
        wrong = {}
        for k in needed:
            node = self.nodes[k]
            try:
                wrong[k] = 0.0 if node[0] in _LEAVES else self._wrong(
                    node[0], node, value, wrong, value[k])
            except (ArithmeticError, ValueError):
                wrong[k] = math.nan
        return wrong[needed[-1]]

    @staticmethod
    def _wrong(kind, node, value, wrong, result):
        """The error that arguments' errors lead to, by moving them, and one rounding."""
        of = node[1:]
        own = 0.0 if kind in _EXACT else 2 * EPSILON * abs(result)
        errors = [wrong[j] for j in of]
        if kind in _SUMS:
            return sum(errors) + EPSILON * sum(abs(value[j]) for j in of)
        if kind == "*":
            a, b = (value[j] for j in of)
            return abs(a) * errors[1] + abs(b) * errors[0] + own
        for i, error in enumerate(errors):
            for moved in (error, -error) if error else ():
                arguments = [value[j] for j in of]
                arguments[i] += moved
                own += abs(OPERATIONS[kind](*arguments) - result)
        return own
