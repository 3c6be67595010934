"""A graph as the text of a scene.

What is used twice becomes a definition, which the scene evaluates once.  Summands that
differ in their indices and numbers alone become one sum over an index, so that a chain
of a thousand masses is one term with a thousand instances, as if it had been typed.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import math
import re

from ._graph import STATE, TIME

_SUM, _PRODUCT, _POWER, _ATOM = range(4)
_FEWEST = 3  # summands that are worth a sum over an index
_LARGEST = 300  # operations of such a summand
_MOST = 100000  # summands
_SHORT = 24  # characters of parameters that are no definition
_LONGEST = 2000  # characters of a text before it becomes a definition
_DEEPEST = 40  # parentheses
_LINE = 60000  # characters of an effect

#: Names that scenes give another meaning.
RESERVED = frozenset(
    "t pi sum sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp log "
    "log10 sqrt cbrt hypot abs min max sign mod floor bessel_j0 bessel_j1 elliptic_k "
    "elliptic_e kepler ln pow arcsin arccos arctan arctan2 arsinh arcsinh arcosh arcosh "
    "arccosh artanh arctanh sgn".split())


def may_be_named(name):
    """Whether a parameter of a scene can have that name."""
    return (re.fullmatch(r"[A-Za-z\u0391-\u03c9][A-Za-z\u0391-\u03c90-9_]{0,60}", name)
            is not None and name not in RESERVED and name[:2] not in ("p_", "v_"))


def number(x):
    if not math.isfinite(x):
        raise ValueError("it computes with the number %s" % x)
    text = repr(int(x)) if x == int(x) and abs(x) < 1e15 else repr(x)
    return "(%s)" % text if text.startswith("-") else text


class _Text:
    """A formula in part: how tightly it binds, how deep its parentheses are."""

    __slots__ = ("text", "level", "depth")

    def __init__(self, text, level=_ATOM, depth=0):
        self.text, self.level, self.depth = text, level, depth

    def within(self, level):
        """Its text where nothing that binds less tightly than `level` may stand."""
        return self if self.level >= level else _Text(
            "(%s)" % self.text, _ATOM, self.depth + 1)


def _joined(operation, a, b):
    if operation in "+-":
        b = b.within(_PRODUCT)
        return _Text("%s %s %s" % (a.text, operation, b.text), _SUM,
                     max(a.depth, b.depth))
    if operation in "*/":
        a, b = a.within(_PRODUCT), b.within(_POWER)
        return _Text(a.text + operation + b.text, _PRODUCT, max(a.depth, b.depth))
    a, b = a.within(_ATOM), b.within(_ATOM)
    return _Text(a.text + "^" + b.text, _POWER, max(a.depth, b.depth))


def _applied(operation, of):
    if operation in ("+", "-", "*", "/", "^"):
        return _joined(operation, *of)
    if operation == "neg":
        a = of[0].within(_PRODUCT)
        return _Text("-" + a.text, _SUM, a.depth)
    return _Text("%s(%s)" % (operation, ", ".join(a.text for a in of)), _ATOM,
                 1 + max(a.depth for a in of))


def _in_line(numbers):
    """The text of a whole number that grows evenly with i = 1, 2, ..., else None."""
    step = numbers[1] - numbers[0]
    if any(b - a != step for a, b in zip(numbers, numbers[1:])):
        return None
    first = numbers[0] - step
    if not step:
        return "%d" % first
    text = "i" if step == 1 else "-i" if step == -1 else "%d*i" % step
    return text + ("%+d" % first if first else "")


class _Summand:
    """A product of a number, of factors that read no state, and of what does."""

    __slots__ = ("number", "factors", "core")

    def __init__(self, number, factors, core):
        self.number, self.factors, self.core = number, factors, core


class _Writer:
    def __init__(self, graph, coordinates, taken):
        self.graph, self.coordinates = graph, coordinates
        self.texts, self.definitions, self.tables = {}, [], []
        self.known_linear = {}
        self.prefix = next(name for name in ("d", "h", "def", "part", "shared_part")
                           if not any(re.fullmatch(name + r"\d+|%s" % name, other)
                                      for other in taken))
        self.table = next(name for name in ("c", "k", "table", "constants_of_sums")
                          if not any(re.fullmatch(name + r"\d+|%s" % name, other)
                                     for other in taken))
        self.sums = "i" not in taken and any(i is not None for _, i in coordinates)

    # Leaves.

    def coordinate(self, kind, k, index=None):
        name, own = self.coordinates[k]
        name = name if kind == "q" else "p_" + name
        return name if own is None else "%s[%s]" % (name, index or own)

    def leaf(self, node):
        if node[0] == "number":
            return _Text(number(node[1]))
        return _Text(self.coordinate(*node) if node[0] in "qp" else node[-1])

    # Sums over an index.

    def summands(self, root):
        """The summands of a node, equal ones joined, or None where they are too many."""
        found, ahead, nodes = {}, [(root, 1.0, ())], self.graph.nodes
        while ahead:
            k, factor, others = ahead.pop()
            node = nodes[k]
            kind = node[0]
            if kind in ("+", "-"):
                ahead.append((node[2], factor if kind == "+" else -factor, others))
                ahead.append((node[1], factor, others))
                continue
            if kind == "neg":
                ahead.append((node[1], -factor, others))
                continue
            inner = self._passes(node) if kind in ("*", "/") else None
            if inner is not None:
                outer = node[2] if inner == node[1] else node[1]
                x = self.graph.number(outer)
                if x is None:
                    ahead.append((inner, factor, others + ((kind, outer),)))
                    continue
                if kind == "*" or x != 0 and math.isfinite(1 / x):
                    ahead.append((inner, factor * x if kind == "*" else factor / x,
                                  others))
                    continue
            for core, own in self.monomials(node) or ((k, 1.0),):
                known = found.setdefault((core, others), _Summand(0.0, others, core))
                known.number += factor * own
            if len(found) + len(ahead) > _MOST:
                return None
        return [summand for summand in found.values() if summand.number]

    def monomials(self, node):
        """Of a row of a quadratic form, (a*x + b*y + ...)*x, its products and their
        numbers, else None: each is a summand of two variables, or of one."""
        if node[0] != "*":
            return None
        a, b = self.linear(node[1]), self.linear(node[2])
        if not a or not b or min(len(a), len(b)) != 1:
            return None
        return [(self.graph.apply("*", min(i, j), max(i, j)), x * y)
                for i, x in a.items() for j, y in b.items()]

    def linear(self, root):
        """{leaf: number} of a sum of variables times numbers, else None."""
        if root in self.known_linear:
            return self.known_linear[root]
        found, ahead = {}, [(root, 1.0)]
        while ahead and found is not None:
            k, factor = ahead.pop()
            node = self.graph.nodes[k]
            kind = node[0]
            if kind in ("q", "p"):
                found[k] = found.get(k, 0.0) + factor
            elif kind in ("+", "-"):
                ahead += [(node[2], factor if kind == "+" else -factor),
                          (node[1], factor)]
            elif kind == "neg":
                ahead.append((node[1], -factor))
            elif kind == "*" and self.graph.number(node[1]) is not None:
                ahead.append((node[2], factor * self.graph.number(node[1])))
            elif kind in ("*", "/") and self.graph.number(node[2]) is not None:
                x = self.graph.number(node[2])
                ahead.append((node[1], factor * x if kind == "*" else factor / x
                              if x else math.nan))
            else:
                found = None
            if found is not None and len(ahead) + len(found) > _MOST:
                found = None
        self.known_linear[root] = found
        return found

    def _passes(self, node):
        """Of a product or quotient with one factor that reads a state, that factor."""
        reads = [self.graph.reads[k] & STATE for k in node[1:]]
        if node[0] == "*" and reads[0] != reads[1]:
            return node[1] if reads[0] else node[2]
        return node[1] if node[0] == "/" and reads[0] and not reads[1] else None

    def shape(self, summand):
        """Of a summand what it has in common with others, and its leaves."""
        tokens, leaves = [], []
        ahead = [summand.core]
        ahead += [k for _, k in summand.factors]
        tokens += [kind for kind, _ in summand.factors]
        nodes = self.graph.nodes
        while ahead:
            node = nodes[ahead.pop()]
            kind = node[0]
            if kind in "qp":
                name, index = self.coordinates[node[1]]
                tokens.append((kind, name))
                if index is not None:
                    leaves.append(index)
            elif kind == "number":
                tokens.append(kind)
                leaves.append(node[1])
            elif kind == "^" and self.graph.number(node[2]) is not None:
                tokens.append(("^", self.graph.number(node[2])))
                ahead.append(node[1])
            elif kind in ("t", "parameter"):
                tokens.append(node)
            else:
                tokens.append(kind)
                ahead.extend(reversed(node[1:]))
            if len(tokens) > _LARGEST:
                return None, None
        return tuple(tokens), leaves

    def values(self, column):
        """The text of what takes these values for i = 1, 2, ...: an index where they
        are whole numbers, else a number."""
        if isinstance(column[0], int):
            return _in_line(column) or "%s[i]" % self.tabled(column, "%d")
        if all(x == column[0] for x in column):
            return number(column[0])
        return "%s[i]" % self.tabled(column, "%r")

    def tabled(self, column, form):
        name = "%s%d" % (self.table, len(self.tables) + 1)
        text = ", ".join(form % x for x in column)
        for other, size, known in self.tables:
            if known == text:
                return other
        self.tables.append((name, len(column), text))
        return name

    def over_index(self, summands, leaves):
        """A sum over i of summands of one shape, as the number of these, the variables
        that each reads, and a _Text of its body with a number before it."""
        texts = [self.values(column) for column in zip(*leaves)]
        ahead = iter(texts)
        first, reads = summands[0], set()

        def body(k):
            node = self.graph.nodes[k]
            kind = node[0]
            if kind in "qp":
                own = self.coordinates[node[1]][1]
                name = self.coordinate(kind, node[1], None if own is None else next(ahead))
                reads.add(name)
                return _Text(name)
            if kind == "number":
                return _Text(next(ahead))
            if kind in ("t", "parameter"):
                return self.leaf(node)
            if kind == "^" and self.graph.number(node[2]) is not None:
                return _joined("^", body(node[1]), self.leaf(self.graph.nodes[node[2]]))
            return _applied(kind, [body(j) for j in node[1:]])
        # The order of `shape`: factors from the last, then the core.
        factors = [(kind, body(k)) for kind, k in reversed(first.factors)]
        same = first.number if len({x.number for x in summands}) == 1 else None
        core = body(first.core)
        if same is None:
            factors.append(("*", _Text(self.values([x.number for x in summands]))))
        text = self.product(_Summand(1.0, None, None), core, factors[::-1])
        return len(summands), reads, 1.0 if same is None else same, text

    def joined_sums(self, sums):
        """Sums over an index as texts, those that read the same variables joined."""
        found = {}
        for count, reads, factor, body in sums:
            found.setdefault((count, frozenset(reads)), []).append((factor, body))
        for (count, _), bodies in found.items():
            factor = bodies[0][0] if len(bodies) == 1 else 1.0
            inner = bodies[0][1] if len(bodies) == 1 else self.sum_of(
                [self.times(*body) for body in bodies])
            yield self.times(factor, _Text("sum(i = 1..%d, %s)" % (count, inner.text),
                                           _ATOM, inner.depth + 1))

    @staticmethod
    def times(factor, text):
        if factor not in (1, -1):
            text = text.within(_PRODUCT)
            text = _Text(number(abs(factor)) + "*" + text.text, _PRODUCT, text.depth)
        return text if factor > 0 else _applied("neg", [text])

    def alone(self, summand):
        return self.product(summand, self.texts[summand.core],
                            [(kind, self.texts[k]) for kind, k in summand.factors])

    def product(self, summand, core, factors):
        """A number times factors times what reads the state."""
        text = None
        for kind, factor in factors:
            if kind == "*":
                text = factor if text is None else _joined("*", text, factor)
        if text is not None:
            core = core.within(_PRODUCT)
            text = text.within(_PRODUCT)
            core = _Text(text.text + "*" + core.text, _PRODUCT, max(
                text.depth, core.depth)) if not core.text.startswith("1/") else _Text(
                    text.text + core.text[1:], _PRODUCT, max(text.depth, core.depth))
        for kind, factor in factors:
            if kind == "/":
                core = _joined("/", core, factor)
        return self.times(summand.number, core)

    def groups(self, root):
        """Of a sum, what is a sum over an index (a _Text), and what is not (a
        _Summand); None where it is to be written as it stands."""
        before = len(self.graph.nodes)
        summands = self.summands(root)
        if summands is None or len(summands) < _FEWEST:
            return None
        alike, order = {}, []
        for summand in summands:
            shape, leaves = self.shape(summand)
            if shape is None or not leaves or not self.sums:
                order.append(([summand], None))
                continue
            if shape not in alike:
                alike[shape] = ([], [])
                order.append(alike[shape])
            alike[shape][0].append(summand)
            alike[shape][1].append(leaves)
        if len(self.graph.nodes) == before and not any(
                leaves and len(members) >= _FEWEST for members, leaves in order):
            return None
        sums = [self.over_index(*group) for group in order
                if group[1] and len(group[0]) >= _FEWEST]
        return list(self.joined_sums(sums)) + [
            summand for members, leaves in order if not (
                leaves and len(members) >= _FEWEST) for summand in members]

    # Other formulas.

    def write(self, roots, grouped):
        """Makes the texts of what roots are made of.  `grouped`: {node: groups}."""
        uses, order, ahead, seen = {}, [], [(k, False) for k in roots], set()
        for k in roots:
            uses[k] = uses.get(k, 0) + 1
        while ahead:  # what a text is made of is written before it
            k, done = ahead.pop()
            if done:
                order.append(k)
            elif k not in seen:
                seen.add(k)
                ahead.append((k, True))
                for j in self.parts(k, grouped):
                    uses[j] = uses.get(j, 0) + 1
                    ahead.append((j, False))
        for k in order:
            node = self.graph.nodes[k]
            if grouped.get(k):
                text = self.sum_of(grouped[k])
            elif node[0] in ("number", "t", "q", "p", "parameter"):
                self.texts[k] = self.leaf(node)
                continue
            else:
                text = _applied(node[0], [self.texts[j] for j in node[1:]])
            short = re.fullmatch(r"-[\w\[\]]+", text.text) or (
                not self.graph.reads[k] & (STATE | TIME) and len(text.text) < _SHORT)
            if uses[k] > 1 and not short or len(text.text) > _LONGEST or (
                    text.depth > _DEEPEST):
                name = "%s%d" % (self.prefix, len(self.definitions) + 1)
                self.definitions.append((name, text.text))
                text = _Text(name)
            self.texts[k] = text

    def parts(self, k, grouped):
        """The nodes whose texts the text of k is made of."""
        node = self.graph.nodes[k]
        if node[0] in ("number", "t", "q", "p", "parameter"):
            return ()
        if k not in grouped:
            grouped[k] = self.groups(k) if node[0] in "+-" else None
        if not grouped[k]:
            if node[0] in "+-":  # nor is a part of this sum one over an index
                grouped.update((j, None) for j in node[1:]
                               if self.graph.nodes[j][0] in "+-")
            return node[1:]
        return [j for part in grouped[k] if isinstance(part, _Summand)
                for j in [part.core] + [outer for _, outer in part.factors]]

    def sum_of(self, parts):
        text = None
        for part in parts:
            part = part if isinstance(part, _Text) else self.alone(part)
            if text is None:
                text = part
            elif part.text.startswith("-") and part.level == _SUM:
                text = _Text("%s - %s" % (text.text, part.text[1:]), _SUM,
                             max(text.depth, part.depth))
            else:
                text = _joined("+", text, part)
        return text

    def effects(self, root):
        """H as a list of texts, each no longer than a line may be."""
        grouped = {root: self.groups(root)}
        self.write([root], grouped)
        parts = grouped.get(root)
        if parts is None and len(self.texts[root].text) > _LINE:
            parts = self.summands(root)
        if not parts:
            # The root itself may have become a definition.
            return [self.texts[root].text]
        chunks, length = [[]], 0
        for part in parts:
            text = part if isinstance(part, _Text) else self.alone(part)
            if chunks[-1] and length + len(text.text) > _LINE:
                chunks.append([])
                length = 0
            chunks[-1].append(text)
            length += len(text.text) + 3
        return [self.sum_of(chunk).text for chunk in chunks]


def scene_text(graph, root, coordinates, start, parameters, title):
    """The text of a scene whose H is the node `root`.

    coordinates   [(name, index from 1 or None)], one for each coordinate
    start         a number for each coordinate, then for each momentum
    parameters    {name: number}
    """
    names = dict.fromkeys(name for name, _ in coordinates)
    writer = _Writer(graph, coordinates, set(names) | set(parameters))
    effects = writer.effects(root)
    lines = ["[scene]", "title = " + title, "[parameters]"]
    lines += ["%s = %r" % item for item in parameters.items()]
    lines += ["%s[1..%d] = %s" % table for table in writer.tables]
    lines.append("[coordinates]")
    half = len(coordinates)
    for name in names:
        at = [k for k in range(half) if coordinates[k][0] == name]
        row = "" if coordinates[at[0]][1] is None else "[1..%d]" % len(at)
        for prefix, first in (("", 0), ("p_", half)):
            lines.append("%s%s%s = %s" % (prefix, name, row, ", ".join(
                repr(float(start[first + k])) for k in at)))
    if writer.definitions:
        lines.append("[definitions]")
        lines += ["%s = %s" % definition for definition in writer.definitions]
    lines.append("[effects]")
    lines += ["H%s = %s" % (k + 1 if k else "", text) for k, text in enumerate(effects)]
    lines.append("[run]\ngradient = exact\n")
    return "\n".join(lines)
