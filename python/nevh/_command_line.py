"""Command lines of nevh as calls of the functions, for docstrings and worksheets.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import re

_left_out = ("format", "quiet", "output", "keep-plot-script")


class _Number(str):
    """A number as it was written."""
    __repr__ = str.__str__


def _shown(value):
    """A value as a person would type it."""
    if isinstance(value, dict):
        return "{%s}" % ", ".join("%s: %s" % (_shown(name), _shown(one))
                                  for name, one in value.items())
    if isinstance(value, list):
        return "[%s]" % ", ".join(map(_shown, value))
    text = repr(value)
    return '"%s"' % text[1:-1] if text[0] == "'" and '"' not in text else text


def _item(text):
    try:
        float(text)
        return _Number(text)
    except ValueError:
        return text


def _items(text):
    """One value, or a list of those between commas."""
    items = [_item(one) for one in re.split(r",(?![^()]*\))", text)]
    return items if len(items) > 1 else items[0]


def _assigned(texts, between):
    """{name: value} of NAME=VALUE; a text where there is no = in it."""
    parts = [part for text in texts for part in re.split(between, text)]
    if not all("=" in part for part in parts):
        return ",".join(parts)
    return {name.strip(): _item(value.strip()) for name, value in
            (part.split("=", 1) for part in parts)}


def _value_of(option, texts):
    """What the function takes for an option that was given these texts."""
    kind = option["kind"]
    if kind == "settings":
        return _assigned(texts, r",(?=\s*\w+\s*=)")
    if kind == "assignment":
        return _assigned(texts, r"\n")
    if kind in ("integrators", "gradients", "effects", "formulas", "numbers"):
        return _items(texts[-1])
    if kind in ("count", "number", "formula"):
        return _item(texts[-1])
    return texts[-1]


def call_of(words, commands, options, here, keep=()):
    """The call of a command line's words, without "nevh"; `commands` and `options` as the
    help lists them, `here` gives the name of an argument.  What makes a table is given as
    one: files and formats are left out but those in `keep`."""
    of, rest = commands[words[0]], iter(words[1:])
    operands, given, draws = [], {}, ""
    for word in rest:
        if not word.startswith("-"):
            operands.append(word)
            continue
        name = {"-o": "output"}.get(word, word.lstrip("-"))
        text = "" if options[name]["argument"] is None else next(rest)
        if name == "plot" and "format" in of["options"]:
            draws = ".plot()"
        elif name in keep or name not in _left_out:
            given.setdefault(name, []).append(text)
    rename = {"integrators": "integrator"} if words[0] == "sweep" else {}
    arguments = [_shown(one) for one in operands] + [
        "%s=%s" % (rename.get(name, here(name)), True if options[name]["argument"] is None
                   else _shown(_value_of(options[name], texts)))
        for name, texts in given.items()]
    return "nevh.%s(%s)%s" % (words[0], ", ".join(arguments), draws)
