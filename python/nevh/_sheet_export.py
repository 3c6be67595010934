"""Worksheets for Moodle, and pages that mark themselves.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import hashlib
import html
import json
import math
import secrets

from . import _sheet_text as text

_cells = 24  # of the interval of right answers
_rounds = 2000


def moodle(room, chosen, names, key):
    """Numerical questions, a category a name: the answer with its tolerance, and mistakes,
    which bring their words."""
    lines = ['<?xml version="1.0" encoding="UTF-8"?>\n<quiz>\n']
    for name in names:
        for number in chosen:
            asked = room.answers(number, name, key)
            if asked:
                lines.append(_category("nevh/%s/sheet %d" % (
                    (name or "all").replace("/", " "), number)))
            lines += [_question(room, answer) for answer in asked]
    return "".join(lines) + "</quiz>\n"


def _category(path):
    return ('<question type="category"><category><text>$course$/%s</text></category>'
            "</question>\n" % html.escape(path))


def _question(room, answer):
    asks = answer.task.asks()
    lines = ['<question type="numerical">\n<name><text>%s</text></name>\n'
             '<questiontext format="html"><text><![CDATA[%s%s]]></text></questiontext>\n'
             % (html.escape(answer.task.name), _text_of(room, answer),
                "<p>%s</p>" % html.escape(asks))]
    lines.append(_answer(100, answer.number, answer.width(answer.number), ""))
    # An interval begins where that before it ends: Moodle takes the first that fits.
    for said, number in answer.mistakes():
        lines.append(_answer(0, number, answer.width(number), said))
    return "".join(lines) + _units(answer.task.unit) + "</question>\n"


def _units(unit):
    """The unit, which may be typed and need not be; without one a text behind the number is
    refused."""
    if not unit:
        return "<unitgradingtype>0</unitgradingtype><showunits>3</showunits>\n"
    return ("<units><unit><multiplier>1</multiplier><unit_name>%s</unit_name></unit></units>\n"
            "<unitgradingtype>0</unitgradingtype><unitpenalty>0.1</unitpenalty>"
            "<showunits>0</showunits><unitsleft>0</unitsleft>\n" % html.escape(unit))


def _answer(share, number, width, said):
    return ('<answer fraction="%d" format="plain_text"><text>%.10g</text>'
            "<tolerance>%.6g</tolerance><feedback format=\"html\"><text>%s</text>"
            "</feedback></answer>\n" % (share, number, width, html.escape(html.escape(said))))


def _text_of(room, answer):
    """The item of a task in HTML."""
    from ._classroom import read_sheets
    sheet = read_sheets(room.path, answer.name, answer.key)[answer.task.sheet - 1]
    item, made = 0, ""
    for kind, part in text.parts_of(sheet.body):
        if kind == "item":
            item = part
        elif item == answer.task.item:
            made += text.as_html(part) if kind == "text" else "<pre>%s</pre>" % html.escape(
                part if kind == "example" else text.text_of(part, sheet.source))
    return made.replace("]]>", "")


def _digest(salt, cell):
    """A digest that takes time to find by trial: rounds of SHA-256."""
    made = ("%s:%d" % (salt, cell)).encode()
    for _ in range(_rounds):
        made = hashlib.sha256(made).digest()
    return made.hex()[:12]


def cells_of(number, width):
    """The cells of an interval: the width of one, and their numbers."""
    cell = 2*width/_cells
    cell = float("%.2g" % cell)
    return cell, range(math.floor((number - width)/cell), math.floor((number + width)/cell) + 1)


def check_page(room, sheet, name, key):
    """A sheet that says right or not, without a network; it holds digests of the cells
    that right answers fall in."""
    asked = room.answers(sheet.number, name or None, key)
    held = {}
    for answer in asked:
        salt = secrets.token_hex(8)
        cell, numbers = cells_of(answer.number, answer.width(answer.number))
        held[answer.task.name] = {"salt": salt, "cell": cell, "rounds": _rounds, "right": sorted(
            _digest(salt, one) for one in numbers)}

    def boxes(item):
        return "".join(
            '<div class="answer"><label>%s <input data-task="%s" autocomplete="off"></label>'
            "<output></output></div>" % (html.escape(answer.task.asks()), answer.task.name)
            for answer in asked if answer.task.item == item) or '<div class="room"></div>'
    body = text.sheet_html(sheet.number, sheet.title, sheet.body, sheet.source, name, boxes)
    script = "<script>\nconst held = %s;\n%s</script>\n" % (
        json.dumps(held), text.text_of("check.js", sheet.source))
    return text.page("Sheet %d" % sheet.number, body, sheet.source, script)
