"""Progress of long calls where a person waits: on a terminal, or in a notebook.

SPDX-License-Identifier: GPL-3.0-or-later
"""

from __future__ import annotations

import sys
import threading
import time

_first, _between = 2.0, 0.25  # seconds until the first line, and from one to the next


def _cell():
    """The kernel of a notebook in which a person runs a cell, or None: programs that run
    notebooks cannot be asked for input."""
    ipython = sys.modules.get("IPython")
    shell = ipython and ipython.get_ipython()
    kernel = getattr(shell, "kernel", None)
    return kernel if getattr(kernel, "_allow_stdin", False) else None


class _Terminal:
    """A line of stderr, which is rubbed out at the end."""

    def show(self, text):
        sys.stderr.write("\r\033[K" + text)
        sys.stderr.flush()

    def end(self):
        self.show("")


class _Notebook:
    """An output below the cell, which is empty at the end."""

    def __init__(self):
        from IPython.display import display, HTML
        self._html = HTML
        self._output = display(HTML(""), display_id=True)

    def show(self, text):
        self._output.update(self._html(text and "<code>%s</code>" % text))

    def end(self):
        self.show("")


class Progress:
    """How far a call is; nothing where it is short, or where no person looks.  `what` is
    its name."""

    def __init__(self, what):
        self.what, self._place = what, None
        self._start = self._shown = time.monotonic()
        self._wait = _first
        self.looks = threading.current_thread() is threading.main_thread() and (
            _cell() is not None or bool(sys.stderr and sys.stderr.isatty()))

    def at(self, share=None):
        """A part of the call is done, 0 to 1; None where that is not known."""
        now = time.monotonic()
        if not self.looks or now - self._shown < self._wait:
            return
        self._shown, self._wait = now, _between
        if self._place is None:
            self._place = _Notebook() if _cell() is not None else _Terminal()
        took = now - self._start
        self._place.show("nevh.%s: %.0f s" % (self.what, took) + (
            "" if not share else ", %2.0f %%, %.0f s left" % (
                100 * share, took * (1 - share) / share)))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._place is not None:
            self._place.end()
