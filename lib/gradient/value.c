/* nevh: values of H, of its effects, and their rounding.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/block_private.h"
#include <float.h>
#include <math.h>

/* Neumaier's compensated sum. */
static void value_add(double *sum, double *roundoff, double x) {
    double next = *sum + x;
    *roundoff += fabs(*sum) >= fabs(x) ? (*sum - next) + x : (x - next) + *sum;
    *sum = next;
}

/* Adds all instances of a term at a few lanes to sums, lost digits and, unless
   that is NULL, sizes. */
static int value_add_term(nevh_field *f, nevh__planned *term, nevh__block b,
                          double *sum, double *roundoff, double *size) {
    int status = NEVH_OK;
    while (!status && nevh__block_next(f, term, &b)) {
        status = nevh__block_values(f, term, &b);
        for (size_t k = 0; !status && k < b.used; k++) {
            size_t lane = b.lane + k % b.lanes;
            value_add(sum + lane, roundoff + lane, f->h[k]);
            if (size)
                size[lane] += fabs(f->h[k]);
        }
    }
    return status;
}

/* As many lanes as there is room for, from `lane` on. */
static nevh__block lanes_from(const nevh_field *f, size_t lane, size_t width,
                              const double t[], const double q[],
                              const double p[]) {
    nevh__block b = nevh__block_over(width, t + lane, q + lane, p + lane, 1, 1);
    size_t rest = width - lane;
    b.first = lane;
    b.until = rest < f->capacity ? rest : f->capacity;
    return b;
}

int nevh_field_value(nevh_field *f, size_t width, const double t[],
                     const double q[], const double p[], double h[]) {
    if (!f)
        return NEVH_EINVAL;
    double *sum = f->sums, *roundoff = sum + f->capacity;
    int status = nevh__field_ready(f);
    for (size_t at = 0, lanes; !status && at < width; at += lanes) {
        nevh__block b = lanes_from(f, at, width, t, q, p);
        lanes = b.until;
        for (size_t lane = 0; lane < lanes; lane++)
            sum[lane] = roundoff[lane] = 0;
        for (size_t i = 0; !status && i < f->n_terms; i++)
            status = value_add_term(f, &f->terms[i], b, sum, roundoff, NULL);
        for (size_t lane = 0; lane < lanes; lane++)
            h[at + lane] = sum[lane] + roundoff[lane];
    }
    return status;
}

int nevh__field_moving_values(nevh_field *f, size_t width, const double t[],
                              const double q[], const double p[], double h[],
                              double roundoff[], double size[]) {
    int status = nevh__field_ready(f);
    for (size_t lane = 0; lane < width; lane++)
        h[lane] = roundoff[lane] = size[lane] = 0;
    for (size_t at = 0, lanes; !status && at < width; at += lanes) {
        nevh__block b = lanes_from(f, at, width, t, q, p);
        lanes = b.until;
        for (size_t i = 0; !status && i < f->n_terms; i++)
            if (f->terms[i].nv)
                status = value_add_term(f, &f->terms[i], b, h + at,
                                        roundoff + at, size + at);
    }
    return status;
}

static int term_value(nevh_field *f, nevh__planned *term, double t,
                      const double q[], const double p[], double *h) {
    double sum = 0, roundoff = 0;
    nevh__block b = nevh__block_over(1, &t, q, p, 1, 1);
    int status = value_add_term(f, term, b, &sum, &roundoff, NULL);
    *h = sum + roundoff;
    return status;
}

static int effects(nevh_field *f, bool constants, double t, const double q[],
                   const double p[], double h[]) {
    int status = nevh__field_ready(f);
    for (size_t i = 0; !status && i < f->system->n_effects; i++)
        h[i] = 0;
    for (size_t i = 0; !status && i < f->n_terms; i++) {
        nevh__planned *term = &f->terms[i];
        double value;
        if (!constants && !term->nv && !term->term->decl.time)
            continue;
        status = term_value(f, term, t, q, p, &value);
        h[term->term->effect] += value;
    }
    return status;
}

int nevh__field_moving_terms(nevh_field *f, double t, const double q[],
                             const double p[], double h[]) {
    int status = nevh__field_ready(f);
    for (size_t i = 0; !status && i < f->n_terms; i++) {
        h[i] = 0;
        if (f->terms[i].nv)
            status = term_value(f, &f->terms[i], t, q, p, &h[i]);
    }
    return status;
}

int nevh_field_effects(nevh_field *f, double t, const double q[],
                       const double p[], double h[]) {
    if (!f)
        return NEVH_EINVAL;
    return effects(f, true, t, q, p, h);
}

int nevh__field_moving_effects(nevh_field *f, double t, const double q[],
                               const double p[], double h[]) {
    return effects(f, false, t, q, p, h);
}

/* The group of a variable that an instance reads; `count`: it has none, or it
   is that of a variable before. */
static size_t new_group(const nevh__planned *term, size_t instance, size_t k,
                        size_t count, const size_t group[]) {
    size_t own = group[nevh__index(term, instance, k)];
    for (size_t i = 0; own < count && i < k; i++)
        if (group[nevh__index(term, instance, i)] == own)
            return count;
    return own < count ? own : count;
}

static int add_groups(nevh_field *f, nevh__planned *term, nevh__block b,
                      size_t count, const size_t group[], double h[]) {
    int status = NEVH_OK;
    while (!status && nevh__block_next(f, term, &b)) {
        status = nevh__block_values(f, term, &b);
        for (size_t i = 0; !status && i < b.groups; i++)
            for (size_t k = 0; k < term->nv; k++) {
                size_t own = new_group(term, b.group + i, k, count, group);
                if (own < count)
                    h[own] += f->h[i];
            }
    }
    return status;
}

int nevh_field_groups(nevh_field *f, double t, const double q[],
                      const double p[], size_t count, const size_t group[],
                      double h[]) {
    if (!f)
        return NEVH_EINVAL;
    int status = nevh__field_ready(f);
    for (size_t g = 0; g < count; g++)
        h[g] = 0;
    for (size_t i = 0; !status && i < f->n_terms; i++)
        status =
            add_groups(f, &f->terms[i], nevh__block_over(1, &t, q, p, 1, 1),
                       count, group, h);
    return status;
}

static int add_noise(nevh_field *f, nevh__planned *term, nevh__block b,
                     double noise_q[], double noise_p[]) {
    int status = NEVH_OK;
    while (!status && nevh__block_next(f, term, &b)) {
        status = nevh__block_values(f, term, &b);
        for (size_t i = 0; !status && i < b.groups * term->nv; i++) {
            size_t at = i / term->nv, k = i % term->nv;
            size_t instance = b.group + at;
            double *noise = k < term->nq ? noise_q : noise_p;
            noise[nevh__index(term, instance, k)] +=
                DBL_EPSILON * fabs(f->h[at]) /
                nevh__delta(f, term, instance, k, f->alone);
        }
    }
    return status;
}

int nevh__field_noise(nevh_field *f, double t, const double q[],
                      const double p[], double noise_q[], double noise_p[]) {
    for (size_t i = 0; i < f->n; i++)
        noise_q[i] = noise_p[i] = 0;
    int status = NEVH_OK;
    for (size_t i = 0; !status && i < f->n_terms; i++) {
        nevh__block b = nevh__block_over(1, &t, q, p, 1, 1);
        if (f->terms[i].delta)
            status = add_noise(f, &f->terms[i], b, noise_q, noise_p);
    }
    return status;
}
