"""Quantities, answers and mistakes of the worksheets' tasks.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ast
import hashlib
import math
import os
import re
import shlex
import subprocess
import threading

from . import _commands
from ._hand_in import plain
from ._library import Failed

_functions = {name: getattr(math, name) for name in
              ("pi", "sqrt", "sin", "cos", "log", "exp", "log10")}


def value_of(formula, names):
    """A number from a formula of the lists, in which ^ is a power."""
    tree = ast.parse(formula.replace("^", "**"), mode="eval")
    for node in ast.walk(tree):
        if isinstance(node, (ast.Attribute, ast.Lambda, ast.Subscript)):
            raise ValueError("%s is no formula" % formula)
    return eval(compile(tree, formula, "eval"), {"__builtins__": {}},
                {**_functions, **names})


def drawn(low, high, *words):
    """A number between two that are written with as many decimals, from words."""
    decimals = len(low.partition(".")[2])
    first, last = (round(float(one)*10**decimals) for one in (low, high))
    digest = hashlib.sha256("\0".join(words).encode()).digest()
    return "%.*f" % (decimals, (first + int.from_bytes(digest[:8], "big") %
                                (last - first + 1))/10**decimals)


def _number(text):
    try:
        return float(text)
    except ValueError:
        return text


class Quantities:
    """The quantities that a sheet sets: @set NAME VALUE, and how others are drawn,
    @c drawn NAME LOW HIGH, NAME = FORMULA or NAME: TEXT."""

    def __init__(self, body):
        self.defaults = dict(re.findall(r"^@set (\S+) (.*)$", body, flags=re.M))
        self.rules = re.findall(r"^@c drawn ([\w-]+)(: | = | )(.*)$", body, flags=re.M)

    def of(self, name=None, key="", sheet=0, changed=()):
        """{quantity: text}: the defaults, or those of a name; `changed` are formulas
        that replace some."""
        made = dict(self.defaults)
        if name is not None:
            for quantity, kind, rule in self.rules:
                if kind == " ":
                    made[quantity] = drawn(*rule.split(), key, plain(name), str(sheet),
                                           quantity)
        for quantity, formula in dict(changed).items():
            made[quantity] = "%.15g" % value_of(formula, {
                one: _number(text) for one, text in made.items()})
        for quantity, kind, rule in self.rules if name is not None else ():
            if quantity in changed:
                continue
            if kind == " = ":
                made[quantity] = "%.12g" % value_of(rule, {
                    one: _number(text) for one, text in made.items()})
            elif kind == ": ":
                made[quantity] = filled(rule, made)
        return made


def filled(text, quantities):
    """A text with @value{NAME} replaced."""
    return re.sub(r"@value\{([\w-]+)\}", lambda at: quantities[at.group(1)], text)


class Number:
    """A line of numbers.list: a number, and the command and the program of awk that it
    comes from."""

    def __init__(self, sheet, line):
        self.sheet = sheet
        self.key, _, self.shown, self.command, self.program = line.split("|", 4)


def numbers(folder):
    """{key: Number} of numbers.list."""
    made, sheet = {}, 0
    with open(os.path.join(folder, "numbers.list"), encoding="utf-8") as file:
        for line in file.read().splitlines():
            heading = re.match(r"# (\d+): ", line)
            if heading:
                sheet = int(heading.group(1))
            elif line and line[0] != "#":
                one = Number(sheet, line)
                made[one.key] = one
    return made


class Measured:
    """Numbers that commands print; each command is run once, by any thread."""
    first = 'NR == 1 { for (i = 1; i <= NF; i++) c[$i] = i } '

    def __init__(self, folder):
        self.folder = folder
        self.outputs, self.numbers, self.locks = {}, {}, {}

    def number(self, command, program):
        """The number that a command of numbers.list prints, by its program of awk."""
        if (command, program) not in self.numbers:
            self.numbers[command, program] = self.read(command, program)
        return self.numbers[command, program]

    def read(self, command, program):
        """As number, which keeps it."""
        made = _output(["awk", "-F,", "-vOFMT=%.12g", self.first + program], self.output(command),
                       self.folder)
        try:
            return float(made.split()[0])
        except (IndexError, ValueError):
            raise Failed("no number comes from: %s" % command) from None

    def output(self, command):
        """What a command prints, without the lines of #."""
        loop = re.match(r"for (\w+) in ([^;]*); do (nevh [^;]*); done$", command)
        if loop:
            name, values, each = loop.groups()
            return "".join(self.output(each.replace("$" + name, value))
                           for value in values.split())
        with self.locks.setdefault(command, threading.Lock()):
            return self._of_one(command)

    def _of_one(self, command):
        if command not in self.outputs:
            if command.startswith("nevh ") and not re.search(r"[;$&<>]", command):
                words = [_commands.command()] + shlex.split(command)[1:]
            else:
                words = ["sh", "-c", 'nevh() { "$NEVH_COMMAND" "$@"; }; ' + command]
            self.outputs[command] = re.sub("^#.*\n", "", _output(
                words, "", self.folder), flags=re.M)
        return self.outputs[command]


def _output(words, given, folder):
    made = subprocess.run(words, input=given, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, encoding="utf-8", cwd=folder,
                          env=dict(os.environ, NEVH_COMMAND=_commands.command()))
    if made.returncode:
        raise Failed("%s fails: %s" % (shlex.join(words), made.stderr.strip()))
    return made.stdout


class Task:
    """A task of tasks.list: its answer is a number of numbers.list."""

    def __init__(self, line):
        self.name, self.key, digits, slack, self.unit, self.label = (
            one.strip() for one in line.split("|"))
        self.digits, self.kind = int(digits.split()[0]), digits.split()[1]
        self.slack, _, self.absolute = slack.partition(" ")
        self.mistakes = []
        self.truth = None
        self.sheet, item = re.match(r"(\d+)\.(\d+)", self.name).groups()
        self.sheet, self.item = int(self.sheet), int(item)

    def around(self, number):
        """How far right answers may be from a number before they are rounded."""
        return float(self.slack)*(1 if self.absolute else abs(number))

    def unit_asked(self, number):
        """The unit of the last digit that is asked for."""
        if self.kind == "decimals":
            return 10.0**-self.digits
        return last_unit(number, self.digits)

    def asks(self):
        """The label, with the digits and the unit."""
        return "%s %s (%d %s%s)" % (self.name, self.label, self.digits, self.kind,
                                    ", in " + self.unit if self.unit else "")


def last_unit(number, digits):
    """The unit of the last of so many digits of a number."""
    return 10.0**(math.floor(math.log10(abs(number))) - digits + 1) if number else 0.0


def tasks(folder):
    """{name: Task} of tasks.list; a line that begins with spaces is the truth or a mistake of
    the task above it, or a mistake of all where there is none yet."""
    made, common, task = {}, [], None
    with open(os.path.join(folder, "tasks.list"), encoding="utf-8") as file:
        for line in file.read().splitlines():
            if not line or line[0] == "#":
                continue
            if line[0] != " ":
                task = Task(line)
                made[task.name] = task
            elif line.startswith("  = "):
                task.truth = [one.strip() for one in line[4:].split("|", 1)]
            else:
                said, rules = line.strip().split(": ", 1)
                for rule in rules.split("; "):
                    (task.mistakes if task else common).append((said, rule.strip()))
    for task in made.values():
        task.mistakes += common
    return made


class Answer:
    """The answer of a name to a task, and its mistakes as numbers."""

    def __init__(self, room, task, name, key):
        self.room, self.task, self.name, self.key = room, task, name, key
        self.number = self.measured() if task.truth is None else room.measured.number(*(
            filled(one, self.quantities()) for one in task.truth))
        self.known = None

    def quantities(self, changed=()):
        return self.room.quantities[self.task.sheet].of(self.name, self.key,
                                                        self.task.sheet, changed)

    def measured(self, changed=(), replaced=()):
        """What the command gives, after quantities are changed and texts replaced."""
        listed = self.room.numbers[self.task.key]
        quantities = self.quantities(changed)
        texts = [filled(one, quantities) for one in (listed.command, listed.program)]
        for old, new in replaced:
            texts = [one.replace(old, new) for one in texts]
        return self.room.measured.number(*texts)

    def mistaken(self, rule):
        """The number of a mistake; None where there is none."""
        try:
            if " -> " in rule:
                return self.measured(replaced=[filled(rule, self.quantities()).split(" -> ")])
            change = re.match(r"([\w-]+) = (.*)", rule)
            if change:
                return self.measured(changed={change.group(1): change.group(2)})
            return float(value_of(rule, {"x": self.number, **{
                one: _number(text) for one, text in self.quantities().items()}}))
        except (Failed, ArithmeticError, ValueError, TypeError):
            return None

    def width(self, number, unit=math.inf):
        """How far an answer may be from a number, typed with a last digit of `unit`."""
        asked = self.task.unit_asked(number)
        return self.task.around(number) + 1.0001*max(min(unit, asked), asked/2)

    def is_near(self, typed, number):
        return abs(typed.number - number) <= self.width(number, typed.unit)

    def is_right(self, typed):
        """Whether a reading of what was typed is the right number."""
        return self.is_near(typed, self.number) or \
            typed.other is not None and self.is_near(typed.other, self.number)

    def tells_apart(self, number):
        """Whether no answer may be taken for both this number and the right one."""
        return number is not None and math.isfinite(number) and abs(
            number - self.number) > self.width(number) + self.width(self.number)

    def mistakes(self):
        """(words, number) of the mistakes that give another number."""
        if self.known is None:
            tried = [(said, self.mistaken(rule)) for said, rule in self.task.mistakes]
            self.known = [one for one in tried if self.tells_apart(one[1])]
        return self.known

    def judged(self, typed):
        """(verdict, why) of what was typed."""
        if typed.number is None:
            return "unreadable", typed.why
        if self.is_right(typed):
            return "right", ""
        if abs(typed.number - self.number) <= self.task.around(self.number) + typed.unit/2:
            return "wrong", "too few digits: %d %s are asked for" % (self.task.digits,
                                                                   self.task.kind)
        for said, number in self.mistakes():
            if self.is_near(typed, number):
                return "wrong", said
        return "wrong", ""
