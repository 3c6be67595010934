libnevh_core_la_SOURCES += \
	models/models_private.h \
	models/models.c \
	models/oscillator.c \
	models/pendulum.c \
	models/double_pendulum.c \
	models/elastic_pendulum.c \
	models/coupled_oscillators.c
