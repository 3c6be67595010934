/* nevh: the registry of schemes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"
#include <stdbool.h>
#include <string.h>

#define ENTRY(id) &nevh__##id##_entry,
static const nevh_integrator *const all[] = {NEVH__SCHEMES(ENTRY) NULL};
#undef ENTRY

const nevh_integrator *const *nevh_integrators(void) {
    return all;
}

/* True if a comma-separated list holds the name. */
static bool listed(const char *list, const char *name) {
    size_t length = strlen(name);
    for (const char *at = list; length && at && *at; at += *at == ',') {
        at += strspn(at, " ");
        size_t end = strcspn(at, ",");
        if (end == length && strncmp(at, name, length) == 0)
            return true;
        at += end;
    }
    return false;
}

const nevh_integrator *nevh_integrator_named(const char *name) {
    for (size_t i = 0; name && all[i]; i++)
        if (strcmp(all[i]->name, name) == 0 || listed(all[i]->aliases, name))
            return all[i];
    return NULL;
}
