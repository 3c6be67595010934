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

size_t nevh_substeps_named(const char *text) {
    size_t digits = text && *text == '+' ? strspn(text + 1, "0123456789") : 0;
    return digits && digits < 6 && !text[1 + digits]
               ? strtoul(text + 1, NULL, 10)
               : 0;
}
