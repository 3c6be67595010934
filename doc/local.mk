# The manual, and pages for man.
info_TEXINFOS = doc/nevh.texi
doc_nevh_TEXINFOS = \
	doc/compare-pendulum.txt \
	doc/cost-pendulum.txt \
	doc/recommend-pendulum.txt \
	doc/gradients-pendulum.txt \
	doc/hard.txt
AM_MAKEINFOHTMLFLAGS = --no-split
# Without TeX; make pdf needs it.
AM_DISTCHECK_DVI_TARGET = html

dist_man3_MANS = doc/nevh.3

# nevh(1) is what nevh --help says, and in tarballs.
if HAVE_PAGE
dist_man1_MANS = doc/nevh.1
MAINTAINERCLEANFILES = doc/nevh.1
doc/nevh.1: $(tools_nevh_SOURCES) doc/nevh.h2m configure.ac \
  | tools/nevh$(EXEEXT)
	$(AM_V_GEN)$(MKDIR_P) doc && \
	  $(HELP2MAN) --name 'compare symplectic integrators on a Hamiltonian' \
	    --include $(srcdir)/doc/nevh.h2m --output $@ ./tools/nevh$(EXEEXT)
endif
EXTRA_DIST += doc/nevh.h2m doc/figures.sh doc/hard.awk \
	doc/gradient-cost.txt doc/steps-that-follow.txt doc/nevh-cost.txt \
	doc/hard-all.txt

# What the manual and the README quote, made anew.
figures: all
	$(SHELL) $(srcdir)/doc/figures.sh $(srcdir) ./tools/nevh$(EXEEXT) examples
