"""The worksheets as notebooks, from doc/sheets/sheets.texi.

    python3 sheets.py SHEETS.texi FOLDER

writes FOLDER/sheet-N.ipynb; the commands of a sheet become calls of the package.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import json
import os
import re
import shlex
import sys

from nevh import _commands
from nevh._command_line import call_of


def markdown(text):
    """Texinfo as Markdown; a command that is not known here fails."""
    text = re.sub(r"@(code|command|file)\{([^{}]*)\}", r"`\2`", text)
    text = re.sub(r"@emph\{([^{}]*)\}", r"*\1*", text)
    text = re.sub(r"``|''", '"', text)
    unknown = re.search(r"@[a-z]+", text)
    assert not unknown, "sheets.py does not know %s" % unknown.group()
    return re.sub(r"@([@{}])", r"\1", text).strip()


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


def writer_of(name, folder):
    """The cell that writes a scene of the sheets."""
    with open(os.path.join(folder, name), encoding="utf-8") as file:
        return "code", 'with open("%s", "w") as file:\n    file.write("""%s""")' % (
            name, file.read())


def cells_of(chapter, folder):
    """The cells of a sheet: (kind, text)."""
    title, body = chapter.split("\n", 1)
    yield "markdown", "# Worksheet: " + markdown(title)
    yield "code", "import nevh"
    if "quartic.nevh" in body and "@verbatiminclude" not in body:
        yield writer_of("quartic.nevh", folder)
    number = 0
    for part in re.split(r"(@example\n.*?@end example|@verbatiminclude .*?\n|@item\n)",
                         re.sub(r"@(?:end )?enumerate\n|@noindent\n|@bye", "", body),
                         flags=re.S):
        if part == "@item\n":
            number += 1
            continue_with = "## %d\n\n" % number
        elif part.startswith("@example"):
            for call in calls(part[len("@example\n"):-len("@end example")]):
                yield "code", call
        elif part.startswith("@verbatiminclude"):
            yield writer_of(part.split()[1], folder)
        else:
            text = for_notebooks(markdown(part))
            if number and (text or continue_with):
                text, continue_with = continue_with + text, ""
            if text.strip():
                yield "markdown", text.strip()


def notebook(cells):
    def cell(k, kind, text):
        made = {"cell_type": kind, "metadata": {}, "source": text.splitlines(True),
                "id": "cell-%d" % k}
        return dict(made, execution_count=None, outputs=[]) if kind == "code" else made
    return {"cells": [cell(k, *one) for k, one in enumerate(cells)],
            "metadata": {"kernelspec": {"display_name": "Python 3", "language": "python",
                                        "name": "python3"},
                         "language_info": {"name": "python"}},
            "nbformat": 4, "nbformat_minor": 5}


def main(sheets, folder):
    with open(sheets, encoding="utf-8") as file:
        chapters = re.split(r"^@node Sheet \d+\n@chapter ", file.read(), flags=re.M)[1:]
    os.makedirs(folder, exist_ok=True)
    for k, chapter in enumerate(chapters, 1):
        path = os.path.join(folder, "sheet-%d.ipynb" % k)
        with open(path, "w", encoding="utf-8") as file:
            json.dump(notebook(cells_of(chapter, os.path.dirname(sheets))), file, indent=1,
                      ensure_ascii=False)
            file.write("\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
