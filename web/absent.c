/* nevh: what the live page's module is without: GSL, compiled steps, locales, and a
   look at gradients, which follow from formulas there.

   GSL cannot be linked for this target where Debian packages it for the machine
   alone.  Its functions that the library refers to end in an error here, which
   the library tells as it tells GSL's own.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/energy_private.h"
#include "diagnose/kinks_private.h"
#include "diagnose/passage_private.h"
#include "ensemble/outcomes/outcome_private.h"
#include "gradient/step_selection_private.h"
#include "kernels/gsl_private.h"
#include "kernels/tao_private.h"
#include "native/native_private.h"
#include "page.h"
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multiroots.h>
#include <gsl/gsl_sf_bessel.h>
#include <gsl/gsl_sf_ellint.h>
#include <locale.h>
#include <math.h>

const char *page_absent;

static int absent(const char *what) {
    page_absent = what;
    return GSL_EFAILED;
}

/* The reference integrators of GSL, and Tao's methods, which choose their
   binding along one of their orbits. */
static int refuse(nevh_work *w) {
    absent("integrators that need GSL");
    return nevh_work_fail(w, NEVH_ESTRUCT, "%s needs GSL", w->integrator->name);
}
const nevh_kernel nevh__gsl_kernel = {.plan = refuse};
const nevh_kernel nevh__tao_kernel = {.plan = refuse};

/* Outcomes of sweeps: scenes may name them, and no sweep runs here. */
#define OUTCOME(name_, takes_)                                                 \
    const nevh__outcome_type nevh__outcome_##name_ = {                         \
        .info = {.name = #name_, .takes = NEVH_OUTCOME_TAKES_##takes_}};
NEVH__OUTCOMES(OUTCOME)

/* A solver of roots that finds none. */
static const char roots[] = "GSL's solver for several unknowns";
static gsl_multiroot_fdfsolver solver;
static gsl_vector vector;
const gsl_multiroot_fdfsolver_type *gsl_multiroot_fdfsolver_hybridsj;
gsl_multiroot_fdfsolver *
gsl_multiroot_fdfsolver_alloc(const gsl_multiroot_fdfsolver_type *type,
                              size_t n) {
    (void)type, (void)n;
    return &solver;
}
void gsl_multiroot_fdfsolver_free(gsl_multiroot_fdfsolver *s) {
    (void)s;
}
int gsl_multiroot_fdfsolver_set(gsl_multiroot_fdfsolver *s,
                                gsl_multiroot_function_fdf *f,
                                const gsl_vector *x) {
    (void)s, (void)f, (void)x;
    return absent(roots);
}
int gsl_multiroot_fdfsolver_iterate(gsl_multiroot_fdfsolver *s) {
    (void)s;
    return absent(roots);
}
gsl_vector *gsl_vector_calloc(const size_t n) {
    (void)n;
    return &vector;
}
void gsl_vector_free(gsl_vector *v) {
    (void)v;
}
double gsl_vector_get(const gsl_vector *v, const size_t i) {
    (void)v, (void)i;
    return NAN;
}
void gsl_vector_set(gsl_vector *v, const size_t i, double x) {
    (void)v, (void)i, (void)x;
}
void gsl_vector_set_zero(gsl_vector *v) {
    (void)v;
}
int gsl_vector_memcpy(gsl_vector *to, const gsl_vector *from) {
    (void)to, (void)from;
    return absent(roots);
}
int gsl_vector_sub(gsl_vector *a, const gsl_vector *b) {
    (void)a, (void)b;
    return absent(roots);
}
int gsl_vector_scale(gsl_vector *a, const double x) {
    (void)a, (void)x;
    return absent(roots);
}
int gsl_matrix_set_col(gsl_matrix *m, const size_t j, const gsl_vector *v) {
    (void)m, (void)j, (void)v;
    return absent(roots);
}

/* Special functions. */
static const char bessel[] = "Bessel functions";
static const char elliptic[] = "elliptic integrals";
int gsl_sf_bessel_J0_e(const double x, gsl_sf_result *result) {
    (void)x, (void)result;
    return absent(bessel);
}
int gsl_sf_bessel_J1_e(const double x, gsl_sf_result *result) {
    (void)x, (void)result;
    return absent(bessel);
}
int gsl_sf_ellint_Kcomp_e(double k, gsl_mode_t mode, gsl_sf_result *result) {
    (void)k, (void)mode, (void)result;
    return absent(elliptic);
}
int gsl_sf_ellint_Ecomp_e(double k, gsl_mode_t mode, gsl_sf_result *result) {
    (void)k, (void)mode, (void)result;
    return absent(elliptic);
}
int gsl_sf_ellint_Dcomp_e(double k, gsl_mode_t mode, gsl_sf_result *result) {
    (void)k, (void)mode, (void)result;
    return absent(elliptic);
}
double gsl_cdf_ugaussian_Pinv(const double x) {
    (void)x;
    absent("normal distributions");
    return NAN;
}

/* Steps that would have to be compiled. */
void nevh__native_plan(nevh_work *w, const nevh__watched *watched,
                       char why[NEVH__WHY_NATIVE]) {
    (void)w, (void)watched;
    why[0] = '\0';
}
void nevh__native_free(nevh__native *x) {
    (void)x;
}
bool nevh__background_is_done(nevh__background *b) {
    (void)b;
    return true;
}
bool nevh__native_await(nevh__native *x) {
    (void)x;
    return false;
}
size_t nevh__native_run(nevh_work *w, double t0, double h, size_t from,
                        size_t steps, double q[], double p[]) {
    (void)w, (void)t0, (void)h, (void)from, (void)steps, (void)q, (void)p;
    return 0;
}
bool nevh__native_write(nevh__writer *w, nevh_work *work) {
    (void)w, (void)work;
    return false;
}
bool nevh__write_program(nevh__writer *w, nevh_work *work,
                         const nevh_program *program) {
    (void)w, (void)work, (void)program;
    return false;
}

/* Terms of a page are formulas, whose derivatives nobody has written. */
int nevh__verify(nevh__step_selection *e, const nevh__planned *term) {
    (void)e, (void)term;
    return NEVH_OK;
}

/* Numbers are in the C locale always. */
locale_t newlocale(int mask, const char *name, locale_t base) {
    (void)mask, (void)name, (void)base;
    return (locale_t)0;
}
locale_t uselocale(locale_t locale) {
    (void)locale;
    return (locale_t)0;
}
void freelocale(locale_t locale) {
    (void)locale;
}

/* A page has no words for poles that a step passes, and looks for no kinks. */
bool nevh__passage_init(nevh__passage *s, const nevh_system *system) {
    *s = (nevh__passage){.system = system};
    return true;
}
void nevh__passage_clear(nevh__passage *s) {
    (void)s;
}
void nevh__passage_keep(nevh__passage *s, double t, const double q[],
                        const double p[]) {
    (void)s, (void)t, (void)q, (void)p;
}
void nevh__passage_look(nevh__passage *s, double t, const double q[],
                        const double p[]) {
    (void)s, (void)t, (void)q, (void)p;
}
bool nevh__theory_doubts(const nevh_system *s) {
    (void)s;
    return false;
}
bool nevh__kink_between(nevh_field *f, double t, const double from[],
                        const double to[], double largest, bool slopes,
                        double room[]) {
    (void)f, (void)t, (void)from, (void)to, (void)largest, (void)slopes,
        (void)room;
    return false;
}

/* Scenes of a page have few effects: each term is taken by itself. */
bool nevh__field_join(nevh_field *f) {
    for (f->n_pieces = 0; f->n_pieces < f->n_terms; f->n_pieces++)
        f->pieces[f->n_pieces] = &f->terms[f->n_pieces];
    return true;
}
void nevh__joints_clear(nevh_field *f) {
    for (; f->n_pieces > 0; f->n_pieces--)
        nevh__planned_clear(f->pieces[f->n_pieces - 1]);
}
void nevh__joint_count(nevh_field *f, nevh__planned *piece) {
    (void)f, (void)piece;
}
int nevh__joint_fail(nevh_field *f, const nevh__planned *piece,
                     const nevh__places *at, int status) {
    (void)f, (void)piece, (void)at;
    return status;
}
