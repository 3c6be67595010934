/* nevh: energy-preserving methods for any H by discrete gradients.

   A step is made of one part or more, each of which solves

       x = J D(z, z + h x)

   for the mean slope x.  What the solution leaves of rounding, and of its last
   sweep, would make the energy walk at random; so kernels that take values of H
   at both ends remember the energy that the orbit should have, and let the next
   part make up for what is lacking.  Where H reads t, that energy changes with
   t only: from one part to the next by H(t', z) - H(t, z).
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "discrete_gradient_private.h"
#include "work/work_private.h"
#include "gradient/field_private.h"
#include "implicit/implicit_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The fourth power of a |dz|, in units of the metric, so short that dz has no
   direction. */
static const double nowhere = 0x1p-136;
/* Defects of the energy up to so many roundings of H are tolerated, for no
   correction of them means anything. */
static const double tolerated = 4 * DBL_EPSILON;

typedef struct {
    nevh__tableau *nodes;
    nevh__stage_solver *solver;
    double *length; /* 2n */
    double *metric; /* 2n */
    size_t *lanes;  /* 0 to width */
    bool autonomous;
} gradient_plan;

/* Memory: what sums lost; slopes of each part in the last steps, and the h of
   these (0: there is none); whether there is an energy; it, in two parts, and
   the time it was taken at. */
enum { STEPS = 3 };
typedef struct {
    double *compensation;  /* 2n x width */
    double *slopes[STEPS]; /* parts x 2n x width each, the last step first */
    double *h[STEPS];      /* width */
    double *known, *energy, *roundoff, *t; /* width */
} remembered;

static const nevh__discrete_gradient *table_of(const nevh_work *w) {
    return w->integrator->table;
}

static size_t node_count(const nevh_work *w) {
    return table_of(w)->averages ? (size_t)w->integrator->stages : 1;
}

static void clear(nevh_work *w) {
    gradient_plan *g = w->plan;
    if (!g)
        return;
    nevh__tableau_free(g->nodes);
    nevh__stage_solver_free(g->solver);
    free(g->length);
    free(g->metric);
    free(g->lanes);
    free(g);
    w->plan = NULL;
}

/* The metric of what a term reads; curved[k]: of H, and `energy` is what H
   varies by, at most.  The part of it that a variable has within its length
   counts where it is small, in powers of 256: neighbours have the same. */
static void measure(const nevh_work *w, const nevh__planned *term,
                    double energy, const double curved[]) {
    const gradient_plan *g = w->plan;
    for (size_t at = 0; at < term->term->decl.count * term->nv; at++) {
        size_t v = at % term->nv;
        size_t k =
            nevh__index(term, at / term->nv, v) + (v < term->nq ? 0 : w->n);
        double part = curved[k] * g->length[k] * g->length[k] / energy;
        double weight = part > 0 ? exp2(4 * trunc(log2(part) / 8)) : 1;
        g->metric[k] = weight / g->length[k];
    }
}

/* In units of the lengths alone, light bodies would get a part of the energy
   that heavy ones deficit: where a gradient is corrected, units are of H.  Where
   quotients of H leave nothing but rounding to correct, lengths do. */
static int plan_metric(nevh_work *w) {
    const gradient_plan *g = w->plan;
    double energy = 0, *curved = nevh__array(2 * w->n, sizeof *curved);
    if (!curved)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    int status = nevh__field_lengths(w->field, w->options, g->length);
    if (!status && table_of(w)->averages)
        status = nevh__field_curvatures(w->field, w->options, curved);
    for (size_t k = 0; k < 2 * w->n; k++)
        energy = fmax(energy, curved[k] * g->length[k] * g->length[k]);
    for (size_t i = 0; !status && i < w->field->n_terms; i++)
        measure(w, &w->field->terms[i], energy, curved);
    free(curved);
    return status
               ? nevh_work_fail(w, status, "%s", nevh_field_message(w->field))
               : NEVH_OK;
}

/* The slope is that of one stage, near the middle. */
static const double middle = 0.5;
static const nevh__stage_shape shape = {1, false, &middle, &middle};

static int plan_parts(nevh_work *w, size_t nodes) {
    int status = nevh_work_find_scale(w);
    if (status)
        return status;
    gradient_plan *g = w->plan = nevh__array(1, sizeof *g);
    if (!g)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    g->nodes = nevh__gauss_new(nodes);
    g->length = nevh__array(2 * w->n, sizeof *g->length);
    g->metric = nevh__array(2 * w->n, sizeof *g->metric);
    g->lanes = nevh__array(w->width, sizeof *g->lanes);
    g->solver = nevh__stage_solver_new(w, &shape);
    if (!g->nodes || !g->length || !g->metric || !g->lanes || !g->solver)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    g->autonomous = nevh_system_traits(w->system) & NEVH_AUTONOMOUS;
    for (size_t lane = 0; lane < w->width; lane++)
        g->lanes[lane] = lane;
    return plan_metric(w);
}

static int plan(nevh_work *w) {
    const nevh__discrete_gradient *table = table_of(w);
    size_t nodes = node_count(w), all = 2 * w->size;
    if (nodes < 1 || nodes > NEVH__MOST_STAGES)
        return nevh_work_fail(w, NEVH_EINVAL,
                              "%s: %zu stages, where 1 to %d are possible",
                              w->integrator->name, nodes, NEVH__MOST_STAGES);
    int status = plan_parts(w, nodes);
    if (status)
        return status;
    w->memory_rows = 2 * w->n * (1 + STEPS * table->parts) + STEPS + 4;
    w->scratch_size = (w->memory_rows + 8) * w->width + 3 * all +
                      nodes * (2 * all + w->width) +
                      (table->own_size ? table->own_size(w) : 0);
    return NEVH_OK;
}

static double *take(double **from, size_t count) {
    double *taken = *from;
    *from += count;
    return taken;
}

static remembered find_memory(const nevh_work *w, double *from) {
    size_t width = w->width, slopes = 2 * w->size * table_of(w)->parts;
    remembered m = {.compensation = take(&from, 2 * w->size)};
    for (int i = 0; i < STEPS; i++)
        m.slopes[i] = take(&from, slopes);
    for (int i = 0; i < STEPS; i++)
        m.h[i] = take(&from, width);
    m.known = take(&from, width);
    m.energy = take(&from, width);
    m.roundoff = take(&from, width);
    m.t = take(&from, width);
    return m;
}

static nevh__values take_values(double **from, size_t count) {
    nevh__values v = {take(from, count), NULL, NULL};
    v.roundoff = take(from, count);
    v.size = take(from, count);
    return v;
}

/* The step under way, in the scratch behind a copy of the memory. */
static nevh__gradient_step lay_out(nevh_work *w, double h) {
    const gradient_plan *g = w->plan;
    size_t width = w->width, all = 2 * w->size, nodes = g->nodes->stages;
    double *at = w->scratch + w->memory_rows * width;
    nevh__gradient_step s = {
        .work = w, .nodes = g->nodes, .length = g->length, .metric = g->metric};
    s.h = h / (double)table_of(w)->parts;
    s.compensation = w->scratch;
    s.z = take(&at, all);
    s.x = take(&at, all);
    s.ends = take(&at, all);
    s.start = take_values(&at, width);
    s.end = take_values(&at, width);
    s.deficit = take(&at, width);
    s.times = take(&at, width);
    s.slopes = take(&at, nodes * all);
    s.points = take(&at, nodes * (all + width));
    s.own = at;
    return s;
}

static int find_values(const nevh__gradient_step *s, size_t count,
                       const double z[], const nevh__values *to) {
    nevh_work *w = s->work;
    int status = nevh__field_moving_values(w->field, count, s->times, z,
                                           z + w->n * count, to->h,
                                           to->roundoff, to->size);
    if (status)
        nevh_work_fail(w, status, "%s", nevh_field_message(w->field));
    return status;
}

static void set_times(const nevh__gradient_step *s, const remembered *m) {
    for (size_t lane = 0; lane < s->work->width; lane++)
        s->times[lane] = m && m->known[lane] != 0 ? m->t[lane] : s->t;
}

/* Finds the deficit of H at the start, and the energy to keep. */
static int begin_balance(const nevh__gradient_step *s, const remembered *m) {
    const nevh_work *w = s->work;
    bool autonomous = ((const gradient_plan *)w->plan)->autonomous;
    set_times(s, m);
    int status = find_values(s, w->width, s->z, &s->start);
    for (size_t i = 0; !status && i < w->width; i++)
        s->deficit[i] = m->known[i] == 0
                            ? 0
                            : (m->energy[i] - s->start.h[i]) +
                                  (m->roundoff[i] - s->start.roundoff[i]);
    set_times(s, NULL);
    if (!status && !autonomous)
        status = find_values(s, w->width, s->z, &s->start);
    for (size_t i = 0; !status && i < w->width; i++) {
        m->t[i] = s->t;
        if (autonomous && m->known[i] != 0)
            continue;
        m->known[i] = 1;
        m->energy[i] = s->start.h[i];
        m->roundoff[i] = s->start.roundoff[i] + s->deficit[i];
    }
    return status;
}

/* Continues the polynomial through the slopes of this part in the last steps,
   as far as these were by h. */
static void guess(const nevh__gradient_step *s, const remembered *m, double h) {
    static const double weights[STEPS + 1][STEPS] = {
        {0}, {1}, {2, -1}, {3, -3, 1}};
    const nevh_work *w = s->work;
    for (size_t i = 0; i < 2 * w->size; i++) {
        size_t lane = i % w->width, at = s->part * 2 * w->size + i, known = 0;
        while (known < STEPS && m->h[known][lane] == h)
            known++;
        s->x[i] = 0;
        for (size_t k = 0; k < known; k++)
            s->x[i] += weights[known][k] * m->slopes[k][at];
    }
}

static void find_ends(const nevh__gradient_step *s, size_t active,
                      const size_t lanes[], const double x[]) {
    size_t width = s->work->width;
    for (size_t k = 0; k < 2 * s->work->n; k++)
        for (size_t a = 0; a < active; a++) {
            size_t i = k * width + lanes[a];
            s->ends[k * active + a] =
                s->z[i] + (s->h * x[i] + s->compensation[i]);
        }
}

/* The deficit of D . dz against H(ends) - H(z), less the deficit before; faded out
   if it is rounding.  Over |dz|^2, for which dz may be 0. */
static double find_defect(const nevh__gradient_step *s, size_t active, size_t a,
                          size_t lane, const double out[]) {
    const nevh_work *w = s->work;
    double way = 0, deficit = (s->end.h[a] - s->start.h[lane]) +
                              (s->end.roundoff[a] - s->start.roundoff[lane]) -
                              s->deficit[lane];
    for (size_t k = 0; k < 2 * w->n; k++) {
        double dz = s->ends[k * active + a] - s->z[k * w->width + lane];
        deficit -= out[nevh__conjugate(w, k) * active + a] * dz;
        way += dz * s->metric[k] * (dz * s->metric[k]);
    }
    if (deficit == 0)
        return 0;
    double noise = tolerated * s->start.size[lane] / deficit;
    return deficit / ((1 + noise * noise) * (way + nowhere / way));
}

/* If D does not give H(ends), adds the smallest vector, by the metric, that makes
   it so. */
static void balance(const nevh__gradient_step *s, size_t active,
                    const size_t lanes[], double out[]) {
    const nevh_work *w = s->work;
    for (size_t a = 0; a < active; a++) {
        double defect = find_defect(s, active, a, lanes[a], out);
        for (size_t k = 0; k < 2 * w->n; k++) {
            double dz = s->ends[k * active + a] - s->z[k * w->width + lanes[a]];
            out[nevh__conjugate(w, k) * active + a] +=
                defect * (dz * s->metric[k]) * s->metric[k];
        }
    }
}

static int map(void *data, size_t active, const size_t lanes[],
               const double x[], double out[]) {
    const nevh__gradient_step *s = data;
    const nevh__discrete_gradient *table = table_of(s->work);
    size_t half = s->work->n * active;
    find_ends(s, active, lanes, x);
    int status = NEVH_OK;
    if (table->takes_ends && table->averages)
        status = find_values(s, active, s->ends, &s->end);
    if (!status)
        status = table->gradient(s, active, lanes, x, out);
    if (!status && table->takes_ends)
        balance(s, active, lanes, out);
    for (size_t i = half; i < 2 * half; i++)
        out[i] = -out[i];
    return status;
}

/* z + compensation += h x, the product's rounding included. */
static void advance(const nevh__gradient_step *s, double *z,
                    double *compensation) {
    for (size_t i = 0; i < 2 * s->work->size; i++) {
        double way = s->h * s->x[i], d = way + compensation[i], next = z[i] + d;
        double roundoff =
            fma(s->h, s->x[i], -way) + nevh__roundoff(d, way, compensation[i]);
        compensation[i] = nevh__roundoff(next, z[i], d) + roundoff;
        z[i] = next;
    }
}

static int account(const nevh__gradient_step *s) {
    nevh_work *w = s->work;
    const gradient_plan *g = w->plan;
    const double *q = s->points, *p = q + w->size, *t = p + w->size;
    int status = NEVH_OK;
    for (size_t j = 0; !status && j < g->nodes->stages; j++) {
        nevh__find_nodes(s, j, 1, w->width, g->lanes, s->x);
        status = nevh_work_account(w, NEVH_OF_Q | NEVH_OF_P,
                                   g->nodes->b[j] * s->h, t, q, p);
    }
    return status;
}

static int take_part(nevh__gradient_step *s, const remembered *m, double h) {
    nevh_work *w = s->work;
    const nevh__discrete_gradient *table = table_of(w);
    const gradient_plan *g = w->plan;
    guess(s, m, h);
    nevh__stage_problem problem = {.t = s->t,
                                   .h = s->h,
                                   .q = s->z,
                                   .p = s->z + w->size,
                                   .x = s->x,
                                   .map = map,
                                   .data = s,
                                   .noise = table->noise};
    set_times(s, NULL);
    int status = table->takes_ends ? begin_balance(s, m) : NEVH_OK;
    if (!status)
        status = nevh__stage_solve(g->solver, &problem);
    if (!status && w->accounts)
        status = account(s);
    if (status)
        return status;
    size_t at = s->part * 2 * w->size, size = 2 * w->size * sizeof *s->x;
    for (int i = STEPS - 1; i > 0; i--)
        memcpy(m->slopes[i] + at, m->slopes[i - 1] + at, size);
    memcpy(m->slopes[0] + at, s->x, size);
    advance(s, s->z, m->compensation);
    return NEVH_OK;
}

static int commit(const nevh__gradient_step *s, const remembered *m, double t,
                  double h, double q[], double p[]) {
    nevh_work *w = s->work;
    double check = 0;
    for (size_t i = 0; i < 2 * w->size; i++)
        check += s->z[i] - s->z[i];
    if (check != 0)
        return nevh__fail_range(w, t, h);
    for (size_t lane = 0; lane < w->width; lane++) {
        for (int i = STEPS - 1; i > 0; i--)
            m->h[i][lane] = m->h[i - 1][lane];
        m->h[0][lane] = h;
    }
    memcpy(q, s->z, w->size * sizeof *q);
    memcpy(p, s->z + w->size, w->size * sizeof *p);
    memcpy(w->memory, w->scratch,
           w->memory_rows * w->width * sizeof *w->memory);
    return NEVH_OK;
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    size_t parts = table_of(w)->parts;
    nevh__gradient_step s = lay_out(w, h);
    remembered m = find_memory(w, w->scratch);
    memcpy(w->scratch, w->memory,
           w->memory_rows * w->width * sizeof *w->memory);
    memcpy(s.z, q, w->size * sizeof *q);
    memcpy(s.z + w->size, p, w->size * sizeof *p);
    int status = NEVH_OK;
    for (; !status && s.part < parts; s.part++) {
        s.t = t + ((double)s.part + 0.5) / (double)parts * h;
        status = take_part(&s, &m, h);
    }
    return status ? status : commit(&s, &m, t, h, q, p);
}

/* The energy is another one; first guesses may stay. */
static void apply_friction(nevh_work *w, const double factor[]) {
    remembered m = find_memory(w, w->memory);
    for (size_t i = 0; i < w->size; i++)
        m.compensation[w->size + i] *= factor[i / w->width];
    for (size_t lane = 0; lane < w->width; lane++)
        m.known[lane] = 0;
}

const nevh_kernel nevh__discrete_gradient_kernel = {.plan = plan,
                                                    .step = step,
                                                    .clear = clear,
                                                    .apply_friction =
                                                        apply_friction};
