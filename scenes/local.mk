# Installed, and found there by name.
scenesdir = $(pkgdatadir)/scenes
dist_scenes_DATA = \
	scenes/coupled-oscillators.nevh \
	scenes/coupled-pendulums.nevh \
	scenes/damped-driven-pendulum.nevh \
	scenes/double-pendulum-as-printed.nevh \
	scenes/double-pendulum-chaotic.nevh \
	scenes/double-pendulum-regular.nevh \
	scenes/double-pendulum.nevh \
	scenes/earth-halley.nevh \
	scenes/elastic-pendulum.nevh \
	scenes/figure-eight.nevh \
	scenes/fput-1000.nevh \
	scenes/fput.nevh \
	scenes/henon-heiles.nevh \
	scenes/kapitza.nevh \
	scenes/kepler-0.9.nevh \
	scenes/kepler.nevh \
	scenes/magnetic.nevh \
	scenes/oscillator-paper.nevh \
	scenes/oscillator.nevh \
	scenes/outer-solar-system.nevh \
	scenes/pendulum-rotating.nevh \
	scenes/pendulum-separatrix.nevh \
	scenes/pendulum-small.nevh \
	scenes/pendulum.nevh \
	scenes/sun-earth-moon.nevh

# What configure makes for the command in the build tree.
distclean-local:
	test ! -h scenes || rm -f scenes
