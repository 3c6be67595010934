"""nevh sheet and nevh mark: a worksheet for each student, and marks.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import csv
import html
import io
import json
import os
import re
import sys
import unicodedata

from . import _sheet_export as export
from . import _sheet_text as text
from ._library import Error
from ._progress import Progress
from ._tasks import Answer, Measured, Quantities, filled, numbers, plain, tasks, typed


class Sheet:
    """A sheet, with its numbers: a title, and Texinfo without @value."""

    def __init__(self, number, title, body, source):
        self.number, self.title, self.body, self.source = number, title, body, source


def read_sheets(path, name=None, key=""):
    """The sheets of sheets.texi, with the usual numbers or those of a name."""
    made = []
    for number, (title, body) in enumerate(text.chapters(path), 1):
        quantities = Quantities(body).of(name, key, number)
        made.append(Sheet(number, title, filled(re.sub(r"^@c .*\n", "", body, flags=re.M),
                                                quantities), os.path.dirname(path)))
    return made


class Room:
    """The sheets, their quantities, tasks and numbers."""

    def __init__(self):
        self.folder = text.folder()
        self.path = os.path.join(self.folder, "sheets.texi")
        self.tasks, self.numbers = tasks(self.folder), numbers(self.folder)
        self.measured = Measured(self.folder)
        self.quantities = {number: Quantities(body) for number, (_, body) in
                           enumerate(text.chapters(self.path), 1)}

    def asked(self, number):
        """The tasks of a sheet."""
        return [task for task in self.tasks.values() if task.sheet == number]

    def answers(self, number, name, key):
        """The answers of a name to the tasks of a sheet."""
        return [Answer(self, task, name, key) for task in self.asked(number)]


def write_notebook(sheet, path, asked=()):
    """A sheet as a notebook."""
    cells = text.cells_of(sheet.title, sheet.body, sheet.source, asked)
    with open(path, "w", encoding="utf-8") as file:
        json.dump(text.notebook(cells), file, indent=1, ensure_ascii=False)
        file.write("\n")


def file_name(name):
    """A name as a part of a file's name."""
    letters = unicodedata.normalize("NFKD", plain(name)).encode("ascii", "ignore").decode()
    made = re.sub(r"[^a-z0-9]+", "-", letters).strip("-")
    return made if made else "student-" + plain(name).encode().hex()[:16]


def boxes(asked):
    """What follows an item: room for answers, or for work where no number is asked."""
    def of(item):
        rows = ['<div class="answer"><span>%s</span><b></b></div>' % html.escape(task.asks())
                for task in asked if task.item == item]
        return "".join(rows) or '<div class="room"></div>'
    return of


def names_of(given):
    """The names: of a file with one a line, or the name itself."""
    if not os.path.isfile(given):
        if "/" in given or given.endswith((".txt", ".csv")):
            raise Error("there is no file %s with names, one a line" % given)
        if not plain(given):
            raise Error("--for takes a name, or a file of names")
        return [given]
    with open(given, encoding="utf-8-sig") as file:
        listed = [" ".join(line.split()) for line in file]
    listed = [name for name in listed if name and name[0] != "#"]
    if not listed:
        raise Error("%s has no names, one a line" % given)
    twice = [name for k, name in enumerate(listed)
             if plain(name) in map(plain, listed[:k])]
    if twice:
        raise Error("%s has the name %s twice; write it so that the two differ" % (
            given, twice[0]))
    return listed


def numbers_of(given, known):
    """The sheets that are asked for: N, or all where none is given."""
    if given is None:
        return known
    if not given.isdigit() or int(given) not in known:
        raise Error("there is no sheet %s; there are %d to %d" % (given, known[0], known[-1]))
    return [int(given)]


def list_of_sheets(room):
    """A line a sheet."""
    lines = ["Worksheets for a class, two hours each:", ""]
    for sheet in read_sheets(room.path):
        lines.append("  %d  %-28s %d answers are numbers" % (
            sheet.number, text.markdown(sheet.title), len(room.asked(sheet.number))))
    return "\n".join(lines + [
        "", "To begin:",
        "  nevh sheet 1                        writes sheet-1.html, to print, and sheet-1.ipynb",
        "  nevh sheet 1 --for names.txt --key 7   one a name, with other numbers",
        "  nevh sheet 1 --for names.txt --key 7 --answers   the answers",
        "  nevh mark answers.csv --key 7       right, wrong, and why", ""])


def told(names):
    """The names one by one, with the progress."""
    with Progress("sheet") as progress:
        for k, name in enumerate(names):
            progress.at(k/len(names))
            yield name


def write(path, made):
    with open(path, "w", encoding="utf-8", newline="") as file:
        file.write(made)


def make_sheets(room, given):
    """Pages and notebooks in a folder; what was written."""
    folder = given.output or "."
    if not os.path.isdir(folder):
        os.mkdir(folder)
    names = [None] if given.name is None else names_of(given.name)
    chosen, count = numbers_of(given.number, sorted(room.quantities)), 0
    for name in told(names):
        for sheet in read_sheets(room.path, name, given.key):
            if sheet.number not in chosen:
                continue
            asked = room.asked(sheet.number)
            stem = os.path.join(folder, "-".join(
                ["sheet", str(sheet.number)] + ([file_name(name)] if name else [])))
            if given.form in (None, "page"):
                body = text.sheet_html(sheet.number, sheet.title, sheet.body, sheet.source,
                                       name or "", boxes(asked))
                write(stem + ".html", text.page("Sheet %d" % sheet.number, body,
                                                sheet.source))
                count += 1
            if given.form in (None, "notebook"):
                write_notebook(sheet, stem + ".ipynb", [(task.item, task.asks())
                                                        for task in asked])
                count += 1
            if given.form == "check":
                write(stem + "-check.html", export.check_page(
                    room, sheet, name or "", given.key))
                count += 1
    return "%d files are made in %s\n" % (count, folder)


def answer_rows(room, given):
    """The answers: a row a name and task."""
    names = [None] if given.name is None else names_of(given.name)
    chosen = numbers_of(given.number, sorted(room.quantities))
    rows = [["name", "task", "answer", "lowest", "highest", "unit", "asked"]]
    for name in told(names):
        for number in chosen:
            for answer in room.answers(number, name, given.key):
                width = answer.width(answer.number)
                rows.append([name or "", answer.task.name, shown(answer.number, answer),
                             "%.6g" % (answer.number - width),
                             "%.6g" % (answer.number + width), answer.task.unit,
                             answer.task.label])
    return rows


def shown(number, answer):
    """A number with a digit more than is asked for."""
    if answer.task.kind == "decimals":
        return "%.*f" % (answer.task.digits + 1, number)
    return "%.*g" % (answer.task.digits + 1, number)


def as_csv(rows):
    made = io.StringIO()
    csv.writer(made, lineterminator="\n").writerows(rows)
    return made.getvalue()


def as_table(rows):
    """Rows in columns, the first as a head."""
    widths = [max(len(str(row[k])) for row in rows) for k in range(len(rows[0]))]
    return "".join(" ".join("%-*s" % pair for pair in zip(widths, map(str, row))).rstrip() +
                   "\n" for row in rows)


def read_answers(path):
    """(name, task, answer) of a CSV, by the names of its columns; , or ; between them."""
    with (sys.stdin if path == "-" else open(path, encoding="utf-8-sig", newline="")) as file:
        lines = file.read().splitlines()
    if not lines:
        raise Error("%s is empty" % path)
    mark = max(",;\t", key=lines[0].count)
    rows = list(csv.reader(lines, delimiter=mark))
    head = [plain(cell) for cell in rows[0]]
    missing = [name for name in ("name", "task", "answer") if name not in head]
    if missing:
        raise Error("%s: the first line names no column %s; it has to be name,task,answer"
                    % (path, missing[0]))
    places = [head.index(name) for name in ("name", "task", "answer")]
    for number, row in enumerate(rows[1:], 2):
        if not any(cell.strip() for cell in row):
            continue
        if len(row) != len(head):
            raise Error('%s: line %d has %d columns, not %d; an answer with a comma stands '
                        'between quotes, "1,6"' % (path, number, len(row), len(head)))
        yield number, [row[place].strip() for place in places]


def mark_rows(room, given):
    """The verdict of each answer, and the numbers of right ones of each name."""
    known, rows, sums = {}, [["name", "task", "answer", "verdict", "why"]], {}
    for number, (name, task, said) in read_answers(given.number):
        task = task.rstrip(".").lower()
        if task not in room.tasks:
            near = [one for one in room.tasks if one.startswith(task)]
            raise Error("%s: line %d: there is no task %s%s" % (
                given.number, number, task, "; there are " + ", ".join(near) if near else ""))
        at = (plain(name), task)
        if at not in known:
            known[at] = Answer(room, room.tasks[task], name or None, given.key)
        verdict, why = known[at].judged(typed(said, room.tasks[task].unit)) if said else \
            ("missing", "")
        rows.append([name, task, said, verdict, why])
        right, of = sums.get(plain(name), (0, 0))
        sums[plain(name)] = right + (verdict == "right"), of + 1
    return rows, sums


def run(given):
    """What a command prints."""
    room = Room()
    if given.what == "mark":
        rows, sums = mark_rows(room, given)
        if given.format == "csv":
            return as_csv(rows)
        return as_table(rows) + "\n" + "".join(
            "%s: %d of %d are right\n" % (name, *one) for name, one in sums.items())
    if given.answers:
        rows = answer_rows(room, given)
        return as_csv(rows) if given.format == "csv" or given.output else as_table(rows)
    if given.form == "moodle":
        return export.moodle(room, numbers_of(given.number, sorted(room.quantities)),
                             [None] if given.name is None else names_of(given.name), given.key)
    if given.number is given.name is given.form is given.output is None:
        return list_of_sheets(room)
    return make_sheets(room, given)


def main(arguments):
    """nevh sheet and nevh mark, whose options the command has read."""
    reader = argparse.ArgumentParser(prog="nevh", add_help=False)
    reader.add_argument("what", choices=("sheet", "mark"))
    reader.add_argument("number", nargs="?")
    reader.add_argument("--for", dest="name")
    reader.add_argument("--key", default="")
    reader.add_argument("--as", dest="form")
    reader.add_argument("--answers", action="store_true")
    reader.add_argument("--format")
    reader.add_argument("--output")
    given = reader.parse_args(arguments)
    try:
        made = run(given)
        if given.output and (given.what == "mark" or given.answers or given.form == "moodle"):
            write(given.output, made)
        else:
            sys.stdout.write(made)
    except OSError as error:
        sys.stderr.write("nevh: %s: %s\n" % (error.filename, error.strerror))
        return 2
    except UnicodeDecodeError:
        sys.stderr.write("nevh: a file that was given is no text in UTF-8\n")
        return 2
    except Error as error:
        sys.stderr.write("nevh: %s\n" % error)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
