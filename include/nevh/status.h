/* nevh: status codes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_STATUS_H
#define NEVH_STATUS_H

#if defined(__GNUC__) || defined(__clang__)
#define NEVH_API __attribute__((visibility("default")))
#else
#define NEVH_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Every function that can fail returns one of these as int.  Where GSL has a
   code for the same thing the number is GSL's, so that a callback written for
   GSL may pass its own codes on; what GSL lacks is numbered from 1024.

   Where memory is out an object is NULL.  Every function takes NULL for an
   object, and for an integrator or gradient, which NULL is where a name is
   none: the status of NULL is NEVH_ENOMEM; what acts on it returns NEVH_EINVAL,
   outputs being untouched; a text is "" or says what is wrong, a number 0 or
   NAN, a pointer NULL; what returns nothing does nothing. */
#define NEVH_STATUS_LIST(X)                                                    \
    X(NEVH_OK, 0, "no error")                                                  \
    X(NEVH_EDOM, 1, "a value is not finite")                                   \
    X(NEVH_EINVAL, 4, "invalid argument")                                      \
    X(NEVH_EFAILED, 5, "a part of the computation failed")                     \
    X(NEVH_ENOMEM, 8, "out of memory")                                         \
    X(NEVH_EMAXITER, 11, "the stage equations were not solved")                \
    X(NEVH_ESTRUCT, 1024, "the scheme does not fit this Hamiltonian")          \
    X(NEVH_ENOGRAD, 1025, "a term cannot give the gradient asked for")         \
    X(NEVH_ESTALE, 1026, "the system changed after it was planned")            \
    X(NEVH_STOPPED, 1027, "an observer stopped the run")

#define NEVH_STATUS_ENTRY(name, number, text) name = number,
enum nevh_status { NEVH_STATUS_LIST(NEVH_STATUS_ENTRY) };
#undef NEVH_STATUS_ENTRY

/* The meaning of a status in a few words; never NULL, also for a number that
   is no status.  The message of the object at fault says more. */
NEVH_API const char *nevh_status_text(int status);

#ifdef __cplusplus
}
#endif
#endif
