libnevh_core_la_SOURCES += \
	integrators/integrator.c \
	integrators/schemes_private.h \
	integrators/list.c \
	integrators/work_private.h \
	integrators/work.c \
	integrators/splitting_kernel.c \
	integrators/symplectic_euler.c \
	integrators/verlet.c \
	integrators/runge_kutta_kernel.c \
	integrators/euler.c \
	integrators/rk4.c \
	integrators/gauss_private.h \
	integrators/gauss_kernel.c \
	integrators/gauss_coefficients.c \
	integrators/gauss.c \
	integrators/discrete_gradient_private.h \
	integrators/discrete_gradient_kernel.c \
	integrators/itoh_abe.c \
	integrators/gonzalez.c \
	integrators/avf.c \
	integrators/gsl_private.h \
	integrators/gsl_kernel.c \
	integrators/gsl_references.c
