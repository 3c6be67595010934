/* nevh: what an energy observer holds.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ENERGY_STATE_PRIVATE_H
#define NEVH_ENERGY_STATE_PRIVATE_H

#include "diagnose/energy_book_private.h"
#include "diagnose/energy_private.h"
#include "diagnose/passage_private.h"
#include "diagnose/trend_private.h"
#include "system/system_private.h"

struct nevh_energy {
    nevh_field *field; /* for values only */
    size_t n, width;
    const nevh_stepper *followed;             /* NULL: errors are of H alone */
    bool begun;                               /* any of the lanes */
    bool only_largest;                        /* error is asked for */
    double given_scale;                       /* by the user; 0: found */
    void *memory;                             /* of all arrays */
    double *t, *h, *initial, *scale, *gained; /* width each */
    double *limit;   /* width: the largest effect at the start */
    double *start;   /* 2n x width: the state there, and */
    double *start_t; /* width: the time */
    double *typical; /* width: the largest energy of the motion; -1: not looked
                        for yet */
    double *largest; /* width: the largest sum of terms' |values| met */
    double *seen;    /* width: the |error| at which that was looked for */
    nevh_theory theory;
    bool searches;        /* for kinks, which would make KEEPS ROUGH */
    double *marked;       /* width x 2n: a state of a while ago, */
    size_t *mark, *kinks; /* width: its sample; kinks between such states */
    double *noise, *blur; /* width: of the gradient, relative */
    size_t *steps, *next_look; /* width */
    bool *started;             /* width */
    double *sums;              /* 3 x width: of the terms, lost, and sizes */
    double *effects;
    double *state;         /* 2n: one lane */
    double *booking;       /* 3n: of the book */
    nevh__passage passage; /* of one lane */
    nevh__book book;       /* likewise */
    double missed;         /* as in the report, in energies */
    double sudden; /* the largest change of the error in one step, one lane */
    nevh__trend *trend;
    nevh__report report;
};

/* An |error| above so many times the one at the last look is one that rises. */
static const double nevh__energy_higher = 1.5;

/* At the first state, which is in `state`: |H0| of what reads something, or the
   largest of its effects, or, where there is none, that of the orbit. */
int nevh__energy_find_scale(nevh_energy *, size_t lane, double t);
/* After all that was met. */
double nevh__energy_scale(const nevh_energy *, size_t lane);

#endif
