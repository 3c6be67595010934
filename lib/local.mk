# Every object is in libnevh_core.la.  libnevh.la is all of it with only
# NEVH_API visible; tests that look inside link libnevh_core.la itself.
noinst_LTLIBRARIES += libnevh_core.la
libnevh_core_la_LIBADD = $(GSL_LIBS) $(QUADMATH_LIBS)
libnevh_core_la_SOURCES = \
	lib/system/system_private.h \
	lib/system/vector_private.h \
	lib/system/status.c \
	lib/system/memory.c \
	lib/system/register.c \
	lib/system/system.c \
	lib/system/friction.c \
	lib/system/term_values.c \
	lib/system/closeness.c \
	lib/system/probe_private.h \
	lib/system/probe.c \
	lib/system/masses.c \
	lib/system/kinetic.c \
	lib/system/kinetic_time.c \
	lib/system/motion_private.h \
	lib/system/normal_mode.c \
	lib/system/swing.c \
	lib/system/ellipse.c \
	lib/gradient/field_private.h \
	lib/gradient/block_private.h \
	lib/gradient/scatter_map_private.h \
	lib/gradient/evaluation_private.h \
	lib/gradient/step_selection_private.h \
	lib/gradient/methods.c \
	lib/gradient/plan.c \
	lib/gradient/step_selection.c \
	lib/gradient/lengths.c \
	lib/gradient/control_private.h \
	lib/gradient/control.c \
	lib/gradient/pilot.c \
	lib/gradient/step_scan.c \
	lib/gradient/complex.c \
	lib/gradient/report.c \
	lib/gradient/findings.c \
	lib/gradient/verify.c \
	lib/gradient/scatter_map.c \
	lib/gradient/field.c \
	lib/gradient/exact_gather.c \
	lib/gradient/block.c \
	lib/gradient/evaluation.c \
	lib/gradient/central_block.c \
	lib/gradient/stencil_private.h \
	lib/gradient/stencil_plan.c \
	lib/gradient/central_stencil.c \
	lib/gradient/exact_block.c \
	lib/gradient/exact_point.c \
	lib/gradient/value.c \
	lib/gradient/time.c \
	lib/gradient/gsl_system.c \
	lib/expression/tape_private.h \
	lib/expression/tape_inside_private.h \
	lib/expression/tape_operations_private.h \
	lib/expression/tape.c \
	lib/expression/tape_build.c \
	lib/expression/tape_rules.c \
	lib/expression/tape_finish.c \
	lib/expression/tape_value.c \
	lib/expression/tape_block.c \
	lib/expression/tape_along.c \
	lib/expression/tape_gradient.c \
	lib/expression/tape_complex.c \
	lib/expression/tape_special.c \
	lib/expression/kepler.c \
	lib/expression/formula_private.h \
	lib/expression/formula_inside_private.h \
	lib/expression/pool.c \
	lib/expression/character.c \
	lib/expression/formula_error.c \
	lib/expression/token.c \
	lib/expression/function.c \
	lib/expression/parse.c \
	lib/expression/refuse.c \
	lib/expression/head.c \
	lib/expression/names.c \
	lib/expression/suggest.c \
	lib/expression/resolve_private.h \
	lib/expression/resolve.c \
	lib/expression/meaning.c \
	lib/expression/expression.c \
	lib/expression/evaluate.c \
	lib/expression/variables.c \
	lib/expression/split.c \
	lib/expression/typeset.c \
	lib/expression/walk.c \
	lib/expression/instance.c \
	lib/expression/formula.c \
	lib/taylor/graph_private.h \
	lib/taylor/graph.c \
	lib/taylor/derive.c \
	lib/taylor/series_private.h \
	lib/taylor/series_text.h \
	lib/taylor/schedule.c \
	lib/taylor/series_double.c \
	lib/taylor/series_quad.c \
	lib/taylor/series_long.c \
	lib/taylor/orbit_private.h \
	lib/taylor/orbit_text.h \
	lib/taylor/quad_orbit.c \
	lib/taylor/long_orbit.c \
	lib/taylor/certain.c \
	lib/work/work_private.h \
	lib/work/work.c \
	lib/work/substeps.c \
	lib/work/transform_private.h \
	lib/work/transform.c \
	lib/work/ledger_private.h \
	lib/work/ledger.c \
	lib/implicit/implicit_private.h \
	lib/implicit/stage_progress.h \
	lib/implicit/stage_judge.h \
	lib/implicit/fixed_point.c \
	lib/implicit/judge.c \
	lib/implicit/newton.c \
	lib/implicit/factor.c \
	lib/implicit/rescue.c \
	lib/native/native_private.h \
	lib/native/compiler_private.h \
	lib/native/compiler.c \
	lib/native/writer_private.h \
	lib/native/writer.c \
	lib/native/formula_text.c \
	lib/native/slope_text.c \
	lib/native/prelude_text.c \
	lib/native/steps_text.c \
	lib/native/splitting_text.c \
	lib/native/runge_kutta_text.c \
	lib/native/nystrom_text.c \
	lib/native/stage_text.c \
	lib/native/noise_text.c \
	lib/native/taylor_text.c \
	lib/native/program_text.c \
	lib/native/cache.c \
	lib/native/build.c \
	lib/native/native.c \
	lib/run/stepper_private.h \
	lib/run/structure.c \
	lib/run/stepper.c \
	lib/run/friction_step.c \
	lib/run/save.c \
	lib/run/run.c \
	lib/run/branch_private.h \
	lib/run/branch.c \
	lib/run/until.c \
	lib/run/run_at.c \
	lib/run/section_private.h \
	lib/run/section.c \
	lib/run/section_branch.c \
	lib/run/section_turn.c \
	lib/run/section_level.c \
	lib/diagnose/energy_private.h \
	lib/diagnose/energy.c \
	lib/diagnose/trend_private.h \
	lib/diagnose/trend.c \
	lib/diagnose/verdict.c \
	lib/diagnose/symplecticity.c \
	lib/diagnose/exact_private.h \
	lib/diagnose/exact.c \
	lib/diagnose/recognise.c \
	lib/diagnose/reference_private.h \
	lib/diagnose/reference.c \
	lib/diagnose/reference_pair_private.h \
	lib/diagnose/reference_pair.c \
	lib/diagnose/reference_run.c \
	lib/diagnose/reference_watch.c \
	lib/diagnose/reference_spread.c \
	lib/diagnose/reference_series.c \
	lib/diagnose/reference_walk.c \
	lib/diagnose/state_error.c \
	lib/diagnose/stability.c \
	lib/diagnose/variational.c \
	lib/diagnose/chaos_private.h \
	lib/diagnose/chaos.c \
	lib/diagnose/chaos_walk.c \
	lib/diagnose/chaos_starts.c \
	lib/diagnose/chaos_report.c \
	lib/diagnose/chaos_crowd.c \
	lib/diagnose/shadow.c \
	lib/diagnose/rates.c \
	lib/diagnose/frequencies.c \
	lib/diagnose/loop_private.h \
	lib/diagnose/loop.c \
	lib/diagnose/loop_panel.c \
	lib/diagnose/loop_inside.c \
	lib/ensemble/random_private.h \
	lib/ensemble/random.c \
	lib/ensemble/ensemble_private.h \
	lib/ensemble/ensemble.c \
	lib/ensemble/lanes.c \
	lib/ensemble/observe.c \
	lib/ensemble/cross.c \
	lib/ensemble/event.c \
	lib/ensemble/chaotic.c \
	lib/scene/scene_private.h \
	lib/scene/equation.c \
	lib/scene/lines.c \
	lib/scene/piece.c \
	lib/scene/message.c \
	lib/scene/values.c \
	lib/scene/coordinates.c \
	lib/scene/elements.c \
	lib/scene/scene_formula.c \
	lib/scene/shown.c \
	lib/scene/values_shown.c \
	lib/scene/scene_section.c \
	lib/scene/scene_system.c \
	lib/scene/scene_friction.c \
	lib/scene/scene_run.c \
	lib/scene/velocity.c \
	lib/scene/start.c \
	lib/scene/access.c \
	lib/scene/write.c \
	lib/scene/code_private.h \
	lib/scene/code.c \
	lib/scene/code_term.c \
	lib/scene/scene_ensemble_private.h \
	lib/scene/scene_ensemble.c \
	lib/scene/scene_outcome.c \
	lib/scene/sweep_private.h \
	lib/scene/variant.c \
	lib/scene/variant_alike.c \
	lib/scene/solve.c \
	lib/scene/sweep.c \
	lib/scene/sweep_keep.c \
	lib/scene/binding.c \
	lib/scene/crew.c \
	lib/scene/member.c \
	lib/scene/scene.c

# The kernels' steps as text, for steps that are compiled: strings, line by line.
step_texts = integrators/kernels/splitting_step.h \
	lib/implicit/stage_progress.h \
	lib/implicit/stage_judge.h \
	integrators/kernels/stage_step.h \
	integrators/kernels/stage_sums_private.h \
	integrators/kernels/runge_kutta_step.h \
	integrators/kernels/nystrom_step.h
nodist_libnevh_core_la_SOURCES = lib/native/kernel_texts.c
lib/native/kernel_texts.c: lib/local.mk lib/native/kernel_texts.awk $(step_texts)
	$(MKDIR_P) lib/native
	cd $(srcdir) && $(AWK) -f lib/native/kernel_texts.awk $(step_texts) \
	  >$(abs_builddir)/$@.new && mv $(abs_builddir)/$@.new $(abs_builddir)/$@
EXTRA_DIST += lib/native/kernel_texts.awk
CLEANFILES += lib/native/kernel_texts.c

# -version-info C:R:A, at each release, beginning with that of the last one:
#   the library's code changed at all          R + 1
#   functions or data added, changed, removed  C + 1, R = 0
#   of these, some added, none changed         A + 1
#   of these, some changed or removed          A = 0
# 0.1.0  0:0:0
lib_LTLIBRARIES += libnevh.la
libnevh_la_SOURCES =
libnevh_la_LIBADD = libnevh_core.la
libnevh_la_LDFLAGS = -version-info 0:0:0 -no-undefined $(SANITIZE_FLAGS)
