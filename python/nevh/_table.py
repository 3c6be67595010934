"""Tables of commands, and what commands draw or write.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import csv
import html
import numbers
import os
from typing import Any, Iterable

from ._arrays import np


class Table(list):
    """Rows of a command: dictionaries, whose names are those of its CSV columns.

    table["dt"]      a column: an array of NumPy where it has numbers, else a list
    table[0]         a row; table[:3] is a Table of the first three
    table.columns    the names of the columns
    table.notes      the lines above the table
    table.words      the sentences below it
    table.command    the arguments of the command that made it

    A notebook shows a table, print shows it as text, plot draws it.
    """
    _most = 60  # rows that are shown; all of them are there

    def __init__(self, rows: Iterable[dict[str, Any]] = (), notes: Iterable[str] = (),
                 words: Iterable[str] = (), columns: Iterable[str] = (),
                 command: Iterable[str] = ()) -> None:
        list.__init__(self, rows)
        self.notes, self.words = list(notes), list(words)
        self.columns = list(columns) or list(self[0] if self else ())
        self.command = list(command)

    def __getitem__(self, key):
        if isinstance(key, slice):
            return Table(list.__getitem__(self, key), self.notes, self.words, self.columns,
                         self.command)
        if not isinstance(key, str):
            return list.__getitem__(self, key)
        if key not in self.columns:
            raise KeyError("there is no column %r; there are %s"
                           % (key, ", ".join(self.columns)))
        column = [row.get(key) for row in self]
        if np is None or not all(value is None or isinstance(value, numbers.Real)
                                 for value in column) or not any(
                                     value is not None for value in column):
            return column
        return np.array([float("nan") if value is None else value for value in column])

    def __reduce__(self):
        return Table, (list(self), self.notes, self.words, self.columns, self.command)

    def to_pandas(self) -> Any:
        """The rows as a pandas.DataFrame."""
        import pandas
        return pandas.DataFrame(list(self), columns=self.columns)

    def to_csv(self, file: str | os.PathLike[str]) -> None:
        """Write the rows as CSV."""
        with open(file, "w", encoding="utf-8", newline="") as out:
            writer = csv.DictWriter(out, self.columns)
            writer.writeheader()
            writer.writerows(self)

    def plot(self, x: str | None = None, y: Any = None, by: str | None = None,
             ax: Any = None) -> Any:
        """Draw columns by matplotlib; returns its Axes.

        x, y   names of columns; y may be several.  Default: what the command's own
               pictures show
        by     the column whose values have a line each, as "integrator"
        ax     the Axes to draw into; default: new ones
        """
        from ._plot import plot_table
        return plot_table(self, x, y, by, ax)

    def _shown(self):
        """The columns that differ from row to row, and what is the same in all rows."""
        same, shown = [], []
        for name in self.columns:
            values = [row.get(name) for row in self]
            if len(self) > 1 and all(value == values[0] for value in values):
                if values[0] is not None:
                    same.append("%s: %s" % (name, _cell(name, values[0])))
            elif any(value is not None for value in values):
                shown.append(name)
        return shown, ["same in all rows: " + ", ".join(same)] if same else []

    def __repr__(self):
        return str(self)

    def _rows(self):
        """Rows that are shown: all, or the first and the last."""
        half = self._most // 2
        return list(self) if len(self) <= self._most else \
            self[:half] + [None] + self[-half:]

    def _repr_html_(self):
        columns, same = self._shown()
        rows = ["".join("<td>%s</td>" % html.escape("..." if row is None else
                                                    _cell(name, row.get(name)))
                        for name in columns) for row in self._rows()]
        return "<table><caption>%s</caption><thead><tr>%s</tr></thead><tbody>%s" \
            "</tbody></table>%s" % (
                "<br>".join(map(html.escape, self.notes + same)),
                "".join("<th>%s</th>" % html.escape(name.replace("_", " "))
                        for name in columns),
                "".join("<tr>%s</tr>" % row for row in rows),
                "".join("<p>%s</p>" % html.escape(line) for line in self.words))

    def __str__(self):
        columns, same = self._shown()
        cells = [columns] + [["..."] * len(columns) if row is None else
                             [_cell(name, row.get(name)) for name in columns]
                             for row in self._rows()]
        widths = [max(len(row[k]) for row in cells) for k in range(len(columns))]
        return "\n".join(self.notes + same + ["  ".join(
            cell.ljust(width) for cell, width in zip(row, widths)).rstrip()
            for row in cells] + self.words)


def _cell(name, value):
    if value is None:
        return ""
    if isinstance(value, float):
        return "%.1e" % value if "error" in name or "drift" in name else "%.6g" % value
    return str(value)


class Text(str):
    """What a command writes: a program, a page, a picture.  A notebook shows pictures
    and pages; save(FILE) keeps it."""

    def save(self, file: str | os.PathLike[str]) -> None:
        """Write it to a file."""
        with open(file, "w", encoding="utf-8") as out:
            out.write(self)

    def _repr_html_(self):
        if self.lstrip()[:14].lower() != "<!doctype html":
            return None
        return '<iframe srcdoc="%s" width="100%%" height="600"></iframe>' % html.escape(self)

    def _repr_svg_(self):
        return str(self) if "<svg" in self[:400] and self.rstrip().endswith("</svg>") \
            else None
