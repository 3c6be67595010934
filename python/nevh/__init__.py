"""nevh: write the Hamiltonian, get the motion.

    import nevh
    orbit = nevh.solve("p_phi^2/2 - cos(phi)", (0, 100), [2, 0], "verlet", dt=0.1)
    orbit.t, orbit.y, orbit.energy_error, orbit.verdict

A package over the shared library libnevh, by ctypes: no compiler is needed, and
NumPy only where arrays are asked for.  The library is looked for where the
variable NEVH_LIBRARY says, beside this package, in the build tree and the prefix
that it stands in, then where the system's loader looks.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from ._library import (Error, Failed, integrators, library, Refused, verdicts,
                       __version__)
from ._scene import Scene, scenes
from ._solve import solve
from ._hgrad import HGrad
from ._own import Integrator
from ._table import Table, Text
from ._commands import command, _function, gradients, main, _names
from ._sweep import sweep

__all__ = ["solve", "sweep", "HGrad", "Integrator", "Scene", "Table", "Text", "Error", "Refused", "Failed",
           "integrators", "gradients", "scenes", "verdicts", "library", "command"]

for _name in __all__:  # their place is this package, as messages and pickles say it
    if hasattr(globals()[_name], "__module__"):
        globals()[_name].__module__ = __name__


def __getattr__(name):
    """A command as a function, when it is first asked for."""
    if name.startswith("_"):
        raise AttributeError("module 'nevh' has no attribute %r" % name)
    globals()[name] = _function(name)
    return globals()[name]


def __dir__():
    try:
        known = {*__all__, *_names()}
    except Error:  # the library is there, and no command
        known = __all__
    return sorted(known) + ["__doc__", "__version__"]
