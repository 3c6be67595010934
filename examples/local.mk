# One file each, and nothing but the installed headers and libnevh.la.
examples = \
	examples/first_hamiltonian \
	examples/pendulum_energy \
	examples/double_pendulum_energy \
	examples/effects
noinst_PROGRAMS += $(examples)
examples_first_hamiltonian_LDADD = libnevh.la
examples_pendulum_energy_SOURCES = examples/pendulum_energy.c $(energy_table)
examples_double_pendulum_energy_SOURCES = \
	examples/double_pendulum_energy.c $(energy_table)
energy_table = examples/energy_table.c examples/energy_table.h
examples_pendulum_energy_LDADD = libnevh.la
examples_double_pendulum_energy_LDADD = libnevh.la
examples_effects_LDADD = libnevh.la
