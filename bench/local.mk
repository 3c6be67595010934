# Programs that only make bench builds and runs.  Results are of one machine:
# they stay in the build tree.
EXTRA_PROGRAMS += bench/gradient
bench_gradient_SOURCES = bench/gradient.c $(gradient_systems)
bench_gradient_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/examples
bench_gradient_LDADD = libnevh.la
EXTRA_PROGRAMS += bench/tape
bench_tape_LDADD = libnevh_core.la
EXTRA_PROGRAMS += bench/scenes
bench_scenes_LDADD = libnevh.la
CLEANFILES += bench/gradient$(EXEEXT) bench/results-gradient.csv \
	bench/tape$(EXEEXT) bench/scenes$(EXEEXT)

bench: bench/gradient$(EXEEXT) bench/tape$(EXEEXT) bench/scenes$(EXEEXT)
	@commit=`git -C $(srcdir) describe --always --dirty 2>/dev/null`; \
	./bench/gradient$(EXEEXT) "$${commit:-unknown}" \
	  bench/results-gradient.csv && \
	./bench/tape$(EXEEXT) "$${commit:-unknown}" && \
	./bench/scenes$(EXEEXT) $(srcdir)/scenes/*.nevh

bench-recommend: tools/nevh$(EXEEXT)
	NEVH_SCENES=$(srcdir)/scenes $(SHELL) $(srcdir)/bench/recommend.sh \
	  ./tools/nevh$(EXEEXT)

EXTRA_DIST += bench/recommend.sh
.PHONY: bench bench-recommend
