/* nevh: states to digits that are certain.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_CERTAIN_H
#define NEVH_CERTAIN_H

#include <nevh/system.h>
#include <signal.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An orbit in quad precision, by two runs of Taylor series that differ in order
   and in tolerance: digits common to both are certain.  One thread at a
   time. */
typedef struct nevh_certain nevh_certain;

/* The orbit through (q, p) at t0.
   digits   that states are to have, 1 to 30; tolerances follow from it
   returns  the orbit, to be freed with nevh_certain_free; NULL only when memory
            is out.  Otherwise it may carry NEVH_EINVAL, or NEVH_ESTRUCT where a
            term is not a formula or not analytic, or where nevh was built
            without libquadmath; the message says which.
   Numbers of the system, and q and p, are taken as the doubles that they are;
   nevh_scene_certain has all digits of a scene's.
   The system is borrowed and must not be changed.  Friction is counted in. */
NEVH_API nevh_certain *nevh_certain_new(const nevh_system *, double t0,
                                        const double q[], const double p[],
                                        int digits);
NEVH_API void nevh_certain_free(nevh_certain *); /* NULL is allowed */
/* The status of making it or of the last call; NEVH_ENOMEM for NULL. */
NEVH_API int nevh_certain_status(const nevh_certain *);
/* The message to that status, or ""; never NULL. */
NEVH_API const char *nevh_certain_message(const nevh_certain *);

/* Goes to a time, on either side of t0; times in order cost least.
   returns  NEVH_OK; NEVH_EDOM where a series is not finite, NEVH_EFAILED where
            they get too short to get there: then there is no state
   cost     of pendulums and planets some 0.1 ms for each time in which the
            orbit changes by itself; linear in the operations of H */
NEVH_API int nevh_certain_go(nevh_certain *, double t);
/* The same to time + rest: of a time that no double is. */
NEVH_API int nevh_certain_go_to(nevh_certain *, double time, long double rest);
/* Calls return NEVH_EFAILED soon after *ending is not 0, as a handler of a signal
   may set it: series may get ever shorter for a long time.
   ending   borrowed while the orbit lives; NULL: none */
NEVH_API void nevh_certain_stop_at(nevh_certain *,
                                   const volatile sig_atomic_t *ending);
/* Series that both runs took so far. */
NEVH_API size_t nevh_certain_series(const nevh_certain *);

/* Results at the present time: of coordinate k for k < n, else of momentum k - n. */
/* The value as a double; NAN out of range. */
NEVH_API double nevh_certain_value(const nevh_certain *, size_t k);
/* A bound of the error of all digits: eight times the difference of the two runs, or
   rounding. */
NEVH_API double nevh_certain_error(const nevh_certain *, size_t k);
/* The largest value so far, at the starts of series and within them. */
NEVH_API double nevh_certain_size(const nevh_certain *, size_t k);
/* The number of certain digits, at most those asked for; 0: none. */
NEVH_API int nevh_certain_digits(const nevh_certain *, size_t k);
/* The certain digits as text, to be freed with free; "0" where there is none.  NULL
   out of range, and when memory is out. */
NEVH_API char *nevh_certain_text(const nevh_certain *, size_t k);
/* number + rest with 30 digits or fewer, to be freed with free; NULL when memory
   is out. */
NEVH_API char *nevh_certain_number(double number, long double rest);

#ifdef __cplusplus
}
#endif
#endif
