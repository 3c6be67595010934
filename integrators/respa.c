/* nevh: steps by parts whose fast effects are taken in substeps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/form_flow_private.h"
#include "schemes_private.h"
#include <stdlib.h>
#include <string.h>

static const nevh_splitting table = {NEVH_KICK, NEVH_COMPOSITION, 0, NULL};

const nevh_integrator nevh__respa_entry = {
    .name = "respa",
    .aliases = "r-RESPA, impulse",
    .source = "M. Tuckerman, B. J. Berne, G. J. Martyna, Reversible multiple "
              "time scale molecular dynamics, J. Chem. Phys. 97 (1992) "
              "1990-2001, with the slow kicks outside",
    .order = 2,
    .stages = 1,
    .gradients = 1,
    .symplectic = NEVH_YES,
    .symmetric = NEVH_YES,
    .explicit_form = NEVH_YES,
    .preserves_energy = NEVH_NO,
    .needs = NEVH_PARTS,
    .kernel = &nevh__substeps_kernel,
    .table = &table,
};
NEVH__PUBLISH(respa);

size_t nevh_substeps_named(const char *name) {
    static const char begins[] = "respa+";
    size_t before = sizeof begins - 1;
    if (!name || strncmp(name, begins, before) != 0)
        return 0;
    size_t digits = strspn(name + before, "0123456789");
    return digits < 6 && !name[before + digits]
               ? strtoul(name + before, NULL, 10)
               : 0;
}
