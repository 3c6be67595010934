/* nevh: the step and the speed at which a live page opens.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_LESSON_H
#define NEVH_LESSON_H

#include <nevh/nevh.h>

enum { LESSON_TEXT = 400 };

/* A step, and the time of the orbit in a second. */
typedef struct {
    double dt, rate;
} lesson_pace;
/* The scene's shortest step; real time where that is known, and shows 30 of the scene's
   steps in 20 s, and no more than 2000 a second; else as much as shows the run in 400 s,
   by 40 to 600 steps a second. */
lesson_pace lesson_usual(nevh_scene *);

/* Finds where the energy error of a scheme that is not symplectic passes that of one
   that is, as soon as can be watched.
   name      of `count` integrators: the first that is symplectic, and the first that
             is not, are taken, and Verlet's or the midpoint rule, and rk4, where
             there is none
   gradient  NULL: the scene's
   start     2n
   usual     as of lesson_usual
   text      out, JSON: why (0: found; 1: it stays below for too long; 2: the
             symplectic error grows as well; 3: more than most_steps steps), dt,
             faster (the speed is 2^faster times the usual one), crossing (a time since
             the start, or null), reached (the longest such time that was tried), and
             schemes
   cost      runs of both at up to some forty steps */
void lesson_find(nevh_scene *, const char *const name[], size_t count,
                 const char *gradient, const double start[], lesson_pace usual,
                 size_t most_steps, char text[LESSON_TEXT]);
/* True of integrators that pages have. */
bool lesson_has(const char *name);
#endif
