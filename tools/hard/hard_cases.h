/* nevh hard: the cases.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_HARD_CASES_H
#define NEVH_HARD_CASES_H

typedef struct {
    const char *name;
    const char *scene;      /* as nevh compare takes it */
    const char *settings;   /* parameters, as --set takes them, with "; " */
    const char *dt, *t_end; /* formulas.  NULL: the scene's, as settings */
} hard_case;
/* Ended by one without a name. */
extern const hard_case hard_cases[];

#endif
