bin_PROGRAMS += tools/nevh
tools_nevh_SOURCES = \
	tools/tool.h \
	tools/plan.h \
	tools/row.h \
	tools/pace.h \
	tools/nevh.c \
	tools/options_private.h \
	tools/options.c \
	tools/arguments.c \
	tools/words.c \
	tools/numbers.c \
	tools/table.c \
	tools/output.c \
	tools/scenes.c \
	tools/plan.c \
	tools/stop.c \
	tools/row.c \
	tools/row_time.c \
	tools/shelf.c \
	tools/row_notes.c \
	tools/records.c \
	tools/ladder.h \
	tools/grid.c \
	tools/fit.c \
	tools/ladder.c \
	tools/cost_private.h \
	tools/cost.c \
	tools/cost_table.c \
	tools/cost_price.c \
	tools/cost_words.c \
	tools/recommend_private.h \
	tools/recommend.c \
	tools/advice.c \
	tools/gradients_private.h \
	tools/gradients.c \
	tools/gradients_along.c \
	tools/compare.c \
	tools/verdict.c \
	tools/state.c \
	tools/match.c \
	tools/diagnostics.c \
	tools/effects.c \
	tools/trajectory.h \
	tools/lines.c \
	tools/resume.c \
	tools/trajectory.c \
	tools/run.c \
	tools/stability.c \
	tools/preflight.c \
	tools/hard_private.h \
	tools/hard_cases.c \
	tools/hard_subject.c \
	tools/hard_state.c \
	tools/hard_run.c \
	tools/hard_judge.c \
	tools/hard.c \
	tools/check.c \
	tools/section.c \
	tools/impact_private.h \
	tools/impact.c \
	tools/impact_orbit.c \
	tools/new.c \
	tools/sample.c \
	tools/list.c \
	tools/plot.h \
	tools/plot_private.h \
	tools/plot.c \
	tools/plot_range.c \
	tools/plot_layout.c \
	tools/plot_script.c \
	tools/plot_gnuplot.c \
	tools/plot_write.c \
	tools/envelope.h \
	tools/envelope.c \
	tools/energy_plot.h \
	tools/energy_plot.c \
	tools/compare_plot.c \
	tools/thinned.h \
	tools/thinned.c \
	tools/run_plot.c \
	tools/section_plot.c \
	tools/cost_plot.c
tools_nevh_CPPFLAGS = $(AM_CPPFLAGS) -D_GNU_SOURCE \
	-DNEVH_SCENES='"$(scenesdir)"'
tools_nevh_LDADD = libnevh.la

dist_completions_DATA = tools/completion/nevh
