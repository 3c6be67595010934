"""What people hand in: numbers as they type them, tables as spreadsheets save them, and
lists of names.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import csv
import difflib
import io
import math
import os
import re
import select
import stat
import sys
import unicodedata

from ._library import Error

_number = (r"(?:\d{1,3}(?:[ '\u2019]\d{3})+(?:[.,]\d+)?|\d{1,3}(?:,\d{3})+\.\d+|"
           r"\d{1,3}(?:\.\d{3})+,\d+|\d{1,3}(?:,\d{3}){2,}|\d{1,3}(?:\.\d{3}){2,}|"
           r"\d+[.,]?\d*|[.,]\d+)(?![.,]?\d)")
_power = (r"(?:\s*[eE]\s?([-+]?\s?\d+)|(?:\s*[*xX\u00d7\u00b7\u22c5]\s*10\s*(?:\^|\*\*)?|"
          r"\s10\s*(?:\^|\*\*|(?=[-+])))\s*[({]?\s*([-+]?\s?\d+)\s*[)}]?)?")
_superscripts = str.maketrans("\u207a\u207b\u2070\u00b9\u00b2\u00b3" + "".join(
    map(chr, range(0x2074, 0x207a))), "+-0123456789")
_dashes = str.maketrans(dict.fromkeys("\u2010\u2011\u2012\u2013\u2014\u2212", "-"))
_units = {  # the units of answers, and what people write for them
    "s": {"ms": 1e-3, "ks": 1e3, "\u03bcs": 1e-6, "us": 1e-6, "min": 60, "minutes": 60, "h": 3600},
    "rad": {"mrad": 1e-3, **dict.fromkeys(("\u00b0", "deg", "degree", "degrees", "grad"),
                                         math.pi/180)},
    "rad/s": {"hz": 2*math.pi, "hertz": 2*math.pi, "krad/s": 1e3, "\u00b0/s": math.pi/180,
              "deg/s": math.pi/180},
    "%": {}, "": {}, "1/s": {}}
_shares = {"%": 0.01, "percent": 0.01, "per cent": 0.01, "\u2030": 1e-3}
_months = ("jan|feb|m[a\u00e4]r|apr|ma[iy]|jun|jul|aug|sep|o[ck]t|nov|de[cz]")
_blank = ("", "-", "--", "n/a", "na", "none", "?")


class Typed:
    """A number as a person typed it, the unit of its last digit, and another reading of
    it, if any; or why there is no number."""

    def __init__(self, number, unit=0.0, other=None, why=""):
        self.number, self.unit, self.other, self.why = number, unit, other, why


def is_blank(text):
    """Whether a cell is one that nobody filled in."""
    return text.strip().translate(_dashes).lower() in _blank


def plain(name):
    """A name in one form, whatever its case and spaces."""
    return " ".join(unicodedata.normalize("NFKC", name).casefold().split())


def _cleaned(text):
    """A number in the characters of a program."""
    text = re.sub("([%s]+)" % "".join(map(chr, _superscripts)), lambda at: "^" + at.group()
                  .translate(_superscripts), text)
    text = unicodedata.normalize("NFKC", text).translate(_dashes)
    text = re.sub(r"\\(?:cdot|times)(?![a-z])", "*", text.replace("{,}", ","))
    text = re.sub(r"\\[,;! ]|\\(?:left|right)\b|\$", " ", text).strip().strip("\"'`").strip()
    text = re.split(r"[=\u2248\u2243~]", text)[-1].strip()
    text = re.sub(r"^(?:about|approx(?:\.|imately)?|ca\.?|circa|roughly)\s+", "", text, flags=re.I)
    text = re.sub(r"^([-+]?)\s*10\s*(\^|\*\*)", r"\g<1>1*10\2", text)
    return re.sub(r"^minus\s+", "-", text, flags=re.I)


def _mantissa(text):
    """The text of a mantissa with a point, and its thousands read away."""
    text = re.sub("[ '\u2019]", "", text)
    if "," in text and "." in text or max(text.count(","), text.count(".")) > 1:
        point = text[max(text.rfind(","), text.rfind("."))]
        other = "," if point == "." else "."
        return text.replace(other, "").replace(point, "." if text.count(point) == 1 else "")
    return text.replace(",", ".")


def _last_place(mantissa):
    """The unit of the last digit; zeros at the end of a whole number may be rounded ones."""
    if "." in mantissa:
        return 10.0**-len(mantissa.partition(".")[2])
    digits = mantissa.lstrip("0")
    return 10.0**(len(digits) - len(digits.rstrip("0")))


def _scale(rest, unit):
    """The factor of what stands behind a number; None where that is another number."""
    rest = re.sub(r"^\(\d+\)|(?:\u00b1|\+/-|\+-)\s*%s%s" % (_number, _power), "", rest)
    said = re.sub(r"[\s^*\u00b7()\[\]{}.]", "", rest)
    if said in ("s-1", "1/s", "/s", "rads-1", "1/sec"):
        return 1.0
    if re.search(r"\d", re.sub(r"[A-Za-z]-?[1-4]\b", "", re.sub(r"\s*\^\s*", "", rest))):
        return None
    return _units.get(unit, {}).get(said.lower() if said != "M" else said, 1.0 if unit == "%"
                                    else _shares.get(rest.strip().lower(), 1.0))


def _exact(text):
    """A fraction, or a multiple of pi."""
    at = re.match(r"([-+]?)\s*(%s)?\s*(\*?\s*(?:pi|\u03c0)\b)?\s*(?:/\s*(%s))?\s*([^\d]*)$" % (
        _number, _number), text, flags=re.I)
    if not at or not (at.group(3) or at.group(2) and at.group(4)):
        return None
    over, under = (float(_mantissa(part or "1")) for part in (at.group(2), at.group(4)))
    if not under:
        return None
    return (-1 if at.group(1) == "-" else 1)*over*(math.pi if at.group(3) else 1)/under


def typed(text, unit=""):
    """The number in an answer in a unit, such as 1.6e-2, 1,6*10^-2, 76 %, 1.5 s or 1/3."""
    given, text = text.strip().translate(_dashes), _cleaned(text)
    if re.match(r"(\d{1,2}[./-]\s?\d{1,2}[./-]\s?\d{2,4}|\d{4}-\d\d-\d\d)\b|\d{1,2}[-. ]{1,2}(%s)|"
                r"(%s)[a-z]*[-. ]\d" % (_months, _months), given, flags=re.I):
        return Typed(None, why="a date, which spreadsheets make of numbers such as 1.2 and 1/2")
    if given.startswith("#"):
        return Typed(None, why="an error of the spreadsheet")
    exact = _exact(text)
    if exact is not None:
        return Typed(exact)
    at = re.match(r"([-+]?)\s*(%s)%s\s*(.*)$" % (_number, _power), text, flags=re.S)
    if not at:
        return Typed(None, why="not a number")
    sign, written, power, ten, rest = at.groups()
    scale = _scale(rest, unit)
    if scale is None:
        return Typed(None, why="more than one number")
    mantissa = _mantissa(written)
    scale *= float("%s1e%s" % (sign, (power or ten or "0").replace(" ", "")))
    number, last = float(mantissa)*scale, _last_place(mantissa)*abs(scale)
    if not math.isfinite(number):
        return Typed(None, why="too large for a number")
    other = None
    if re.match(r"[1-9]\d{0,2},\d{3}$", written):  # 2,219 may be 2219
        other = Typed(1000*number, 1000*last)
    return Typed(number, last, other)


# Tables.


def bytes_of(path, longest=10, most=1 << 26):
    """The bytes of a file, not too many; a pipe that nobody writes to is not waited for
    without end."""
    if path == "-":
        return sys.stdin.buffer.read()
    with open(path, "rb", opener=lambda name, flags: os.open(name, flags | os.O_NONBLOCK)
              ) as file:
        if stat.S_ISFIFO(os.fstat(file.fileno()).st_mode) and \
                not select.select([file], [], [], longest)[0]:
            raise Error("%s: nothing was written to this pipe for %g s" % (path, longest))
        os.set_blocking(file.fileno(), True)
        data = file.read(most + 1)
    if len(data) > most:
        raise Error("%s is too large: it has more than %d MB" % (path, most >> 20))
    return data


def text_of(path):
    """The text of a file in the encodings that spreadsheets write."""
    data = bytes_of(path)
    if data[:2] == b"PK":
        raise Error("%s is a file of a spreadsheet; save it as CSV" % path)
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16", "replace")
    if b"\0" in data[:64]:
        return data.decode("utf-16-le" if data[1:2] == b"\0" else "utf-16-be", "replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def rows_of(path, text=None):
    """(line, cells) of a CSV with , or ; or tabs; the first is the head.  A pipe gives its
    text once."""
    text = re.sub(r"^\s*(?:sep=(.)\r?\n)?\s*", "", text_of(path) if text is None else text)
    if not text:
        raise Error("%s is empty" % path)
    mark = max(",;\t", key=text.splitlines()[0].count)
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=mark)
    for row in reader:
        row = [re.sub("^'(?=[=+@-])", "", " ".join(cell.split())) for cell in row]
        if any(row):
            yield reader.line_num, row


_heads = {"name": ("name", "student", "names", "full name", "student name", "student's name"),
          "first": ("first name", "given name", "firstname"),
          "last": ("last name", "surname", "family name", "lastname"),
          "task": ("task", "question", "exercise", "item", "problem"),
          "answer": ("answer", "value", "result", "response")}


def _column(head, kind):
    return next((k for k, cell in enumerate(head) if plain(cell) in _heads[kind]), None)


def _naming(head):
    """The columns of the names."""
    name, last = _column(head, "name"), _column(head, "last")
    if name is None and last is not None:
        return [k for k in (_column(head, "first"), last) if k is not None]
    return [] if name is None else [name]


def task_of(text, tasks):
    """The task that a text names, such as 1.1a, Task 1.1 (a) or 1,1a; or None."""
    at = re.match(r"(?:[a-z]+\.?\s*|#)?(\d+)\s?[.,]\s?(\d+)\s?\(?([a-z]?)\)?(?![a-z\d])",
                  plain(text))
    if not at:
        return None
    number = "%d.%d" % (int(at.group(1)), int(at.group(2)))
    return next((one for one in (number + at.group(3), number) if one in tasks), None)


class _Faults:
    """The lines of a file that cannot be read, which are told together."""
    most = 10

    def __init__(self, path):
        self.path, self.lines = path, []

    def add(self, line, said):
        self.lines.append("line %d: %s" % (line, said))

    def tell(self):
        if self.lines:
            more = len(self.lines) - self.most
            raise Error("%s: %s%s" % (self.path, "\n  ".join(self.lines[:self.most]),
                                      "\n  and %d lines more" % more if more > 0 else ""))


def _fitted(row, head):
    """A row with as many cells as the head, or None: cells that are empty at the end may be
    too few or too many, and a comma may divide an answer, 1,6, in the last column."""
    if len(row) == len(head) + 1 and plain(head[-1]) in _heads["answer"] and \
            re.match(r"[-+]?\d+$", row[-2]) and re.match(r"\d", row[-1]):
        row = row[:-2] + [row[-2] + "," + row[-1]]
    while len(row) > len(head) and not row[-1]:
        row = row[:-1]
    return None if len(row) > len(head) else row + [""]*(len(head) - len(row))


def _cells(row, head, tasks):
    """(task, answer) of a row: of its columns, or of all columns whose heads are tasks."""
    task, answer = _column(head, "task"), _column(head, "answer")
    if task is not None and answer is not None:
        return [(row[task], row[answer])]
    return [(cell, row[k]) for k, cell in enumerate(head) if task_of(cell, tasks)]


def _checked(head, path, tasks):
    """What a head has to name."""
    names = [task for task in head if task_of(task, tasks)]
    missing = [] if _naming(head) else ["name"]
    if not names:
        missing += [kind for kind in ("task", "answer") if _column(head, kind) is None]
    if missing:
        raise Error("%s: the first line names no column %s; it has to be name,task,answer, "
                    "or name and the tasks, as nevh sheet --as form writes it" % (
                        path, missing[0]))


def read_answers(path, tasks, listed=None):
    """(line, name, task, answer) of a CSV, by the names of its columns: name,task,answer, or
    name and a column a task.  `listed` are the names there may be."""
    rows, faults, made = list(rows_of(path)), _Faults(path), []
    head = rows[0][1]
    _checked(head, path, tasks)
    for line, row in rows[1:]:
        cells = _fitted(row, head)
        if cells is None:
            faults.add(line, 'there are %d columns, not %d; an answer with a comma stands '
                       'between quotes, "1,6"' % (len(row), len(head)))
            continue
        name = " ".join(cells[k] for k in _naming(head) if cells[k])
        for said, answer in _cells(cells, head, tasks):
            task = task_of(said, tasks)
            if task:
                made.append((line, name, task, answer))
            else:
                near = [one for one in tasks if re.sub("[^0-9.]", "", said) and
                        one.startswith(re.sub("[^0-9.]", "", said).strip("."))]
                faults.add(line, "there is no task %s%s" % (
                    said, "; there are " + ", ".join(near) if near else ""))
    made = _with_names(made, listed, faults)
    faults.tell()
    return made


def _words(name):
    """The words of a name without accents, in any order: Lovelace, Ada."""
    letters = unicodedata.normalize("NFKD", plain(name))
    return tuple(sorted(re.findall(r"\w+", "".join(
        one for one in letters if not unicodedata.combining(one)))))


def _with_names(made, listed, faults):
    """The answers with names as they are listed."""
    if listed is None:
        if any(name for _, name, _, _ in made):
            for line in sorted({line for line, name, _, _ in made if not name}):
                faults.add(line, "there is no name")
        return made
    known = {plain(name): name for name in listed}
    for name in listed:
        words = _words(name)
        known[words] = None if words in known else name
    found = []
    for line, name, task, answer in made:
        one = known.get(plain(name)) or known.get(_words(name))
        if one:
            found.append((line, one, task, answer))
        else:
            near = difflib.get_close_matches(name, listed, 1, 0.6)
            said = "%s is not in the list of names" % name if name else "there is no name"
            said += "; %s is" % near[0] if near else ""
            if "line %d: %s" % (line, said) not in faults.lines:
                faults.add(line, said)
    return found


def names_of(given):
    """The names: of a file with one a line or a column of names, or the name itself."""
    if not os.path.exists(given) or os.path.isdir(given):
        if "/" in given or given.endswith((".txt", ".csv")):
            raise Error("there is no file %s with names, one a line" % given)
        if not plain(given):
            raise Error("--for takes a name, or a file of names")
        return [given]
    whole = text_of(given)
    listed = [" ".join(line.split()) for line in whole.splitlines()]
    listed = [name for name in listed if name and name[0] != "#"]
    if not listed:
        raise Error("%s has no names, one a line" % given)
    rows = [row for _, row in rows_of(given, whole)]
    if _naming(rows[0]):
        listed = [" ".join(row[k] for k in _naming(rows[0]) if k < len(row) and row[k])
                  for row in rows[1:]]
        listed = [name for name in listed if name]
    return _each_once(listed, given)


def _each_once(listed, given):
    seen = set()
    for name in listed:
        if plain(name) in seen:
            raise Error("%s has the name %s twice; write it so that the two differ" % (
                given, name))
        seen.add(plain(name))
    return listed
