nevhincludedir = $(includedir)/nevh
nevhinclude_HEADERS = \
	include/nevh/binding.h \
	include/nevh/body.h \
	include/nevh/certain.h \
	include/nevh/simd.h \
	include/nevh/chaos.h \
	include/nevh/confirm.h \
	include/nevh/diagnose.h \
	include/nevh/extend.h \
	include/nevh/gradient.h \
	include/nevh/gsl.h \
	include/nevh/integrator.h \
	include/nevh/models.h \
	include/nevh/nevh.h \
	include/nevh/probe.h \
	include/nevh/reference.h \
	include/nevh/run.h \
	include/nevh/scene.h \
	include/nevh/section.h \
	include/nevh/shadow.h \
	include/nevh/ensemble.h \
	include/nevh/sweep.h \
	include/nevh/loop.h \
	include/nevh/frequencies.h \
	include/nevh/status.h \
	include/nevh/system.h \
	include/nevh/timing.h \
	include/nevh/transform.h
