/* nevh: a Hamiltonian in two parts, A + B.

   A has the terms whose flow is known: quadratic forms of coordinates and momenta
   with constant coefficients, lower powers included, and -k/|q| of two or three
   coordinates whose momenta have p^2/2m alone.  B = V(t, q) is the rest; of
   oscillators whose coordinates it does not read otherwise, it may be a function of
   their actions.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PARTS_PRIVATE_H
#define NEVH_PARTS_PRIVATE_H

#include "system/system_private.h"

/* The enabled term that hinders, and the reason. */
typedef struct {
    const nevh_term *term; /* NULL: no term is in A */
    const char *reason;    /* "reads momenta and is no quadratic form ..." */
} nevh__parts_fault;

/* Inner terms are any V(q) that is to be fast: these kick in substeps of A. */
typedef enum {
    NEVH__KICK,
    NEVH__FORM,
    NEVH__CENTRE,
    NEVH__INNER
} nevh__part_role;
enum { NEVH__ALL_PARTS = (1 << (NEVH__INNER + 1)) - 1 };

/* Chooses the terms of A.
   substeps whether terms may be inner ones
   part     out, one for each term of the system
   returns  NEVH_OK; NEVH_ESTRUCT where what reads momenta is no such form, or
            nothing is; NEVH_ENOMEM
   cost     a few gradients of each instance */
int nevh__parts_find(const nevh_system *, bool substeps, nevh__part_role part[],
                     nevh__parts_fault *);

/* Derivatives of an instance of such a term: of variable i by variable j at
   form[i * (nv + 1) + j], and at 0 in the last column; nv = nq + np variables.
   room     nevh__form_room doubles
   returns  whether the derivatives are linear */
size_t nevh__form_room(const nevh_term *);
bool nevh__form_find(const nevh__term_entry *, size_t instance, double form[],
                     double room[]);
/* The k of an instance that is -k/|q| of all its coordinates; false: it is not. */
enum { NEVH__SPACE = 3 }; /* the most of these */
bool nevh__centre_find(const nevh__term_entry *, size_t instance, double *k,
                       double room[]);
/* The k of an instance that is -k/|a - b| of two points in NEVH__PLANE or NEVH__SPACE
   dimensions, and of each of its coordinates that of the other point beside it, which is not
   written where k is 0; false: it is not. */
enum { NEVH__PLANE = 2, NEVH__PAIR = 2 * NEVH__SPACE };
bool nevh__pair_find(const nevh__term_entry *, size_t instance, double *k,
                     size_t beside[NEVH__PAIR], double room[]);
/* s of each coordinate of an instance that is a function of (s q^2 + p^2/s)/2 of each
   alone, 0 where it does not depend on that; false: it is no such function.
   of       room for as many */
bool nevh__turn_find(const nevh__term_entry *, size_t instance, size_t of[],
                     double s[]);
/* Finds the terms of B that turn coordinates which no other term of B reads.
   turn     out, one for each term
   returns  NEVH_OK; NEVH_ENOMEM */
int nevh__turns_choose(const nevh_system *, const nevh__part_role part[],
                       bool turn[]);
/* Leaves to B the centres whose coordinates are moved otherwise, too, and forms of q
   beside the others.
   part     in and out, one for each term
   returns  NEVH_OK; NEVH_ENOMEM */
int nevh__centres_choose(const nevh_system *, nevh__part_role part[]);

#endif
