# Check suites, one file each, tests/check_NAME.c.
suites = \
	tests/check_system \
	tests/check_structure \
	tests/check_gradient \
	tests/check_steps \
	tests/check_many_steps \
	tests/check_step_reports \
	tests/check_exact \
	tests/check_portable \
	tests/check_body \
	tests/check_point \
	tests/check_lanes \
	tests/check_one_orbit \
	tests/check_one_orbit_terms \
	tests/check_probe \
	tests/check_tape \
	tests/check_tape_build \
	tests/check_tape_terms \
	tests/check_formula \
	tests/check_formula_terms \
	tests/check_random_formulas \
	tests/check_scene \
	tests/check_scene_errors \
	tests/check_scene_write \
	tests/check_scene_effects \
	tests/check_shipped \
	tests/check_scene_shown \
	tests/check_registry \
	tests/check_coefficients \
	tests/check_masses \
	tests/check_nystrom \
	tests/check_splitting \
	tests/check_published \
	tests/check_trees \
	tests/check_order \
	tests/check_reversal \
	tests/check_symplecticity \
	tests/check_drift \
	tests/check_stability \
	tests/check_energy_preserving \
	tests/check_evaluations \
	tests/check_run \
	tests/check_until \
	tests/check_section \
	tests/check_closeness \
	tests/check_transform \
	tests/check_own_time \
	tests/check_eccentric \
	tests/check_energy \
	tests/check_verdict \
	tests/check_grid \
	tests/check_friction \
	tests/check_damped_orbits \
	tests/check_damped_steps \
	tests/check_balance \
	tests/check_ledger \
	tests/check_time_slope \
	tests/check_models \
	tests/check_reference \
	tests/check_state_error \
	tests/check_reference_end \
	tests/check_failures \
	tests/check_hard_steps \
	tests/check_hard \
	tests/check_hard_pendulum \
	tests/check_hard_judge \
	tests/check_implicit \
	tests/check_stiff \
	tests/check_brouwer \
	tests/check_threads \
	tests/check_adaptive \
	tests/check_damped \
	tests/check_tao \
	tests/check_gsl
TEST_LIBS = tests/libsupport.la libnevh.la $(CHECK_LIBS)
# These look inside, so they link what is not visible in libnevh.la.
INSIDE_LIBS = tests/libsupport.la libnevh_core.la $(CHECK_LIBS)
tests_check_random_formulas_LDADD = $(INSIDE_LIBS) $(MUPARSER_LIBS)
tests_check_random_formulas_CPPFLAGS = $(AM_CPPFLAGS) $(MUPARSER_CFLAGS)
tests_check_coefficients_LDADD = $(INSIDE_LIBS)
tests_check_splitting_LDADD = $(INSIDE_LIBS)
tests_check_damped_LDADD = $(INSIDE_LIBS)
tests_check_brouwer_LDADD = $(INSIDE_LIBS)
tests_check_implicit_LDADD = $(INSIDE_LIBS)
tests_check_tao_LDADD = $(INSIDE_LIBS)
tests_check_time_slope_LDADD = $(INSIDE_LIBS)
tests_check_transform_LDADD = $(INSIDE_LIBS)
tests_check_tape_LDADD = $(INSIDE_LIBS)
tests_check_tape_build_LDADD = $(INSIDE_LIBS)
tests_check_tape_terms_LDADD = $(INSIDE_LIBS)
tests_check_formula_LDADD = $(INSIDE_LIBS)
tests_check_formula_terms_LDADD = $(INSIDE_LIBS)
tests_check_hard_pendulum_LDADD = $(TEST_LIBS) $(GSL_LIBS)
tests_check_grid_SOURCES = tests/check_grid.c tools/grid.c
tests_check_hard_judge_SOURCES = tests/check_hard_judge.c \
	tools/hard_private.h \
	tools/hard_cases.c \
	tools/hard_subject.c \
	tools/hard_state.c \
	tools/hard_run.c \
	tools/hard_judge.c \
	tools/stability.c \
	tools/words.c
tests_check_hard_judge_CPPFLAGS = $(AM_CPPFLAGS) -D_GNU_SOURCE
tests_check_gsl_LDADD = $(TEST_LIBS) $(GSL_LIBS)
tests_check_damped_orbits_LDADD = $(TEST_LIBS) $(GSL_LIBS)
tests_check_threads_CFLAGS = $(AM_CFLAGS) -pthread
tests_check_threads_LDFLAGS = $(AM_LDFLAGS) -pthread

check_PROGRAMS = tests/steps tests/steps_of tests/forge
tests_forge_CPPFLAGS = $(AM_CPPFLAGS) -D_GNU_SOURCE
tests_steps_LDADD = libnevh.la
tests_steps_of_LDADD = libnevh.la
check_LTLIBRARIES =
if HAVE_CHECK
check_PROGRAMS += $(suites)
check_LTLIBRARIES += tests/libsupport.la
tests_libsupport_la_SOURCES = tests/support.c tests/support.h \
	tests/damped.h tests/driven.h tests/state.h \
	tests/hard.h
if HAVE_WRAP
memory_suite = tests/check_memory
check_PROGRAMS += $(memory_suite)
tests_check_memory_LDADD = $(INSIDE_LIBS)
tests_check_memory_LDFLAGS = $(AM_LDFLAGS) \
	-Wl,--wrap=malloc -Wl,--wrap=calloc -Wl,--wrap=realloc
endif
all_suites = $(suites) $(memory_suite)
endif

# What nevh hard runs, beside the scenes.
harddir = $(pkgdatadir)/hard
dist_hard_DATA = \
	tests/hard/double-pendulum.nevh \
	tests/hard/earth.nevh \
	tests/hard/edge.nevh \
	tests/hard/elastic-pendulum.nevh \
	tests/hard/fput.nevh \
	tests/hard/head-on.nevh \
	tests/hard/henon-heiles.nevh \
	tests/hard/kepler.nevh \
	tests/hard/kink.nevh \
	tests/hard/late-start.nevh \
	tests/hard/magnetic-mirror.nevh \
	tests/hard/molecule.nevh \
	tests/hard/offset.nevh \
	tests/hard/outer-planets.nevh \
	tests/hard/pendulum-modulus.nevh \
	tests/hard/pythagorean.nevh \
	tests/hard/resonance.nevh \
	tests/hard/schwarzschild.nevh \
	tests/hard/swinging-atwood.nevh \
	tests/hard/toda.nevh \
	tests/hard/uniform-field.nevh

dist_check_SCRIPTS = \
	tests/symbols.sh \
	tests/fuzz_compiles.sh \
	tests/cplusplus.sh \
	tests/examples.sh \
	tests/nevh.sh \
	tests/nevh_scenes.sh \
	tests/nevh_help.sh \
	tests/nevh_start.sh \
	tests/quickstart.sh \
	tests/bad_scenes.sh \
	tests/completion.sh \
	tests/nevh_new.sh \
	tests/nevh_effects.sh \
	tests/nevh_compare.sh \
	tests/nevh_reference.sh \
	tests/nevh_verdict.sh \
	tests/nevh_plot.sh \
	tests/nevh_section.sh \
	tests/nevh_run.sh \
	tests/nevh_code.sh \
	tests/nevh_memory.sh \
	tests/nevh_files.sh \
	tests/nevh_units.sh \
	tests/nevh_check.sh \
	tests/nevh_hard.sh \
	tests/nevh_cost.sh \
	tests/nevh_recommend.sh \
	tests/pkgconfig.sh \
	tests/install.sh \
	tests/effects_off.sh \
	tests/valgrind.sh

EXTRA_DIST += tests/outside.c tests/interrupt.c tests/starve.c tests/formula.h tests/scene.h tests/shipped.h \
	tests/nevh_support.sh tests/nevh_interrupt.sh tests/bad tests/fuzz

TESTS = $(all_suites) $(dist_check_SCRIPTS)
TEST_EXTENSIONS = .sh
SH_LOG_COMPILER = $(SHELL)

# Tests with the tag slow are for make check-slow; make check-valgrind leaves out
# those with the tag long as well, which take orbits that others take, too.
CHECK_TAGS = CK_EXCLUDE_TAGS
# Seconds; ten times what a busy machine takes, since only a hang should meet it.
TEST_TIMEOUT = 600
AM_TESTS_ENVIRONMENT = \
	$(CHECK_TAGS)=slow; export $(CHECK_TAGS); \
	CK_DEFAULT_TIMEOUT=$(TEST_TIMEOUT); export CK_DEFAULT_TIMEOUT; \
	CC='$(CC)'; export CC; \
	NM='$(NM)'; export NM; \
	LIBTOOL='$(LIBTOOL)'; export LIBTOOL; \
	PKG_CONFIG='$(PKG_CONFIG)'; export PKG_CONFIG; \
	PKG_CONFIG_PATH='$(PKG_CONFIG_PATH)'; export PKG_CONFIG_PATH; \
	GSL_CFLAGS='$(GSL_CFLAGS)'; export GSL_CFLAGS; \
	GSL_LIBS='$(GSL_LIBS)'; export GSL_LIBS; \
	SANITIZE_FLAGS='$(SANITIZE_FLAGS)'; export SANITIZE_FLAGS; \
	EXAMPLES='$(examples)'; export EXAMPLES;

check-local:
if !HAVE_CHECK
	@echo "*** The Check suites were SKIPPED: Check >= 0.15 was not found" \
	  "when nevh was configured."
endif

# For ./quickstart, which shows how many have run.
count-tests:
	@set -- $(TESTS); echo $$#

check-slow:
	$(MAKE) $(AM_MAKEFLAGS) check TESTS='$(all_suites)' \
	  CHECK_TAGS=CK_INCLUDE_TAGS TEST_TIMEOUT=3600
	NEVH_SCENES='$(srcdir)/scenes' tools/nevh hard --quiet
	$(MAKE) $(AM_MAKEFLAGS) bench/verdicts$(EXEEXT)
	bench/verdicts$(EXEEXT) -s 0.1 -w 0.1 $(srcdir)
	$(MAKE) $(AM_MAKEFLAGS) fuzz FUZZ_SECONDS=60

# With clang; 77 is for what cannot be run here.
FUZZ_SECONDS = 1800
fuzz:
	srcdir=$(srcdir) GSL_CFLAGS='$(GSL_CFLAGS)' GSL_LIBS='$(GSL_LIBS)' \
	  $(SHELL) $(srcdir)/tests/fuzz/run.sh $(FUZZ_SECONDS) || test $$? = 77

VALGRIND = valgrind -q --leak-check=full --error-exitcode=9
check-valgrind: all $(check_LTLIBRARIES) $(check_PROGRAMS)
	@failed=; for suite in $(all_suites); do \
	  srcdir='$(srcdir)' CK_FORK=no CK_EXCLUDE_TAGS='slow long' \
	  $(LIBTOOL) --mode=execute \
	    $(VALGRIND) ./$$suite || failed="$$failed $$suite"; \
	done; \
	test -z "$$failed" || { echo "failed under valgrind:$$failed"; exit 1; }

.PHONY: count-tests check-slow check-valgrind fuzz
