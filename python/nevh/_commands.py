"""The commands of nevh as functions, made from the list that makes its help.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import functools
import inspect
import json
import math
import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import warnings
from typing import Any

from ._library import _closest, Error, Failed, gradient_names, _lib, _name_list, Refused, _text, _trees
from ._scene import _assign, _is_row, _scene, _starts, _value
from ._command_line import call_of
from ._own import Integrator, rows_of_functions
from ._progress import Progress
from ._table import Table, Text

# Options that have other names here, or none.
_names_here = {"with": "with_effects", "without": "without_effects", "set": "parameters",
               "start": "y0", "from": "from_scene", "for": "name", "as": "form"}
_no_options = ("format", "quiet", "help", "version")
_files_of_tables = ("output", "resume")  # a Table has to_csv
_of_scenes = ("with", "without", "set", "start")
_in_order = ("integrators", "dt", "t-end")
_not_functions = ("sweep", "help")  # sweep fills arrays by the library itself


def command() -> str:
    """The file of the command nevh that belongs to the library."""
    given = os.environ.get("NEVH_COMMAND")
    base = os.path.dirname(os.path.realpath(_lib.path))
    tries = [given] if given else [
        os.path.join(tree, part) for tree in
        (os.path.dirname(base), os.path.dirname(os.path.dirname(base)), *_trees())
        for part in ("tools/nevh", "bin/nevh")]
    for path in filter(None, tries):
        if os.access(path, os.X_OK) and not os.path.isdir(path):
            return path
    raise Error("the command nevh was not found beside %s; set NEVH_COMMAND to its "
                "file" % _lib.path)


def _run(arguments):
    """What the command prints, and its exit status; the interrupt key ends it first."""
    process = subprocess.Popen([command()] + arguments, stdin=subprocess.DEVNULL,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               encoding="utf-8", errors="replace",
                               env=dict({"PYTHON": sys.executable}, **os.environ))
    try:
        with Progress(arguments[0]) as progress:
            out, said = _heard(process, progress)
    except BaseException:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(10)
        except (KeyboardInterrupt, subprocess.TimeoutExpired):
            process.kill()
            process.wait()
        raise
    return out, said.strip(), process.returncode


def _heard(process, progress):
    """What a process prints until it ends."""
    while True:
        try:
            return process.communicate(timeout=0.25 if progress.looks else None)
        except subprocess.TimeoutExpired:
            progress.at()


@functools.lru_cache(maxsize=None)
def _list():
    """{name: command} and {name: option} of `nevh help --format json`."""
    out, said, status = _run(["help", "--format", "json"])
    if status:
        raise Error("%s help fails: %s" % (command(), said))
    read = json.loads(out)
    return ({one["name"]: one for one in read["commands"]},
            {one["name"]: one for one in read["options"]})


def _names():
    """The functions: a name each."""
    return [name for name in _list()[0] if name not in _not_functions]


def _here(option):
    return _names_here.get(option, option.replace("-", "_"))


def _signature(of):
    """How the function of a command is called."""
    kind = inspect.Parameter
    parameters, operand = [], of["operand"]
    if operand == "N":
        parameters.append(kind("number", kind.POSITIONAL_OR_KEYWORD, default=None,
                               annotation="int | str | None"))
    elif operand:
        parameters.append(kind(operand.split(".")[0].lower(), kind.POSITIONAL_OR_KEYWORD,
                               annotation={"SCENE": "Any", "SCENE...": "Any"}.get(
                                   operand, "str")))
    elif of["name"] == "hard":
        parameters.append(kind("case", kind.POSITIONAL_OR_KEYWORD, default=None,
                               annotation="str | None"))
    options = [name for name in of["options"] if name not in _no_options and
               not (name in _files_of_tables and "format" in of["options"] and
                    of["name"] != "sheet")]  # whose output is a folder
    parameters += [kind(_here(name), kind.POSITIONAL_OR_KEYWORD if name in _in_order else
                        kind.KEYWORD_ONLY, default=None,
                        annotation=_types_of(_list()[1][name]) + " | None")
                   for name in sorted(options, key=_place)]
    if "set" in options:
        parameters.append(kind("coordinates", kind.KEYWORD_ONLY, default=None,
                               annotation="Sequence[str] | None"))
    parameters.append(kind("options", kind.KEYWORD_ONLY, default=(),
                           annotation="Sequence[str]"))
    return inspect.Signature(parameters, return_annotation="Table" if "format" in of[
        "options"] else "str" if operand == "FILE" else "Text")


def _place(option):
    return _in_order.index(option) if option in _in_order else len(_in_order)


def _types_of(option):
    """The annotation of an option."""
    if option["kind"] == "choice":
        return "Literal[%s]" % ", ".join('"%s"' % word for word in option["words"])
    return {"start": "Mapping[str, float | str] | Sequence[float]",
            "data": "str | PathLike[str] | Mapping[str, Any]"}.get(option["name"]) or {
        "flag": "bool", "count": "int", "number": "float",
        "numbers": "float | Sequence[float]", "formula": "float | str",
        "formulas": "float | str | Sequence[float | str]",
        "file": "str | PathLike[str]", "settings": "Mapping[str, Any]",
        "assignments": "Mapping[str, Any] | Sequence[str] | str",
        "assignment": "Mapping[str, Any] | Sequence[str] | str",
        "scene": "str | PathLike[str]", "count-or-all": "int | str"}.get(
            option["kind"], "str | Sequence[str]")


def _kind_of(option):
    """The values that an option takes, in words."""
    return {"flag": "True or False", "count": "a whole number", "number": "a number",
            "numbers": "a number or several", "formula": "a number or formula",
            "formulas": "a number or formula, or several", "choice": ", ".join(
                option["words"] or ()), "file": "the name of a file",
            "assignment": "{name: values}, or texts", "settings": "{name: value}"}.get(
                option["kind"], "a text, or several")


def _documentation(of, signature):
    """The docstring of a command's function: that of its help."""
    import textwrap
    listed = _list()[1]
    lines = textwrap.wrap(_message(of["help"][0].upper() + of["help"][1:] + "."), 86) + [""]
    for name in of["options"]:
        if _here(name) not in signature.parameters:
            continue
        help = {"set": "parameters of the scene or formula: {name: value}",
                "start": "where the orbit starts: {name: value}, or coordinates, then momenta",
                "data": listed["data"]["help"] + "; or the columns as {name: values}"}.get(
                    name, listed[name]["help"])
        lines += textwrap.wrap("%s (%s): %s" % (_here(name), _kind_of(listed[name]), help),
                               86, subsequent_indent="    ", break_on_hyphens=False)
    if "set" in of["options"]:
        lines.append("coordinates: of a formula, see Scene")
    lines += ["options: more options of the command, as texts", ""]
    lines.append("Returns %s." % (
        "a Table with the columns %s" % ", ".join(of["columns"]) +
        (", ..." if len(of["columns"]) < 3 else "") if of["columns"] else
        "a Table" if "format" in of["options"] else
        "the name of the file" if of["operand"] == "FILE" else
        "what it writes or draws as a Text"))
    lines[-1:] = textwrap.wrap(lines[-1], 86, break_on_hyphens=False)
    example = _example(of)
    if example:
        lines += ["", ">>> made = " + example, ">>> len(made) > 0", "True"]
    return "\n".join(lines)


def _example(of):
    """The first example of the help as a call."""
    words = shlex.split(of["examples"][0])[1:] if of["examples"] else []
    return call_of(words, *_list(), _here, ["output"]) if len(words) > 1 else ""


def _several(value):
    """A list of one or of several."""
    return list(value) if isinstance(value, (list, tuple)) else [] if value is None else \
        [value]


def _joined(name, value):
    if isinstance(value, str) or not hasattr(value, "__iter__"):
        value = [value]
    return ",".join(one if isinstance(one, str) else _value(name, one) for one in value)


def _option(option, name, value, folder):
    """The words of one option."""
    word, kind = "--" + option["name"], option["kind"]
    if value is None or value is False and kind == "flag":
        return []
    if kind == "flag":
        if value is not True:
            raise TypeError("%s is True or False, not %r" % (name, value))
        return [word]
    if kind in ("assignment", "assignments"):
        lines = [value] if isinstance(value, str) else \
            [_assign(*item) for item in value.items()] if hasattr(value, "items") else \
            [_joined(name, value)] if all(isinstance(v, str) and "=" not in v
                                          for v in value) else list(value)
        return [part for line in lines for part in (word, line)]
    if kind == "file":
        if name == "data" and not isinstance(value, (str, os.PathLike)):
            value = _data_file(value, os.path.join(folder, "data.csv"))
        return [word, os.fspath(value)]
    if not isinstance(value, (str, os.PathLike)) and not _is_row(value) and \
            not hasattr(value, "__float__"):
        raise TypeError("%s takes %s, not %.80r" % (name, _kind_of(option), value))
    return [word, _joined(name, value)]


def _data_file(data, path):
    """Measured columns, of a dictionary, a data frame, a Table or a structured array, as
    the CSV that the command reads."""
    names = getattr(data, "columns", None) if isinstance(data, Table) else \
        data.keys() if hasattr(data, "keys") else getattr(
            getattr(data, "dtype", None), "names", None)
    if names is None or not len(names):
        raise Refused("data is a file or columns, {name: values} or a data frame, not %.80r"
                      % (data,))
    columns = {_text("the name of a column of data", name): data[name] for name in names}
    for name, column in columns.items():
        if isinstance(column, str) or not hasattr(column, "__len__"):
            raise Refused("data: %s = %.80r is no column" % (name, column))
    if len({len(column) for column in columns.values()}) > 1:
        raise Refused("data: the columns %s are not of one length" % ", ".join(columns))
    cells = [[_measured(name, value) for value in column]
             for name, column in columns.items()]
    with open(path, "w", encoding="utf-8") as file:
        file.writelines(",".join(row) + "\n" for row in [list(columns), *zip(*cells)])
    return path


def _measured(name, value):
    """A measured number as a cell of a CSV, which is empty where there is none."""
    try:
        number = math.nan if value is None else float(value)
    except (TypeError, ValueError):
        raise Refused("data: %s has %.80r, which is no number" % (name, value)) from None
    return "" if math.isnan(number) else repr(number)


def _check_formula(of, given, what):
    """Refuses a formula without what a scene would say: where it starts and ends, and
    the time step."""
    takes = of["options"]
    needs = [name for name, option, needless in (
        ("y0", "start", "vary"), ("t_end", "t-end", "at"), ("dt", "dt", None))
        if option in takes and name not in given and needless not in given and (
            option, of["name"]) != ("dt", "page")]
    if needs:
        raise Refused("%s needs %s" % (what, " and ".join(needs)))


def _scene_words(of, source, given, folder, coordinates, sections=""):
    """A scene as the command takes it: a file, and options for what is changed."""
    if callable(source):  # refused before it is traced
        _check_formula(of, given, "a function")
    made = _scene(source, given.pop("parameters", None), coordinates,
                  given.pop("with_effects", None) or (),
                  given.pop("without_effects", None) or (), given.get("y0"))
    if made.is_formula:
        _check_formula(of, given, "a formula")
    y0 = given.pop("y0", None)
    if callable(source):  # its scene starts there
        y0 = None
    words, path = list(made._changes), made.path
    if path is None or not os.path.exists(path) or sections:
        if path is None or not os.path.exists(path):
            words, text = [], made.text
        else:
            with open(path, encoding="utf-8") as file:
                text = file.read()
        path = os.path.join(folder, made.name + ".nevh")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text + "\n" + sections)
    for name, value in _starts(made, y0).items():
        words += ["--start", "%s=%s" % (name, _value(name, value))]
    return words, path, made.name


def _sections(own):
    """The sections of integrators, each once: one that is composed has that of its parts."""
    return "\n".join(dict.fromkeys(
        "[integrator " + section.strip() + "\n" for one in own
        for section in one.text.split("[integrator ")[1:]))


def _words(of, given, folder):
    """The arguments of a command for those of its function, and the names of scenes."""
    listed, operand = _list()[1], of["operand"]
    given = {name: value for name, value in given.items() if value is not None}
    more = given.pop("options", ())
    if isinstance(more, str):
        raise TypeError("options is a list of texts, not the text %r" % more)
    more = _name_list("options", more)
    words, operands, names = [], [], []
    coordinates = given.pop("coordinates", None)
    own = [one for one in _several(given.get("integrators")) if isinstance(one, Integrator)]
    if own:
        given["integrators"] = [getattr(one, "name", one) for one in given["integrators"]] \
            if isinstance(given["integrators"], (list, tuple)) else own[0].name
    if operand and operand.startswith("SCENE"):
        sources = given.pop("scene")
        many = operand.endswith("...") and isinstance(sources, (list, tuple))
        for k, source in enumerate(sources if many else [sources]):
            place = os.path.join(folder, str(k))
            os.mkdir(place)
            extra, path, name = _scene_words(of, source, given if not many else dict(given),
                                             place, coordinates,
                                             _sections(own))
            words, operands, names = words + extra, operands + [path], names + [name]
        if many:
            for name in _of_scenes:
                given.pop(_here(name), None)
    else:
        name = {"N": "number", None: "case"}.get(operand) or operand.lower()
        if isinstance(given.get(name), int) and operand == "N":
            given[name] = str(given[name])
        if name in given:
            operands = [_text(name, os.fspath(given[name]) if isinstance(
                given[name], os.PathLike) else given[name])]
            del given[name]
        if "parameters" in given:
            words += [part for item in given.pop("parameters").items()
                      for part in ("--set", _assign(*item))]
    for name in of["options"]:
        if _here(name) in given:
            words += _option(listed[name], _here(name), given.pop(_here(name)), folder)
    return words + list(more) + (["--"] if operands else []) + operands, names


def _call(name, given):
    """Run a command; its table, its text or its picture.  compare runs integrators that
    are functions itself."""
    functions = [one for one in _several(given.get("integrators"))
                 if getattr(one, "step", None)]
    if not functions:
        return _call_command(name, given)
    if name != "compare":
        raise Refused("%s is a function of Python: solve and compare take it, nevh %s does "
                      "not" % (functions[0].name, name))
    others = [one for one in _several(given["integrators"]) if one not in functions]
    table = _call_command(name, dict(given, integrators=others or ["verlet"]))
    rows = rows_of_functions(functions, table, given)
    if not others:
        del table[:]
    table.extend(rows)
    return table


def _call_command(name, given):
    """Run a command by its name."""
    of = _list()[0][name]
    has_table = "format" in of["options"]
    # What makes no table writes a file: that of the caller, else one that is read back.
    file = next((one for one in ("output", "plot") if one in of["options"]), None)
    reads = not has_table and file and not given.get(file)
    with tempfile.TemporaryDirectory(prefix="nevh-") as folder:
        words, scenes = _words(of, given, folder)
        made = os.path.join(folder, "made.svg" if file == "plot" else "made.html")
        arguments = [name] + (["--format", "json"] if has_table else []) + (
            ["--" + file, made] if reads else []) + words
        # Files of this call alone are named without their folder.
        out, said, status = _run(arguments)
        own = re.escape(folder) + r"/(\d+/)?"
        out, said = re.sub(own, "", out), re.sub(own, "", said)
        if status == 2 or status < 0:
            raise Refused(_message(said) or "nevh %s ended with %d" % (name, status))
        if status and not (has_table and out):
            raise Failed(_message(said) or "nevh %s ended with %d" % (name, status))
        if said:
            warnings.warn(_message(said), RuntimeWarning, stacklevel=4)
        if has_table:
            read = json.loads(out)
            names = {re.sub(own, "", path): scene for scene, path in
                     zip(scenes, words[-len(scenes):])}
            for row in read["rows"]:
                if row.get("scene") in names:
                    row["scene"] = names[row["scene"]]
            return Table(read["rows"], read["notes"], read.get("verdict", ()),
                         command=arguments)
        if reads:
            with open(made, encoding="utf-8") as text:
                return Text(text.read())
    return given.get(file or "file")


def _message(said):
    """What the command says, without its name."""
    listed = _list()[1]
    said = re.sub(r"--([a-z][a-z-]*)( (?=[A-Z0-9])|=)?", lambda at: at.group() if at.group(
        1) not in listed else _here(at.group(1)) + ("=" if at.group(2) else ""), said)
    return "\n".join(line[6:] if line.startswith("nevh: ") else line
                     for line in said.splitlines())


def _function(name):
    """The function of a command."""
    of = _list()[0].get(name)
    if of is None or name in _not_functions:
        raise AttributeError("module 'nevh' has no attribute %r%s"
                             % (name, _closest(name, _names())))
    signature = _signature(of)

    def call(*arguments, **named):
        try:
            bound = signature.bind(*arguments, **named)
        except TypeError as error:
            wrong = [one for one in named if one not in signature.parameters]
            raise TypeError("nevh.%s: %s%s" % (
                name, error, _closest(wrong[0], signature.parameters) if wrong else ""
            )) from None
        return _call(name, dict(bound.arguments))
    call.__name__ = call.__qualname__ = name
    call.__module__ = "nevh"
    call.__signature__ = signature
    call.__doc__ = _documentation(of, signature)
    return call


def gradients(scene: Any = None, *arguments: Any, **named: Any) -> Any:
    """The names of all gradients; of a scene the table of `nevh gradients`: errors and
    costs along its orbit, with the options of the command.

    >>> made = nevh.gradients("pendulum", t_end=10)
    >>> len(made) > 0
    True
    """
    if scene is None:
        return gradient_names()
    return _function("gradients")(scene, *arguments, **named)


def main():
    """The command nevh, which runs this Python for worksheets."""
    os.environ.setdefault("PYTHON", sys.executable)
    os.execv(command(), ["nevh"] + sys.argv[1:])
