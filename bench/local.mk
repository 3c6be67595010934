# Programs that make check builds, so that they compile, and only make bench
# runs.  Results are of one machine: they stay in the build tree.
check_PROGRAMS += bench/gradient
bench_gradient_SOURCES = bench/gradient.c $(gradient_systems)
bench_gradient_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/examples
bench_gradient_LDADD = libnevh.la
check_PROGRAMS += bench/tape
bench_tape_LDADD = libnevh_core.la
check_PROGRAMS += bench/scenes
bench_scenes_LDADD = libnevh.la
check_PROGRAMS += bench/native
bench_native_CFLAGS = $(AM_CFLAGS) -O3 -march=native
bench_native_LDADD = libnevh.la
# Instructions, which do not depend on load: COUNTS=FILE compares with an
# earlier table, SCHEMES='NAME ...' counts those alone.
check_PROGRAMS += bench/counts
bench_counts_LDADD = libnevh.la
bench_counts_LDFLAGS = -static-libtool-libs
EXTRA_DIST += bench/counts.sh bench/python.py bench/marks.py bench/page.mjs
CLEANFILES += bench/counts$(EXEEXT) bench/results-counts.csv

bench-counts: bench/counts$(EXEEXT)
	$(SHELL) $(srcdir)/bench/counts.sh ./bench/counts$(EXEEXT) \
	  bench/results-counts.csv "$(COUNTS)" $(SCHEMES)

# Brouwer's law over a million periods: minutes.
check_PROGRAMS += bench/brouwer
bench_brouwer_LDADD = libnevh.la
CLEANFILES += bench/brouwer$(EXEEXT)
bench-brouwer: bench/brouwer$(EXEEXT)
	./bench/brouwer$(EXEEXT)

# How often the intervals of nevh fit hold the truth.
EXTRA_DIST += bench/fit.sh bench/walk.sh
bench-fit: all
	$(SHELL) $(srcdir)/bench/fit.sh ./tools/nevh$(EXEEXT) \
	  examples/add_noise$(EXEEXT) 400

# What it judges with is the command's own, all but its main.
check_PROGRAMS += bench/verdicts
bench_verdicts_SOURCES = bench/verdicts.c bench/verdicts_private.h \
	bench/verdicts_run.c bench/verdicts_label.c
bench_verdicts_CPPFLAGS = $(AM_CPPFLAGS) -D_GNU_SOURCE
bench_verdicts_LDADD = $(tools_nevh_OBJECTS:tools/nevh-nevh.o=) libnevh.la $(GSL_LIBS)
bench_verdicts_DEPENDENCIES = $(tools_nevh_OBJECTS) libnevh.la
CLEANFILES += bench/gradient$(EXEEXT) bench/results-gradient.csv \
	bench/tape$(EXEEXT) bench/scenes$(EXEEXT) bench/native$(EXEEXT)

# nevh's peers are used where they are found, and never needed: a script tries.
# bench/RESULTS.md is a copy of results-peers.md, from a machine at rest.
peers = bench/peers
EXTRA_DIST += bench/RESULTS.md $(peers)/build $(peers)/paper.py $(peers)/problems.h \
	$(peers)/problems.c $(peers)/peer.h $(peers)/bench.h $(peers)/peers.c \
	$(peers)/measure.c $(peers)/results.c $(peers)/nevh_systems.h \
	$(peers)/nevh_systems.c $(peers)/nevh_peer.c $(peers)/gsl_peer.c \
	$(peers)/boost_peer.cpp $(peers)/sundials_peer.c $(peers)/scipy_peer.c
PEERS_ROUNDS = 9
CLEANFILES += bench/results-peers.csv bench/results-peers.md
clean-local: clean-python
	rm -rf tests/cache
	rm -rf $(peers)/*.o $(peers)/.libs $(peers)/peers $(peers)/empty* \
	  $(peers)/circumstances.h $(peers)/build.log

bench-peers: libnevh.la
	@commit=`git -C $(srcdir) describe --always --dirty 2>/dev/null`; \
	CC="$(CC)" CXX="$${CXX:-c++}" CFLAGS="$(CFLAGS) -ffp-contract=off" \
	STD=-std=c11 CPPFLAGS="-I$(top_srcdir)/include $(GSL_CFLAGS)" \
	GSL_LIBS="$(GSL_LIBS)" PYTHON="$${PYTHON:-python3}" \
	LIBTOOL="$(SHELL) ./libtool" \
	  $(SHELL) $(srcdir)/$(peers)/build $(srcdir) "$${commit:-unknown}" && \
	PYTHON="$${PYTHON:-python3}" NEVH_BENCH_PY=$(srcdir)/$(peers)/paper.py \
	  $(peers)/peers bench/results-peers.csv bench/results-peers.md \
	  $(PEERS_ROUNDS)

bench: bench/gradient$(EXEEXT) bench/tape$(EXEEXT) bench/scenes$(EXEEXT) \
  bench-peers
	@commit=`git -C $(srcdir) describe --always --dirty 2>/dev/null`; \
	./bench/gradient$(EXEEXT) "$${commit:-unknown}" \
	  bench/results-gradient.csv && \
	./bench/tape$(EXEEXT) "$${commit:-unknown}" && \
	./bench/scenes$(EXEEXT) $(srcdir)/scenes/*.nevh

bench-recommend: tools/nevh$(EXEEXT)
	NEVH_SCENES=$(srcdir)/scenes $(SHELL) $(srcdir)/bench/recommend.sh \
	  ./tools/nevh$(EXEEXT)
	NEVH_SCENES=$(srcdir)/scenes $(SHELL) $(srcdir)/bench/answers.sh \
	  ./tools/nevh$(EXEEXT) >bench/results-answers.csv; \
	  tail -n 4 bench/results-answers.csv

# Wrong and undecided rows are listed in bench/wrong-verdicts, long runs kept in
# bench/long-runs, to be removed where schemes changed.  LISTS= takes others.
SHARE = 0.35
LISTS = $(srcdir)/bench/orbits/list $(srcdir)/bench/textbook/list \
	$(srcdir)/bench/blind/list
bench-verdicts: bench/verdicts$(EXEEXT)
	./bench/verdicts$(EXEEXT) -s $(SHARE) -o bench/wrong-verdicts \
	  -r bench/long-runs $(srcdir) $(LISTS)

# Two threads, and two ranks, against one.
bench-speedup: all
	NEVH_SCENES=$(srcdir)/scenes $(SHELL) $(srcdir)/bench/speedup.sh \
	  ./tools/nevh$(EXEEXT) \
	  `test -x tools/nevh-mpi$(EXEEXT) && echo ./tools/nevh-mpi$(EXEEXT)`

# What sweeps, sections and flow are promised to do: ten minutes.
bench-ensembles: all
	NEVH_SCENES=$(srcdir)/scenes python3 -B $(srcdir)/bench/ensembles.py \
	  ./tools/nevh$(EXEEXT) \
	  `test -x tools/nevh-mpi$(EXEEXT) && echo ./tools/nevh-mpi$(EXEEXT)`

# What references, exponents and frequencies are promised to be: ten minutes.
bench-certain: all
	NEVH_SCENES=$(srcdir)/scenes python3 -B $(srcdir)/bench/certain.py \
	  ./tools/nevh$(EXEEXT)

# Whether nevh check warns of runs that go wrong, and of no others: half an hour.
bench-warnings: all
	NEVH_SCENES=$(srcdir)/scenes $(SHELL) $(srcdir)/bench/warnings.sh \
	  ./tools/nevh$(EXEEXT) $(srcdir)

# Members that differ in a constant of H, against those that start elsewhere.
bench-lanes: all
	NEVH_SCENES=$(srcdir)/scenes $(SHELL) $(srcdir)/bench/lanes.sh \
	  ./tools/nevh$(EXEEXT)

# Whether states are the same bits however they are made: hours, or SCHEMES=, FORMS=.
bench-hashes: all
	NEVH_SCENES=$(srcdir)/scenes $(SHELL) $(srcdir)/bench/hashes.sh \
	  ./tools/nevh$(EXEEXT)

EXTRA_DIST += bench/hashes.sh bench/ensembles.py bench/promises.py bench/certain.py bench/lanes.sh bench/parts.sh bench/parts bench/speedup.sh bench/recommend.sh bench/answers.sh bench/integrable.sh bench/exponents.sh bench/exponents bench/warnings.sh bench/orbits bench/textbook \
	bench/blind bench/kinks
CLEANFILES += bench/results-answers.csv bench/verdicts$(EXEEXT) bench/wrong-verdicts
DISTCLEANFILES = bench/long-runs
.PHONY: bench bench-brouwer bench-certain bench-ensembles bench-fit bench-counts bench-hashes bench-lanes bench-peers bench-recommend bench-warnings bench-speedup \
  bench-verdicts
