# The manual, and pages for man.
info_TEXINFOS = doc/nevh.texi
doc_nevh_TEXINFOS = \
	doc/compare-pendulum.txt \
	doc/cost-pendulum.txt \
	doc/cost-length-pendulum.txt \
	doc/recommend-pendulum.txt \
	doc/gradients-pendulum.txt \
	doc/hard.txt \
	doc/verdicts.txt \
	doc/paper.txt \
	doc/compare-first.txt \
	doc/gradient-cost.txt \
	doc/steps-that-follow.txt \
	doc/hoop.nevh \
	doc/native-never.txt \
	doc/native-always.txt \
	doc/installing.texi \
	doc/tutorial.texi \
	doc/catalogue.texi \
	doc/performance.texi \
	doc/bibliography.texi \
	doc/reference.texi
AM_MAKEINFOHTMLFLAGS = --no-split
# Without TeX; make pdf needs it.
AM_DISTCHECK_DVI_TARGET = html

# The C reference is what the headers say, in the order of first use.
dist_man3_MANS = doc/nevh.3
reference_headers = \
	include/nevh/status.h include/nevh/system.h include/nevh/body.h \
	include/nevh/simd.h include/nevh/probe.h include/nevh/gradient.h \
	include/nevh/integrator.h include/nevh/run.h include/nevh/transform.h \
	include/nevh/timing.h include/nevh/diagnose.h include/nevh/loop.h include/nevh/frequencies.h include/nevh/confirm.h include/nevh/chaos.h include/nevh/shadow.h include/nevh/reference.h include/nevh/certain.h \
	include/nevh/section.h include/nevh/ensemble.h include/nevh/scene.h \
	include/nevh/sweep.h include/nevh/models.h include/nevh/binding.h \
	include/nevh/gsl.h include/nevh/extend.h
# In the sources, where makeinfo looks for it, and in tarballs.
doc/reference.texi: $(reference_headers) doc/reference.awk
	$(AM_V_GEN)cd $(srcdir) && \
	  $(AWK) -v form=texi -f doc/reference.awk $(reference_headers) \
	    >doc/reference.tmp && mv doc/reference.tmp doc/reference.texi
doc/nevh.3: $(reference_headers) doc/reference.awk doc/nevh.3.head
	$(AM_V_GEN)cd $(srcdir) && \
	  { cat doc/nevh.3.head && \
	    $(AWK) -v form=man -f doc/reference.awk $(reference_headers); } \
	    >doc/nevh.tmp && mv doc/nevh.tmp doc/nevh.3
# A page a header, too: nevh_run(3) is <nevh/run.h>.
header_pages = \
	doc/nevh_status.3 doc/nevh_system.3 doc/nevh_body.3 doc/nevh_simd.3 \
	doc/nevh_probe.3 doc/nevh_gradient.3 doc/nevh_integrator.3 doc/nevh_run.3 \
	doc/nevh_transform.3 doc/nevh_timing.3 doc/nevh_diagnose.3 doc/nevh_loop.3 \
	doc/nevh_frequencies.3 doc/nevh_chaos.3 doc/nevh_confirm.3 doc/nevh_shadow.3 \
	doc/nevh_reference.3 doc/nevh_certain.3 doc/nevh_section.3 \
	doc/nevh_ensemble.3 doc/nevh_scene.3 doc/nevh_sweep.3 doc/nevh_models.3 \
	doc/nevh_binding.3 doc/nevh_gsl.3 doc/nevh_extend.3
dist_man3_MANS += $(header_pages)
$(header_pages): doc/nevh.3
	$(AM_V_GEN)cd $(srcdir) && page=doc/`basename $@` && \
	  header=include/nevh/`basename $@ .3 | sed 's/nevh_//'`.h && \
	  { sed -n 's/^\.TH NEVH /.TH NEVH_'`basename $$header .h | tr a-z A-Z`' /p' \
	      doc/nevh.3.head && \
	    sed -n '1s|^/\* nevh: *\(.*[^.]\)\.* *$$|.SH NAME\nnevh_'`basename $$header .h`' \\- \1|p' \
	      $$header && \
	    $(AWK) -v form=man -f doc/reference.awk $$header && \
	    printf '.SH SEE ALSO\n.BR nevh (3)\n'; } >$$page.tmp && mv $$page.tmp $$page
MAINTAINERCLEANFILES = $(header_pages) doc/nevh.3 doc/reference.texi web/kit.html

# nevh(1) is what nevh --help says, and in tarballs.
if HAVE_PAGE
dist_man1_MANS = doc/nevh.1
MAINTAINERCLEANFILES += doc/nevh.1
doc/nevh.1: $(tools_nevh_SOURCES) doc/nevh.h2m configure.ac \
  | tools/nevh$(EXEEXT)
	$(AM_V_GEN)$(MKDIR_P) doc && \
	  $(HELP2MAN) --name 'compare symplectic integrators on a Hamiltonian' \
	    --include $(srcdir)/doc/nevh.h2m --output $@ ./tools/nevh$(EXEEXT)
endif
EXTRA_DIST += doc/nevh.h2m doc/nevh.3.head doc/reference.awk doc/figures.sh doc/hard.awk \
	doc/nevh-cost.txt doc/energy.svg

# Worksheets: every number is measured again.
EXTRA_DIST += doc/sheets/answers.texi doc/sheets/numbers.texi doc/sheets/sheets.sh
# What nevh sheet and nevh mark read.
sheetsdir = $(pkgdatadir)/sheets
dist_sheets_DATA = doc/sheets/sheets.texi doc/sheets/numbers.list doc/sheets/tasks.list \
	doc/sheets/quartic.nevh doc/sheets/schemes.nevh doc/sheets/sheets.css doc/sheets/check.js
sheets_html = doc/nevh-sheets.html doc/nevh-answers.html
CLEANFILES += $(sheets_html) doc/nevh-sheets.pdf doc/nevh-answers.pdf
run_sheets = $(SHELL) $(srcdir)/doc/sheets/sheets.sh $(srcdir) \
	tools/nevh$(EXEEXT) examples
sheets: all $(sheets_html)
	$(run_sheets) check
	@if command -v texi2pdf >/dev/null && command -v tex >/dev/null; then \
	  for name in sheets answers; do \
	    texi2pdf --quiet --clean -I $(srcdir)/doc/sheets -I $(srcdir)/build-aux \
	      -o doc/nevh-$$name.pdf $(srcdir)/doc/sheets/$$name.texi || exit 1; \
	  done; \
	else echo "There is no TeX: the sheets are $(sheets_html) alone."; fi
sheet_to_html = $(MKDIR_P) doc && $(MAKEINFO) --html --no-split \
	--css-include=$(srcdir)/doc/sheets/sheets.css -I $(srcdir)/doc/sheets -o $@
doc/nevh-sheets.html: doc/sheets/sheets.texi doc/sheets/quartic.nevh doc/sheets/schemes.nevh
	$(AM_V_GEN)$(sheet_to_html) $(srcdir)/doc/sheets/sheets.texi
doc/nevh-answers.html: doc/sheets/answers.texi doc/sheets/numbers.texi
	$(AM_V_GEN)$(sheet_to_html) $(srcdir)/doc/sheets/answers.texi

# The manual as pages, with the pictures of its commands: doc/nevh-site/index.html.
EXTRA_DIST += doc/site/site.sh doc/site/site.css doc/site/search.js doc/site/search.awk \
	doc/site/pictures.awk doc/site/head.html doc/site/top.html
site: all $(srcdir)/doc/version.texi
	MAKEINFO="$(MAKEINFO)" MAKEINFOFLAGS="$(AM_MAKEINFOFLAGS) $(MAKEINFOFLAGS)" \
	  $(SHELL) $(srcdir)/doc/site/site.sh $(srcdir) tools/nevh$(EXEEXT) doc/nevh-site
.PHONY: site
clean-local: clean-site
clean-site:
	rm -rf doc/nevh-site
.PHONY: clean-site
sheets-numbers: all
	$(run_sheets) write
.PHONY: sheets sheets-numbers

# What the manual and the README quote, made anew.
EXTRA_PROGRAMS += doc/catalogue
doc_catalogue_LDADD = libnevh.la
figures: all bench/verdicts$(EXEEXT) doc/catalogue$(EXEEXT)
	$(SHELL) $(srcdir)/doc/figures.sh $(srcdir) ./tools/nevh$(EXEEXT) examples
	doc/catalogue >$(srcdir)/doc/catalogue.texi
