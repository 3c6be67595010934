# Installed, and found there by name.
scenesdir = $(pkgdatadir)/scenes
dist_scenes_DATA = \
	scenes/charged-chain.nevh \
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
	scenes/henon-heiles-chaotic.nevh \
	scenes/kapitza.nevh \
	scenes/kepler-0.9.nevh \
	scenes/kepler.nevh \
	scenes/magnetic.nevh \
	scenes/oscillator-paper.nevh \
	scenes/oscillator.nevh \
	scenes/outer-solar-system.nevh \
	scenes/own-integrators.nevh \
	scenes/pendulum-filmed.nevh \
	scenes/pendulum-filmed.csv \
	scenes/pendulum-periods.nevh \
	scenes/pendulum-rotating.nevh \
	scenes/pendulum-separatrix.nevh \
	scenes/pendulum-small.nevh \
	scenes/penning-trap.nevh \
	scenes/kirkwood-gap.nevh \
	scenes/pendulum.nevh \
	scenes/solar-system.nevh \
	scenes/sun-earth-moon.nevh

# What configure makes for the command in the build tree.
distclean-local:
	test ! -h scenes || rm -f scenes
	test ! -h web/kit.html || rm -f web/kit.html

# What nevh hard runs, beside the scenes.
harddir = $(scenesdir)/hard
dist_hard_DATA = \
	scenes/hard/double-pendulum.nevh \
	scenes/hard/earth.nevh \
	scenes/hard/edge.nevh \
	scenes/hard/elastic-pendulum.nevh \
	scenes/hard/fput.nevh \
	scenes/hard/head-on.nevh \
	scenes/hard/henon-heiles.nevh \
	scenes/hard/kepler.nevh \
	scenes/hard/kink.nevh \
	scenes/hard/late-start.nevh \
	scenes/hard/magnetic-mirror.nevh \
	scenes/hard/molecule.nevh \
	scenes/hard/offset.nevh \
	scenes/hard/outer-planets.nevh \
	scenes/hard/pendulum-modulus.nevh \
	scenes/hard/pythagorean.nevh \
	scenes/hard/resonance.nevh \
	scenes/hard/schwarzschild.nevh \
	scenes/hard/swinging-atwood.nevh \
	scenes/hard/toda.nevh \
	scenes/hard/uniform-field.nevh
