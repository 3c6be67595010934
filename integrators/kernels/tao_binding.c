/* nevh: how firmly Tao's two copies are bound.

   The ratios r_k of the binding make a momentum comparable to its coordinate.
   They are those of the user's scales, where there are any; otherwise those at
   which H is curved alike in both:

       r_k^2 = |d2H/dq_k dq| / |d2H/dp_k dp|,

   root mean squares over states of a run from those to plan at.  For an
   oscillator that is sqrt(k m).

   omega must be large for the copies to stay together, while from order 4 on
   the error grows with it, and steps with 2 omega h near a multiple of pi may
   resonate.  In the coordinates q_k sqrt(r_k), p_k / sqrt(r_k) the binding is a
   circle, and the norm of the Hessian of H a frequency.  In units of its
   largest value N along the run, copies were seen to part within 1e5 steps
   where omega was below

                                   h      h N     tao2   tao4   tao6 (2 h)
       pendulum                    0.1    0.13    0.25   0.25   0.25
       (q^2 + 1)(p^2 + 1)/2        0.01   0.1     0.2    0.2    0.2
       Henon-Heiles, E = 1/12      0.1    0.15    0.2    0.2    0.2
       Kepler, e = 0.3             0.05   0.17    0.8    0.8    0.8
       Kepler, e = 0.6             0.01   0.09    0.6    0.6    0.6
       double pendulum, regular    0.01   0.15    1.3    1.3    1.6
       double pendulum, chaotic    0.01   0.15    1.6    1.3    1.3
       double pendulum, from rest  0.01   0.17    1.3    1.3    1.3
       charge in a magnetic field  0.05   0.15    never  never  never

   so twice the most is taken.  An orbit that goes on to where H is curved much
   more than on the run (some ten periods) wants a binding given.

   Other units of q, p and t change nothing of all this where scales are given,
   nor where they are powers of two times the first; else, lengths being found
   in powers of two, ratios may shift by a few per cent.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tao_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>

static const double firmness = 3;   /* omega over the largest norm */
static const double reach = 0x1p-7; /* of differences, in lengths */
static const double trust =
    4096; /* a curvature is noise so far below another */
enum { SWEEPS = 16 };

/* H around the states of a run. */
typedef struct {
    nevh__step_selection selection;
    nevh_field *field;
    size_t n;
    double *move;           /* 2n: by which a state is moved to both sides */
    double *point;          /* 2n */
    double *ahead, *behind; /* 2n: gradients there */
    double *unit;           /* 2n: sqrt(1/r), then sqrt(r) */
    double *curved;         /* 2n: sums of squares */
} survey;

static void close_survey(survey *s) {
    nevh__step_selection_clear(&s->selection);
    free(s->move);
    for (size_t i = 0; i < s->field->n_terms; i++)
        s->field->terms[i].values = 0;
    s->field->gradients = 0;
    s->field->report = (nevh__report){0};
}

static bool open_survey(survey *s, nevh_work *w) {
    size_t m = 2 * w->n;
    *s = (survey){.field = w->field, .n = w->n};
    s->move = nevh__array(6 * m, sizeof *s->move);
    if (!s->move)
        return false;
    s->point = s->move + m;
    s->ahead = s->point + m;
    s->behind = s->ahead + m;
    s->unit = s->behind + m;
    s->curved = s->unit + m;
    if (nevh__step_selection_init(&s->selection, w->field, w->options) ||
        !nevh__add_run(&s->selection))
        return false;
    nevh__find_neighbours(&s->selection);
    return true;
}

static bool gradient_beside(survey *s, size_t at, double sign, double out[]) {
    const nevh__samples *z = &s->selection.samples;
    size_t n = s->n;
    for (size_t i = 0; i < n; i++) {
        s->point[i] = z->q[at * n + i] + sign * s->move[i];
        s->point[n + i] = z->p[at * n + i] + sign * s->move[n + i];
    }
    return nevh_field_gradient(s->field, 1, &z->t[at], s->point, s->point + n,
                               out, out + n) == NEVH_OK;
}

/* The Hessian times twice the move, to ahead; false where H is not finite. */
static bool differ(survey *s, size_t at) {
    if (!gradient_beside(s, at, 1, s->ahead) ||
        !gradient_beside(s, at, -1, s->behind))
        return false;
    for (size_t i = 0; i < 2 * s->n; i++)
        s->ahead[i] -= s->behind[i];
    return true;
}

/* Sums up how H is curved in q, and in p: moves in all coordinates by plus or
   minus their lengths, then in all momenta. */
static void add_curved(survey *s, size_t at, uint64_t *random) {
    for (size_t first = 0; first <= s->n; first += s->n) {
        for (size_t i = 0; i < 2 * s->n; i++) {
            double part = nevh__random(random) < 0 ? -reach : reach;
            bool moves = i >= first && i < first + s->n;
            s->move[i] = moves ? part * s->selection.length[i] : 0;
        }
        if (!differ(s, at))
            continue;
        for (size_t i = first; i < first + s->n; i++) {
            double curved = s->ahead[i] * s->selection.length[i];
            s->curved[i] += curved * curved;
        }
    }
}

/* Rounded to an eighth of an octave: at which states the run is looked at rests
   on the last digits of its gradients, and the binding should not. */
static double steady(double x) {
    static const double eighths = 11.541560327111707; /* 8/log(2) */
    return nevh_simd_pow(2, round(nevh_simd_log(x) * eighths) / 8);
}

/* Variations of H by its curvature in q_k and in p_k, within their lengths, and
   the action that the lengths span. */
typedef struct {
    double q, p, action;
    bool both; /* neither is missing */
} bend;

static bend bend_of(const survey *s, size_t k) {
    const double *length = s->selection.length;
    bend b = {.q = sqrt(s->curved[k]),
              .p = sqrt(s->curved[s->n + k]),
              .action = length[k] * length[s->n + k]};
    b.both = b.q * trust > b.p && b.p * trust > b.q;
    return b;
}

/* If one of the two is missing, as for a coordinate that H does not depend on, the
   other is set to the largest frequency found; if nothing is curved, the scales
   remain. */
static void find_ratios(survey *s, const double scale[], double ratio[]) {
    const double *length = s->selection.length;
    uint64_t random = 1;
    double frequency = 0;
    for (size_t at = 0; at < s->selection.neighbours; at++)
        add_curved(s, at, &random);
    for (size_t k = 0; k < s->n; k++) {
        bend b = bend_of(s, k);
        if (b.both)
            frequency = fmax(frequency, sqrt(b.q) * sqrt(b.p) / b.action);
    }
    for (size_t k = 0; k < s->n; k++) {
        bend b = bend_of(s, k);
        double other = frequency * b.action;
        double part = b.both      ? sqrt(b.q / b.p)
                      : b.q > b.p ? b.q / other
                                  : other / b.p;
        bool usable = part > 0 && part <= DBL_MAX;
        ratio[k] = usable ? length[s->n + k] / length[k] * steady(part)
                          : scale[s->n + k] / scale[k];
    }
}

/* Makes a vector one of unit length, and returns the length it had. */
static double normalise(size_t count, double v[]) {
    double most = 0, sum = 0;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, fabs(v[i]));
    if (!(most > 0 && most <= DBL_MAX))
        return 0;
    for (size_t i = 0; i < count; i++)
        sum += (v[i] / most) * (v[i] / most);
    for (size_t i = 0; i < count; i++)
        v[i] = v[i] / most / sqrt(sum);
    return most * sqrt(sum);
}

/* The norm of the Hessian at a sample by the power method; 0 where H is not
   finite beside it.  v: 2n, what the method works on. */
static double curvature(survey *s, size_t at, double step, double v[]) {
    size_t m = 2 * s->n;
    double norm = 0;
    uint64_t random = 1;
    for (size_t i = 0; i < m; i++)
        v[i] = nevh__random(&random);
    normalise(m, v);
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        for (size_t i = 0; i < m; i++)
            s->move[i] = step * v[i] * s->unit[i];
        if (!differ(s, at))
            return 0;
        for (size_t i = 0; i < m; i++)
            v[i] = s->ahead[i] * s->unit[i] / (2 * step);
        if ((norm = normalise(m, v)) == 0)
            return 0;
    }
    return norm;
}

/* The largest curvature on the run; of nearby states if nothing is curved on it. */
static double largest_curvature(survey *s, const double ratio[]) {
    const nevh__step_selection *e = &s->selection;
    double step = INFINITY, first = 0, most = 0;
    for (size_t k = 0; k < s->n; k++) {
        s->unit[k] = 1 / sqrt(ratio[k]);
        s->unit[s->n + k] = sqrt(ratio[k]);
        step = fmin(step, sqrt(e->length[k]) * sqrt(e->length[s->n + k]));
    }
    for (size_t at = 0; at < e->samples.count; at++) {
        if (at < e->neighbours || most == 0)
            most = fmax(most, curvature(s, at, reach * step, s->curved));
        first = first > 0 ? first : most;
    }
    return first > 0 ? first * steady(most / first) : 0;
}

int nevh__binding_choose(nevh_work *w, nevh__binding *b) {
    const nevh_options *o = w->options;
    if (!(o->binding >= 0 && o->binding <= DBL_MAX))
        return nevh_work_fail(w, NEVH_EINVAL,
                              "the binding %g is not a positive number",
                              o->binding);
    b->omega = o->binding;
    int status = nevh_work_find_scale(w);
    if (status)
        return status;
    for (size_t k = 0; k < w->n; k++)
        b->ratio[k] = w->scale[w->n + k] / w->scale[k];
    if (o->binding > 0 && o->scale)
        return NEVH_OK;
    survey s;
    bool open = open_survey(&s, w);
    if (open && !o->scale)
        find_ratios(&s, w->scale, b->ratio);
    if (open && o->binding == 0)
        b->omega = firmness * largest_curvature(&s, b->ratio);
    close_survey(&s);
    return open ? NEVH_OK : nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
}
