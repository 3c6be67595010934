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

from ._library import (Error, Failed, gradients, integrators, library, Refused, verdicts,
                       __version__)
from ._scene import Scene, scenes
from ._solve import solve
from ._hgrad import HGrad
from ._commands import command, compare, main
from ._sweep import sweep

__all__ = ["solve", "compare", "sweep", "HGrad", "Scene", "Error", "Refused",
           "Failed", "integrators", "gradients", "scenes", "verdicts", "library", "command"]


def __dir__():
    return __all__ + ["__doc__", "__version__"]


for _name in __all__:  # their place is this package, as messages and pickles say it
    if hasattr(globals()[_name], "__module__"):
        globals()[_name].__module__ = __name__
