"""nevh: write the Hamiltonian, get the motion.

    import nevh
    orbit = nevh.solve("p_phi^2/2 - cos(phi)", (0, 100), [2, 0], "verlet", dt=0.1)
    orbit.t, orbit.y, orbit.energy_error, orbit.verdict

One file over the shared library libnevh, by ctypes: no compiler is needed, and
NumPy only where arrays are asked for.  The library is looked for where the
variable NEVH_LIBRARY says, beside this file, in the build tree and the prefix
that this file stands in, then where the system's loader looks.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import csv
import ctypes as c
import difflib
import html
import math
import numbers
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import warnings
from typing import Any, Callable, Mapping, Sequence

try:
    import numpy as np
except ImportError:
    np = None

__version__ = "0.1.0"
__all__ = ["solve", "compare", "sweep", "HGrad", "Scene", "Error", "Refused",
           "Failed", "integrators", "gradients", "scenes", "verdicts", "library", "command"]



def __dir__():
    return __all__ + ["__doc__", "__version__"]


verdicts = ("bounded", "random-walk", "drifts", "unstable", "undecided")
_INVALID, _STOPPED, _STRUCTURE, _NO_GRADIENT = 4, 1027, 1024, 1025


class Error(Exception):
    """What the library says; `result` is the orbit so far, where there is one."""
    result = None


class Refused(Error, ValueError):
    """Input is wrong, or the method does not fit this H."""


class Failed(Error, ArithmeticError):
    """A computation has no finite result."""


def _check(status, message):
    if status:
        text = message.decode() if isinstance(message, bytes) else message
        if status == 8:
            raise MemoryError(text or "out of memory")
        kind = Refused if status in (_INVALID, _STRUCTURE, _NO_GRADIENT) else Failed
        raise kind(text)


# The library: where it is, what it declares.

_here = os.path.dirname(os.path.realpath(__file__))


def _trees():
    """Folders that hold what belongs together, installed or built."""
    yield os.path.join(_here, "nevh_files")
    yield os.path.join(os.path.dirname(_here), "nevh_files")
    for up in ("..", "../build", "../../..", "../../../.."):
        yield os.path.normpath(os.path.join(_here, up))


def _libraries():
    given = os.environ.get("NEVH_LIBRARY")
    if given:
        yield given
        return
    names = ("libnevh.so.0", "libnevh.so", "libnevh.0.dylib")
    machine = "/" + getattr(sys.implementation, "_multiarch", "")
    for folder in [_here] + [os.path.join(tree, part) for tree in _trees()
                             for part in (".libs", "lib", "lib64", "lib" + machine)]:
        for name in names:
            if os.path.exists(os.path.join(folder, name)):
                yield os.path.join(folder, name)
    yield from names


class _Options(c.Structure):
    _fields_ = [("gradient", c.c_void_p), ("gradient_step", c.c_double),
                ("gradient_steps", c.c_void_p), ("scale", c.c_void_p),
                ("t", c.c_double), ("q", c.c_void_p), ("p", c.c_void_p),
                ("width", c.c_size_t), ("tolerance", c.c_double),
                ("transform", c.c_void_p), ("binding", c.c_double),
                ("portable", c.c_bool), ("balance", c.c_bool), ("native", c.c_int),
                ("steps_foreseen", c.c_double), ("native_cache", c.c_char_p)]


class _Observer(c.Structure):
    _fields_ = [("observe", c.c_void_p), ("data", c.c_void_p), ("every", c.c_size_t)]


class _Energy(c.Structure):
    _fields_ = ([("samples", c.c_size_t)] + [(name, c.c_double) for name in (
        "initial scale max rms final drift drift_error straightness first_fifth "
        "last_fifth").split()] + [("verdict", c.c_int), ("theory", c.c_int)] +
        [(name, c.c_double) for name in "span limit met rounding gradient".split()] +
        [("rate", c.c_double * 3), ("early", c.c_double), ("least", c.c_double),
         ("gone", c.c_bool), ("grown", c.c_double), ("relative", c.c_double * 2),
         ("missed", c.c_double)])


class _JudgedRun(c.Structure):
    _fields_ = [("t", c.c_double), ("h", c.c_double), ("t_end", c.c_double),
                ("q", c.c_void_p), ("p", c.c_void_p), ("stop", c.POINTER(_Observer)),
                ("stops", c.c_size_t), ("seconds", c.c_double),
                ("allowed", c.c_double), ("regular", c.c_bool)]


class _Counts(c.Structure):
    _fields_ = [(name, c.c_uint64) for name in
                "values gradients sweeps newtons rescues".split()] + [
                    ("hamiltonians", c.c_double)]


class _Separability(c.Structure):
    _fields_ = [("separable", c.c_bool), ("term", c.c_char_p),
                ("mixed", c.c_double), ("states", c.c_size_t)]


class _Run(c.Structure):
    _fields_ = ([("t_start", c.c_double), ("t_end", c.c_double)] +
                [(name, c.c_size_t) for name in
                 "dts integrators gradients tolerances".split()] +
                [("dt", c.POINTER(c.c_double)), ("tolerance", c.POINTER(c.c_double)),
                 ("integrator", c.POINTER(c.c_char_p)),
                 ("gradient", c.POINTER(c.c_char_p)), ("gradient_step", c.c_double),
                 ("gradient_steps", c.c_void_p), ("energy_scale", c.c_double),
                 ("native", c.c_int), ("match_work", c.c_bool),
                 ("reference", c.c_char_p), ("transform", c.c_char_p)])


class _SweepOptions(c.Structure):
    _fields_ = [("integrator", c.c_void_p), ("transformed", c.c_bool),
                ("gradient", c.c_void_p), ("gradient_step", c.c_double),
                ("gradient_steps", c.c_void_p), ("dt", c.c_double),
                ("t_end", c.c_double), ("tolerance", c.c_double),
                ("portable", c.c_bool), ("width", c.c_size_t),
                ("threads", c.c_size_t), ("ordered", c.c_bool), ("native", c.c_int),
                ("native_cache", c.c_char_p)]


class _Records(c.Structure):
    _fields_ = [("records", c.c_void_p), ("first", c.c_uint64), ("count", c.c_uint64),
                ("columns", c.c_size_t), ("failed", c.c_uint64),
                ("failed_member", c.c_uint64), ("message", c.c_char * 400)]


_value_fn = c.CFUNCTYPE(c.c_double, c.c_double, c.c_void_p, c.c_void_p, c.c_void_p)
_observe_fn = c.CFUNCTYPE(c.c_int, c.c_void_p, c.c_size_t, c.c_double, c.c_void_p,
                          c.c_void_p)

# NAME: RESULT ARGUMENTS, a letter each: p object or array, s text, i status,
# z size, u 64 bits, d number, b truth, and structures.
_functions = """version:s size_of:zs scene_read:ps scene_parse:pss
scene_free:-p scene_status:ip scene_message:sp scene_set:ips scene_enable:ipsb
scene_set_start:ips scene_write:pps scene_dof:zp scene_coordinate:spz
scene_system:pp scene_start:ippp scene_run_settings:Rp scene_transform:pp
scene_stops:bp scene_stop_text:sp scene_vary:ippz scene_set_outcomes:ips
system_from:pzpp system_free:-p system_status:ip system_message:sp system_probe:ipdpppp
system_traits:ip system_friction:bpp integrator_named:ps integrator_name:sp
integrator_adaptive:bp integrator_own_time:bp integrator_needs:ip integrators:p
integrator_needs_formulas:bp gradient_named:ps gradient_name:sp gradients:p
stepper_new:pppp stepper_free:-p stepper_status:ip stepper_message:sp
stepper_time:dp stepper_taken:zp stepper_counts:Cp stepper_order:ip run_at:ipdddpzpppppz
energy_new:ppp energy_free:-p energy_status:ip energy_message:sp energy_follow:ipp
energy_passed:dpp
energy_expect:ipp energy_set_scale:ipd energy_result:Epz verdict_settle:ipppp
counts_seconds:dpzpiz field_new:ppp field_free:-p
field_status:ip field_message:sp field_gradient:ipzppppp field_value:ipzpppp sweep_new:ppp sweep_free:-p
sweep_status:ip sweep_message:sp sweep_members:up sweep_columns:zp sweep_column:spz
sweep_is_verdict:bpz sweep_run:ipuuppp sweep_stop:-p""".split()
_types = {"p": c.c_void_p, "s": c.c_char_p, "i": c.c_int, "z": c.c_size_t,
          "u": c.c_uint64, "d": c.c_double, "b": c.c_bool, "-": None,
          "R": c.POINTER(_Run), "C": _Counts, "E": _Energy}


class _Library:
    def __init__(self):
        tried = []
        for name in _libraries():
            try:
                self.dll = c.CDLL(name)
                self.path = name
                break
            except OSError as error:
                tried.append("  " + str(error))
        else:
            raise ImportError("libnevh was not found; set NEVH_LIBRARY to its "
                              "file:\n" + "\n".join(tried))
        for line in _functions:
            name, types = line.split(":")
            try:
                function = self.dll["nevh_" + name]
            except AttributeError:
                raise ImportError("%s has no nevh_%s: it is of another version than "
                                  "%s" % (self.path, name, __file__)) from None
            function.restype = _types[types[0]]
            function.argtypes = [_types[letter] for letter in types[1:]]
            setattr(self, name, function)
        self.check()

    def check(self):
        version = self.version().decode()
        if version != __version__:
            raise ImportError("%s is nevh %s, and %s is for %s"
                              % (self.path, version, __file__, __version__))
        for name, declared in (("options", _Options), ("observer", _Observer),
                               ("energy_report", _Energy), ("counts", _Counts),
                               ("judged_run", _JudgedRun),
                               ("scene_run", _Run), ("sweep_options", _SweepOptions),
                               ("sweep_records", _Records),
                               ("separability", _Separability)):
            size = self.size_of(b"nevh_" + name.encode())
            if size != c.sizeof(declared):
                raise ImportError("%s: nevh_%s has %d bytes, not %d: it was built for "
                                  "another machine or version" % (
                                      self.path, name, size, c.sizeof(declared)))

    def address(self, name):
        return c.cast(self.dll["nevh_" + name], c.c_void_p).value


_lib = _Library()


def library() -> str:
    """The file of the library that is in use."""
    return _lib.path


def _names(objects, name):
    array = c.cast(objects(), c.POINTER(c.c_void_p))
    found = []
    while array[len(found)]:
        found.append(name(array[len(found)]).decode())
    return found


def integrators() -> list[str]:
    """The names of all methods."""
    return _names(_lib.integrators, _lib.integrator_name)


def gradients() -> list[str]:
    """The names of all gradients."""
    return _names(_lib.gradients, _lib.gradient_name)


_scipy_names = {"DOP853": "dop853", "RK45": "dopri5"}


def _text(what, value):
    if not isinstance(value, str):
        raise TypeError("%s is a text, not %r" % (what, value))
    return value


def _closest(name, names):
    """The words (did you mean NAME?), or none."""
    folded = {known.lower(): known for known in names}
    close = difflib.get_close_matches(name.lower(), folded, 1)
    return " (did you mean %s?)" % folded[close[0]] if close else ""


def _integrator(name):
    if isinstance(name, type):  # scipy.integrate.DOP853
        name = name.__name__
    name, plus, rest = _text("method", name).partition("+")
    found = _lib.integrator_named(_scipy_names.get(name, name).encode())
    if not found or (plus and rest != "transform"):
        raise Refused("there is no method %r%s; nevh.integrators() lists them, and of "
                      "SciPy's %s are known" % (
                          name + plus + rest, _closest(name, integrators()),
                          " and ".join(_scipy_names)))
    return found, bool(plus)


def _gradient(name):
    found = _lib.gradient_named(_text("gradient", name).encode())
    if not found:
        raise Refused("there is no gradient %r; there are %s"
                      % (name, ", ".join(gradients())))
    return found


# Arrays: NumPy's, or lists.

def _numbers(values, what="the array"):
    """An array of doubles, and what its memory is passed as."""
    try:
        if np is not None:
            if np.ma.is_masked(values):
                raise Refused("%s has masked values; it takes a number in each place"
                              % what)
            array = np.array(values, ndmin=1)
            if array.dtype.kind not in "biufO":
                raise TypeError
            array = array.astype(float, order="C", copy=False)
            if array.ndim != 1:
                raise Refused("%s has the shape %s; it takes numbers in a row"
                              % (what, array.shape))
            return array, array.ctypes.data
        if isinstance(values, (int, float)):
            values = [values]
        array = (c.c_double * len(values))(*values)
        return array, c.addressof(array)
    except (TypeError, ValueError, OverflowError) as error:
        if isinstance(error, Refused):
            raise
        raise Refused("%s takes real numbers in a row, not %.80r"
                      % (what, values)) from None


def _real(what, value):
    """A number as a float: of Python or NumPy, no text."""
    try:
        if isinstance(value, str):
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise Refused("%s = %.80r is not a real number" % (what, value)) from None


def _positive(what, value):
    number = _real(what, value)
    if not 0 < number < math.inf:
        raise Refused("%s = %g: it takes a number above 0" % (what, number))
    return number


def _whole_from_one(what, value):
    number = _real(what, value)
    if number < 1 or number % 1:
        raise Refused("%s = %g: it takes a whole number from 1" % (what, number))
    return int(number)


def _table(rows, columns):
    if np is not None:
        array = np.empty((rows, columns))
        return array, array.ctypes.data
    array = (c.c_double * (rows * columns))()
    return array, c.addressof(array)


def _cut(array, rows, columns, kept):
    if np is not None:
        return array if kept == columns else array[:, :kept].copy()
    return [array[k * columns:k * columns + kept] for k in range(rows)]


class Result(dict):
    """A dictionary whose items are attributes, too, as SciPy's results are.

    A verdict that the run leaves open is found when it is first asked for.
    """

    def __missing__(self, name):
        settle = self.__dict__.get("_settle") if name == "verdict" else None
        if not settle:
            raise KeyError(name)
        self["verdict"] = settle()
        del self._settle
        return self["verdict"]

    def get(self, name, default=None):
        return self[name] if name in self else default

    def __contains__(self, name):
        return dict.__contains__(self, name) or (
            name == "verdict" and "_settle" in self.__dict__)

    def __getattr__(self, name):
        try:
            return self[name]
        except KeyError:
            raise AttributeError(name) from None

    def __dir__(self):
        return list(self)

    def __repr__(self):
        width = max(map(len, self), default=0)
        return "\n".join("%*s: %s" % (width, key, re.sub(
            "\n", "\n" + " " * (width + 2), repr(value)[:300]))
                         for key, value in self.items())


def _whole(name):
    """A method of dictionaries that takes all items."""
    method = getattr(dict, name)

    def call(self, *arguments):
        self.get("verdict")
        return method(self, *arguments)
    return call


for _name in "__eq__ __iter__ __len__ __reduce_ex__ copy items keys values".split():
    setattr(Result, _name, _whole(_name))


# Scenes, files or formulas.

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


def _scene_of_formula(formula, parameters, coordinates):
    """The text of a scene whose H is that formula."""
    definitions = ""
    if coordinates is None:
        coordinates = list(dict.fromkeys(re.findall(r"\bp_([^\W\d]\w*)", formula)))
        if not coordinates and re.search(r"\bp\b", formula):
            coordinates, definitions = ["q"], "[definitions]\np = p_q\n"
        if not coordinates:
            if re.fullmatch(r"[^\W\d][\w-]*", formula):
                raise Refused("there is no scene %r%s; as a formula it has no momentum "
                              "p_NAME" % (formula, _closest(formula, scenes())))
            raise Refused("%r names no momentum p_NAME: give coordinates=[...]" % formula)
    lines = ["[parameters]"]
    for name, value in (parameters or {}).items():
        if _is_row(value):
            name = "%s[1..%d]" % (name, len(value))
        lines.append(_assign(name, value))
    lines.append("[coordinates]")
    for name in coordinates:
        lines.append(re.sub(r"\[(\w+)\]", r"[i = 1..\1]", name) + " = 0")
    formula = " ".join(formula.split())
    return "[scene]\ntitle = H = %s\n%s\n%s[effects]\nH = %s\n[run]\ngradient = exact\n" \
        % (formula, "\n".join(lines), definitions, formula)


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


def _again(text, path, is_formula):
    scene = Scene(text)
    scene.path, scene.is_formula = path, is_formula
    return scene


class Scene:
    """A scene: the name of one that ships, a file, a scene's text, or H alone.

    parameters   {name: number, formula or list}, of the scene or in the formula
    coordinates  of a formula: names, "x[8]" for an array; default: all NAME of
                 which it has p_NAME, in that order; q where it has q and p alone
    with_effects, without_effects   names of effects to switch on and off
    """

    def __init__(self, source: str | os.PathLike,
                 parameters: Mapping[str, Any] | None = None,
                 coordinates: Sequence[str] | None = None,
                 with_effects: str | Sequence[str] = (),
                 without_effects: str | Sequence[str] = ()) -> None:
        self._made = self.path = None
        if not isinstance(source, (str, os.PathLike)):
            raise TypeError("a scene is a text, the name of a file or of a scene, not %r"
                            % type(source).__name__)
        text = os.fspath(source)
        self.is_formula = False
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
            for name, value in (parameters or {}).items():
                self._check(_lib.scene_set(self._made, _assign(name, value).encode()))
        for names, on in ((with_effects, True), (without_effects, False)):
            for name in [names] if isinstance(names, str) else names:
                name = _text("an effect", name).encode()
                self._check(_lib.scene_enable(self._made, name, on))

    @property
    def name(self):
        """The name of its file without .nevh, or H."""
        return os.path.basename(self.path)[:-5] if self.path else "H"

    def __repr__(self):
        title = re.search(r"^title *= (.*)$", self.text, re.M)
        return "<Scene %s: %s; %s>" % (self.name, title.group(1) if title else "no title",
                                       ", ".join(self.names))

    def __reduce__(self):  # to copy and to pickle it
        return _again, (self.text, self.path, self.is_formula)

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
    def n(self):
        """Degrees of freedom."""
        return _lib.scene_dof(self._made)

    @property
    def names(self):
        """Coordinates, then momenta, in the order of y."""
        q = [_lib.scene_coordinate(self._made, k).decode() for k in range(self.n)]
        return q + ["p_" + name for name in q]

    def start(self, y0=None):
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
    def text(self):
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


def _scene(source, parameters, coordinates, with_effects, without_effects):
    """A Scene, which is made already or is to be."""
    if not isinstance(source, Scene):
        return Scene(source, parameters, coordinates, with_effects, without_effects)
    if parameters or coordinates or with_effects or without_effects:
        raise Refused("parameters, coordinates and effects are set when a Scene is made")
    return source


def _starts(scene, y0):
    """{name: value} of what is to start elsewhere."""
    if y0 is None or isinstance(y0, dict):
        return y0 or {}
    return dict(zip(scene.names, scene.start(y0)))


# Functions: of Python, or addresses of functions in C.

def _address(function):
    """The address of a C function double H(double t, const double q[], const double
    p[], const void *params), or None: of a ctypes function or c_void_p, of what
    numba's @cfunc gives, of a scipy.LowLevelCallable.  A plain number is refused:
    nobody could tell that it is an address."""
    if isinstance(function, numbers.Integral):
        raise TypeError("H = %r is a number; an address of a C function is given as "
                        "ctypes.c_void_p(address)" % (function,))
    if isinstance(function, c.c_void_p):
        if not function.value or function.value < 4096:
            raise TypeError("%r is not the address of a function" % function)
        return function.value
    if hasattr(function, "address"):
        return int(function.address)
    if isinstance(function, c._CFuncPtr):
        return c.cast(function, c.c_void_p).value
    if type(function).__name__ == "LowLevelCallable":
        capsule = tuple.__getitem__(function, 0)
        name, pointer = c.pythonapi.PyCapsule_GetName, c.pythonapi.PyCapsule_GetPointer
        name.restype, name.argtypes = c.c_char_p, [c.py_object]
        pointer.restype, pointer.argtypes = c.c_void_p, [c.py_object, c.c_char_p]
        return pointer(capsule, name(capsule))
    return None


class _Trap:
    """Keeps what a function of Python raised until the library has returned.  While
    it plans, H is tried at states where no orbit may come: there an error is but a
    value that is not finite."""

    def __init__(self):
        self.error = None
        self.planning = True

    def spring(self):
        error, self.error = self.error, None
        if error is not None:
            raise error

    def planned(self, status):
        self.planning = False
        if status or not isinstance(self.error, Exception):
            self.spring()
        self.error = None


class _PythonValue:
    """H(t, y, *args, **parameters) of Python as a C function."""

    def __init__(self, function, n, trap, args, parameters):
        size = 8 * n
        state = np.empty(2 * n) if np is not None else (c.c_double * (2 * n))()
        at = state.ctypes.data if np is not None else c.addressof(state)
        move = c.memmove

        def value(t, q, p, _):
            if trap.error is not None and not trap.planning:
                return float("nan")
            try:
                move(at, q, size)
                move(at + size, p, size)
                return float(function(t, state.copy() if np is not None else state[:],
                                      *args, **parameters))
            except BaseException as error:
                trap.error = error
                return float("nan")
        self.function = _value_fn(value)
        self.address = c.cast(self.function, c.c_void_p).value


class _Subject:
    """A system, with what belongs to it: of a scene, or of a function."""

    def __init__(self, H, n=None, parameters=None, args=(), coordinates=None,
                 with_effects=(), without_effects=(), params=None):
        self.scene = self.own = None
        self.calls_python = False
        self.trap = _Trap()
        if isinstance(H, (Scene, str, os.PathLike)):
            self.scene = _scene(H, parameters, coordinates, with_effects,
                                without_effects)
            self.system = _lib.scene_system(self.scene._made)
            self.n = self.scene.n
            return
        address = _address(H)
        if address is None and not callable(H):
            raise TypeError("H is a text, a Scene, a function or the address of one, "
                            "not %r" % type(H).__name__)
        if with_effects or without_effects or coordinates:
            raise Refused("a function has neither effects nor names of coordinates")
        self.n = n
        self.kept = H
        if address is None:
            self.kept = _PythonValue(H, n, self.trap, tuple(args), parameters or {})
            address = self.kept.address
            self.calls_python = True
        self.own = self.system = _lib.system_from(
            n, address, c.cast(params, c.c_void_p) if params is not None else None)
        _check(_lib.system_status(self.own), _lib.system_message(self.own))

    def __del__(self):
        if getattr(self, "own", None):
            _lib.system_free(self.own)

    def friction(self):
        rates, at = _numbers([0.0] * self.n)
        return rates if _lib.system_friction(self.system, at) else None

    def reads_time(self, t, y):
        """Whether H depends on t; of a function, whether some times differ."""
        if not self.own:
            return not _lib.system_traits(self.system) & 2
        field = _lib.field_new(self.system, c.byref(_Options(gradient_step=1)))
        h, found = c.c_double(), set()
        for later in (0.0, 0.1234, 0.777, 1.618, 31.4, 1234.5):
            _lib.field_value(field, 1, c.byref(c.c_double(t + later)), y[1],
                             y[1] + 8 * self.n, c.byref(h))
            found.add(h.value)
        _lib.field_free(field)
        return len(found) > 1

    def separable(self, t, y):
        if _lib.system_traits(self.system) & 1:
            return True
        found = _Separability()
        _, at = y
        _lib.system_probe(self.system, t, at, at + 8 * self.n, None, c.byref(found))
        return found.separable


# Runs.

def _set_gradient_steps(o, scene, given, n, what):
    """The half-spreads of differences in options: those given, a number or one for
    each of y; else the scene's.  Returns what must be kept while the options are used."""
    if given is None and scene:
        settings = scene._settings()
        o.gradient_step = settings.gradient_step
        o.gradient_steps = settings.gradient_steps
        return None
    if not hasattr(given, "__len__"):
        o.gradient_step = given or 0
        return None
    steps, o.gradient_steps = _numbers(given, what)
    if len(steps) != 2 * n:
        raise Refused("%s has %d numbers; it takes one, or %d" % (what, len(steps), 2 * n))
    return steps


class _Plan:
    """A stepper and what watches it."""

    def __init__(self, subject, name, gradient, y, t0, tolerance, gradient_step):
        self.subject = subject
        integrator, transformed = _integrator(name)
        o = self.options = _Options(t=t0, q=y[1], p=y[1] + 8 * subject.n,
                                    tolerance=tolerance)
        if gradient is None:  # none is taken: nothing is to be planned
            o.gradient, gradient_step = _gradient("central2"), 1
        else:
            o.gradient = _gradient(gradient)
        if transformed:
            o.transform = subject.scene and _lib.scene_transform(subject.scene._made)
            if not o.transform:
                raise Refused("%s: there is no scene with a transform" % name)
        self.steps = _set_gradient_steps(o, subject.scene, gradient_step, subject.n,
                                         "gradient_step")
        o.balance = subject.reads_time(t0, y) or subject.friction() is not None
        self.integrator = integrator
        self.stepper = _lib.stepper_new(subject.system, integrator, c.byref(o))
        status = _lib.stepper_status(self.stepper)
        subject.trap.planned(status)
        self.check(status)
        self.observe_energy()

    def observe_energy(self):
        """An observer of the energy that has seen nothing yet."""
        _lib.energy_free(getattr(self, "energy", None))
        self.energy = _lib.energy_new(self.subject.system, c.byref(self.options))
        if self.options.balance:
            _lib.energy_follow(self.energy, self.stepper)
        _lib.energy_expect(self.energy, self.stepper)
        scene = self.subject.scene
        if scene and scene._settings().energy_scale > 0:
            _lib.energy_set_scale(self.energy, scene._settings().energy_scale)

    def __del__(self):
        _lib.energy_free(getattr(self, "energy", None))
        if hasattr(self, "stepper"):
            _lib.stepper_free(self.stepper)

    def check(self, status):
        _check(status, _lib.stepper_message(self.stepper))


class _Interrupt:
    """While the library runs, the interrupt key is noted, to be raised after."""

    def __init__(self):
        self.pressed = False
        self.before = None

    def __enter__(self):
        main = threading.current_thread() is threading.main_thread()
        if main and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            self.before = signal.signal(signal.SIGINT, self.note)
        return self

    def note(self, *_):
        self.pressed = True

    def __exit__(self, *_):
        if self.before is not None:
            signal.signal(signal.SIGINT, self.before)


def _watcher(observe, n, trap, interrupt):
    """An observer that calls `observe`, and looks for the interrupt key."""
    view = c.c_double * n

    def watch(_, step, t, q, p):
        try:
            if interrupt.pressed:
                raise KeyboardInterrupt
            if observe is None:
                return 0
            y = list(view.from_address(q)) + list(view.from_address(p))
            return bool(observe(t, np.array(y) if np is not None else y))
        except BaseException as error:
            trap.error = error
            return 1
    return _observe_fn(watch)


def _times_of_steps(t0, t_end, h):
    count = round((t_end - t0) / h)
    if count > 0 and abs((t_end - t0) / h - count) <= 1e-9 * count:
        h = (t_end - t0) / count
        count -= 1
    else:
        count = int((t_end - t0) / h)
    if np is not None:
        times = np.empty(count + 2)
        np.multiply(np.arange(count + 1), h, out=times[:-1])
        times[:-1] += t0
        times[-1] = t_end
        return times
    return [t0 + i * h for i in range(count + 1)] + [t_end]


def _steps(method, dt, rtol, atol, span, y0):
    """The step and the tolerance of a method."""
    integrator, _ = _integrator(method)
    if not _lib.integrator_adaptive(integrator):
        if rtol is not None or atol is not None:
            raise Refused("%s takes steps of dt and no tolerance: leave out rtol and "
                          "atol" % method)
        if dt is None:
            raise Refused("%s takes steps of dt: give it" % method)
        return dt, 0.0
    rtol = 1e-9 if rtol is None else _positive("rtol", rtol)
    if atol is not None:
        least = min(_numbers(atol, "atol")[0])
        if least > 0:
            rtol = min(rtol, least / max(1.0, max(map(abs, y0))))
        elif not least == 0:
            raise Refused("atol = %g: it takes 0 or a number above it" % least)
    return abs(span) / 256 if dt is None else dt, rtol


def _choose(subject, dt, t0, y):
    """Methods, of which the first that is not refused is taken."""
    if dt is None:
        return ["dop853"] if subject.own else ["taylor", "dop853"]
    return ["verlet" if subject.separable(t0, y) else "gauss4"]


def _takes_none(method):
    """Whether a method takes no gradient."""
    return _lib.integrator_needs_formulas(_integrator(method)[0])


def _stops(scene):
    """The observers, none or one, that stop a run where the scene says."""
    if scene and _lib.scene_stops(scene._made):
        return [(_lib.address("scene_stop_observe"), scene._made, 1)]
    return []


def _settler(plan, t0, h, t_end, start, report):
    """A function that gives the verdict on a run to the end, of a longer one."""
    counts = _lib.stepper_counts(plan.stepper)
    seconds = _lib.counts_seconds(c.byref(counts), plan.subject.n, plan.integrator,
                                  _lib.stepper_order(plan.stepper),
                                  _lib.stepper_taken(plan.stepper))

    def settle():
        subject = plan.subject
        y, at = _numbers(start)
        plan.observe_energy()
        with _Interrupt() as interrupt:
            watch = _watcher(None, subject.n, subject.trap, interrupt)
            stops = _stops(subject.scene) + [(c.cast(watch, c.c_void_p).value, None, 64)]
            run = _JudgedRun(t0, h, t_end, at, at + 8 * subject.n,
                             (_Observer * len(stops))(*stops), len(stops), seconds)
            status = _lib.verdict_settle(plan.stepper, plan.energy, c.byref(run),
                                         c.byref(report))
        subject.trap.spring()
        _check(status, b"")
        return verdicts[report.verdict]
    return settle


def _run_plan(plan, t0, t_end, h, times, y, observe, every):
    """The orbit as a Result, and the status of the library."""
    subject, n = plan.subject, plan.subject.n
    start = list(y[0])
    times, times_at = _numbers(times)
    states, states_at = _table(2 * n, len(times))
    kept, trap = c.c_size_t(), subject.trap
    watched = [(_lib.address("energy_observe"), plan.energy, 1)]
    watched += _stops(subject.scene)
    with _Interrupt() as interrupt:
        watch = _watcher(observe, n, trap, interrupt)
        watched.append((c.cast(watch, c.c_void_p).value, None, every))
        observers = (_Observer * len(watched))(*watched)
        status = _lib.run_at(plan.stepper, t0, h, t_end, times_at, len(times),
                             states_at, c.byref(kept), y[1], y[1] + 8 * n, observers,
                             len(watched))
    report = _lib.energy_result(plan.energy, 0)
    counts = _lib.stepper_counts(plan.stepper)
    message = _lib.stepper_message(plan.stepper).decode()
    if status == _STOPPED and _lib.energy_status(plan.energy):
        status = _lib.energy_status(plan.energy)
        message = _lib.energy_message(plan.energy).decode()
    if status == _STOPPED and subject.scene and _lib.scene_stops(subject.scene._made):
        message += ": " + _lib.scene_stop_text(subject.scene._made).decode()
    reached = t_end if not status else (
        _lib.stepper_time(plan.stepper) if _lib.stepper_taken(plan.stepper) else t0)
    effect = c.c_char_p()
    passed = _lib.energy_passed(plan.energy, c.byref(effect))
    if not math.isnan(passed) and status in (0, _STOPPED):
        status = -1
        message = (f"A step before t = {passed:.6g} passes a pole of "
                   f"{effect.value.decode()}: what follows is not the orbit of H.")
    count = kept.value
    result = Result(
        t=times[:count] if count < len(times) else times,
        y=_cut(states, 2 * n, len(times), count),
        nfev=counts.gradients, hamiltonian_evals=counts.hamiltonians,
        status=0 if not status else 1 if status == _STOPPED else -1,
        message=message or "The end of t_span was reached.",
        success=status in (0, _STOPPED), energy_error=report.max,
        energy_drift=report.drift,
        energy_scale=report.scale, t_reached=reached,
        y_reached=y[0].copy() if np is not None else list(y[0]), sol=None)
    verdict = verdicts[report.verdict]
    if verdict == "unstable" and not status and report.max > 1:
        warnings.warn(
            f"The energy changes by up to {report.max:.2g} times its scale: these "
            "steps are no measure of the orbit; take a smaller dt, or another "
            "integrator.", RuntimeWarning, stacklevel=4)
    if verdict == "undecided" and not status and not subject.calls_python:
        result._settle = _settler(plan, t0, h, t_end, start, report)
    else:
        result["verdict"] = verdict
    return status, result


def _span(scene, t_span):
    if t_span is None:
        settings = scene._settings()
        return settings.t_start, settings.t_end
    try:
        t0, t_end = t_span
    except (TypeError, ValueError):
        raise Refused("t_span = %.80r: it takes two times" % (t_span,)) from None
    return _real("t_span[0]", t0), _real("t_span[1]", t_end)


def _times_to_keep(t_eval, t0, t_end):
    times, _ = _numbers(t_eval, "t_eval")
    least, most = min(t0, t_end), max(t0, t_end)
    ahead = math.copysign(1, t_end - t0)
    if np is not None and (least <= times).all() and (times <= most).all() and (
            np.diff(times) * ahead >= 0).all():
        return times
    before = t0
    for k, t in enumerate(times):
        if not least <= t <= most:
            raise Refused("t_eval[%d] = %g is not within t_span = %g, %g"
                          % (k, t, t0, t_end))
        if (t - before) * ahead < 0:
            raise Refused("t_eval[%d] = %g is not in the order of the run: it comes after "
                          "%g" % (k, t, before))
        before = t
    return times


def solve(H: Any, t_span: Sequence[float] | None = None,
          y0: Sequence[float] | Mapping[str, float | str] | None = None,
          method: str | type | None = None, *, dt: float | None = None,
          rtol: float | None = None, atol: float | Sequence[float] | None = None,
          t_eval: Sequence[float] | None = None, gradient: str | None = None,
          gradient_step: float | Sequence[float] | None = None,
          parameters: Mapping[str, Any] | None = None, args: Sequence[Any] = (),
          coordinates: Sequence[str] | None = None,
          with_effects: str | Sequence[str] = (),
          without_effects: str | Sequence[str] = (), params: Any = None,
          observe: Callable[[float, Any], Any] | None = None, every: int = 1,
          check: bool = True) -> Result:
    """Follow the orbit of a Hamiltonian from t_span[0] to t_span[1].

    H        H as text ("p_x^2/2 + k*x^2/2"), a scene (see Scene), a pointer of ctypes
             to a C function H(t, q, p, params), or, slow, a function H(t, y, *args,
             **parameters) of Python, where y has coordinates, then momenta
    y0       coordinates, then momenta; of scenes also {name: value}, None: as they say
    method   a name of nevh.integrators() or of SciPy's DOP853 and RK45.  None: the
             first of the scene; else with dt verlet, or gauss4 where H is no sum of
             T(p) and V(q); without dt taylor, or dop853 for functions and for
             formulas that are not analytic
    dt       the step.  Of methods that adapt it is where their steps end; None: a
             256th of the time
    rtol     of methods that adapt, relative to the larger of |y| and the length over
             which H varies; default 1e-9.  atol can make it smaller only:
             min(rtol, atol/max(1, |y0|))
    t_eval   times to keep; default: all steps of dt.  They do not change the orbit
    gradient default: of scenes what they say, exact of other texts, central4 of
             functions
    gradient_step   half the spread of differences, a number or one for each of y;
             default: the scene's, else chosen where the orbit starts
    parameters, coordinates, with_effects, without_effects: see Scene
    observe  called with (t, y) after `every` steps; what is true ends the run
    check    False: a step that fails gives a result with status -1, as SciPy's

    Returns t, y (a row a variable), nfev (gradients), status (0: the end; 1: stopped;
    -1: failed), message, success, as SciPy does; energy_error (the largest over the
    run, relative to energy_scale), verdict (of nevh.verdicts; what the run leaves open
    is found as nevh compare finds it, by a longer run, when it is first asked for; but
    for functions of Python), energy_drift (a unit of time), hamiltonian_evals, t_reached and y_reached (the last good state), method,
    dt, tolerance, gradient (None where none is taken), names.

    Raises Refused for input that is wrong, Failed where a step fails, and what
    `observe` or H raised; the orbit so far is then the exception's `result`.
    """
    n = None
    if not isinstance(H, (Scene, str, os.PathLike)):
        if y0 is None or t_span is None:
            raise Refused("a function needs t_span and y0")
        y0, _ = _numbers(y0, "y0")
        if len(y0) < 2 or len(y0) % 2:
            raise Refused("y0 takes as many momenta as coordinates, not %d in all"
                          % len(y0))
        n = len(y0) // 2
    if observe is not None and not callable(observe):
        raise TypeError("observe is a function, not %r" % type(observe).__name__)
    every = _whole_from_one("every", every)
    subject = _Subject(H, n, parameters, args,
                       coordinates, with_effects, without_effects, params)
    scene = subject.scene
    if scene and scene.is_formula and (y0 is None or t_span is None):
        raise Refused("a formula needs t_span and y0")
    y = scene.start(y0) if scene else y0
    t0, t_end = _span(scene, t_span)
    y = _numbers(y)
    if not all(map(math.isfinite, y[0])):
        k = next(k for k, number in enumerate(y[0]) if not math.isfinite(number))
        raise Refused("y0[%d]%s is %g" % (
            k, ", the start of %s," % scene.names[k] if scene else "", y[0][k]))
    if scene:
        settings = scene._settings()
        if method is None and settings.integrators:
            method = settings.integrator[0].decode()
        adapts = method and _lib.integrator_adaptive(_integrator(method)[0])
        if dt is None and settings.dts and not adapts:
            dt = settings.dt[0]
        if (rtol is None and settings.tolerances and adapts and
                not scene.is_formula):
            rtol = settings.tolerance[0]
        gradient = gradient or settings.gradient[0].decode()
    if not t_end - t0 < float("inf") or t_end == t0:
        raise Refused("t_span = %g, %g is no time to go" % (t0, t_end))
    dt = None if dt is None else _positive("dt", dt)
    methods = [method] if method else _choose(subject, dt, t0, y)
    dt, tolerance = _steps(methods[0], dt, rtol, atol, t_end - t0, y[0])
    h = dt if t_end > t0 else -dt
    if gradient:
        _gradient(gradient)
    for name in methods:
        of = None if _takes_none(name) else gradient or "central4"
        try:
            plan = _Plan(subject, name, of, y, t0, tolerance, gradient_step)
        except Refused:
            if name == methods[-1]:
                raise
        else:
            method, gradient = name, of
            break
    if t_eval is None:
        t_eval = _times_of_steps(t0, t_end, h)
    else:
        t_eval = _times_to_keep(t_eval, t0, t_end)
    if observe is None:
        every = 16 if tolerance else 512
    status, result = _run_plan(plan, t0, t_end, h, t_eval, y, observe, every)
    names = scene.names if scene else None
    result.update(method=method, dt=dt, tolerance=tolerance, gradient=gradient,
                  names=names)
    try:
        subject.trap.spring()
        if check and status not in (0, _STOPPED):
            _check(status, result.message)
    except BaseException as error:
        result["success"], result["status"] = False, -1
        result["message"] = str(error) or type(error).__name__
        error.result = result
        raise
    return result


def _hgrad(H, ds, named):
    return HGrad(H, ds, **named)


class HGrad:
    """The right-hand side f(t, y) of Hamilton's equations, for solve_ivp and others.

        G = nevh.HGrad(H, k=4, m=1)
        solve_ivp(G, (0, 3), [1, 0])

    H   as of solve; of a function's other parameters `constants` are the values
    ds  half the spread of the differences: a number, or one for each of y; default:
        chosen where the first state is
    gradient  default: central4 of values of H

    y may be of shape (2n,), or (2n, k) for k states.  `counts` says how often H was
    evaluated.  One thread at a time may call it.
    """

    def __init__(self, H, ds=None, *, gradient="central4", args=(), coordinates=None,
                 with_effects=(), without_effects=(), params=None, parameters=None,
                 **constants):
        self._given = H, ds, dict(
            constants, gradient=gradient, args=args, coordinates=coordinates,
            with_effects=with_effects, without_effects=without_effects, params=params,
            parameters=parameters)
        self._gradient = _gradient(gradient)
        self._ds = ds
        constants = dict(parameters or {}, **constants)
        self._subject, self._field, self._width = None, None, 0
        self._make = lambda n: _Subject(H, n, constants, args, coordinates,
                                        with_effects, without_effects, params)
        if isinstance(H, (Scene, str, os.PathLike)):
            self._subject = self._make(None)

    def __reduce__(self):  # to copy and to pickle it
        return _hgrad, self._given

    def __del__(self):
        if getattr(self, "_field", None):
            _lib.field_free(self._field)

    def _plan(self, t, y):
        size = len(y)
        if self._subject is None:
            if size % 2:
                raise Refused("y has %d numbers; it takes as many momenta as "
                              "coordinates" % size)
            self._subject = self._make(size // 2)
        n = self._n = self._subject.n
        self._count(size)
        first = [row[0] if hasattr(row, "__len__") else row for row in y]
        start, at = _numbers(first)
        o = _Options(t=t, q=at, p=at + 8 * n, gradient=self._gradient)
        self._steps = _set_gradient_steps(o, self._subject.scene, self._ds, n, "ds")
        self._field = _lib.field_new(self._subject.system, c.byref(o))
        status = _lib.field_status(self._field)
        self._subject.trap.planned(status)
        _check(status, _lib.field_message(self._field))
        self._rates = self._subject.friction()

    def _count(self, size):
        if size != 2 * self._n:
            raise Refused("y has %d numbers; it takes %d" % (size, 2 * self._n))

    def _room(self, width):
        self._width = width
        half = 8 * self._n * width
        self._y, at = _table(2 * self._n, width)
        self._dy, out = _table(2 * self._n, width)
        self._t, times = _numbers([0.0] * width)
        self._call = (self._field, width, times, at, at + half, out + half, out)

    def __call__(self, t, y):
        if np is not None:
            y = np.asarray(y)
            if y.ndim not in (1, 2) or y.dtype.kind not in "biufO":
                raise Refused("y has the shape %s of %s; it takes real numbers, (2n,) or "
                              "(2n, k)" % (y.shape, y.dtype))
            if y.ndim == 2 and not y.shape[1]:
                return np.empty(y.shape)
        if self._field is None:
            self._plan(t, y)
        if np is None:
            return self._lists(t, y)
        width = y.shape[1] if y.ndim == 2 else 1
        if width != self._width:
            self._room(width)
        n = self._n
        if len(y) != 2 * n:
            self._count(len(y))
        self._t[:] = t
        self._y[:] = y if y.ndim == 2 else y[:, None]
        self._take()
        dy = self._dy.copy()
        np.negative(dy[n:], out=dy[n:])
        if self._rates is not None:
            dy[n:] -= np.asarray(self._rates)[:, None] * self._y[n:]
        return dy if y.ndim == 2 else dy[:, 0]

    def _lists(self, t, y):
        if self._width != 1:
            self._room(1)
        n = self._n
        self._count(len(y))
        self._t[0] = t
        self._y[:] = y
        self._take()
        rates = self._rates or [0.0] * n
        return self._dy[:n] + [-d - r * p for d, r, p in
                               zip(self._dy[n:], rates, self._y[n:])]

    def _take(self):
        status = _lib.field_gradient(*self._call)
        self._subject.trap.spring()
        if status:
            for k, number in enumerate(self._y if np is None else self._y.ravel()):
                if not math.isfinite(number):
                    raise Failed("y[%d] is %g" % (k // self._width, number))
            _check(status, _lib.field_message(self._field))


# Tables.

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

    scene    as of Scene; a formula needs y0 and t_end
    options  more options of the command: ["--match", "work"]

    Returns rows, dictionaries with the columns of the command's CSV (see the manual),
    which a notebook shows as a table.  rows["verdict"] is a column.

    The command is run, since the choice of a reference, and timing, are its own and
    not the library's.
    """
    made = _scene(scene, parameters, coordinates, with_effects, without_effects)
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


def _lines(vary):
    if isinstance(vary, str):
        return [vary]
    return [_assign(name, value) for name, value in vary.items()] \
        if isinstance(vary, dict) else list(vary)


def sweep(scene: str | os.PathLike | Scene, vary: Any = None,
          outcomes: str | Sequence[str] | None = None, integrator: str | None = None, *,
          dt: float | None = None, t_end: float | None = None, rtol: float | None = None,
          gradient: str | None = None, threads: int | None = None,
          count: int | None = None, seed: int | None = None, combine: str | None = None,
          y0: Sequence[float] | Mapping[str, float | str] | None = None,
          parameters: Mapping[str, Any] | None = None,
          coordinates: Sequence[str] | None = None,
          with_effects: str | Sequence[str] = (),
          without_effects: str | Sequence[str] = ()) -> Any:
    """Many orbits of a scene, side by side, into a structured array of NumPy.

    vary      {name: what}: an array of values, or a text as "range(0, pi, 1000)",
              "normal(1, 0.1)", as [ensemble] of a scene has them; default: the scene's
    outcomes  as "state, last(x), period, verdict" (a number of nevh.verdicts);
              default: the scene's, or state and energy_error
    integrator, dt, t_end, rtol   default: the scene's
    threads   default: all processors

    Returns an array with a field for each name that is varied and each outcome, and
    `status`: 1 where a member is done, 2 where it failed, 3 where it has no start.
    A warning says how many members failed, and why the first did.  The interrupt key
    lets the members under way end; the exception's `result` is the array, with status
    0 of those that did not begin.
    """
    if np is None:
        raise ImportError("nevh.sweep needs NumPy")
    made = _scene(scene, parameters, coordinates, with_effects, without_effects)
    if made is scene:  # the caller's is not changed
        made = Scene(made.text)
    made._set_start(_starts(made, y0))
    lines = _lines(vary) if vary is not None else []
    lines += [_assign(name, value) if isinstance(value, str) else "%s = %d" % (
        name, value) for name, value in (("count", count), ("seed", seed),
                                         ("combine", combine)) if value is not None]
    if lines:
        encoded = (c.c_char_p * len(lines))(*(line.encode() for line in lines))
        made._check(_lib.scene_vary(made._made, encoded, len(lines)))
    if outcomes is not None:
        text = outcomes if isinstance(outcomes, str) else ", ".join(outcomes)
        made._check(_lib.scene_set_outcomes(made._made, text.encode()))
    settings = made._settings()
    if integrator is None and settings.integrators:
        integrator = settings.integrator[0].decode()
    found, transformed = _integrator(integrator or "verlet")
    adapts = _lib.integrator_adaptive(found)
    if made.is_formula and (t_end is None or dt is None and not adapts):
        raise Refused("a formula needs t_end, and dt but for methods that adapt")
    if rtol is not None and not adapts:
        raise Refused("%s takes steps of dt and no tolerance: leave out rtol"
                      % (integrator or "verlet"))
    o = _SweepOptions(integrator=found, transformed=transformed,
                      dt=0 if dt is None else _positive("dt", dt),
                      t_end=0 if t_end is None else _ends(settings, t_end),
                      threads=(os.cpu_count() or 1) if threads is None else
                      _whole_from_one("threads", threads),
                      gradient=_gradient(gradient or settings.gradient[0].decode()),
                      gradient_step=settings.gradient_step,
                      gradient_steps=settings.gradient_steps,
                      tolerance=0 if not adapts else _tolerance(made, rtol))
    made_sweep = _lib.sweep_new(made._made, c.byref(o))
    try:
        return _sweep(made_sweep)
    finally:
        _lib.sweep_free(made_sweep)


def _tolerance(scene, rtol):
    """rtol, else the first of the scene's, else 1e-9."""
    settings = scene._settings() if scene and not scene.is_formula else None
    if rtol is None:
        return settings.tolerance[0] if settings and settings.tolerances else 1e-9
    return _positive("rtol", rtol)


def _ends(settings, t_end):
    t_end = _real("t_end", t_end)
    if not settings.t_start < t_end < math.inf:
        raise Refused("t_end = %g: it takes a time after the start, %g"
                      % (t_end, settings.t_start))
    return t_end


def _sweep(s):
    def check(status):
        _check(status, _lib.sweep_message(s))
    check(_lib.sweep_status(s))
    members, columns = _lib.sweep_members(s), _lib.sweep_columns(s)
    names = [_lib.sweep_column(s, k).decode() for k in range(columns)]
    size = 8 + 8 * columns
    kind = np.dtype({"names": ["status"] + names, "formats": ["u1"] + ["f8"] * columns,
                     "offsets": [0] + [8 + 8 * k for k in range(columns)],
                     "itemsize": size})
    array = np.zeros(members, kind)
    records = _Records(records=array.ctypes.data, count=members, columns=columns)
    status, done = [], threading.Event()

    def run():
        status.append(_lib.sweep_run(s, 0, members, None, _lib.address("sweep_keep"),
                                     c.byref(records)))
        done.set()
    # In a thread of its own, for that of the caller takes the interrupt key.  Its join
    # would not do: of Python 3.11 it takes an interrupted thread for one that has ended.
    threading.Thread(target=run).start()
    pressed = None
    while not done.is_set():
        try:
            done.wait()
        except BaseException as error:
            pressed = error
            _lib.sweep_stop(s)
    if pressed is not None:
        pressed.result = array
        raise pressed
    check(status[0])
    if records.failed:
        warnings.warn("%d of %d members failed; member %d: %s" % (
            records.failed, members, records.failed_member,
            records.message.decode()), stacklevel=3)
    return array


def main():
    """The command nevh."""
    os.execv(command(), ["nevh"] + sys.argv[1:])
