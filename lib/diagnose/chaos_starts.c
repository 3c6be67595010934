/* nevh: states and displacements that the analysis of chaos starts from.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/chaos_private.h"
#include <math.h>
#include <string.h>

static const double apart = 1e-4; /* starts, in lengths of H */
enum { TRIES = 8 };

static double drawn(uint64_t *state) {
    /* A sum of three uniform numbers: bell-shaped, of variance 1. */
    return nevh__random(state) + nevh__random(state) + nevh__random(state);
}

/* Moves z = (q, p) along the gradient, in lengths, to the energy. */
static int to_energy(nevh_chaos *c, double z[], double energy) {
    size_t n = c->n;
    const double *length = c->options.scale;
    double best = INFINITY;
    for (int i = 0; i < TRIES; i++) {
        double h, square = 0;
        int status = nevh_field_value(c->field, 1, &c->t_start, z, z + n, &h);
        if (!status)
            status = nevh_field_gradient(c->field, 1, &c->t_start, z, z + n,
                                         c->slope, c->slope + n);
        if (status)
            return status;
        for (size_t k = 0; k < 2 * n; k++)
            square += pow(c->slope[k] * length[k], 2);
        if (!(square > 0) || !(fabs(h - energy) < best))
            break;
        best = fabs(h - energy);
        for (size_t k = 0; k < 2 * n; k++)
            z[k] -= (h - energy) / square * length[k] * length[k] * c->slope[k];
    }
    return NEVH_OK;
}

/* To lane 0 of a start, of which the others are copies. */
static void put_state(nevh_chaos *c, size_t start, const double z[]) {
    size_t n = c->n, from = c->tangent ? n : 0;
    for (size_t i = 0; i < c->lanes; i++)
        for (size_t k = 0; k < n; k++) {
            size_t lane = start * c->lanes + i;
            c->q[k * c->width + lane] = z[k];
            c->p[(from + k) * c->width + lane] = z[n + k];
        }
}

/* Orthonormal displacements, the same for all starts but for the numbers drawn;
   deviations and frame each. */
static void draw_vectors(nevh_chaos *c, size_t start, uint64_t *state) {
    size_t m = 2 * c->n, vectors = nevh__chaos_vectors(c);
    nevh__chaos_start *s = &c->start[start];
    for (size_t v = 0; v < vectors; v++) {
        double *w = s->w + v * m, norm = 0;
        size_t first = v < c->deviations ? 0 : c->deviations;
        for (size_t k = 0; k < m; k++)
            w[k] = drawn(state);
        for (size_t twice = 0; twice < 2; twice++)
            for (size_t u = first; u < v; u++)
                nevh__chaos_remove_part(w, s->w + u * m, m);
        for (size_t k = 0; k < m; k++)
            norm += w[k] * w[k];
        for (size_t k = 0; k < m; k++)
            w[k] /= sqrt(norm);
        s->norm[v] = 1;
    }
}

static void chaos_starts_forget(nevh_chaos *c, nevh__chaos_start *s) {
    memset(s->log, 0, nevh__chaos_logs(c) * NEVH__BINS * sizeof *s->log);
    s->moment = s->indicator = s->area = s->moved = 0;
    s->sali = sqrt(2);
    for (size_t k = 0; k <= c->deviations; k++)
        s->gali[k] = 1;
    s->clock = (nevh__chaos_clock){.looks_a_bin = 1};
}

static void forget_all(nevh_chaos *c) {
    memset(c->q, 0, 2 * c->n * c->width * sizeof *c->q);
    memset(c->p, 0, 2 * c->n * c->width * sizeof *c->p);
    c->stride = c->first_stride;
    nevh_stepper_reset(c->stepper);
}

uint64_t nevh__chaos_draw(const nevh_chaos *c, size_t number) {
    uint64_t state = (c->seed + 1) * 0x9e3779b97f4a7c15u + number;
    for (int k = 0; k < 4; k++)
        nevh__random(&state);
    return state;
}

void nevh__chaos_place(nevh_chaos *c, size_t start, const double z[],
                       uint64_t *drawn_from) {
    chaos_starts_forget(c, &c->start[start]);
    put_state(c, start, z);
    for (size_t k = 0; k < 2 * c->n; k++) {
        double x = c->start[start].first[k] = z[k] / c->options.scale[k];
        c->start[start].course[k] = (nevh__course){.low = x, .high = x};
    }
    draw_vectors(c, start, drawn_from);
    for (size_t v = 0; v < nevh__chaos_vectors(c); v++)
        nevh__chaos_put(c, start, v);
}

void nevh__chaos_fill_up(nevh_chaos *c) {
    size_t used = c->starts * c->lanes, rows = c->tangent ? 2 * c->n : c->n;
    for (size_t k = 0; k < rows; k++)
        for (size_t lane = used; lane < c->width; lane++) {
            c->q[k * c->width + lane] = c->q[k * c->width + used - 1];
            c->p[k * c->width + lane] = c->p[k * c->width + used - 1];
        }
}

int nevh__chaos_begin(nevh_chaos *c) {
    size_t m = 2 * c->n;
    double energy;
    int status = nevh_field_value(c->field, 1, &c->t_start, c->own,
                                  c->own + c->n, &energy);
    forget_all(c);
    c->mark = c->largest = 0;
    c->kinks = 0;
    for (size_t i = 0; !status && i < c->starts; i++) {
        uint64_t state = nevh__chaos_draw(c, i);
        memcpy(c->place, c->own, m * sizeof *c->own);
        for (size_t k = 0; i && k < m; k++)
            c->place[k] += apart * c->options.scale[k] * drawn(&state);
        if (i)
            status = to_energy(c, c->place, energy);
        nevh__chaos_place(c, i, c->place, &state);
    }
    nevh__chaos_fill_up(c);
    return status ? nevh__fail(&c->report, status, "%s",
                               nevh_field_message(c->field))
                  : NEVH_OK;
}
