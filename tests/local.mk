# Check suites, one file each, tests/FOLDER/check_NAME.c; the longest first, here and among
# the scripts, so that no core waits for one at the end.
suites = \
	tests/native/check_native \
	tests/hard/check_hard_cases \
	tests/scheme/check_order \
	tests/robust/check_hard \
	tests/system/check_system \
	tests/system/check_structure \
	tests/gradient/check_gradient \
	tests/gradient/check_steps tests/gradient/check_rest \
	tests/gradient/check_many_steps tests/gradient/check_joined \
	tests/gradient/check_step_reports \
	tests/gradient/check_exact \
	tests/gradient/check_portable \
	tests/system/check_body \
	tests/gradient/check_point \
	tests/gradient/check_lanes \
	tests/gradient/check_same_bits \
	tests/system/check_probe \
	tests/expression/check_tape \
	tests/expression/check_tape_build \
	tests/expression/check_operations \
	tests/expression/check_range \
	tests/expression/check_elementary \
	tests/expression/check_timing \
	tests/expression/check_tape_terms \
	tests/expression/check_formula \
	tests/expression/check_formula_extremes \
	tests/expression/check_formula_terms \
	tests/expression/check_random_formulas \
	tests/expression/check_random_terms \
	tests/taylor/check_series \
	tests/taylor/check_taylor \
	tests/taylor/check_compiled \
	tests/taylor/check_domain \
	tests/taylor/check_reach \
	tests/taylor/check_certain \
	tests/scene/check_scene \
	tests/scene/check_scene_errors \
	tests/scene/check_scene_write \
	tests/scene/check_scene_effects \
	tests/scene/check_shipped \
	tests/scene/check_scene_shown \
	tests/scene/check_velocities tests/scene/check_elements \
	tests/scene/check_equation \
	tests/scene/check_scene_integrators \
	tests/scheme/check_registry \
	tests/scheme/check_coefficients \
	tests/system/check_masses \
	tests/scheme/check_nystrom \
	tests/scheme/check_splitting \
	tests/scheme/check_parts \
	tests/scheme/check_respa \
	tests/scheme/check_kepler_flow \
	tests/scheme/check_hierarchy \
	tests/scheme/check_published \
	tests/scheme/check_trees \
	tests/scheme/check_reversal \
	tests/scheme/check_symplecticity \
	tests/scheme/check_drift \
	tests/scheme/check_stability \
	tests/scheme/check_energy_preserving \
	tests/scheme/check_evaluations \
	tests/native/check_loops \
	tests/native/check_native_cache \
	tests/native/check_compilers \
	tests/run/check_run \
	tests/run/check_until \
	tests/run/check_run_at \
	tests/run/check_section \
	tests/run/check_section_orbits \
	tests/ensemble/check_random \
	tests/ensemble/check_ensemble \
	tests/ensemble/check_ensemble_chaos \
	tests/ensemble/check_sweep \
	tests/system/check_closeness \
	tests/run/check_transform \
	tests/scheme/check_own_time \
	tests/scheme/check_eccentric \
	tests/diagnose/check_energy \
	tests/diagnose/check_chaos \
	tests/diagnose/check_confirm \
	tests/diagnose/check_shadow \
	tests/diagnose/check_kinks \
	tests/diagnose/check_verdict \
	tests/diagnose/check_loop \
	tests/diagnose/check_frequencies \
	tests/tool/check_grid \
	tests/tool/check_plot_thin \
	tests/system/check_friction \
	tests/run/check_damped_orbits \
	tests/run/check_damped_steps \
	tests/run/check_balance \
	tests/run/check_ledger \
	tests/gradient/check_time_slope \
	tests/system/check_models \
	tests/system/check_models_exact \
	tests/diagnose/check_reference \
	tests/diagnose/check_reference_runs \
	tests/diagnose/check_state_error \
	tests/diagnose/check_reference_end \
	tests/diagnose/check_reference_time \
	tests/robust/check_failures \
	tests/robust/check_null \
	tests/robust/check_traps \
	tests/robust/check_hard_steps \
	tests/robust/check_hard_pendulum \
	tests/scheme/check_implicit \
	tests/scheme/check_stiff \
	tests/scheme/check_brouwer \
	tests/robust/check_threads \
	tests/scheme/check_adaptive \
	tests/scheme/check_adaptive_ends \
	tests/scheme/check_damped \
	tests/scheme/check_tao \
	tests/scheme/check_gsl
TEST_LIBS = tests/support/libsupport.la libnevh.la $(CHECK_LIBS)
# These look inside, so they link what is not visible in libnevh.la.
INSIDE_LIBS = tests/support/libsupport.la libnevh_core.la $(CHECK_LIBS)
tests_expression_check_random_formulas_LDADD = $(INSIDE_LIBS) $(MUPARSER_LIBS)
tests_expression_check_random_formulas_CPPFLAGS = $(AM_CPPFLAGS) $(MUPARSER_CFLAGS)
tests_scheme_check_coefficients_LDADD = $(INSIDE_LIBS)
tests_native_check_loops_LDADD = $(INSIDE_LIBS)
tests_native_check_native_LDADD = $(INSIDE_LIBS)
tests_native_check_native_cache_LDADD = $(INSIDE_LIBS)
tests_native_check_compilers_LDADD = $(INSIDE_LIBS)
tests_scheme_check_splitting_LDADD = $(INSIDE_LIBS)
tests_scheme_check_parts_LDADD = $(INSIDE_LIBS)
tests_scheme_check_kepler_flow_LDADD = $(INSIDE_LIBS)
tests_scheme_check_hierarchy_LDADD = $(INSIDE_LIBS)
tests_scheme_check_trees_LDADD = $(INSIDE_LIBS)
tests_scheme_check_damped_LDADD = $(INSIDE_LIBS)
tests_scheme_check_brouwer_LDADD = $(INSIDE_LIBS)
tests_scheme_check_implicit_LDADD = $(INSIDE_LIBS)
tests_scheme_check_tao_LDADD = $(INSIDE_LIBS)
tests_gradient_check_time_slope_LDADD = $(INSIDE_LIBS)
tests_run_check_transform_LDADD = $(INSIDE_LIBS)
tests_expression_check_tape_LDADD = $(INSIDE_LIBS)
tests_expression_check_operations_LDADD = $(INSIDE_LIBS)
tests_expression_check_range_LDADD = $(INSIDE_LIBS)
tests_expression_check_tape_build_LDADD = $(INSIDE_LIBS)
tests_expression_check_tape_terms_LDADD = $(INSIDE_LIBS)
tests_taylor_check_series_LDADD = $(INSIDE_LIBS)
tests_expression_check_formula_LDADD = $(INSIDE_LIBS)
tests_expression_check_formula_terms_LDADD = $(INSIDE_LIBS)
tests_expression_check_formula_extremes_LDADD = $(INSIDE_LIBS)
tests_expression_check_random_terms_LDADD = $(INSIDE_LIBS)
tests_robust_check_hard_pendulum_LDADD = $(TEST_LIBS) $(GSL_LIBS)
tests_tool_check_grid_SOURCES = tests/tool/check_grid.c tools/search/grid.c
tests_tool_check_plot_thin_CPPFLAGS = $(AM_CPPFLAGS) -D_GNU_SOURCE
tests_tool_check_plot_thin_SOURCES = tests/tool/check_plot_thin.c \
	tools/plot/plot_thin.c \
	tools/cli/memory.c \
	tools/cli/words.c
tests_hard_check_hard_cases_SOURCES = tests/hard/check_hard_cases.c \
	tests/hard/hard_judge.h \
	tests/hard/hard_known.c \
	tests/hard/hard_subject.c \
	tests/hard/hard_state.c \
	tests/hard/hard_run.c \
	tests/hard/hard_judge.c \
	tools/hard/hard_cases.h \
	tools/hard/hard_cases.c \
	tools/experiment/stability.c \
	tools/cli/memory.c \
	tools/cli/words.c
tests_hard_check_hard_cases_CPPFLAGS = $(AM_CPPFLAGS) -D_GNU_SOURCE
tests_ensemble_check_random_LDADD = $(INSIDE_LIBS)
tests_ensemble_check_sweep_LDADD = $(INSIDE_LIBS) $(GSL_LIBS)
tests_diagnose_check_frequencies_LDADD = $(TEST_LIBS) $(GSL_LIBS)
tests_scheme_check_gsl_LDADD = $(TEST_LIBS) $(GSL_LIBS)
tests_run_check_damped_orbits_LDADD = $(TEST_LIBS) $(GSL_LIBS)
tests_robust_check_threads_CFLAGS = $(AM_CFLAGS) -pthread
tests_robust_check_threads_LDFLAGS = $(AM_LDFLAGS) -pthread

check_PROGRAMS = tests/support/steps tests/support/steps_of tests/support/forge
tests_support_forge_CPPFLAGS = $(AM_CPPFLAGS) -D_GNU_SOURCE
tests_support_steps_LDADD = libnevh.la
tests_support_steps_of_LDADD = libnevh.la
check_LTLIBRARIES =
if HAVE_CHECK
check_PROGRAMS += $(suites)
check_LTLIBRARIES += tests/support/libsupport.la
tests_support_libsupport_la_SOURCES = tests/support/support.c tests/support/support.h \
	tests/support/problems.c tests/support/models.h tests/support/section.h \
	tests/support/adaptive.h tests/support/reference.h \
	tests/support/lanes.c tests/support/lanes.h \
	tests/support/damped.h tests/support/driven.h tests/support/state.h \
	tests/support/setting.h \
	tests/support/hard.h
if HAVE_WRAP
memory_suites = tests/robust/check_memory tests/robust/check_memory_scene
check_PROGRAMS += $(memory_suites)
wrap_flags = $(AM_LDFLAGS) -Wl,--wrap=malloc -Wl,--wrap=calloc -Wl,--wrap=realloc
tests_robust_check_memory_LDADD = $(INSIDE_LIBS)
tests_robust_check_memory_LDFLAGS = $(wrap_flags)
tests_robust_check_memory_scene_LDADD = $(INSIDE_LIBS)
tests_robust_check_memory_scene_LDFLAGS = $(wrap_flags)
endif
all_suites = $(suites) $(memory_suites)
endif

dist_check_SCRIPTS = \
	tests/tool/nevh_native.sh \
	tests/build/manual.sh \
	tests/tool/nevh_page_browser.sh \
	tests/tool/nevh_recommend.sh \
	tests/tool/nevh_verdict.sh \
	tests/python/python.sh \
	tests/build/sheets.sh \
	tests/tool/nevh_chaos.sh \
	tests/tool/nevh_compare.sh \
	tests/tool/nevh_at_once.sh \
	tests/build/examples.sh \
	tests/build/paper.sh \
	tests/robust/valgrind.sh \
	tests/robust/effects_off.sh \
	tests/tool/nevh_certain.sh \
	tests/native/step_headers.sh \
	tests/build/symbols.sh \
	tests/build/arrows.sh \
	tests/build/names.sh \
	tests/robust/fuzz_compiles.sh \
	tests/build/cplusplus.sh \
	tests/build/site.sh \
	tests/tool/nevh.sh \
	tests/tool/nevh_scenes.sh \
	tests/tool/nevh_sheet.sh \
	tests/tool/nevh_mark.sh \
	tests/tool/nevh_help.sh \
	tests/tool/nevh_looks.sh \
	tests/tool/nevh_commands.sh \
	tests/tool/nevh_start.sh \
	tests/build/quickstart.sh \
	tests/scene/bad_scenes.sh \
	tests/tool/completion.sh \
	tests/tool/nevh_new.sh \
	tests/tool/nevh_effects.sh \
	tests/tool/nevh_ends.sh \
	tests/tool/nevh_scales.sh \
	tests/tool/nevh_reference.sh \
	tests/tool/nevh_pictures.sh \
	tests/tool/nevh_plot.sh \
	tests/tool/nevh_plot_kinds.sh \
	tests/tool/nevh_section.sh \
	tests/tool/nevh_sweep.sh \
	tests/tool/nevh_flow.sh \
	tests/tool/nevh_frequencies.sh \
	tests/tool/nevh_fit.sh \
	tests/tool/nevh_fit_exact.sh \
	tests/tool/nevh_data.sh \
	tests/tool/nevh_report.sh \
	tests/tool/nevh_report_browser.sh \
	tests/tool/nevh_page.sh \
	tests/tool/nevh_page_lesson.sh \
	tests/tool/nevh_portrait.sh \
	tests/tool/nevh_map.sh \
	tests/tool/nevh_signals.sh \
	tests/tool/nevh_sweep_file.sh \
	tests/tool/nevh_sweep_mpi.sh \
	tests/tool/nevh_run.sh \
	tests/tool/nevh_code.sh \
	tests/tool/nevh_export.sh \
	tests/tool/nevh_export_rows.sh \
	tests/tool/nevh_constants.sh \
	tests/tool/nevh_memory.sh \
	tests/tool/nevh_files.sh \
	tests/tool/nevh_units.sh \
	tests/tool/nevh_integrators.sh tests/tool/nevh_check.sh tests/tool/nevh_warnings.sh \
	tests/tool/nevh_integrable.sh \
	tests/tool/nevh_time.sh \
	tests/tool/nevh_hard.sh \
	tests/tool/nevh_exit.sh \
	tests/tool/nevh_cost.sh \
	tests/tool/nevh_cost_length.sh \
	tests/python/notebook.sh \
	tests/python/wheel.sh \
	tests/build/pkgconfig.sh \
	tests/build/install.sh \
	tests/build/install_prefix.sh \
	tests/build/debian.sh

EXTRA_DIST += \
	tests/build/outside.c \
	tests/native/step_header.c \
	tests/python/commands.py \
	tests/python/hamiltonians.py \
	tests/python/module.py \
	tests/python/own.py \
	tests/python/programs.py \
	tests/python/same_states.py \
	tests/python/traced.py \
	tests/python/wrong_calls.py \
	tests/robust/fuzz \
	tests/robust/long_sweeps.sh \
	tests/scene/bad \
	tests/support/browser.mjs \
	tests/support/chromium.mjs \
	tests/support/constants.py \
	tests/support/firefox.mjs \
	tests/support/formula.h \
	tests/support/formula_terms.h \
	tests/support/interrupt.c \
	tests/support/memory.h \
	tests/support/native.h \
	tests/support/nevh_interrupt.sh \
	tests/support/nevh_command.sh \
	tests/support/nevh_support.sh \
	tests/support/rescale.awk \
	tests/support/scene.h \
	tests/support/shipped.h \
	tests/support/starve.c \
	tests/support/try_axe.mjs \
	tests/support/try_lesson.mjs \
	tests/support/try_page.mjs \
	tests/support/try_report.mjs \
	tests/support/websocket.mjs

TESTS = $(all_suites) $(dist_check_SCRIPTS)
# Scripts that build, install and package, which .ci/run has look at the tarball, too.
tarball_tests = \
	tests/build/install.sh \
	tests/build/install_prefix.sh \
	tests/build/pkgconfig.sh \
	tests/build/quickstart.sh \
	tests/build/symbols.sh \
	tests/python/wheel.sh \
	tests/tool/nevh.sh \
	tests/tool/nevh_scenes.sh
TEST_EXTENSIONS = .sh
SH_LOG_COMPILER = $(SHELL)

# Tests with the tag slow are for make check-slow; make check-valgrind leaves out
# those with the tag long as well, which take orbits that others take, too.
CHECK_TAGS = CK_EXCLUDE_TAGS
# Seconds; ten times what a busy machine takes, since only a hang should meet it.
TEST_TIMEOUT = 600
# Compiled steps are kept in tests/cache, or in $NEVH_TEST_CACHE, which several
# builds of one machine may share.
AM_TESTS_ENVIRONMENT = \
	$(CHECK_TAGS)=slow; export $(CHECK_TAGS); \
	CK_DEFAULT_TIMEOUT=$(TEST_TIMEOUT); export CK_DEFAULT_TIMEOUT; \
	CC='$(CC)'; export CC; \
	XDG_CACHE_HOME="$${NEVH_TEST_CACHE:-$$PWD/tests/cache}"; export XDG_CACHE_HOME; \
	NM='$(NM)'; export NM; \
	LIBTOOL='$(LIBTOOL)'; export LIBTOOL; \
	PKG_CONFIG='$(PKG_CONFIG)'; export PKG_CONFIG; \
	PKG_CONFIG_PATH='$(PKG_CONFIG_PATH)'; export PKG_CONFIG_PATH; \
	GSL_CFLAGS='$(GSL_CFLAGS)'; export GSL_CFLAGS; \
	GSL_LIBS='$(GSL_LIBS)'; export GSL_LIBS; \
	QUADMATH_LIBS='$(QUADMATH_LIBS)'; export QUADMATH_LIBS; \
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
	srcdir=$(srcdir) SLOW=yes $(SHELL) $(srcdir)/tests/build/manual.sh
	srcdir=$(srcdir) SLOW=yes $(SHELL) $(srcdir)/tests/tool/nevh_export_rows.sh
	srcdir=$(srcdir) SLOW=yes $(SHELL) $(srcdir)/tests/tool/nevh_recommend.sh
	srcdir=$(srcdir) SLOW=yes $(SHELL) $(srcdir)/tests/tool/nevh_native.sh
	srcdir=$(srcdir) SLOW=yes $(SHELL) $(srcdir)/tests/tool/nevh_memory.sh
	srcdir=$(srcdir) $(SHELL) $(srcdir)/tests/robust/long_sweeps.sh
	$(MAKE) $(AM_MAKEFLAGS) bench/verdicts$(EXEEXT)
	bench/verdicts$(EXEEXT) -s 0.1 -w 0.1 $(srcdir) $(LISTS)
	$(MAKE) $(AM_MAKEFLAGS) fuzz FUZZ_SECONDS=60

# With clang; 77 is for what cannot be run here.
FUZZ_SECONDS = 1800
fuzz: lib/native/kernel_texts.c
	srcdir=$(srcdir) GSL_CFLAGS='$(GSL_CFLAGS)' GSL_LIBS='$(GSL_LIBS)' \
	  $(SHELL) $(srcdir)/tests/robust/fuzz/run.sh $(FUZZ_SECONDS) || test $$? = 77

VALGRIND = valgrind -q --leak-check=full --error-exitcode=9
check-valgrind: all $(check_LTLIBRARIES) $(check_PROGRAMS)
	@failed=; for suite in $(all_suites); do \
	  srcdir='$(srcdir)' CK_FORK=no CK_EXCLUDE_TAGS='slow long' \
	  $(LIBTOOL) --mode=execute \
	    $(VALGRIND) ./$$suite || failed="$$failed $$suite"; \
	done; \
	test -z "$$failed" || { echo "failed under valgrind:$$failed"; exit 1; }

.PHONY: count-tests check-slow check-valgrind fuzz
