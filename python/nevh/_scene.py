"""Scenes: the name of one that ships, a file, a text, or H alone.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ctypes as c
import math
import os
import re
from typing import Any, Callable, Mapping, Sequence

from ._library import _check, _closest, _INVALID, _lib, _mapping, _name_list, Refused, _text, _trees
from ._arrays import _numbers, _real


def _is_row(value):
    return (hasattr(value, "__len__") and not isinstance(value, str)
            and getattr(value, "ndim", 1) > 0)


def _one_line(what, text):
    """A text that can stand in a line of a scene and ends no part of it."""
    if not text.strip() or not text.isprintable() or "#" in text:
        raise Refused("%s %r: it takes printable text in one line, without #"
                      % (what, text))
    return text


def _value(name, value):
    if isinstance(value, str):
        return _one_line("the value of %s," % name, value)
    number = _real(name, value)
    if not math.isfinite(number):
        raise Refused("%s = %g is not finite" % (name, number))
    return repr(number)


def _assign(name, value):
    _one_line("the name", _text("a name", name))
    if "=" in re.sub(r"\[.*\]", "", name):
        raise Refused("the name %r has a =" % name)
    if not _is_row(value):
        return "%s = %s" % (name, _value(name, value))
    if not len(value):
        raise Refused("there is no value for %s" % name)
    if getattr(value, "ndim", 1) != 1:
        raise Refused("%s has the shape %s; it takes numbers in a row"
                      % (name, value.shape))
    return "%s = %s" % (name, ", ".join(_value(name, one) for one in value))


def _is_scene_text(text):
    return re.search(r"^[ \t]*\[\w+\]", text, re.M) is not None


def _scene_text(title, coordinates, effects, parameters=None, definitions=None):
    """The text of a scene of these effects, {name: formula}, without a start."""
    lines = ["[scene]", "title = " + title, "[parameters]"]
    for name, value in _mapping("parameters", parameters).items():
        if _is_row(value):
            name = "%s[1..%d]" % (name, len(value))
        lines.append(_assign(name, value))
    lines.append("[coordinates]")
    for name in _name_list("coordinates", coordinates):
        lines.append(re.sub(r"\[(\w+)\]", r"[i = 1..\1]", name) + " = 0")
    for section, formulas in (("definitions", definitions), ("effects", effects)):
        if formulas:
            lines.append("[%s]" % section)
            lines += ["%s = %s" % (name, _one_line("the formula of %s," % name,
                                                   " ".join(_text("a formula", formula)
                                                            .split())))
                      for name, formula in formulas.items()]
    return "\n".join(lines + ["[run]", "gradient = exact", ""])


def _coordinates_of(formula):
    """Each NAME of which a formula has p_NAME, in that order."""
    return list(dict.fromkeys(re.findall(r"\bp_([^\W\d]\w*)", formula)))


def _scene_of_formula(formula, parameters, coordinates):
    """The text of a scene whose H is that formula."""
    definitions = {}
    if coordinates is None:
        coordinates = _coordinates_of(formula)
        if not coordinates and re.search(r"\bp\b", formula):
            coordinates, definitions = ["q"], {"p": "p_q"}
        if not coordinates:
            if re.fullmatch(r"[^\W\d][\w-]*", formula):
                raise Refused("there is no scene %r%s; as a formula it has no momentum "
                              "p_NAME" % (formula, _closest(formula, scenes())))
            raise Refused("%r names no momentum p_NAME: give coordinates=[...]" % formula)
    return _scene_text("H = " + " ".join(formula.split()), coordinates, {"H": formula},
                       parameters, definitions)


def _scene_folders():
    folders = [os.environ.get("NEVH_SCENES", "")]
    base = os.path.dirname(os.path.realpath(_lib.path))
    for tree in (os.path.dirname(base), os.path.dirname(os.path.dirname(base)), *_trees()):
        folders += [os.path.join(tree, "share/nevh/scenes"), os.path.join(tree, "scenes")]
    return [folder for folder in folders if folder and os.path.isdir(folder)]


def _shipped(name):
    for folder in _scene_folders():
        path = os.path.join(folder, name + ".nevh")
        if os.path.exists(path):
            return path
    return None


def scenes() -> list[str]:
    """The names of the scenes that ship."""
    return sorted({file[:-5] for folder in _scene_folders()
                   for file in os.listdir(folder) if file.endswith(".nevh")})


def _again(text, path, is_formula, changes):
    scene = Scene(text)
    scene.path, scene.is_formula, scene._changes = path, is_formula, list(changes)
    return scene


class Scene:
    """A scene: the name of one that ships, a file, a scene's text, H alone, H as a function
    (see solve), which is traced, or effects.

    parameters   {name: number, formula or list}, of the scene or in the formulas
    coordinates  of a formula or of effects: names, "x[8]" for an array; default: all
                 NAME of which they have p_NAME, in that order; q for q and p alone
    with_effects, without_effects   names of effects to switch on and off
    y0           of a function: coordinates and momenta where it has a value
    effects      {name: formula}, in place of a source: their sum is H
    definitions  {name: formula} for what the effects share

    str(scene) is its text; with_(g=1.6) the scene with other parameters.
    """

    def __init__(self, source: str | os.PathLike | Callable[..., float] | None = None,
                 parameters: Mapping[str, Any] | None = None,
                 coordinates: Sequence[str] | None = None,
                 with_effects: str | Sequence[str] = (),
                 without_effects: str | Sequence[str] = (),
                 y0: Sequence[float] | None = None, *,
                 effects: Mapping[str, str] | None = None,
                 definitions: Mapping[str, str] | None = None) -> None:
        self._made = self.path = None
        self._changes = []  # since the file was read, as options of the command
        if (source is None) == (effects is None):
            raise TypeError("a scene has a source or effects, one of the two")
        if definitions and effects is None:
            raise TypeError("definitions go with effects")
        if effects is not None:
            effects = {name: _text("a formula", formula) for name, formula in
                       _mapping("effects", effects).items()}
            definitions = _mapping("definitions", definitions)
            coordinates = coordinates or _coordinates_of(" ".join(effects.values()))
            self.is_formula = True
            self._made = _lib.scene_parse(b"scene", _scene_text(
                " + ".join(effects), coordinates, effects, parameters,
                definitions).encode())
            self._check(_lib.scene_status(self._made))
        else:
            self._read(source, parameters, coordinates, y0)
        for option, names in (("with", with_effects), ("without", without_effects)):
            for name in _name_list(option + "_effects", names):
                self._changes += ["--" + option, name]
                self._check(_lib.scene_enable(self._made, name.encode(),
                                              option == "with"))

    def _read(self, source, parameters, coordinates, y0):
        if not isinstance(source, (str, os.PathLike)) and not callable(source):
            raise TypeError("a scene is a text, the name of a file or of a scene, or a "
                            "function, not %r" % type(source).__name__)
        self.is_formula = callable(source)
        if self.is_formula:
            from ._traced import text_of
            text, parameters = text_of(source, y0, parameters, coordinates), None
        else:
            text = os.fspath(source)
        if _is_scene_text(text):
            self._made = _lib.scene_parse(b"scene", text.encode())
        elif text.endswith(".nevh") or os.path.exists(text):
            self.path = text
        elif re.fullmatch(r"[\w./+-]+", text):
            self.path = _shipped(text)
        if self.path:
            self._made = _lib.scene_read(os.fsencode(self.path))
        elif not _is_scene_text(text):
            self.is_formula = True
            text = _scene_of_formula(text, parameters, coordinates)
            self._made = _lib.scene_parse(b"H", text.encode())
        self._check(_lib.scene_status(self._made))
        if not self.is_formula:
            self._set(_mapping("parameters", parameters))

    def _set(self, parameters):
        for name, value in parameters.items():
            text = _assign(name, value)
            self._check(_lib.scene_set(self._made, text.encode()))
            self._changes += ["--set", text]

    def with_(self, **parameters: Any) -> Scene:
        """This scene with other values of parameters; it stays as it is."""
        other = _again(*self.__reduce__()[1])
        other._set(parameters)
        return other

    def __str__(self):
        return self.text

    @property
    def name(self) -> str:
        """The name of its file without .nevh, or H."""
        return os.path.basename(self.path)[:-5] if self.path else "H"

    def __repr__(self):
        title = re.search(r"^title *= (.*)$", self.text, re.M)
        return "<Scene %s: %s; %s>" % (self.name, title.group(1) if title else "no title",
                                       ", ".join(self.names))

    def __reduce__(self):  # to copy and to pickle it
        return _again, (self.text, self.path, self.is_formula, self._changes)

    def __del__(self):
        if getattr(self, "_made", None):
            _lib.scene_free(self._made)

    def _check(self, status):
        message = _lib.scene_message(self._made)
        if status and self.is_formula:  # the user wrote one line, not a scene
            message = re.sub(r"^H:\d+:(\d+): error(.*\nH = )", lambda at: "H, column %d%s"
                             % (int(at.group(1)) - len("H = "), at.group(2)),
                             message.decode())
            message = re.sub(r"^H:\d+:\d+: error: ", "", message)
        # A file that cannot be read is bad input, too.
        _check(_INVALID if status == 5 else status, message)

    @property
    def n(self) -> int:
        """Degrees of freedom."""
        return _lib.scene_dof(self._made)

    @property
    def names(self) -> list[str]:
        """Coordinates, then momenta, in the order of y."""
        q = [_lib.scene_coordinate(self._made, k).decode() for k in range(self.n)]
        return q + ["p_" + name for name in q]

    def start(self, y0: Any = None) -> Any:
        """The state to start from: y0, or where the scene starts; with a dictionary
        {name: value}, what it names is replaced."""
        if y0 is not None and not isinstance(y0, dict):
            array, _ = _numbers(y0, "y0")
            if len(array) != 2 * self.n:
                raise Refused("y0 has the length %d; it takes %d numbers: %s"
                              % (len(array), 2 * self.n, ", ".join(self.names)))
            return array
        if y0:
            return Scene(self.text)._set_start(y0).start()
        array, at = _numbers([0.0] * (2 * self.n))
        self._check(_lib.scene_start(self._made, at, at + 8 * self.n))
        return array

    def _set_start(self, y0):
        for name, value in y0.items():
            self._check(_lib.scene_set_start(self._made, _assign(name, value).encode()))
        return self

    @property
    def text(self) -> str:
        """The scene as text, as it is now, but for the start."""
        free = c.CDLL(None).free
        free.argtypes = [c.c_void_p]
        address = _lib.scene_write(self._made, None)
        if not address:
            raise MemoryError("nevh: out of memory")
        text = c.string_at(address).decode()
        free(address)
        return text

    def _settings(self):
        return _lib.scene_run_settings(self._made).contents


def _scene(source, parameters, coordinates, with_effects, without_effects, y0=None):
    """A Scene, which is made already or is to be; of a function near the state y0."""
    if not isinstance(source, Scene):
        return Scene(source, parameters, coordinates, with_effects, without_effects, y0)
    if parameters or coordinates or with_effects or without_effects:
        raise Refused("parameters, coordinates and effects are set when a Scene is made")
    return source


def _starts(scene, y0):
    """{name: value} of what is to start elsewhere."""
    if y0 is None or isinstance(y0, dict):
        return y0 or {}
    return dict(zip(scene.names, scene.start(y0)))
