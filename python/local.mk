# The module for Python: one file over the shared library, which it finds from
# where it is installed.  make install pythondir=DIR puts it elsewhere.
pythondir = $(pkgdatadir)/python
dist_python_DATA = python/nevh.py
