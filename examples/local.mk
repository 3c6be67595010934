# One file each or with one that several share, and nothing but the installed
# headers and libnevh.la.
examples = \
	examples/first_hamiltonian \
	examples/pendulum_energy \
	examples/double_pendulum_energy \
	examples/integrators \
	examples/effects \
	examples/own_kernel \
	examples/catalogue \
	examples/conservation \
	examples/steps_that_follow \
	examples/text_to_native \
	examples/flip_map \
	examples/chaos_share \
	examples/gradient_error \
	examples/gradient_cost \
	examples/nevh_cost \
	examples/add_noise \
	examples/paper/divergence
noinst_PROGRAMS += $(examples)
examples_first_hamiltonian_LDADD = libnevh.la
examples_pendulum_energy_SOURCES = examples/pendulum_energy.c $(energy_table)
examples_double_pendulum_energy_SOURCES = \
	examples/double_pendulum_energy.c $(energy_table)
energy_table = examples/energy_table.c examples/energy_table.h
examples_pendulum_energy_LDADD = libnevh.la
examples_double_pendulum_energy_LDADD = libnevh.la
examples_integrators_LDADD = libnevh.la
examples_effects_LDADD = libnevh.la
examples_own_kernel_LDADD = libnevh.la
examples_catalogue_LDADD = libnevh.la
examples_conservation_LDADD = libnevh.la
examples_steps_that_follow_LDADD = libnevh.la
examples_text_to_native_LDADD = libnevh.la
examples_flip_map_LDADD = libnevh.la
examples_chaos_share_LDADD = libnevh.la
examples_nevh_cost_LDADD = libnevh.la
examples_add_noise_LDADD = -lm
examples_paper_divergence_LDADD = libnevh.la
gradient_systems = \
	examples/gradient_systems.c examples/gradient_systems.h
examples_gradient_error_SOURCES = \
	examples/gradient_error.c $(gradient_systems)
examples_gradient_cost_SOURCES = examples/gradient_cost.c $(gradient_systems)
examples_gradient_error_LDADD = libnevh.la
examples_gradient_cost_LDADD = libnevh.la

if HAVE_MPI
noinst_PROGRAMS += examples/sweep_mpi
endif
examples_sweep_mpi_CPPFLAGS = $(AM_CPPFLAGS) $(MPI_CPPFLAGS)
examples_sweep_mpi_LDADD = libnevh.la $(MPI_LIBS)

# To read, and to compile with the installed library.
exampledir = $(docdir)/examples
dist_example_DATA = \
	examples/Makefile \
	examples/add_noise.c \
	examples/filmed.sh \
	examples/catalogue.c \
	examples/chaos_share.c \
	examples/conservation.c \
	examples/double_pendulum_energy.c \
	examples/effects.c \
	examples/energy_table.c \
	examples/energy_table.h \
	examples/first_hamiltonian.c \
	examples/flip_map.c \
	examples/gradient_cost.c \
	examples/gradient_error.c \
	examples/gradient_systems.c \
	examples/gradient_systems.h \
	examples/integrators.c \
	examples/nevh_cost.c \
	examples/own_kernel.c \
	examples/paper/divergence.c \
	examples/paper/listing1.py \
	examples/paper/paper.sh \
	examples/pendulum_energy.c \
	examples/steps_that_follow.c \
	examples/sweep_mpi.c \
	examples/text_to_native.c
