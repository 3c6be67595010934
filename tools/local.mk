bin_PROGRAMS += tools/nevh
tools_nevh_SOURCES = \
	tools/cli/tool.h \
	tools/experiment/plan.h \
	tools/experiment/row.h \
	tools/experiment/trial_run.h \
	tools/nevh.c \
	tools/commands.c \
	tools/help.c \
	tools/cli/commands.h \
	tools/cli/options_private.h \
	tools/cli/options.c \
	tools/cli/arguments.c \
	tools/cli/memory.c \
	tools/cli/words.c \
	tools/cli/numbers.c \
	tools/cli/table_private.h \
	tools/cli/table.c \
	tools/cli/shell_line.c \
	tools/cli/output.c \
	tools/cli/outputs.c \
	tools/cli/scenes.c \
	tools/cli/sheet.c \
	tools/experiment/plan.c \
	tools/experiment/plan_stepper.c \
	tools/experiment/stop.c \
	tools/experiment/row.c \
	tools/experiment/row_list.c \
	tools/experiment/follow.c \
	tools/experiment/row_time.c \
	tools/experiment/stepper_cache.c \
	tools/experiment/row_notes.c \
	tools/experiment/conserved.h \
	tools/experiment/conserved.c \
	tools/experiment/time_words.c \
	tools/experiment/records.c \
	tools/search/study.h \
	tools/search/grid.c \
	tools/search/applicable.c \
	tools/search/search.c \
	tools/search/study.c \
	tools/search/cost_private.h \
	tools/search/cost.c \
	tools/search/cost_table.c \
	tools/search/cost_length.c \
	tools/search/cost_price.c \
	tools/search/cost_words.c \
	tools/search/recommend_private.h \
	tools/search/recommend_search.c \
	tools/search/recommend.c \
	tools/search/recommend_longer.c \
	tools/search/recommend_words.c \
	tools/search/gradients_private.h \
	tools/search/gradients.c \
	tools/search/gradients_along.c \
	tools/search/gradients_plot.c \
	tools/compare/compare.c \
	tools/compare/verdict.c tools/compare/verdict_longer.c tools/compare/verdict_private.h \
	tools/experiment/state.c \
	tools/experiment/observable.c \
	tools/experiment/energies.c \
	tools/experiment/match.c \
	tools/experiment/diagnostics.c \
	tools/experiment/shadow.c \
	tools/experiment/smoothness.c \
	tools/inspect/effects.c \
	tools/orbit/trajectory.h \
	tools/orbit/lines.c \
	tools/orbit/resume.c \
	tools/orbit/trajectory.c \
	tools/orbit/run.c \
	tools/orbit/export.c \
	tools/orbit/reference.c \
	tools/experiment/stability.c \
	tools/search/suggested_step.c \
	tools/experiment/trial_run.c \
	tools/hard/hard_cases.h \
	tools/hard/hard_cases.c \
	tools/hard/hard.c \
	tools/ensemble/store.h \
	tools/ensemble/store.c \
	tools/ensemble/store_holes.c tools/ensemble/store_record.c \
	tools/ensemble/ranks.h \
	tools/ensemble/ranks.c \
	tools/ensemble/sweep_private.h \
	tools/ensemble/sweep.c \
	tools/ensemble/sweep_array.c \
	tools/report/report_private.h \
	tools/report/report.c \
	tools/report/report_html.c \
	tools/report/report_kinds.c \
	tools/report/variants.c \
	tools/report/animation.c \
	tools/report/animation_html.c \
	tools/report/animation_private.h \
	tools/cli/page_html.c \
	tools/report/lesson.c \
	tools/report/lesson.h \
	tools/report/live_page.c \
	tools/ensemble/map.h \
	tools/ensemble/map.c \
	tools/ensemble/members.h \
	tools/ensemble/members.c \
	tools/inspect/check.c \
	tools/inspect/parts_words.h \
	tools/inspect/parts_words.c \
	tools/inspect/chaos.c \
	tools/orbit/section.c \
	tools/inspect/impact_private.h \
	tools/inspect/impact.c \
	tools/inspect/impact_orbit.c \
	tools/inspect/impact_plot.c \
	tools/inspect/needed.c \
	tools/cli/new.c \
	tools/cli/sample.c \
	tools/cli/list.c \
	tools/plot/plot.h \
	tools/plot/plot_private.h \
	tools/plot/plot.c \
	tools/plot/plot_range.c \
	tools/plot/plot_ticks.c \
	tools/plot/plot_layout.c \
	tools/plot/plot_script.c \
	tools/plot/plot_series.c \
	tools/plot/looks.h \
	tools/plot/looks.c \
	tools/plot/plot_forms.c \
	tools/plot/plot_guides.c \
	tools/plot/plot_svg.c \
	tools/plot/plot_svg_series.c \
	tools/plot/plot_svg_map.c \
	tools/plot/plot_thin.c \
	tools/plot/plot_map.c \
	tools/plot/plot_quote.c \
	tools/plot/plot_gnuplot.c \
	tools/plot/plot_write.c \
	tools/experiment/envelope.h \
	tools/experiment/envelope.c \
	tools/plot/energy_plot.h \
	tools/plot/energy_plot.c \
	tools/plot/order_plot.h \
	tools/plot/order_plot.c \
	tools/compare/compare_plot.c \
	tools/plot/thinned.h \
	tools/plot/thinned.c \
	tools/orbit/columns.h \
	tools/orbit/columns.c \
	tools/orbit/orbit.h \
	tools/orbit/orbit.c \
	tools/plot/plot_words.c \
	tools/orbit/run_plot_private.h \
	tools/orbit/phase_plot.c \
	tools/orbit/configuration_plot.c \
	tools/orbit/time_plot.c \
	tools/orbit/run_energy_plot.c \
	tools/orbit/run_plot.c \
	tools/orbit/section_plot.c \
	tools/orbit/portrait.h \
	tools/orbit/portrait.c \
	tools/orbit/portrait_equilibria.c \
	tools/orbit/portrait_levels.c \
	tools/orbit/frequencies_command.c \
	tools/orbit/frequencies_private.h \
	tools/orbit/frequencies_words.c \
	tools/fit/measured.h \
	tools/fit/measured.c \
	tools/fit/residuals.c \
	tools/fit/fit_private.h \
	tools/fit/fit_orbit.c \
	tools/fit/fit_scheme.c \
	tools/fit/fit_minimise.c \
	tools/fit/fit_interval.c \
	tools/fit/fit_solve.c \
	tools/fit/fit_command.c \
	tools/orbit/flow.h \
	tools/orbit/flow_shape.h \
	tools/orbit/flow_shape.c \
	tools/orbit/flow_plot.c \
	tools/orbit/flow.c \
	tools/search/cost_plot.c
tools_nevh_CPPFLAGS = $(AM_CPPFLAGS) -D_GNU_SOURCE -DNEVH_COMMAND \
	-DNEVH_SCENES='"$(scenesdir)"' -DNEVH_PAGE='"$(pkgdatadir)/page.html"' \
	-DNEVH_PACKAGE='"$(pythondir)"'
tools_nevh_LDADD = libnevh.la $(GSL_LIBS)

# nevh with ranks of MPI, which mpirun nevh sweep becomes.
if HAVE_MPI
bin_PROGRAMS += tools/nevh-mpi
endif
tools_nevh_mpi_SOURCES = tools/ensemble/ranks_mpi.c
tools_nevh_mpi_CPPFLAGS = $(tools_nevh_CPPFLAGS) $(MPI_CPPFLAGS)
tools_nevh_mpi_LDADD = $(tools_nevh_OBJECTS) $(tools_nevh_LDADD) $(MPI_LIBS)
tools_nevh_mpi_DEPENDENCIES = $(tools_nevh_OBJECTS) libnevh.la

dist_completions_DATA = tools/completion/nevh
