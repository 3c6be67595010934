/* nevh: the list of outcomes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/outcomes/outcome_private.h"
#include <string.h>

#define TYPE(name, takes) &nevh__outcome_##name,
#define INFO(name, takes) &nevh__outcome_##name.info,
static const nevh__outcome_type *const types[] = {NEVH__OUTCOMES(TYPE)};
static const nevh_outcome_info *const all[] = {NEVH__OUTCOMES(INFO) NULL};

const nevh_outcome_info *const *nevh_outcomes(void) {
    return all;
}

int nevh_outcome_find(const char *name) {
    for (int kind = 0; name && kind < NEVH__OUTCOME_COUNT; kind++)
        if (strcmp(all[kind]->name, name) == 0)
            return kind;
    return -1;
}

const nevh__outcome_type *nevh__outcome_type_of(int kind) {
    return kind >= 0 && kind < NEVH__OUTCOME_COUNT ? types[kind] : NULL;
}
