"""Names that a function gives to numbers of its state, as it unpacks them.

SPDX-License-Identifier: GPL-3.0-or-later
"""

import bisect
import dis
import functools
import sys

from ._symbol import Symbol, is_foreign


@functools.lru_cache(maxsize=256)
def _stores(code):
    """Offsets of instructions, and {offset: (operation, names)} of those whose results
    are stored."""
    found, last, offsets = {}, None, []
    for one in dis.get_instructions(code):
        offsets.append(one.offset)
        if one.opname.startswith("STORE_") and isinstance(one.argval, (str, tuple)) and last:
            of = (one.argval,) if isinstance(one.argval, str) else \
                one.argval[:2 if one.opname.endswith("STORE_FAST") else 1]
            operation, names = found.get(last.offset, (last.opname, ()))
            found[last.offset] = operation, names + of
            if operation == "UNPACK_SEQUENCE" and len(names + of) < last.arg:
                continue
        last = one
    return offsets, found


def _note(frame, values, unpacked):
    """Keeps the names under which the user's code stores symbols of coordinates."""
    if is_foreign(frame.f_code.co_filename):
        return
    offsets, stores = _stores(frame.f_code)
    at = offsets[bisect.bisect(offsets, frame.f_lasti) - 1]  # it may be in a cache
    operation, names = stores.get(at, ("", ()))
    if (operation == "UNPACK_SEQUENCE") != unpacked or len(names) != len(values):
        return
    for name, x in zip(names, values):
        if isinstance(x, Symbol) and x.graph.nodes[x.node][0] == "q":
            x.graph.names.setdefault(x.graph.nodes[x.node][1], name)


def noting(kind):
    """A class of rows, derived from `kind`, whose symbols get the names that they are
    stored under."""
    class Row(kind):
        def __iter__(self):
            values = list(super().__iter__())
            _note(sys._getframe(1), values, True)
            return iter(values)

        def __getitem__(self, index):
            found = super().__getitem__(index)
            if isinstance(found, Symbol):
                _note(sys._getframe(1), [found], False)
            elif kind is list:
                return Row(found)
            return found
    return Row
