/* nevh: plots: which look an integrator has.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "looks.h"
#include "plot_private.h"
#include <stdint.h>
#include <string.h>

static const char *const looks[] = {
#define NAME(name) name,
    NEVH_LOOKS(NAME)};
enum { LOOKS = sizeof looks / sizeof *looks, OTHERS = 64 };

/* A number of the name alone. [G. Fowler, L. C. Noll, K.-P. Vo, The FNV
   non-cryptographic hash algorithm, 1991: FNV-1a] */
static size_t number_of(const char *name, size_t length) {
    uint32_t number = 2166136261u;
    for (size_t i = 0; i < length; i++)
        number = (number ^ (unsigned char)name[i]) * 16777619u;
    return number;
}

size_t plot_look_of_integrator(const char *name) {
    size_t length = strcspn(name, "+"); /* of verlet+transform */
    const nevh_integrator *known =
        nevh_integrator_named(text_print("%.*s", (int)length, name));
    size_t look = 0;
    for (; known && look < LOOKS; look++)
        if (strcmp(looks[look], nevh_integrator_name(known)) == 0)
            return look;
    return LOOKS + number_of(name, length) % OTHERS;
}
