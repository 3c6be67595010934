"""nevh sheet and nevh mark: a worksheet for each student, and marks.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import argparse
import concurrent.futures
import contextlib
import csv
import html
import io
import itertools
import json
import os
import re
import shutil
import sys
import unicodedata

from . import _sheet_export as export
from . import _sheet_text as text
from ._hand_in import is_blank, names_of, plain, read_answers, typed
from ._library import Error
from ._progress import Progress
from ._tasks import Answer, Measured, Quantities, filled, numbers, tasks


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
    write(path, json.dumps(text.notebook(cells), indent=1, ensure_ascii=False) + "\n")


def file_name(name):
    """A name as a part of a file's name."""
    whole = plain(name).translate(str.maketrans("łøđ", "lod"))  # no marks on letters
    letters = unicodedata.normalize("NFKD", whole).encode("ascii", "ignore").decode()
    made = re.sub(r"[^a-z0-9]+", "-", letters).strip("-")
    return made if made else "student-" + plain(name).encode().hex()[:16]


def file_names(names):
    """{name: a part of a file's name}, all different: Nuñez and Nunez are two people."""
    made = {}
    for name in filter(None, names):
        stem, count = file_name(name), 2
        while stem in made.values():
            stem, count = "%s-%d" % (file_name(name), count), count + 1
        made[name] = stem
    return made


def boxes(asked):
    """What follows an item: room for answers, or for work where no number is asked."""
    def of(item):
        rows = ['<div class="answer"><span>%s</span><b></b></div>' % html.escape(task.asks())
                for task in asked if task.item == item]
        return "".join(rows) or '<div class="room"></div>'
    return of


def numbers_of(given, known):
    """The sheets that are asked for: N, or all where that, or none, is given."""
    if given in (None, "all"):
        return known
    if not given.isdigit() or int(given) not in known:
        raise Error("there is no sheet %s; there are %d to %d" % (given, known[0], known[-1]))
    return [int(given)]


def list_of_sheets(room):
    """The sheets, a row each."""
    return [["sheet", "title", "answers"]] + [
        [sheet.number, text.markdown(sheet.title), len(room.asked(sheet.number))]
        for sheet in read_sheets(room.path)]


def list_in_words(rows):
    """A line a sheet, and how to begin."""
    lines = ["Worksheets for a class, two hours each:", ""]
    for number, title, count in rows[1:]:
        lines.append("  %d  %-28s %s" % (number, title, "%d answers are numbers" % count
                                         if count > 1 else "1 answer is a number"))
    return "\n".join(lines + [
        "", "To begin:",
        "  nevh sheet 1                     sheet-1.html, to print, and sheet-1.ipynb",
        "For a class; names.txt has a name a line, and the key is yours, and secret:",
        "  nevh sheet 1 --for names.txt --key 7 -o class.html   all to print, other numbers each",
        "  nevh sheet 1 --for names.txt --key 7 --answers       the answers",
        "  nevh sheet 1 --for names.txt --as form -o answers.csv   a table to fill in",
        "  nevh mark answers.csv --for names.txt --key 7        right, wrong, and why", ""])


def say(words):
    """A message of a command, whoever listens: short, and without characters that control a
    terminal, as tools/cli/words.c has them."""
    most, part = 1000, 450
    if len(words) > most:
        words = words[:part] + "..." + words[-part:]
    words = re.sub(r"[\x00-\x08\x0b-\x1f\x7f]", "?", words)
    with contextlib.suppress(OSError):
        sys.stderr.write("nevh: %s\n" % words)
        sys.stderr.flush()


def refuse(words):
    """Says it; the exit status."""
    say(words)
    return 2


def told(things, what="sheet"):
    """Things one by one, with the progress."""
    with Progress(what) as progress:
        for k, one in enumerate(things):
            progress.at(k/len(things))
            yield one


def by_all(function, things):
    """What a function makes of things, in their order, by all processors: each waits for
    commands.  Few wait in line, so that an interrupt ends soon."""
    many = os.cpu_count() or 1
    with concurrent.futures.ThreadPoolExecutor(many) as pool:
        for start in range(0, len(things), 4*many):
            yield from pool.map(function, things[start:start + 4*many])


def write(path, made):
    """A file under another name until it is whole; a device or a pipe as it is."""
    real = os.path.realpath(path)
    old = os.path.isfile(real)
    begun = "%s.%d" % (real, os.getpid()) if old or not os.path.exists(real) else real
    try:
        with open(begun, "w", encoding="utf-8", newline="") as file:
            file.write(made)
        if old:
            shutil.copymode(real, begun)
        if begun != real:
            os.replace(begun, real)
    except BaseException as error:
        if begun != real:
            with contextlib.suppress(OSError):
                os.remove(begun)
        if isinstance(error, OSError):
            raise Error("%s cannot be written: %s" % (path, error.strerror)) from None
        raise


def page_of(room, sheet, name):
    """A sheet as a part of a page to print."""
    return text.sheet_html(sheet.number, sheet.title, sheet.body, sheet.source, name or "",
                           boxes(room.asked(sheet.number)))


def one_page(room, names, chosen, key):
    """The sheets of all names on one page, which prints each on paper of its own."""
    parts = [page_of(room, sheet, name) for name in told(names)
             for sheet in read_sheets(room.path, name, key) if sheet.number in chosen]
    return text.page("Worksheets", "".join(parts), room.folder)


def form(room, names, chosen):
    """A table to be filled in: a row a name, a column a task."""
    return as_csv([["name"] + [task.asks() for number in chosen for task in room.asked(number)]]
                  + [[name or ""] for name in names])


def make_sheets(room, given, names, chosen):
    """Pages and notebooks in a folder; their names."""
    folder, files, stems = given.output or ".", [], file_names(names)
    if folder.endswith((".html", ".ipynb")):
        raise Error("-o %s: a file for each sheet and name is made in a folder: -o %s" % (
            folder, os.path.splitext(folder)[0] or "sheets"))
    if not os.path.isdir(folder):
        os.mkdir(folder)
    for name in told(names):
        for sheet in read_sheets(room.path, name, given.key):
            if sheet.number not in chosen:
                continue
            stem = os.path.join(folder, "-".join(
                ["sheet", str(sheet.number)] + ([stems[name]] if name else [])))
            if given.form in (None, "page"):
                files.append(stem + ".html")
                write(files[-1], text.page("Sheet %d" % sheet.number, page_of(
                    room, sheet, name), sheet.source))
            if given.form in (None, "notebook"):
                files.append(stem + ".ipynb")
                write_notebook(sheet, files[-1], [
                    (task.item, task.asks()) for task in room.asked(sheet.number)])
            if given.form == "check":
                files.append(stem + "-check.html")
                write(files[-1], export.check_page(room, sheet, name or "", given.key))
    return folder, files


def answer_rows(room, given, names, chosen):
    """The answers: a row a name and task."""
    rows = [["name", "task", "answer", "lowest", "highest", "unit", "asked"]]
    found = by_all(lambda at: room.answers(at[1], at[0], given.key),
                   [(name, number) for name in names for number in chosen])
    for name in told(names):
        for each in itertools.islice(found, len(chosen)):
            for answer in each:
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


def is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def as_csv(rows):
    """As tools/cli/table.c writes them: spreadsheets compute a text that begins as a formula
    does, unless an apostrophe is before it."""
    def shown(cell):
        text = str(cell)
        computed = text[:1] in tuple("=+-@\t\r") and not is_number(text)
        return "'" + text if computed else cell
    made = io.StringIO()
    csv.writer(made, lineterminator="\n").writerows([[shown(x) for x in row] for row in rows])
    return made.getvalue()


def as_json(rows, words=()):
    """A table as other commands have it; numbers are numbers."""
    def cell(name, x):
        return float(x) if name in ("answer", "lowest", "highest") and not words else x
    return json.dumps({"rows": [
        {name: cell(name, x) for name, x in zip(rows[0], row)} for row in rows[1:]],
        "notes": [], "verdict": list(words)}, ensure_ascii=False) + "\n"


def as_table(rows):
    """Rows in columns, the first as a head."""
    widths = [max(len(str(row[k])) for row in rows) for k in range(len(rows[0]))]
    return "".join(" ".join("%-*s" % pair for pair in zip(widths, map(str, row))).rstrip() +
                   "\n" for row in rows)


def mark_rows(room, given):
    """The verdict of each answer, and the right ones of each name; without a key the answers
    are those of the sheets that all have."""
    listed = None if given.name is None else names_of(given.name)
    handed = list(read_answers(given.number, room.tasks, listed))
    rows = [["name", "task", "answer", "verdict", "why"]]
    right = {name: {} for name in listed or ()}
    spelt = {plain(name): name for name in right}

    def judged(one):
        _, name, task, said = one
        return ("missing", "") if is_blank(said) else Answer(
            room, room.tasks[task], name if given.key and name else None,
            given.key).judged(typed(said, room.tasks[task].unit))
    for (line, name, task, said), verdict in zip(told(handed, "mark"), by_all(judged, handed)):
        rows.append([name, task, said, *verdict])
        one = right.setdefault(spelt.setdefault(plain(name), name), {})
        if task in one:
            say("line %d: %s answers %s again; the last answer counts" % (line, name, task))
        one[task] = verdict[0] == "right"
    doubt_key(given.key, [row[3] for row in rows[1:] if row[3] != "missing"])
    return rows, right


def doubt_key(key, verdicts):
    """Asks whether the key is that of the sheets, where few of all answers are right."""
    right = verdicts.count("right")
    if len(verdicts) >= 4 and 4*right < len(verdicts):
        say("%d of %d answers %s right; %s" % (
            right, len(verdicts), "is" if right == 1 else "are",
            "is --key %s that of the sheets?" % key if key else
            "if the sheets were made with --key, mark needs the same --key"))


def sums(right):
    """A line a name: how many of the tasks that anybody answers are right."""
    of = len(set().union(*right.values()))
    return "".join("%s: %d of %d are right\n" % (name, sum(one.values()), of) if one
                   else "%s: nothing was handed in\n" % name
                   for name, one in right.items())


def run(given):
    """What a command prints."""
    room, is_json = Room(), given.format == "json" and not is_file(given)
    if given.what == "mark":
        rows, right = mark_rows(room, given)
        if is_json:
            return as_json(rows, sums(right).splitlines())
        return as_csv(rows) if given.format == "csv" else as_table(rows) + "\n" + sums(right)
    if given.number is given.name is given.form is given.output is None and \
            not given.answers:
        rows = list_of_sheets(room)
        return as_json(rows) if is_json else list_in_words(rows)
    if given.name is not None and not given.key and given.form != "form":
        raise Error("--for needs --key too, a word of yours: the numbers are drawn from it and "
                    "from the name")
    if given.key and given.name is None:
        raise Error("--key needs --for too: the numbers are drawn from it and from a name")
    names = [None] if given.name is None else names_of(given.name)
    chosen = numbers_of(given.number, sorted(room.quantities))
    if given.answers:
        if (given.output or "").endswith((".html", ".ipynb")):
            raise Error("the answers are a table: -o FILE.csv, not %s" % given.output)
        rows = answer_rows(room, given, names, chosen)
        return as_json(rows) if is_json else as_csv(rows) if given.format == "csv" or \
            given.output else as_table(rows)
    if given.form in ("moodle", "form") or is_one_page(given):
        made = export.moodle(room, chosen, names, given.key) if given.form == "moodle" else \
            form(room, names, chosen) if given.form == "form" else \
            one_page(room, names, chosen, given.key)
        return as_json([["text"], [made]]) if is_json else made
    folder, files = make_sheets(room, given, names, chosen)
    return as_json([["file"], *([file] for file in files)]) if is_json else \
        "%d %s made in %s\n" % (len(files), "file is" if len(files) == 1 else "files are",
                               folder)


def is_one_page(given):
    """Whether all sheets are asked for in one file."""
    return given.form in (None, "page") and (given.output or "").endswith(".html")


def is_file(given):
    """Whether --output names a file, not a folder."""
    return given.output and (given.what == "mark" or given.answers or
                             given.form in ("moodle", "form") or is_one_page(given))


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
        if is_file(given):
            write(given.output, made)
            made = as_json([["file"], [given.output]]) if given.format == "json" else ""
        sys.stdout.write(made)
        sys.stdout.flush()
    except OSError as error:
        return refuse("%s: %s" % (error.filename or "the output cannot be written",
                                  error.strerror))
    except UnicodeDecodeError:
        return refuse("a file that was given is no text in UTF-8")
    except Error as error:
        return refuse(str(error))
    except KeyboardInterrupt:
        return 130
    return 0


def leave(status):
    """Ends the program: what could not be written is not tried again, with another status."""
    for file in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError):
            file.flush()
    os._exit(status)


if __name__ == "__main__":
    leave(main(sys.argv[1:]))
