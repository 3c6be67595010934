"""Pictures by matplotlib: of tables and of orbits, in the colours of nevh's own.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

from ._library import _lib, Refused
from ._looks import colours as _colours, looks as _looks, marks as _marks

# Columns x, y and by, and which axes are logarithmic, for tables that have x and y.
_pictures = (
    ("flow", "t", "ratio", "integrator", ""),
    ("frequencies", "frequency", "amplitude", "integrator", "y"),
    ("gradients", "half_spread", "max_error", "gradient", "xy"),
    ("cost", "seconds", "max_energy_error", "integrator", "xy"),
    ("recommend", "seconds", "max_energy_error", "integrator", "xy"),
    ("compare", "dt", "max_energy_error", "integrator", "xy"),
    ("hard", "max_energy_error", "state_error", "integrator", "xy"),
)


def _axes(ax):
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError:
        raise ImportError("plot() needs matplotlib; a picture without it is written by "
                          "plot=\"FILE.svg\" of the command") from None
    return pyplot.subplots()[1]


def _number_of(name):
    """FNV-1a, as tools/plot/looks.c."""
    number = 2166136261
    for letter in name:
        number = (number ^ letter) * 16777619 % 2**32
    return number


def style(name):
    """The colour and the mark of an integrator, the same in all pictures."""
    plain = str(name).partition("+")[0].encode()
    known = _lib.integrator_named(plain)
    shown = _lib.integrator_name(known).decode() if known else None
    k = _looks.index(shown) if shown in _looks else len(_looks) + _number_of(plain) % 64
    mark = _marks[k % len(_marks)].split()
    return {"color": _colours[k % len(_colours)], "marker": mark[0],
            "fillstyle": "none" if mark[1:] else "full"}


def _columns_of(table, x, y, by):
    """What a table is drawn by: x, all y, by, and which axes are logarithmic."""
    command = table.command[0] if table.command else ""
    logarithmic, names = "", table.columns
    if x is None and y is None:
        kept = [one for one in _pictures if one[0] == command]
        if kept:
            _, x, y, group, logarithmic = kept[0]
            by = by or group
        elif command == "run" and "p_" + names[1] in names:
            x, y = names[1], "p_" + names[1]
        elif command == "section":
            x, y, by = names[3], names[4], by or "section"
    if x is None or y is None:
        raise Refused("plot: give x and y, two of %s" % ", ".join(names))
    ys = [y] if isinstance(y, str) else list(y)
    for name in [x, *ys] + ([by] if by else []):
        table[name]  # a column that is not there is named
    return x, ys, by, logarithmic


def plot_table(table, x, y, by, ax):
    """The Axes with columns of a table drawn."""
    command = table.command[0] if table.command else ""
    x, ys, by, logarithmic = _columns_of(table, x, y, by)
    ax = _axes(ax)
    groups = list(dict.fromkeys(row.get(by) for row in table)) if by else [None]
    for group in groups:
        rows = [row for row in table if by is None or row.get(by) == group]
        for name in ys:
            points = [(row.get(x), row.get(name)) for row in rows]
            points = [point for point in points
                      if None not in point and not (logarithmic and str in map(type, point))]
            if not points:
                continue
            scattered = command in ("section", "frequencies", "hard")
            look = dict(style(group), markersize=4) if by == "integrator" else \
                {"marker": "." if scattered else ""}
            if scattered:
                look["linestyle"] = ""
            label = " ".join(str(word) for word in
                             ([group] if by else []) + ([name] if len(ys) > 1 else []))
            ax.plot(*zip(*points), label=label or None, linewidth=1, **look)
    for scale, axis, letter in ((ax.set_xscale, ax.xaxis, "x"),
                                (ax.set_yscale, ax.yaxis, "y")):
        if letter in logarithmic:
            scale("log")
            axis.set_minor_formatter("")
    if x == "dt":
        steps = sorted({row["dt"] for row in table if row.get("dt")})
        ax.set_xticks(steps[::-(-len(steps) // 6)], ["%g" % dt for dt in
                                                     steps[::-(-len(steps) // 6)]])
    ax.set_xlabel(x)
    ax.set_ylabel(", ".join(ys))
    if ax.get_legend_handles_labels()[0]:
        ax.legend(fontsize="small")
    return ax


def plot_orbit(orbit, x, y, ax):
    """The Axes with an orbit drawn, or those of an ensemble: names of variables, or t."""
    half = len(orbit.y) // 2
    q = ["q"] if half == 1 else ["q[%d]" % (k + 1) for k in range(half)]
    names = orbit.names or q + ["p_" + name for name in q]  # a function in C has no names
    ensemble = getattr(orbit.y, "ndim", 2) == 3
    rows = {"t": orbit.t, **dict(zip(names, orbit.y.transpose(0, 2, 1) if ensemble
                                     else orbit.y))}
    x = x or names[0]
    y = y or (names[1 if half > 1 and x == names[0] else half])
    ys = [y] if isinstance(y, str) else list(y)
    for name in [x, *ys]:
        if name not in rows:
            raise Refused("plot: there is no variable %r; there are %s"
                          % (name, ", ".join(rows)))
    ax = _axes(ax)
    for k, name in enumerate(ys):
        ax.plot(rows[x], rows[name], linewidth=1, color=_colours[k % len(_colours)],
                label=name if len(ys) > 1 else None)
    ax.set_xlabel(x)
    ax.set_ylabel(", ".join(ys))
    ax.set_title(orbit.method, fontsize="medium")
    if {x, *ys} <= set(names[:half]):
        ax.set_aspect("equal")
    if len(ys) > 1:
        ax.legend(fontsize="small")
    return ax
