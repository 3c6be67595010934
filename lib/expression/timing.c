/* nevh: how H changes with time: stretches of it are halved where the terms
   change.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/timing_stretch_private.h"
#include <fenv.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>

enum {
    FIRST = 64, /* stretches */
    FIRST_SAMPLED = 1024,
    MOST_HALVED = 8192,
    MOST_BREAKS = 4096
};
static const double most_work = 4e6;     /* operations, of either pass */
static const double resolved = 0.5;      /* of the time of a change */
static const double steep = 1e-6;        /* of the range, without bound */
static const double certain_jump = 1e-6; /* of the range */

typedef nevh__time_stretch stretch;

/* The relative rate of change of a part, from its range.  A part without bounds is
   a pole, or is within a function that has bounds. */
static double rate_of(const nevh__range *r, double range, double length) {
    double most = fmax(fabs(r->down), fabs(r->up));
    if (!(range > 0) || !isfinite(range) || isnan(most))
        return 0;
    return (isfinite(most) ? most : (r->high - r->low) / length) / range;
}

static void take_frequency(nevh_timing *m, const stretch *c, size_t i) {
    const nevh__range *r = &m->parts.range[i];
    double turning = fmax(fabs(r->down), fabs(r->up));
    if (m->parts.part[i].turned && !c->broken && isfinite(turning) &&
        turning > m->frequency) {
        m->frequency = turning;
        m->frequency_effect = m->parts.part[i].effect;
    }
}

/* Evaluates the parts over an interval. */
static stretch timing_look(nevh_timing *m, double low, double high) {
    nevh__time_parts *s = &m->parts;
    stretch c = {.low = low, .high = high};
    nevh__time_parts_over(s, low, high);
    for (size_t i = 0; i < s->count; i++) {
        const nevh__range *r = &s->range[i];
        if (!s->part[i].pure || isnan(r->low) || isnan(r->high))
            continue;
        bool endless = !isfinite(r->down) || !isfinite(r->up);
        bool wide = r->high - r->low > steep * m->range[i];
        double rate = rate_of(r, m->range[i], high - low);
        if (!c.broken && (r->broken || (endless && wide)))
            c.broken = true, c.effect = s->part[i].effect;
        c.pole |= (r->broken & NEVH__POLE) != 0;
        if (rate > c.rate)
            c.rate = rate;
        if (rate == c.rate && !c.broken)
            c.effect = s->part[i].effect;
    }
    return c;
}

static bool timing_keep(nevh_timing *m, stretch c) {
    if (m->cells == m->cell_capacity) {
        size_t capacity = 2 * m->cells + 256;
        stretch *grown = nevh__grow(m->cell, capacity, sizeof *grown);
        m->failed |= !grown;
        if (!grown)
            return false;
        m->cell = grown;
        m->cell_capacity = capacity;
    }
    m->cell[m->cells++] = c;
    return true;
}

/* Values of all parts at a time. */
static void values_at(nevh_timing *m, double t, double to[]) {
    nevh__time_parts_over(&m->parts, t, t);
    for (size_t i = 0; i < m->parts.count; i++)
        to[i] = m->parts.range[i].low;
}

/* True if a term differs on either side of a break; effect: out. */
static bool timing_jumps(nevh_timing *m, double before, double after,
                         size_t *effect) {
    nevh__time_parts *s = &m->parts;
    double most = certain_jump;
    values_at(m, before, m->before);
    nevh__time_parts_over(&m->parts, after, after);
    for (size_t i = 0; i < s->count; i++) {
        double by = fabs(s->range[i].low - m->before[i]);
        double part = by / (isfinite(m->range[i]) ? m->range[i] : 1);
        if (s->part[i].outer && part > most &&
            nevh__time_parts_jump(s, s->part[i].effect, before, after))
            most = part, *effect = s->part[i].effect;
    }
    return most > certain_jump;
}

static void add_break(nevh_timing *m, const stretch *c) {
    if (m->n_breaks == m->break_capacity) {
        size_t capacity = 2 * m->n_breaks + 16;
        nevh_time_break *grown = nevh__grow(m->breaks, capacity, sizeof *grown);
        m->failed |= !grown;
        if (!grown)
            return;
        m->breaks = grown;
        m->break_capacity = capacity;
    }
    m->breaks[m->n_breaks++] = (nevh_time_break){
        .before = c->low - m->least,
        .after = c->high + m->least,
        .pole = c->pole,
        .effect = nevh_system_effect_name(m->parts.system, c->effect)};
}

/* A stretch with a break is halved until it is as short as can be; what has none
   is kept. */
static void separate(nevh_timing *m, double low, double high) {
    stretch c = timing_look(m, low, high);
    double middle = low + (high - low) / 2;
    if (m->failed)
        return;
    if (!c.broken) {
        timing_keep(m, c);
        return;
    }
    if (high - low <= m->least) {
        c.rate = 0;
        add_break(m, &c);
        timing_keep(m, c);
        return;
    }
    bool enough = m->halved > m->most_halved || m->n_breaks > MOST_BREAKS;
    m->whole &= !enough;
    m->halved++;
    if (enough) {
        timing_keep(m, c);
        return;
    }
    separate(m, low, middle);
    separate(m, middle, high);
}

static void widen_ranges(nevh_timing *m, double low, double high) {
    nevh__time_parts *s = &m->parts;
    nevh__time_parts_over(s, low, high);
    for (size_t i = 0; i < s->count; i++) {
        m->before[i] = fmin(m->before[i], s->range[i].low);
        m->range[i] = fmax(m->range[i], s->range[i].high);
    }
}

static void begin_ranges(nevh_timing *m) {
    for (size_t i = 0; i < m->parts.count; i++)
        m->before[i] = INFINITY, m->range[i] = -INFINITY;
}

static void end_ranges(nevh_timing *m) {
    for (size_t i = 0; i < m->parts.count; i++)
        m->range[i] -= m->before[i];
}

/* Ranges of the parts, from short stretches; */
static void find_ranges(nevh_timing *m, size_t first) {
    double part = (m->high - m->low) / (double)first;
    begin_ranges(m);
    for (size_t k = 0; k < first; k++)
        widen_ranges(m, m->low + (double)k * part,
                     m->low + (double)(k + 1) * part);
    end_ranges(m);
}

/* and from those that have no breaks, where a pole was possible and is not. */
static void find_ranges_again(nevh_timing *m) {
    begin_ranges(m);
    for (size_t k = 0; k < m->cells; k++)
        if (!m->cell[k].broken)
            widen_ranges(m, m->cell[k].low, m->cell[k].high);
    end_ranges(m);
    for (size_t k = 0; k < m->cells; k++)
        if (!m->cell[k].broken)
            m->cell[k] = timing_look(m, m->cell[k].low, m->cell[k].high);
}

static double need(const stretch *c) {
    return c->broken ? 0 : (c->high - c->low) * c->rate;
}

/* A heap whose first stretch needs to be halved most. */
static void sink(nevh_timing *m, size_t i) {
    stretch *c = m->cell;
    for (size_t k; (k = 2 * i + 1) < m->cells; i = k) {
        if (k + 1 < m->cells && need(&c[k + 1]) > need(&c[k]))
            k++;
        if (need(&c[k]) <= need(&c[i]))
            return;
        stretch kept = c[i];
        c[i] = c[k];
        c[k] = kept;
    }
}

static void rise(nevh_timing *m, size_t i) {
    stretch *c = m->cell;
    while (i && need(&c[i]) > need(&c[(i - 1) / 2])) {
        stretch kept = c[i];
        c[i] = c[(i - 1) / 2];
        c[i = (i - 1) / 2] = kept;
    }
}

/* A sampled term that still changes within the shortest stretch jumps. */
static void end_halving(nevh_timing *m, stretch *c) {
    if (m->parts.n_sampled)
        add_break(m, c);
    c->broken = true;
    c->rate = 0;
}

/* Halves intervals over which terms change fast, compared with the interval's
   length. */
static void timing_halve(nevh_timing *m) {
    for (size_t i = m->cells; i-- > 0;)
        sink(m, i);
    for (m->halved = 0; m->halved < m->most_halved && m->cells; m->halved++) {
        stretch c = m->cell[0];
        double middle = c.low + (c.high - c.low) / 2;
        if (need(&c) <= resolved)
            return;
        if (c.high - c.low <= m->least) {
            end_halving(m, &m->cell[0]);
        } else {
            m->cell[0] = timing_look(m, c.low, middle);
            sink(m, 0);
            if (!timing_keep(m, timing_look(m, middle, c.high)))
                return;
            rise(m, m->cells - 1);
        }
        sink(m, 0);
    }
}

static int by_time(const void *a, const void *b) {
    const stretch *x = a, *y = b;
    return (x->low > y->low) - (x->low < y->low);
}

static int by_break(const void *a, const void *b) {
    const nevh_time_break *x = a, *y = b;
    return (x->before > y->before) - (x->before < y->before);
}

/* In order of time; neighbours are one. */
static void order_breaks(nevh_timing *m) {
    size_t kept = 0;
    qsort(m->breaks, m->n_breaks, sizeof *m->breaks, by_break);
    for (size_t i = 0; i < m->n_breaks; i++) {
        nevh_time_break *last = kept ? &m->breaks[kept - 1] : NULL;
        if (last && m->breaks[i].before <= last->after) {
            last->after = fmax(last->after, m->breaks[i].after);
            last->pole |= m->breaks[i].pole;
        } else
            m->breaks[kept++] = m->breaks[i];
    }
    m->n_breaks = kept;
}

/* From both ends of each stretch, in view of those before and after it. */
static void find_reach(nevh_timing *m) {
    size_t count = m->cells;
    m->bound = nevh__array(2 * count + 2, sizeof *m->bound);
    m->failed |= !m->bound;
    double reach = INFINITY;
    for (size_t i = 0; i < count && !m->failed; i++) {
        m->bound[2 * i] = reach;
        reach = fmin(reach + nevh__reach_slower *
                                 (m->cell[i].high - m->cell[i].low),
                     nevh__stretch_reach(&m->cell[i]));
    }
    reach = INFINITY;
    for (size_t i = count; i-- > 0 && !m->failed;) {
        m->bound[2 * i + 1] = reach;
        reach = fmin(reach + nevh__reach_slower *
                                 (m->cell[i].high - m->cell[i].low),
                     nevh__stretch_reach(&m->cell[i]));
    }
}

/* True if the fast change there, with that of its neighbours, is a good part of a
   range: at the end of the domain of a root it is not. */
static bool is_large(const nevh_timing *m, size_t i) {
    static const double good = 0.05, alike = 0.5;
    const stretch *c = m->cell;
    double least = alike * c[i].rate, change = 0;
    for (size_t k = i; k < m->cells && c[k].rate >= least && change < good; k++)
        change += c[k].rate * (c[k].high - c[k].low);
    for (size_t k = i; k-- > 0 && c[k].rate >= least && change < good;)
        change += c[k].rate * (c[k].high - c[k].low);
    return change >= good;
}

/* True if the change is fast because of a pole. */
static bool is_at_pole(const nevh_timing *m, const stretch *c) {
    static const double near = 8;
    bool at = false;
    for (size_t i = 0; i < m->n_breaks; i++)
        at |= m->breaks[i].pole && c->rate > 0 &&
              fabs(m->breaks[i].before - c->low) < near / c->rate;
    return at;
}

static void find_shortest(nevh_timing *m) {
    m->shortest = INFINITY;
    for (size_t i = 0; i < m->cells; i++) {
        double time = nevh__stretch_reach(&m->cell[i]);
        if (time < m->shortest && is_large(m, i) &&
            !is_at_pole(m, &m->cell[i])) {
            m->shortest = time;
            m->shortest_at = (m->cell[i].low + m->cell[i].high) / 2;
            m->shortest_effect = m->cell[i].effect;
        }
        if (m->cell[i].broken)
            continue;
        nevh__time_parts_over(&m->parts, m->cell[i].low, m->cell[i].high);
        for (size_t k = 0; k < m->parts.nodes; k++)
            take_frequency(m, &m->cell[i], k);
    }
}

/* Which jump, and whose term it is; jumps that come again in equal times are a
   drive. */
static void describe_breaks(nevh_timing *m) {
    double least = INFINITY, most = 0, before = NAN;
    size_t effect = 0, count = 0;
    for (size_t i = 0; i < m->n_breaks; i++) {
        nevh_time_break *b = &m->breaks[i];
        effect = 0;
        b->jump = !b->pole && timing_jumps(m, b->before, b->after, &effect);
        if (!b->jump)
            continue;
        b->effect = nevh_system_effect_name(m->parts.system, effect);
        double since = b->before - before;
        least = fmin(least, since), most = fmax(most, since);
        before = b->before;
        count++;
    }
    bool regular = count > 3 && most - least < 1e-6 * most;
    static const double turn = 6.283185307179586;
    if (regular && m->frequency == 0) {
        m->frequency = turn / most;
        m->frequency_effect = effect;
    }
}

static void timing_make(nevh_timing *m) {
    nevh__time_parts *s = &m->parts;
    size_t first = s->n_sampled ? FIRST_SAMPLED : FIRST;
    double limit = most_work / (double)(s->count + 1);
    m->most_halved = (size_t)fmin(fmax(limit, 2 * FIRST), 64 * MOST_HALVED);
    m->range = nevh__array(s->count, sizeof *m->range);
    m->before = nevh__array(s->count, sizeof *m->before);
    m->failed |= !m->range || !m->before;
    if (m->failed)
        return;
    find_ranges(m, first);
    for (size_t k = 0; k < first && !m->failed; k++) {
        double part = (m->high - m->low) / (double)first;
        separate(m, m->low + (double)k * part, m->low + (double)(k + 1) * part);
    }
    if (m->most_halved > MOST_HALVED)
        m->most_halved = MOST_HALVED;
    if (m->failed)
        return;
    find_ranges_again(m);
    timing_halve(m);
    qsort(m->cell, m->cells, sizeof *m->cell, by_time);
    order_breaks(m);
    find_shortest(m);
    describe_breaks(m);
    find_reach(m);
}

nevh_timing *nevh_timing_new(const nevh_system *s, double t0, double t1,
                             const double q[], const double p[]) {
    nevh_timing *m = s ? nevh__array(1, sizeof *m) : NULL;
    if (!m)
        return NULL;
    m->low = fmin(t0, t1);
    m->high = fmax(t0, t1);
    m->least = 4 * DBL_EPSILON * fmax(fabs(t0), fabs(t1));
    m->shortest = INFINITY;
    nevh__time_parts_init(&m->parts, s, q, p);
    m->failed = m->parts.failed;
    m->whole = m->parts.whole;
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    if (!m->failed && m->parts.count && m->high > m->low)
        timing_make(m);
    fesetenv(&own);
    if (!m->failed)
        return m;
    nevh_timing_free(m);
    return NULL;
}

void nevh_timing_free(nevh_timing *m) {
    if (!m)
        return;
    nevh__time_parts_clear(&m->parts);
    free(m->range);
    free(m->before);
    free(m->cell);
    free(m->bound);
    free(m->breaks);
    free(m);
}
