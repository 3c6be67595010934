# Installed, and found there by name.
scenesdir = $(pkgdatadir)/scenes
dist_scenes_DATA = \
	scenes/coupled-pendulums.nevh \
	scenes/damped-driven-pendulum.nevh \
	scenes/double-pendulum-chaotic.nevh \
	scenes/double-pendulum.nevh \
	scenes/elastic-pendulum.nevh \
	scenes/figure-eight.nevh \
	scenes/fput-1000.nevh \
	scenes/fput.nevh \
	scenes/henon-heiles.nevh \
	scenes/kapitza.nevh \
	scenes/kepler-0.9.nevh \
	scenes/kepler.nevh \
	scenes/magnetic.nevh \
	scenes/oscillator.nevh \
	scenes/pendulum-rotating.nevh \
	scenes/pendulum-small.nevh \
	scenes/pendulum.nevh
