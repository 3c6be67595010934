"""The worksheets' text, doc/sheets/sheets.texi, as notebooks and pages.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import html
import os
import re
import shlex

from . import _commands
from ._command_line import call_of

LINE = 76  # characters of a command that a printed page holds


def folder():
    """The folder of sheets.texi: installed beside the package, or in the sources."""
    here = os.path.dirname(os.path.abspath(__file__))
    tries = [os.path.normpath(os.path.join(here, *parts)) for parts in (
        ("..", "..", "sheets"), ("..", "..", "doc", "sheets"),
        ("..", "nevh_files", "share", "nevh", "sheets"),
        ("..", "..", "..", "..", "share", "nevh", "sheets"))]
    for one in tries:
        if os.path.exists(os.path.join(one, "sheets.texi")):
            return one
    raise _commands.Error("the worksheets were not found in " + ", ".join(tries))


def chapters(path):
    """The sheets of a file: (title, body) each, the body with @set lines."""
    with open(path, encoding="utf-8") as file:
        parts = re.split(r"^@node Sheet \d+\n@chapter ", file.read(), flags=re.M)[1:]
    return [tuple(part.split("\n", 1)) for part in parts]


def parts_of(body):
    """A sheet in parts: ("item", its number), ("example", commands), ("file", name) or
    ("text", Texinfo)."""
    number = 0
    body = re.sub(r"^@(set|c) .*\n", "", body, flags=re.M)
    for part in re.split(r"(@example\n.*?@end example|@verbatiminclude .*?\n|@item\n)",
                         re.sub(r"@(?:end )?enumerate\n|@noindent\n|@bye", "", body),
                         flags=re.S):
        if part == "@item\n":
            number += 1
            yield "item", number
        elif part.startswith("@example"):
            yield "example", part[len("@example\n"):-len("@end example")]
        elif part.startswith("@verbatiminclude"):
            yield "file", part.split()[1]
        else:
            yield "text", part


def marked_up(text, code, emphasis, quote=('"', '"')):
    """Texinfo in another markup, of formats of its text; a command that is not known here
    fails."""
    text = re.sub(r"@(code|command|file)\{([^{}]*)\}", lambda at: code % at.group(2), text)
    text = re.sub(r"@emph\{([^{}]*)\}", lambda at: emphasis % at.group(1), text)
    text = text.replace("``", quote[0]).replace("''", quote[1])
    unknown = re.search(r"@[a-z]+", text)
    assert not unknown, "the worksheets have an unknown %s" % unknown.group()
    return re.sub(r"@([@{}])", r"\1", text).strip()


def markdown(text):
    """Texinfo as Markdown."""
    return marked_up(text, "`%s`", "*%s*")


# Notebooks.


def for_notebooks(text):
    """Sentences about options that draw, which are not needed here."""
    text = re.sub(r"Add `--plot [^`]*`( and look at it)?\.", "`.plot()` draws a table.", text)
    text = re.sub(r"Add `--picture [^`]*` for a map\.\s*", "", text)
    return text.replace("of `flips.csv` is a time,\nor empty", "of the array is a time, or nan")


def folded(call):
    """A long call in several lines."""
    if len(call) <= 88:
        return call
    name, arguments = call.split("(", 1)
    lines, indent = [name + "("], " " * (len(name) + 1)
    for part in re.split(r"(?<=,) (?=[\w]+=)", arguments):
        if len(lines[-1]) + len(part) > 86 and lines[-1].strip():
            lines[-1] = lines[-1].rstrip()
            lines.append(indent)
        lines[-1] += part + " "
    return "\n".join(lines).rstrip()


def calls(example):
    """The cells of an example: each command as a call that a notebook shows, or what is
    Python as it stands."""
    if not example.strip().startswith("nevh "):
        return [re.sub(r"@([@{}])", r"\1", example).strip()]
    lines = re.sub(r"\\\n\s*", "", example).strip().splitlines()
    made = [folded(call_of(shlex.split(line)[1:], *_commands._list(), _commands._here))
            for line in lines if line.startswith("nevh ")]
    assert len(made) == len(lines), example
    return made


def text_of(name, source):
    """A scene of the sheets."""
    with open(os.path.join(source, name), encoding="utf-8") as file:
        return file.read()


def writer_of(name, source):
    """The cell that writes a scene of the sheets."""
    return "code", 'with open("%s", "w") as file:\n    file.write("""%s""")' % (
        name, text_of(name, source))


def cells_of(title, body, source, asked=()):
    """The cells of a sheet: (kind, text); `asked` are (item, label) of answers to be
    given."""
    yield "markdown", "# Worksheet: " + markdown(title)
    yield "code", "import nevh"
    if "quartic.nevh" in body and "@verbatiminclude" not in body:
        yield writer_of("quartic.nevh", source)
    heading, item = "", 0

    def answers():
        lines = ["- %s:" % label for of, label in asked if of == item]
        return [("markdown", "Answers:\n\n" + "\n".join(lines))] if lines else []
    for kind, part in parts_of(body):
        if kind == "item":
            yield from answers()
            heading, item = "## %d\n\n" % part, part
        elif kind == "example":
            for call in calls(part):
                yield "code", call
        elif kind == "file":
            yield writer_of(part, source)
        else:
            text = (heading + for_notebooks(markdown(part))).strip()
            if text:
                yield "markdown", text
                heading = ""
    yield from answers()


def notebook(cells):
    """A notebook of cells."""
    def cell(k, kind, text):
        made = {"cell_type": kind, "metadata": {}, "source": text.splitlines(True),
                "id": "cell-%d" % k}
        return dict(made, execution_count=None, outputs=[]) if kind == "code" else made
    return {"cells": [cell(k, *one) for k, one in enumerate(cells)],
            "metadata": {"kernelspec": {"display_name": "Python 3", "language": "python",
                                        "name": "python3"},
                         "language_info": {"name": "python"}},
            "nbformat": 4, "nbformat_minor": 5}


# Pages.


def as_html(text):
    """Paragraphs of Texinfo."""
    made = marked_up(html.escape(text, quote=False), "<code>%s</code>", "<em>%s</em>",
                     ("\u201c", "\u201d"))
    return "".join("<p>%s</p>\n" % one for one in re.split(r"\n\s*\n", made) if one.strip())


def broken(commands):
    """Long commands in lines that end before an option, so that no page breaks one inside."""
    made = []
    for line in commands.strip("\n").split("\n"):
        words, line = re.split(r" (?=--[a-z])", line), ""
        for word in words:
            if line and len(line.split("\n")[-1]) + 1 + len(word) > LINE:
                line += " \\\n   "
            line += " " * bool(line) + word
        made.append(line)
    return "\n".join(made)


def sheet_html(number, title, body, source, name="", boxes=lambda item: ""):
    """A sheet as a part of a page; `boxes` makes what follows an item."""
    lines = ['<section class="sheet"><h1>%s<small>Sheet %d%s</small></h1>\n' % (
        html.escape(marked_up(title, "%s", "%s")), number,
        " \u00b7 " + html.escape(name) if name else "")]
    item = 0
    for kind, part in parts_of(body):
        if kind == "item":
            lines.append("%s</li>\n" % boxes(item) if item else '<ol class="enumerate">\n')
            lines.append("<li>\n")
            item = part
        elif kind == "example":
            lines.append('<pre class="example">%s</pre>\n' % html.escape(broken(part)))
        elif kind == "file":
            lines.append('<pre class="example">%s</pre>\n' % html.escape(text_of(part,
                                                                                source)))
        else:
            lines.append(as_html(part))
    return "".join(lines) + "%s</li>\n</ol></section>\n" % boxes(item)


def page(title, sheets, source, script=""):
    """A page of sheets."""
    return ('<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">\n'
            '<meta name="viewport" content="width=device-width">\n<title>%s</title>\n'
            "<style>\n%s</style></head>\n<body>\n<main>\n%s</main>\n%s</body></html>\n"
            % (html.escape(title), text_of("sheets.css", source), sheets, script))
