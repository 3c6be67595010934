"""Commands as functions, and their tables.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import csv
import html
import os
import subprocess
import sys
import tempfile
from typing import Any, Mapping, Sequence

from ._library import Error, _lib, Refused, _trees
from ._scene import Scene, _scene, _starts, _value


class Table(list):
    """Rows of `nevh compare`, dictionaries; `notes` is what stands above them."""
    notes = ()
    _shown = ("integrator", "order", "symplectic", "gradient", "dt", "status",
              "max_energy_error", "energy_drift", "state_error", "gradient_evals",
              "hamiltonian_evals", "seconds", "verdict")

    def __getitem__(self, key):
        """A row by its number, or a column by its name."""
        return [row[key] for row in self] if isinstance(key, str) else \
            list.__getitem__(self, key)

    def _cell(self, name, value):
        if value is None:
            return ""
        if isinstance(value, float):
            return "%.1e" % value if "error" in name or "drift" in name else \
                "%.4g" % value
        return html.escape(str(value))

    def _repr_html_(self):
        columns = [name for name in self._shown
                   if any(row.get(name) is not None for row in self) and
                   (name != "hamiltonian_evals" or any(row.get(name) for row in self))]
        head = "".join("<th>%s</th>" % name.replace("_", " ") for name in columns)
        rows = "".join("<tr>%s</tr>" % "".join(
            "<td>%s</td>" % self._cell(name, row.get(name)) for name in columns)
            for row in self)
        notes = "<br>".join(map(html.escape, self.notes))
        return "<table><caption>%s</caption><thead><tr>%s</tr></thead><tbody>%s" \
            "</tbody></table>" % (notes, head, rows)

    def __str__(self):
        cells = [self._shown] + [[self._cell(name, row.get(name)) for name in
                                  self._shown] for row in self]
        widths = [max(len(row[k]) for row in cells) for k in range(len(self._shown))]
        return "\n".join(list(self.notes) + ["  ".join(
            cell.ljust(width) for cell, width in zip(row, widths)).rstrip()
            for row in cells])


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


def _number(text):
    try:
        return int(text)
    except ValueError:
        try:
            return float(text)
        except ValueError:
            return text or None


def _options(**given):
    for name, value in given.items():
        if value is None:
            continue
        if not isinstance(value, str) and hasattr(value, "__iter__"):
            value = ",".join(v if isinstance(v, str) else repr(v) for v in value)
        yield "--" + name.replace("_", "-")
        yield value if isinstance(value, str) else repr(value)


def compare(scene: str | os.PathLike | Scene,
            integrators: str | Sequence[str] | None = None,
            dt: float | Sequence[float] | None = None, t_end: float | None = None, *,
            y0: Sequence[float] | Mapping[str, float | str] | None = None,
            gradient: str | Sequence[str] | None = None,
            tolerance: float | Sequence[float] | None = None,
            parameters: Mapping[str, Any] | None = None,
            coordinates: Sequence[str] | None = None,
            with_effects: str | Sequence[str] = (),
            without_effects: str | Sequence[str] = (),
            options: Sequence[str] = ()) -> Table:
    """The table of `nevh compare`: what each integrator does to the energy, and at
    which cost.

    scene    as of Scene; a formula and a function need y0 and t_end
    options  more options of the command: ["--match", "work"]

    Returns rows, dictionaries with the columns of the command's CSV (see the manual),
    which a notebook shows as a table.  rows["verdict"] is a column.

    The command is run, since the choice of a reference, and timing, are its own and
    not the library's.
    """
    made = _scene(scene, parameters, coordinates, with_effects, without_effects, y0)
    if made.is_formula and (y0 is None or t_end is None):
        raise Refused("a formula needs y0 and t_end")
    arguments = [command(), "compare", "--format", "csv"]
    arguments += _options(integrators=integrators, dt=dt, t_end=t_end,
                          gradient=gradient, tolerance=tolerance)
    for name, value in _starts(made, y0).items():
        arguments += ["--start", "%s=%s" % (name, _value(name, value))]
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.basename(made.path) if made.path else "H.nevh"
        path = os.path.join(folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(made.text)
        done = subprocess.run(arguments + list(options) + [path], text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              encoding="utf-8")
    if done.returncode not in (0, 1):
        raise Refused(done.stderr.strip())
    lines = done.stdout.splitlines()
    table = Table(dict({name: _number(text) for name, text in row.items()},
                       scene=made.name) for row in
                  csv.DictReader(line for line in lines if not line.startswith("#")))
    table.notes = [line[2:] for line in lines if line.startswith("#")]
    return table


def main():
    """The command nevh."""
    os.execv(command(), ["nevh"] + sys.argv[1:])
