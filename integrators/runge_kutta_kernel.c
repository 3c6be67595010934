/* nevh: explicit Runge-Kutta methods, the non-symplectic reference.

   Slopes k_i = f(t + c_i h, y + h sum_j a_ij k_j), y += h sum_i b_i k_i, the
   sum added to the state with compensation.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/extend.h>

static int plan(nevh_work *w) {
    const nevh_butcher *table = w->integrator->table;
    w->memory_rows = 2 * w->n;
    w->scratch_size = (table->stages + 2) * 2 * w->size + w->width;
    return NEVH_OK;
}

/* sum = sum over stages of weights[j] * slopes of stage j. */
static void combine(size_t size, size_t stages, const double weights[],
                    const double slopes[], double h, double sum[]) {
    for (size_t i = 0; i < size; i++)
        sum[i] = 0;
    for (size_t j = 0; j < stages; j++)
        for (size_t i = 0; weights[j] != 0 && i < size; i++)
            sum[i] += weights[j] * slopes[j * size + i];
    for (size_t i = 0; i < size; i++)
        sum[i] *= h;
}

/* The slopes of (q, p): dH/dp, then -dH/dq. */
static int take_slopes(nevh_work *w, double t, const double point[],
                       double slopes[], double time[]) {
    size_t n = w->size;
    for (size_t lane = 0; lane < w->width; lane++)
        time[lane] = t;
    int status = nevh_work_gradient(w, w->width, time, point, point + n,
                                    slopes + n, slopes);
    for (size_t i = n; i < 2 * n; i++)
        slopes[i] = -slopes[i];
    return status;
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    const nevh_butcher *table = w->integrator->table;
    size_t n = w->size, s = table->stages;
    double *slopes = w->scratch, *point = slopes + 2 * n * s;
    double *change = point + 2 * n, *time = change + 2 * n;
    int status = NEVH_OK;
    for (size_t i = 0; !status && i < s; i++) {
        combine(2 * n, i, table->a + i * s, slopes, h, change);
        for (size_t k = 0; k < n; k++) {
            point[k] = q[k] + (change[k] + w->memory[k]);
            point[n + k] = p[k] + (change[n + k] + w->memory[n + k]);
        }
        status = take_slopes(w, t + table->c[i] * h, point, slopes + 2 * n * i,
                             time);
        if (!status && w->accounts)
            status = nevh_work_account(w, NEVH_OF_Q | NEVH_OF_P,
                                       table->b[i] * h, time, point, point + n);
    }
    if (status)
        return status;
    combine(2 * n, s, table->b, slopes, h, change);
    return nevh_work_commit(w, n, q, change, w->memory, p, change + n,
                            w->memory + n);
}

const nevh_kernel nevh_runge_kutta_kernel = {.plan = plan, .step = step};
