/* nevh: a Hamiltonian in two parts, A + B.

   A is a quadratic form of coordinates and momenta with constant coefficients,
   lower powers included, whose flow is known; B = V(t, q) is the rest.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PARTS_PRIVATE_H
#define NEVH_PARTS_PRIVATE_H

#include "system/system_private.h"

/* The enabled term that hinders, and the reason. */
typedef struct {
    const nevh_term *term; /* NULL: no term is in A */
    const char *reason;    /* "reads momenta and is no quadratic form ..." */
} nevh__parts_fault;

/* Chooses the terms of A: those that are such forms.
   fast     out, one for each term of the system
   returns  NEVH_OK; NEVH_ESTRUCT where what reads momenta is no such form, or
            nothing is; NEVH_ENOMEM
   cost     a few gradients of each instance */
int nevh__parts_find(const nevh_system *, bool fast[], nevh__parts_fault *);

/* Derivatives of an instance of such a term: of variable i by variable j at
   form[i * (nv + 1) + j], and at 0 in the last column; nv = nq + np variables.
   room     nevh__form_room doubles
   returns  whether the derivatives are linear */
size_t nevh__form_room(const nevh_term *);
bool nevh__form_find(const nevh__term_entry *, size_t instance, double form[],
                     double room[]);

#endif
