/* nevh: is a term's own gradient that of its values?

   Compared with differences of order 8 at two steps, at a few states.  Where
   the two steps do not agree (a kink, the edge of the domain) or something is
   not finite, nothing is said.  Steps may be too long for ripples of a wide well:
   shorter ones decide.  A deviation may also be rounding of numbers that
   the term adds up and that are larger than its value or its derivative, as
   those of a charge at rest in a magnetic field are.  What they amount to is
   read from states near by: rounding scatters there, an error does not.

   A point gradient must be the gradient to the last bit, so that an orbit does
   not depend on how many there are.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/block_private.h"
#include "gradient/evaluation_private.h"
#include "gradient/step_selection_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double tolerance = 1e-6;
enum { ROUNDS = 4 };
static const double long_step = 0x1p-6, short_step = 0x1p-8; /* of lengths */
/* States near by; the first is displaced by at most a part of the lengths, each
   further one by a 16th of that. */
enum { NEAR_BY = 8, SHORTER = 4 };
static const double farthest = 0x1p-12, nearer = 0x1p-4;
static const double scattered = 4;   /* an error is larger than its scatter */
static const double far_larger = 64; /* than the deviations near by */

typedef struct {
    nevh__step_selection *selection;
    const nevh__planned *term;
    size_t instance;
    double *own; /* nv derivatives of the term's own */
} check;

static nevh__axis axis_of(const check *c, size_t k) {
    return (nevh__axis){c->selection, c->term, c->instance, k};
}

/* Adds to *noise what rounding or underflow of values may do to it. */
static double by_difference(const check *c, size_t k, size_t at, double delta,
                            double *noise) {
    static const double underflow = 0x1p-511; /* whose square is DBL_MIN: of 1/x
                                                 the derivative has x^2 */
    double move[8], x[8], h[8];
    for (size_t j = 0; j < 4; j++) {
        move[2 * j] = (double)(j + 1) * delta;
        move[2 * j + 1] = -move[2 * j];
    }
    const nevh__axis axis = axis_of(c, k);
    nevh__sample_line(&axis, at, 8, move, x, h);
    for (size_t j = 0; j < 4; j++) {
        double weight = nevh_central8->weights[j] / (x[2 * j] - x[2 * j + 1]);
        double rounding = 0;
        for (size_t i = 2 * j; i < 2 * j + 2; i++)
            rounding =
                fmax(rounding, nevh__sample_rounding(&axis, at, move[i], h[i]));
        *noise += 4 * fabs(weight) * (rounding + underflow);
    }
    return nevh__chord_slope(nevh_central8, 1, x, h);
}

/* The term's own derivatives at one sample, from a block of equal lanes. */
static void ask_term(const check *c, size_t at) {
    nevh_field *f = c->selection->field;
    const nevh__planned *term = c->term;
    const nevh_term *decl = &term->term->decl;
    double move[NEVH__LANES] = {0}, x[NEVH__LANES], h[NEVH__LANES];
    const nevh__axis axis = axis_of(c, 0);
    nevh__sample_line(&axis, at, NEVH__LANES, move, x, h);
    double *q = f->rows, *p = q + term->nq * NEVH__LANES;
    double *dp = f->slopes + term->nq * NEVH__LANES;
    decl->gradient(NEVH__LANES, decl->time ? f->times : f->zeros, q, p,
                   p + term->np * NEVH__LANES, decl->params, f->slopes, dp);
    for (size_t k = 0; k < term->nv; k++)
        c->own[k] = f->slopes[k * NEVH__LANES];
}

static const char *verify_variable(const check *c, size_t k,
                                   char text[NEVH__VARIABLE]) {
    return nevh__variable_name(c->selection->field->system, k >= c->term->nq,
                               nevh__index(c->term, c->instance, k), text);
}

static int wrong(const check *c, size_t k, double own, double difference) {
    const nevh_term *decl = &c->term->term->decl;
    char text[NEVH__VARIABLE];
    return nevh__fail(
        &c->selection->field->report, NEVH_ENOGRAD,
        "the exact gradient of term \"%s\" of effect \"%s\" is wrong: its "
        "derivative with respect to %s is %.9g where differences of its "
        "values give %.9g",
        decl->name, decl->effect, verify_variable(c, k, text), own, difference);
}

/* The term's own derivative less that of its values, and how much the latter may
   be off; NAN where nothing can be said. */
typedef struct {
    double own, near, deviation, allowed;
} comparison;

static double verify_length_of(const check *c, size_t k) {
    size_t i = nevh__index(c->term, c->instance, k);
    return c->selection
        ->length[k < c->term->nq ? i : c->selection->field->n + i];
}

static comparison verify_compare(const check *c, size_t k, size_t at,
                                 double length) {
    double noise = 0, own = c->own[k];
    double near = by_difference(c, k, at, short_step * length, &noise);
    double far = by_difference(c, k, at, long_step * length, &noise);
    double allowed =
        tolerance * fmax(fabs(near), fabs(own)) + 64 * fabs(near - far) + noise;
    bool defined = isfinite(own) && isfinite(allowed);
    return (comparison){own, near, defined ? own - near : NAN, allowed};
}

static bool deviates(const comparison *d) {
    return fabs(d->deviation) > d->allowed;
}

/* True if shorter steps, where rounding would not hide the deviation, have none:
   there are ripples that the lengths do not know. */
static bool agrees_nearer(const check *c, size_t k, size_t at,
                          double deviation) {
    double length = verify_length_of(c, k);
    for (int i = 0; i < SHORTER; i++) {
        length *= nearer;
        comparison d = verify_compare(c, k, at, length);
        if (!deviates(&d) && d.allowed < fabs(deviation) / scattered)
            return true;
    }
    return false;
}

/* Sample `to` becomes sample `at`, the variables of the instance displaced by
   parts of their lengths, or of themselves where they are shorter. */
static void displace(const check *c, size_t at, size_t to, double part,
                     bool of_shorter, uint64_t *seed) {
    nevh__samples *s = &c->selection->samples;
    size_t n = c->selection->field->n;
    s->t[to] = s->t[at];
    memcpy(s->q + to * n, s->q + at * n, n * sizeof *s->q);
    memcpy(s->p + to * n, s->p + at * n, n * sizeof *s->p);
    for (size_t k = 0; k < c->term->nv; k++) {
        double *x = (k < c->term->nq ? s->q : s->p) + to * n +
                    nevh__index(c->term, c->instance, k);
        double length = verify_length_of(c, k);
        if (of_shorter && *x != 0)
            length = fmin(length, fabs(*x));
        *x += part * length * nevh__random(seed);
    }
}

/* True if nearby states deviate by about as much, or hardly at all, so that only
   this state is wrong. */
static bool is_error(const check *c, size_t k, size_t at, double deviation) {
    size_t to = c->selection->samples.most, count = 1;
    double sum = 1, squares = 1, most = 0; /* parts of that deviation */
    bool all = true;
    uint64_t seed = at + 1;
    double away = farthest;
    for (int i = 0; i < NEAR_BY; i++, away *= nearer) {
        displace(c, at, to, away, i % 2, &seed);
        ask_term(c, to);
        comparison d = verify_compare(c, k, to, verify_length_of(c, k));
        double part = d.deviation / deviation;
        if (!isfinite(part))
            continue;
        all &= deviates(&d);
        most = fmax(most, fabs(part));
        sum += part;
        squares += part * part;
        count++;
    }
    double mean = sum / (double)count;
    double variance = fmax(0, squares / (double)count - mean * mean);
    return (all && fabs(mean) > scattered * sqrt(variance)) ||
           far_larger * most < 1;
}

static int check_sample(const check *c, size_t at) {
    const nevh__planned *term = c->term;
    ask_term(c, at);
    for (size_t k = 0; k < term->nv; k++) {
        comparison d = {0};
        if (nevh__probed(term, k) == k)
            d = verify_compare(c, k, at, verify_length_of(c, k));
        if (!deviates(&d))
            continue;
        if (!agrees_nearer(c, k, at, d.deviation) &&
            is_error(c, k, at, d.deviation))
            return wrong(c, k, d.own, d.near);
        ask_term(c, at); /* is_error asked elsewhere */
    }
    return NEVH_OK;
}

static bool verify_same(double a, double b) {
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

static int unlike(const check *c, size_t k, double point, double block) {
    const nevh_term *decl = &c->term->term->decl;
    char text[NEVH__VARIABLE];
    return nevh__fail(
        &c->selection->field->report, NEVH_ENOGRAD,
        "the point gradient of term \"%s\" of effect \"%s\" is not its "
        "gradient to the last bit: the derivative with respect to %s is "
        "%.17g where that of a block is %.17g; what is said of NEVH_GRADIENT "
        "in <nevh/body.h> may help, and to leave it out",
        decl->name, decl->effect, verify_variable(c, k, text), point, block);
}

/* Fills a block with one sample and neighbours of it, of which nothing is known
   but that other last bits come up. */
static void verify_spread(const check *c, size_t at, size_t round) {
    nevh_field *f = c->selection->field;
    double move[NEVH__LANES] = {0}, x[NEVH__LANES], h[NEVH__LANES];
    uint64_t seed = ROUNDS * at + round;
    const nevh__axis axis = axis_of(c, 0);
    nevh__sample_line(&axis, at, NEVH__LANES, move, x, h);
    for (size_t k = 0; k < c->term->nv; k++)
        for (size_t lane = 1; lane < NEVH__LANES; lane++)
            f->rows[k * NEVH__LANES + lane] +=
                long_step * verify_length_of(c, k) * nevh__random(&seed);
    for (size_t lane = 1; lane < NEVH__LANES; lane++)
        f->times[lane] += long_step * fabs(nevh__random(&seed));
}

/* One lane, where either half may not be asked for. */
static int check_lane(const check *c, size_t lane, bool of_q, bool of_p) {
    const nevh__planned *term = c->term;
    const nevh_term *decl = &term->term->decl;
    nevh_field *f = c->selection->field;
    double *q = f->one, *p = q + term->nq, *own = c->own;
    for (size_t k = 0; k < term->nv + decl->nc; k++)
        q[k] = f->rows[k * NEVH__LANES + lane];
    for (size_t k = 0; k < term->nv; k++)
        own[k] = NAN;
    decl->point_gradient(decl->time ? f->times[lane] : 0, q, p, p + term->np,
                         decl->params, of_q ? own : NULL,
                         of_p ? own + term->nq : NULL);
    for (size_t k = of_q ? 0 : term->nq; k < (of_p ? term->nv : term->nq); k++)
        if (!verify_same(own[k], f->slopes[k * NEVH__LANES + lane]))
            return unlike(c, k, own[k], f->slopes[k * NEVH__LANES + lane]);
    return NEVH_OK;
}

/* Together first: what takes one half for the other would write nowhere.  Alone
   only in the first round: that is another text, but seldom other bits. */
static int check_point(const check *c, size_t at, size_t round) {
    static const bool asked[][2] = {{true, true}, {true, false}, {false, true}};
    const nevh__planned *term = c->term;
    const nevh_term *decl = &term->term->decl;
    nevh_field *f = c->selection->field;
    double *q = f->rows, *p = q + term->nq * NEVH__LANES;
    double *dp = f->slopes + term->nq * NEVH__LANES;
    int status = NEVH_OK;
    verify_spread(c, at, round);
    for (size_t i = 0; !status && i < (round ? 1 : 3); i++) {
        decl->gradient(NEVH__LANES, decl->time ? f->times : f->zeros, q, p,
                       p + term->np * NEVH__LANES, decl->params,
                       asked[i][0] ? f->slopes : NULL, asked[i][1] ? dp : NULL);
        for (size_t lane = 0; !status && lane < NEVH__LANES; lane++)
            status = check_lane(c, lane, asked[i][0], asked[i][1]);
    }
    return status;
}

/* Thoroughly where it will be called. */
static int check_points(const check *c, size_t at) {
    const nevh_term *decl = &c->term->term->decl;
    size_t rounds = decl->count <= NEVH__MOST_PARTS ? ROUNDS : 1;
    int status = NEVH_OK;
    for (size_t i = 0; decl->point_gradient && !status && i < rounds; i++)
        status = check_point(c, at, i);
    return status;
}

int nevh__verify(nevh__step_selection *e, const nevh__planned *term) {
    size_t count = term->term->decl.count, stride = nevh__stride(count);
    check c = {e, term, 0, nevh__array(term->nv, sizeof *c.own)};
    if (!c.own)
        return nevh__no_memory(&e->field->report);
    int status = NEVH_OK;
    for (; !status && c.instance < count; c.instance += stride)
        for (size_t at = 0; !status && at < e->samples.count; at++)
            if (!(status = check_sample(&c, at)))
                status = check_points(&c, at);
    free(c.own);
    return status;
}
