/* nevh: the account of the energy that comes in from outside; see ledger.c.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_LEDGER_PRIVATE_H
#define NEVH_LEDGER_PRIVATE_H

#include "expression/timing_private.h"
#include <nevh/extend.h>

/* Makes w->ledger, where a balance was asked for and the energy changes:
   H reads t, or there is friction, which `friction` tells. */
int nevh__ledger_plan(nevh_work *, bool friction);
void nevh__ledger_free(struct nevh_ledger *); /* NULL is allowed */
/* A step begins at a state. */
void nevh__ledger_open(nevh_work *, const double q[], const double p[]);
/* Adds sign times H to what is pending; NULL is allowed. */
int nevh__ledger_add(nevh_work *, double sign, double t, const double q[],
                     const double p[]);
/* nevh_work_account, as far as the energy goes. */
int nevh__ledger_account(nevh_work *, unsigned parts, double weight,
                         const double t[], const double q[], const double p[]);
/* True if the last step, between two times, is one of a scheme with a tolerance that
   took dH/dt so often that it passed over none of the changes in time. */
bool nevh__ledger_saw(struct nevh_ledger *, const nevh_timing *, double from,
                      double to);
/* The step was taken: what is pending is added to total, which is two rows of
   width: sums, and the digits that these lost. */
void nevh__ledger_close(const nevh_work *, double total[]);

#endif
