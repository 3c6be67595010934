# The package for Python over the shared library, which it finds from where it is
# installed.  make install pythondir=DIR puts it elsewhere.
pythondir = $(pkgdatadir)/python
dist_python_DATA = python/who-keeps-the-energy.ipynb
python_sheetsdir = $(pythondir)/sheets
dist_python_sheets_DATA = python/sheets/sheet-1.ipynb python/sheets/sheet-2.ipynb \
	python/sheets/sheet-3.ipynb python/sheets/sheet-4.ipynb \
	python/sheets/sheet-5.ipynb python/sheets/sheet-6.ipynb \
	python/sheets/sheet-7.ipynb python/sheets/sheet-8.ipynb \
	python/sheets/sheet-9.ipynb
python_packagedir = $(pythondir)/nevh
dist_python_package_DATA = $(python_package)
python_package = \
	python/nevh/__init__.py \
	python/nevh/__init__.pyi \
	python/nevh/_arrays.py \
	python/nevh/_classroom.py \
	python/nevh/_command_line.py \
	python/nevh/_commands.py \
	python/nevh/_events.py \
	python/nevh/_functions.py \
	python/nevh/_graph.py \
	python/nevh/_graph_text.py \
	python/nevh/_hand_in.py \
	python/nevh/_hgrad.py \
	python/nevh/_library.py \
	python/nevh/_looks.py \
	python/nevh/_members.py \
	python/nevh/_names.py \
	python/nevh/_own.py \
	python/nevh/_plot.py \
	python/nevh/_progress.py \
	python/nevh/_run.py \
	python/nevh/_scene.py \
	python/nevh/_sheet_export.py \
	python/nevh/_sheet_text.py \
	python/nevh/_solve.py \
	python/nevh/_sweep.py \
	python/nevh/_symbol.py \
	python/nevh/_symbol_arrays.py \
	python/nevh/_symbol_functions.py \
	python/nevh/_table.py \
	python/nevh/_tasks.py \
	python/nevh/_trace.py \
	python/nevh/_traced.py \
	python/nevh/_twin.py \
	python/nevh/py.typed
EXTRA_DIST += python/pyproject.toml python/setup.py python/stage.sh python/sheets.py python/stub.py python/looks.awk \
	tests/python/find_python.sh

# A folder that runs wherever it is moved to: what a wheel and make portable hold.
python/nevh_files: libnevh.la tools/nevh$(EXEEXT) python/stage.sh
	$(AM_V_GEN)$(MKDIR_P) python && CC="$(CC)" LDFLAGS="$(LDFLAGS)" \
	  OBJECTS="$(tools_nevh_OBJECTS)" GSL_LIBS="$(GSL_LIBS)" \
	  LIBS="$(QUADMATH_LIBS) $(LIBS)" STRIP="$(STRIP)" srcdir="$(srcdir)" \
	  $(SHELL) $(srcdir)/python/stage.sh $@

# nevh-VERSION-py3-none-manylinux_GLIBC_MACHINE.whl, in python/; without a network.
interpreter = $${PYTHON:-python3}
wheel: python/nevh_files
	@$(interpreter) -c 'import setuptools, wheel' 2>/dev/null || { \
	  echo "make wheel: $(interpreter) has no setuptools or no wheel; do:" \
	    "apt-get install python3-setuptools python3-wheel, then make wheel" \
	    "PYTHON=/usr/bin/python3" >&2; exit 1; }
	rm -rf python/wheel && $(MKDIR_P) python/wheel
	cp -R python/nevh_files $(srcdir)/python/nevh \
	  $(srcdir)/python/pyproject.toml $(srcdir)/python/setup.py python/wheel
	chmod -R u+w python/wheel
	cd python/wheel && $(interpreter) -c \
	  'import setuptools.build_meta as b; print(b.build_wheel(".."))' \
	  >../wheel.log 2>&1 || { cat ../wheel.log; exit 1; }
	rm -rf python/wheel && tail -n 1 python/wheel.log

# One folder for a machine without root and compiler, packed.
portable_name = $(PACKAGE)-$(VERSION)-portable
portable: python/nevh_files
	rm -rf $(portable_name) && cp -R python/nevh_files $(portable_name)
	$(MKDIR_P) $(portable_name)/share/nevh/python $(portable_name)/share/doc/nevh
	cp -R $(srcdir)/python/nevh $(srcdir)/python/sheets $(srcdir)/python/*.ipynb \
	  $(portable_name)/share/nevh/python/
	cp $(srcdir)/README.md $(srcdir)/COPYING $(portable_name)/share/doc/nevh/
	-$(MAKE) html $(sheets_html) && \
	  cp doc/nevh.html $(sheets_html) $(portable_name)/share/doc/nevh/
	tar -czf $(portable_name).tar.gz $(portable_name)
	rm -rf $(portable_name)
.PHONY: wheel portable

clean-python:
	rm -rf python/nevh_files python/nevh_files.new python/wheel python/wheel.log \
	  python/*.whl $(portable_name) $(portable_name).tar.gz
.PHONY: clean-python
