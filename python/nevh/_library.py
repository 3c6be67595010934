"""The shared library libnevh by ctypes: where it is, what it declares, its errors.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import ctypes as c
import difflib
import os
import sys


__version__ = "0.1.0"
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

# The folder that holds this package.
_here = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))


def _trees():
    """Folders that hold what belongs together, installed or built."""
    yield os.path.join(_here, "nevh_files")
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
                ("steps_foreseen", c.c_double), ("native_cache", c.c_char_p),
                ("substeps", c.c_size_t)]


class _Observer(c.Structure):
    _fields_ = [("observe", c.c_void_p), ("data", c.c_void_p), ("every", c.c_size_t)]


class _Energy(c.Structure):
    _fields_ = ([("samples", c.c_size_t)] + [(name, c.c_double) for name in (
        "initial scale max rms final drift drift_error straightness first_fifth "
        "last_fifth").split()] + [("verdict", c.c_int), ("theory", c.c_int)] +
        [(name, c.c_double) for name in "span limit met rounding gradient".split()] +
        [("rate", c.c_double * 3), ("early", c.c_double), ("least", c.c_double),
         ("gone", c.c_bool), ("grown", c.c_double), ("relative", c.c_double * 2),
         ("missed", c.c_double), ("jump", c.c_double), ("jump_t", c.c_double)])


class _JudgedRun(c.Structure):
    _fields_ = [("t", c.c_double), ("h", c.c_double), ("t_end", c.c_double),
                ("q", c.c_void_p), ("p", c.c_void_p), ("stop", c.POINTER(_Observer)),
                ("stops", c.c_size_t), ("seconds", c.c_double),
                ("allowed", c.c_double), ("regular", c.c_bool)]


class _Counts(c.Structure):
    _fields_ = [(name, c.c_uint64) for name in
                "values gradients sweeps newtons rescues".split()] + [
                    ("hamiltonians", c.c_double), ("instances", c.c_uint64)]


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
                 ("reference", c.c_char_p), ("transform", c.c_char_p),
                 ("substeps", c.c_size_t)])


class _SweepOptions(c.Structure):
    _fields_ = [("integrator", c.c_void_p), ("transformed", c.c_bool),
                ("gradient", c.c_void_p), ("gradient_step", c.c_double),
                ("gradient_steps", c.c_void_p), ("dt", c.c_double),
                ("t_end", c.c_double), ("tolerance", c.c_double),
                ("portable", c.c_bool), ("width", c.c_size_t),
                ("threads", c.c_size_t), ("ordered", c.c_bool), ("native", c.c_int),
                ("native_cache", c.c_char_p), ("substeps", c.c_size_t)]


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
integrator_adaptive:bp integrator_own_time:bp integrator_needs:ip integrator_order:ip integrator_symplectic:ip integrators:p scene_integrator_named:pps integrator_facts:ipp
scheme_shortfall:sppz energy_observe:ipzdpp
integrator_needs_formulas:bp substeps_named:zs gradient_named:ps gradient_name:sp gradients:p
stepper_new:pppp stepper_free:-p stepper_status:ip stepper_message:sp
stepper_time:dp stepper_taken:zp stepper_counts:Cp stepper_order:ip run_at:ipdddpzpppppz run_until:ipdddpppz
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


def gradient_names() -> list[str]:
    """The names of all gradients."""
    return _names(_lib.gradients, _lib.gradient_name)


_scipy_names = {"DOP853": "dop853", "RK45": "dopri5"}


def _text(what, value):
    if not isinstance(value, str):
        raise TypeError("%s is a text, not %r" % (what, value))
    return value


def _mapping(what, value):
    """{name: value}, or an empty one for None."""
    if value is None:
        return {}
    if not hasattr(value, "items"):
        raise TypeError("%s is {name: value}, not %.80r" % (what, value))
    return value


def _name_list(what, value):
    """Names: one, or several in a list or tuple; none for None."""
    if value is None or isinstance(value, str):
        return [] if value is None else [value]
    if not isinstance(value, (list, tuple, set, frozenset)):
        raise TypeError("%s is a name, or a list of names, not %.80r" % (what, value))
    return [_text("one of %s" % what, name) for name in value]


def _closest(name, names):
    """The words (did you mean NAME?), or none."""
    folded = {known.lower(): known for known in names}
    close = difflib.get_close_matches(name.lower(), folded, 1, 0.65)
    return " (did you mean %s?)" % folded[close[0]] if close else ""


def _integrator(name):
    if hasattr(name, "_pointer"):  # an Integrator
        return name._pointer, False
    if getattr(name, "step", None) is not None:  # an Integrator that is a function
        raise Refused("%s is a function of Python: solve and compare take it" % name.name)
    if isinstance(name, type):  # scipy.integrate.DOP853
        name = name.__name__
    name, plus, rest = _text("method", name).partition("+")
    found = _lib.integrator_named(_scipy_names.get(name, name).encode())
    if not found or (plus and rest != "transform" and not _substeps(name + plus + rest)):
        raise Refused("there is no method %r%s; nevh.integrators() lists them, and of "
                      "SciPy's %s are known" % (
                          name + plus + rest, _closest(name, integrators()),
                          " and ".join(_scipy_names)))
    return found, rest == "transform"


def _substeps(name):
    """Those of a name such as respa+16; of others 0, for those of the scene."""
    return _lib.substeps_named(name.encode()) if isinstance(name, str) else 0


def _gradient(name):
    found = _lib.gradient_named(_text("gradient", name).encode())
    if not found:
        raise Refused("there is no gradient %r; there are %s"
                      % (name, ", ".join(gradient_names())))
    return found
