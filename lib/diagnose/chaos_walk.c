/* nevh: orbits and displacements are taken forward, and growth is written down.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/chaos_private.h"
#include "diagnose/kinks_private.h"
#include "run/stepper_private.h"
#include <fenv.h>
#include <math.h>
#include <string.h>

/* The distance of nearby orbits, on either side, in lengths of H. */
static const double near_by = 1e-5;
/* Displacements are made unit vectors again beyond that size, and looked at
   more often where they grow by more. */
static const double most_size = 1e3, most_growth = 3;

static double *row_q(nevh_chaos *c, size_t k) {
    return c->q + k * c->width;
}

static double *row_p(nevh_chaos *c, size_t k) {
    return c->p + k * c->width;
}

/* A lane that was changed has no memory. */
static void chaos_walk_forget(nevh_chaos *c, size_t lane) {
    nevh_stepper *s = c->stepper;
    for (size_t row = 0; row < s->rows; row++)
        s->work.memory[row * c->width + lane] = 0;
}

/* Lanes of vector v: of tangents its own, else on either side of the orbit. */
void nevh__chaos_put(nevh_chaos *c, size_t start, size_t v) {
    const double *w = c->start[start].w + v * 2 * c->n, *s = c->options.scale;
    size_t n = c->n, first = start * c->lanes, a = first + 2 * v + 1;
    if (c->tangent)
        chaos_walk_forget(c, first + v);
    for (size_t k = 0; k < n; k++) {
        double x = w[k] * s[k], y = w[n + k] * s[n + k];
        if (c->tangent) {
            row_q(c, n + k)[first + v] = x;
            row_p(c, k)[first + v] = y;
            continue;
        }
        double q = row_q(c, k)[first], p = row_p(c, k)[first];
        row_q(c, k)[a] = q + near_by * x;
        row_p(c, k)[a] = p + near_by * y;
        row_q(c, k)[a + 1] = q - near_by * x;
        row_p(c, k)[a + 1] = p - near_by * y;
    }
}

static void chaos_walk_take(nevh_chaos *c, size_t start, size_t v) {
    double *w = c->start[start].w + v * 2 * c->n;
    const double *s = c->options.scale;
    size_t n = c->n, first = start * c->lanes, a = first + 2 * v + 1;
    for (size_t k = 0; k < n; k++) {
        double *q = row_q(c, k), *p = row_p(c, k);
        double x = c->tangent ? row_q(c, n + k)[first + v]
                              : (q[a] - q[a + 1]) / (2 * near_by);
        double y = c->tangent ? row_p(c, k)[first + v]
                              : (p[a] - p[a + 1]) / (2 * near_by);
        w[k] = x / s[k];
        w[n + k] = y / s[n + k];
    }
}

static double chaos_walk_dot(const double a[], const double b[], size_t m) {
    double sum = 0;
    for (size_t k = 0; k < m; k++)
        sum += a[k] * b[k];
    return sum;
}

static void scale_by(double a[], double x, size_t m) {
    for (size_t k = 0; k < m; k++)
        a[k] *= x;
}

void nevh__chaos_remove_part(double b[], const double a[], size_t m) {
    double x = chaos_walk_dot(a, b, m);
    for (size_t k = 0; k < m; k++)
        b[k] -= x * a[k];
}

/* Makes v orthogonal to the unit vectors before it, and a unit vector.
   returns  its length before */
static double orthonormalise(double all[], size_t v, size_t m) {
    double *w = all + v * m;
    for (int twice = 0; twice < 2; twice++)
        for (size_t u = 0; u < v; u++)
            nevh__chaos_remove_part(w, all + u * m, m);
    double length = sqrt(chaos_walk_dot(w, w, m));
    if (length > 0)
        scale_by(w, 1 / length, m);
    return length;
}

static void add_growth(nevh__chaos_start *s, size_t log, double growth) {
    s->log[log * NEVH__BINS + s->clock.bin] += growth;
}

/* The indices of the deviations, as unit vectors in `place`. */
static void index_alignment(nevh_chaos *c, nevh__chaos_start *s) {
    size_t m = 2 * c->n;
    double plus = 0, minus = 0, volume = 1;
    memcpy(c->place, s->w, c->deviations * m * sizeof *s->w);
    for (size_t v = 0; v < c->deviations; v++)
        scale_by(
            c->place + v * m,
            1 / sqrt(chaos_walk_dot(c->place + v * m, c->place + v * m, m)), m);
    for (size_t k = 0; k < m; k++) {
        plus += pow(c->place[k] + c->place[m + k], 2);
        minus += pow(c->place[k] - c->place[m + k], 2);
    }
    s->sali = sqrt(fmin(plus, minus));
    if (c->of_members)
        return;
    for (size_t v = 0; v < c->deviations; v++) {
        volume *= orthonormalise(c->place, v, m);
        s->gali[v + 1] = volume;
    }
    s->gali[2] = sqrt(plus * minus) / 2;
}

/* A deviation: its growth since the last look; NAN where it overflowed. */
static double look_at_deviation(nevh_chaos *c, size_t start, size_t v) {
    nevh__chaos_start *s = &c->start[start];
    double *w = s->w + v * 2 * c->n;
    chaos_walk_take(c, start, v);
    double norm = sqrt(chaos_walk_dot(w, w, 2 * c->n)), before = s->norm[v];
    if (!isfinite(norm) || norm == 0)
        return NAN;
    s->norm[v] = norm;
    if (!c->tangent || norm > most_size || norm < 1 / most_size) {
        scale_by(w, 1 / norm, 2 * c->n);
        s->norm[v] = 1;
        nevh__chaos_put(c, start, v);
    }
    return log(norm / before);
}

static double look_at_frame(nevh_chaos *c, size_t start) {
    nevh__chaos_start *s = &c->start[start];
    double *first = s->w + c->deviations * 2 * c->n, most = 0;
    for (size_t v = 0; v < c->frame; v++)
        chaos_walk_take(c, start, c->deviations + v);
    for (size_t v = 0; v < c->frame; v++) {
        double growth = log(orthonormalise(first, v, 2 * c->n));
        if (!isfinite(growth))
            return NAN;
        most = fmax(most, fabs(growth));
        add_growth(s, v, growth);
        nevh__chaos_put(c, start, c->deviations + v);
    }
    return most;
}

/* The orbit's lanes are made equal: implicit stages end as their tolerance
   lets them. */
static void align_orbit(nevh_chaos *c, size_t start) {
    size_t first = start * c->lanes, bytes = sizeof(double);
    for (size_t i = 1; c->tangent && i < c->lanes; i++) {
        bool same = true;
        for (size_t k = 0; k < c->n; k++) {
            double *q = row_q(c, k) + first, *p = row_p(c, c->n + k) + first;
            same = same && !memcmp(q, q + i, bytes) && !memcmp(p, p + i, bytes);
            q[i] = q[0];
            p[i] = p[0];
        }
        if (!same)
            chaos_walk_forget(c, first + i);
    }
}

/* A range that has grown was not that of the motion: crossings of it are not yet
   known. */
static void chaos_walk_follow(nevh__course *v, double x) {
    static const double grown = 1.05, quarter = 0.25;
    double before = v->high - v->low;
    v->low = fmin(v->low, x);
    v->high = fmax(v->high, x);
    double range = v->high - v->low;
    if (range > grown * before)
        v->crossings = v->side = 0;
    int side = x < v->low + quarter * range    ? -1
               : x > v->high - quarter * range ? 1
                                               : 0;
    v->crossings += side * v->side < 0;
    v->side = side ? side : v->side;
}

static void look_at_orbit(nevh_chaos *c, size_t start) {
    nevh__chaos_start *s = &c->start[start];
    size_t lane = start * c->lanes, from = c->tangent ? c->n : 0;
    for (size_t k = 0; k < c->n; k++) {
        const double *scale = c->options.scale + k;
        double q = row_q(c, k)[lane] / scale[0];
        double p = row_p(c, from + k)[lane] / scale[c->n];
        s->moved = fmax(s->moved, fabs(q - s->first[k]));
        s->moved = fmax(s->moved, fabs(p - s->first[c->n + k]));
        chaos_walk_follow(&s->course[k], q);
        chaos_walk_follow(&s->course[c->n + k], p);
    }
}

/* returns  the largest growth; NAN where something is not finite */
static double look_at_start(nevh_chaos *c, size_t start, double t0, double t1) {
    nevh__chaos_start *s = &c->start[start];
    double most = 0, before = s->indicator;
    align_orbit(c, start);
    if (!c->of_members)
        look_at_orbit(c, start);
    for (size_t v = 0; v < c->deviations; v++) {
        double growth = look_at_deviation(c, start, v);
        if (!isfinite(growth))
            return NAN;
        if (v == 0) {
            s->moment += (t0 + t1) / 2 * growth;
            if (!c->frame)
                add_growth(s, 0, growth);
        }
    }
    if (c->deviations > 1)
        index_alignment(c, s);
    s->indicator = 2 * s->moment / t1;
    s->area += (before + s->indicator) / 2 * (t1 - t0);
    if (c->frame)
        most = look_at_frame(c, start);
    return most;
}

static void merge_bins(const nevh_chaos *c, nevh__chaos_start *s) {
    nevh__chaos_clock *clock = &s->clock;
    size_t half = NEVH__BINS / 2, bytes = half * sizeof(double);
    for (size_t b = 0; b < half; b++)
        clock->span[b] = clock->span[2 * b] + clock->span[2 * b + 1];
    memset(clock->span + half, 0, bytes);
    for (size_t v = 0; v < nevh__chaos_logs(c); v++) {
        double *g = s->log + v * NEVH__BINS;
        for (size_t b = 0; b < half; b++)
            g[b] = g[2 * b] + g[2 * b + 1];
        memset(g + half, 0, bytes);
    }
    clock->bin = half;
    clock->looks_a_bin *= 2;
}

static void next_bin(const nevh_chaos *c, nevh__chaos_start *s) {
    nevh__chaos_clock *clock = &s->clock;
    if (++clock->looks < clock->looks_a_bin)
        return;
    clock->looks = 0;
    if (++clock->bin == NEVH__BINS)
        merge_bins(c, s);
}

double nevh__chaos_look(nevh_chaos *c, size_t start) {
    nevh__chaos_start *s = &c->start[start];
    nevh__chaos_clock *clock = &s->clock;
    double t0 = clock->seen * c->dt, t1 = clock->done * c->dt;
    double growth = look_at_start(c, start, t0, t1);
    if (!isfinite(growth))
        return growth;
    clock->span[clock->bin] += t1 - t0;
    clock->seen = clock->done;
    next_bin(c, s);
    return growth;
}

/* For jumps of the force between the first start's state and that an eighth of the
   steps ago. */
static void chaos_walk_search(nevh_chaos *c) {
    size_t n = c->n, at = c->tangent ? n : 0;
    double done = c->start[0].clock.done, h, roundoff, size;
    double t = c->t_start + done * c->way * c->dt, *now = c->marked + 2 * n;
    if (!c->searches || done < c->mark + c->mark / 8)
        return;
    for (size_t k = 0; k < n; k++) {
        now[k] = row_q(c, k)[0];
        now[n + k] = row_p(c, at + k)[0];
    }
    if (nevh__field_moving_values(c->field, 1, &t, now, now + n, &h, &roundoff,
                                  &size))
        return;
    c->largest = fmax(c->largest, size);
    if (c->mark > 0 && nevh__kink_between(c->field, t, c->marked, now,
                                          c->largest, true, now + 2 * n))
        c->kinks++;
    memcpy(c->marked, now, 2 * n * sizeof *now);
    c->mark = done;
}

static int chaos_walk_look(nevh_chaos *c, double steps) {
    double most = 0;
    for (size_t i = 0; i < c->starts; i++) {
        nevh__chaos_clock *clock = &c->start[i].clock;
        clock->done += steps;
        double growth = nevh__chaos_look(c, i);
        if (!isfinite(growth)) {
            clock->done -= steps;
            return nevh__fail(
                &c->report, NEVH_EDOM,
                "a displacement of start %zu has grown beyond "
                "all numbers, or vanished, at t = %.9g",
                i, c->t_start + (clock->done + steps) * c->way * c->dt);
        }
        most = fmax(most, growth);
    }
    nevh__chaos_fill_up(c);
    chaos_walk_search(c);
    if (most > most_growth && c->stride > 1)
        c->stride /= 2;
    return NEVH_OK;
}

double nevh__chaos_steps(const nevh_chaos *c, double until) {
    return rint(c->way * (until - c->t_start) / c->dt);
}

bool nevh__chaos_advance(nevh_chaos *c, double last) {
    double done = c->start[0].clock.done, stride = (double)c->stride;
    if (c->report.status || !(done < last))
        return false;
    /* Looks come at multiples of the stride, however a run is cut. */
    double steps = fmin(last - done, stride - fmod(done, stride));
    int status = nevh_run(c->stepper, c->t_start + done * c->way * c->dt,
                          c->way * c->dt, (size_t)steps, c->q, c->p, NULL, 0);
    if (status) {
        nevh__fail(&c->report, status, "%s", nevh_stepper_message(c->stepper));
        return false;
    }
    chaos_walk_look(c, steps);
    if (!c->tangent) /* what one lane remembers no other knows of */
        nevh_stepper_reset(c->stepper);
    return true;
}

int nevh_chaos_run(nevh_chaos *c, double until) {
    if (!c || !isfinite(until))
        return NEVH_EINVAL;
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    double last = nevh__chaos_steps(c, until);
    while (nevh__chaos_advance(c, last))
        ;
    fesetenv(&own);
    return c->report.status;
}
