/* nevh: what a sweep over stages did to one orbit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_STAGE_PROGRESS_H
#define NEVH_STAGE_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>

typedef struct {
    bool moved;      /* something changed */
    size_t improved; /* unknowns whose change was smaller than ever */
    double change;   /* the largest, in units of scale; infinite, where it is
                        not finite */
} nevh__stage_progress;

#endif
