/* nevh: version, and sizes of structures.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "config.h"
#include <nevh/binding.h>
#include <nevh/diagnose.h>
#include <nevh/sweep.h>
#include <nevh/system.h>
#include <string.h>

const char *nevh_version(void) {
    return PACKAGE_VERSION;
}

#define SIZE_OF(type)                                                          \
    { #type, sizeof(type) }

size_t nevh_size_of(const char *type) {
    static const struct {
        const char *name;
        size_t size;
    } sizes[] = {
        SIZE_OF(nevh_counts),        SIZE_OF(nevh_energy_report),
        SIZE_OF(nevh_judged_run),    SIZE_OF(nevh_observer),
        SIZE_OF(nevh_options),       SIZE_OF(nevh_scene_options),
        SIZE_OF(nevh_scene_run),     SIZE_OF(nevh_sweep_options),
        SIZE_OF(nevh_sweep_records), SIZE_OF(nevh_separability),
        SIZE_OF(nevh_term),
    };
    for (size_t i = 0; type && i < sizeof sizes / sizeof *sizes; i++)
        if (strcmp(type, sizes[i].name) == 0)
            return sizes[i].size;
    return 0;
}
