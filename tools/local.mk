bin_PROGRAMS += tools/nevh
tools_nevh_SOURCES = \
	tools/tool.h \
	tools/nevh.c \
	tools/options_private.h \
	tools/options.c \
	tools/arguments.c \
	tools/words.c \
	tools/table.c \
	tools/output.c \
	tools/scenes.c \
	tools/plan.c \
	tools/row.c \
	tools/compare.c \
	tools/verdict.c \
	tools/effects.c \
	tools/stability.c \
	tools/preflight.c \
	tools/hard_private.h \
	tools/hard_cases.c \
	tools/hard_subject.c \
	tools/hard_run.c \
	tools/hard_judge.c \
	tools/hard.c \
	tools/check.c \
	tools/list.c
tools_nevh_CPPFLAGS = $(AM_CPPFLAGS) -D_GNU_SOURCE \
	-DNEVH_SCENES='"$(scenesdir)"'
tools_nevh_LDADD = libnevh.la
