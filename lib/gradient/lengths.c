/* nevh: over which lengths does H vary?
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/step_selection_private.h"
#include "expression/tape_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A length is where this part of a variation is not that of a quadratic. */
static const double not_quadratic = 0.2;
/* Relative to the kinetic energy, or to other terms that vary: a smaller change
   comes from a distant or weak force, and has no information on the momenta. */
static const double out_of_reach = 0x1p-26;
/* The energy of a start beside that of its orbit. */
static const double far_less = 0x1p-10;
/* The same, of an orbit that has no size, beside that over coordinates of 1. */
static const double as_at_rest = 0x1p-40;
enum { FARTHEST = 400, LEAP = 8 }; /* powers of two from the first guess */
enum { FROM_LEAST = 1100 }; /* the same, from a momentum that is nearly 0 */
enum { FEWEST_AHEAD = 2, MOST_AHEAD = 30 }; /* distances at once */
/* Doublings over which H is a power of the distance, or constant: it is so beyond. */
enum { POWERS = 100 };
enum { NEARER = 3, NEAREST = 24 }; /* below a distance that may be periods */
static const double as_much = 0.125;
static const double overflowing = 0x1p500;
static const double least = 0x1p-1068; /* of the rounding of any value */
/* Distances over the first one: beyond, what is not finite is no edge of a domain. */
static const double no_edge = 0x1p60;
enum { MOST_LANES = 4, TRIED_LANES = 64 };
/* Powers of two may be whole periods, over which nothing varies. */
static const double askew = 0.618;

/* A row of equal numbers, its first ones moved. */
static void lengths_fill(double *row, size_t stride, double value, size_t count,
                         const double move[]) {
    for (size_t i = 0; i < count; i++)
        row[i] = value + move[i];
    for (size_t i = count; i < stride; i++)
        row[i] = value;
}

void nevh__sample_line(const nevh__axis *a, size_t at, size_t count,
                       const double move[], double x[], double h[]) {
    nevh_field *f = a->e->field;
    const nevh__planned *term = a->term;
    const nevh_term *decl = &term->term->decl;
    size_t stride = nevh__padded(count), n = f->n;
    const double *q = a->e->samples.q + at * n, *p = a->e->samples.p + at * n;
    double *row = f->rows;
    for (size_t j = 0; j < term->nv + decl->nc; j++, row += stride) {
        double value = j >= term->nv
                           ? decl->c[a->instance * decl->nc + j - term->nv]
                       : j < term->nq ? q[nevh__index(term, a->instance, j)]
                                      : p[nevh__index(term, a->instance, j)];
        lengths_fill(row, stride, value, j == a->k ? count : 0, move);
    }
    lengths_fill(f->times, stride, a->e->samples.t[at],
                 a->k == NEVH__TIME ? count : 0, move);
    double *rows_p = f->rows + term->nq * stride;
    nevh__term_values(term->term, f->portable, stride, count,
                      decl->time ? f->times : f->zeros, f->rows, rows_p,
                      rows_p + term->np * stride, f->h, f->one);
    memcpy(x, a->k == NEVH__TIME ? f->times : f->rows + a->k * stride,
           count * sizeof *x);
    memcpy(h, f->h, count * sizeof *h);
}

double nevh__sample_rounding(const nevh__axis *a, size_t at, double move,
                             double h) {
    const nevh_term *decl = &a->term->term->decl;
    size_t n = a->e->field->n;
    double *x = a->e->field->one;
    if (decl->value != nevh__tape_value)
        return DBL_EPSILON * fabs(h);
    for (size_t j = 0; j < a->term->nv; j++) {
        const double *from =
            j < a->term->nq ? a->e->samples.q : a->e->samples.p;
        x[j] = from[at * n + nevh__index(a->term, a->instance, j)];
        x[j] += j == a->k ? move : 0;
    }
    return nevh__tape_rounding(
        a->e->samples.t[at] + (a->k == NEVH__TIME ? move : 0), x,
        x + a->term->nq, decl->nc ? decl->c + a->instance * decl->nc : NULL,
        decl->params);
}

/* The variation of h within one distance: as a whole, the part that a quadratic
   through the half distance does not explain, and the part that may be rounding. */
typedef struct {
    double whole, rest, rounding;
} variation;

/* A number that is not one is no larger. */
static inline double lengths_larger(double a, double b) {
    return b > a ? b : a;
}

/* h: at a place, and on both sides of it at half the distance and at all. */
static variation lengths_compare(double here, const double half[2],
                                 const double all[2]) {
    double most = lengths_larger(
        fabs(here), lengths_larger(lengths_larger(fabs(half[0]), fabs(half[1])),
                                   lengths_larger(fabs(all[0]), fabs(all[1]))));
    double even = (all[0] - here) + (all[1] - here), odd = all[0] - all[1];
    double near_even = (half[0] - here) + (half[1] - here);
    double near_odd = half[0] - half[1];
    return (variation){
        lengths_larger(fabs(all[0] - here), fabs(all[1] - here)),
        lengths_larger(fabs(even - 4 * near_even), fabs(odd - 2 * near_odd)),
        32 * DBL_EPSILON * most + least};
}

/* Beyond the length, or outside the domain. */
static bool too_far(const variation *v) {
    return !(v->rest <= not_quadratic * v->whole + v->rounding);
}

/* A formula may add up numbers that are far larger than its values: then the
   rest may be rounding of these. */
static void allow_for_rounding(const nevh__axis *a, double distance,
                               const double h[3], variation *v) {
    const double moves[] = {0, distance, -distance};
    double most = 0;
    for (size_t i = 0; i < 3; i++)
        most = lengths_larger(
            most, nevh__sample_rounding(a, a->e->at, moves[i], h[i]));
    if (isfinite(most) && isfinite(v->whole))
        v->rounding = fmax(v->rounding, 16 * most);
}

/* Within a distance, twice that, and so on. */
static void vary_on(const nevh__axis *a, double distance, size_t count,
                    variation v[]) {
    double move[3 + 2 * MOST_AHEAD], x[3 + 2 * MOST_AHEAD];
    double h[3 + 2 * MOST_AHEAD];
    move[0] = 0;
    for (size_t i = 1; i <= count + 1; i++) {
        move[2 * i - 1] = i > 1 ? 2 * move[2 * i - 3] : distance / 2;
        move[2 * i] = -move[2 * i - 1];
    }
    nevh__sample_line(a, a->e->at, 3 + 2 * count, move, x, h);
    for (size_t i = 0; i < count; i++, distance *= 2) {
        const double outer[] = {h[0], h[3 + 2 * i], h[4 + 2 * i]};
        v[i] = lengths_compare(h[0], h + 1 + 2 * i, h + 3 + 2 * i);
        if (too_far(&v[i]))
            allow_for_rounding(a, distance, outer, &v[i]);
    }
}

static variation vary(const nevh__axis *a, double distance) {
    variation v;
    vary_on(a, distance, 1, &v);
    return v;
}

/* A power of the distance has no length: its parts stay the same.  Of what has
   settled far away, as 1/r has, both are the same. */
static bool lengths_alike(const variation *a, const variation *b) {
    double share = b->rest / b->whole, noise = b->rounding / b->whole;
    return fabs(a->rest / a->whole - share) <= 1e-9 * share + noise &&
           noise < 0.1 && !(fabs(a->whole - b->whole) <= 0.1 * b->whole);
}

/* True if the variation is rounding of an argument, as of cos(x/1e-30) far from
   where it is resolved.  Unlike noise, it is smaller at shorter distances. */
static bool is_lost(const nevh__axis *a, double distance, const variation *v) {
    static const double less = 0x1p-4;
    if (v->rest <= not_quadratic * v->whole || v->whole > v->rounding)
        return false;
    double nearer = ldexp(distance, -LEAP);
    return vary(a, nearer).rounding < less * v->rounding;
}

/* Within a distance of many periods, five values may happen to be those of a
   quadratic.  Somewhere nearer they are not, although they vary as much; little
   ripples do not count.  Returns where, or else the distance. */
static double unfold(const nevh__axis *a, double distance) {
    double whole = vary(a, distance).whole;
    for (int down = NEARER; whole > 0 && down <= NEAREST; down += NEARER) {
        double nearer = ldexp(distance, -down);
        variation v = vary(a, nearer);
        if (v.whole >= as_much * whole &&
            (too_far(&v) || is_lost(a, nearer, &v)))
            return nearer;
    }
    return distance;
}

/* In leaps below `distance`, and how many; false where there is no length. */
static bool leap_down(const nevh__axis *a, double *distance, int *leaps) {
    variation v = vary(a, *distance);
    while (*leaps < FARTHEST / LEAP &&
           (too_far(&v) || is_lost(a, *distance, &v))) {
        variation before = v;
        ++*leaps;
        *distance = ldexp(*distance, -LEAP);
        v = vary(a, *distance);
        if (lengths_alike(&before, &v))
            return false;
    }
    return !too_far(&v);
}

/* True for a term such as eps*x^4 with eps = 0: it does not vary until x^4
   overflows. */
static bool is_overflow(const variation *v, double times) {
    bool finite = isfinite(v->rest) && isfinite(v->whole);
    return !finite && times > no_edge;
}

/* Twice the distance again and again, at most so often, until that is too far.
   Several are asked for at once, the more the longer it takes. */
static double double_up(const nevh__axis *a, double distance,
                        const variation *here, int most) {
    variation v[MOST_AHEAD], last = *here;
    size_t ahead = FEWEST_AHEAD;
    double whole = here->whole, first = distance;
    int powers = 0;
    bool seen = whole > here->rounding;
    for (int done = 0; done < most;
         ahead = 2 * ahead < MOST_AHEAD ? 2 * ahead : MOST_AHEAD) {
        vary_on(a, 2 * distance, ahead, v);
        for (size_t i = 0; i < ahead && done < most; i++, done++) {
            seen |= v[i].whole > v[i].rounding;
            if (!(whole < overflowing) || is_overflow(&v[i], distance / first))
                return seen ? INFINITY : NAN;
            if (too_far(&v[i]))
                return distance;
            bool still = v[i].whole == 0 && last.whole == 0;
            powers = still || lengths_alike(&last, &v[i]) ? powers + 1 : 0;
            if (powers == POWERS)
                return seen ? INFINITY : NAN;
            distance *= 2;
            whole = v[i].whole;
            last = v[i];
        }
    }
    return seen ? INFINITY : NAN;
}

double nevh__curve_length(const nevh__axis *a, double guess) {
    variation v = vary(a, guess);
    variation aside = vary(a, askew * guess);
    bool periods = !(v.whole > v.rounding) && aside.whole > aside.rounding;
    double distance = periods ? askew * guess : guess;
    int leaps = 0;
    double nearer = distance;
    do {
        distance = nearer;
        if (!leap_down(a, &distance, &leaps))
            return NAN;
        nearer = unfold(a, distance);
    } while (nearer < distance);
    v = vary(a, distance);
    return double_up(a, distance, &v, leaps ? LEAP : FARTHEST);
}

/* The distance over which an instance varies by `energy`: in leaps below it,
   then up by twos.  NAN: it does not vary so much. */
static double energy_length(const nevh__axis *a, double guess, double energy) {
    double distance = guess;
    for (int i = 0; i < FROM_LEAST / LEAP && distance > DBL_MIN; i++) {
        if (!(vary(a, distance).whole >= energy))
            break;
        distance = ldexp(distance, -LEAP);
    }
    for (int i = 0; i < FROM_LEAST && distance < overflowing; i++) {
        if (!(vary(a, distance).whole < energy))
            return distance;
        distance *= 2;
    }
    return NAN;
}

/* The size of variable i of n, or if it is 0 the largest of all. */
static double lengths_size_of(const double x[], size_t n, size_t i) {
    double most = fabs(x[i]);
    for (size_t k = 0; x[i] == 0 && k < n; k++)
        most = lengths_larger(most, fabs(x[k]));
    return most;
}

/* A first guess that only saves time, so that it is a power of two: the variable's
   size, or that of others of its kind, which have its unit; 1 where all are 0. */
static double first_guess(const nevh__step_selection *e, size_t i) {
    size_t n = e->field->n;
    const nevh__samples *s = &e->samples;
    bool sized = e->sizes && !isnan(e->sizes[i]);
    double x = e->options->scale ? e->options->scale[i]
               : sized           ? e->sizes[i]
               : i < n           ? lengths_size_of(s->q + e->at * n, n, i)
                                 : lengths_size_of(s->p + e->at * n, n, i - n);
    return x > 0 && isfinite(x) ? exp2(floor(log2(x))) : 1;
}

/* energy: that of the variable's component */
typedef void (*visit_fn)(nevh__step_selection *, const nevh__planned *,
                         size_t instance, size_t k, size_t i, double *energy);

static void visit_all(nevh__step_selection *e, visit_fn visit, double *energy) {
    for (size_t j = 0; j < e->field->n_terms; j++) {
        const nevh__planned *term = &e->field->terms[j];
        size_t count = term->term->decl.count, stride = nevh__stride(count);
        for (size_t instance = 0; instance < count; instance += stride)
            for (size_t k = 0; k < term->nv; k++) {
                size_t i = nevh__index(term, instance, k);
                if (nevh__probed(term, k) == k)
                    visit(e, term, instance, k,
                          k < term->nq ? i : e->field->n + i,
                          energy + e->component[i]);
            }
    }
}

/* Finite lengths, and the largest variation of H within them. */
static void find_curved(nevh__step_selection *e, const nevh__planned *term,
                        size_t instance, size_t k, size_t i, double *energy) {
    double length = nevh__curve_length(&(nevh__axis){e, term, instance, k},
                                       first_guess(e, i));
    if (!isfinite(length))
        return;
    *energy =
        fmax(*energy, vary(&(nevh__axis){e, term, instance, k}, length).whole);
    if (e->length[i] > 0 && e->length[i] <= length)
        return;
    e->length[i] = length;
    e->shortened = true;
}

/* Variations of all terms within the lengths that some have. */
static void find_within(nevh__step_selection *e, const nevh__planned *term,
                        size_t instance, size_t k, size_t i, double *energy) {
    if (!(e->length[i] > 0))
        return;
    double whole =
        vary(&(nevh__axis){e, term, instance, k}, e->length[i]).whole;
    *energy = fmax(*energy, isfinite(whole) ? whole : 0);
}

/* Nothing is curved: variations over the variables' own sizes. */
static void find_energy(nevh__step_selection *e, const nevh__planned *term,
                        size_t instance, size_t k, size_t i, double *energy) {
    size_t n = e->field->n;
    const nevh__samples *s = &e->samples;
    double x = i < n ? s->q[e->at * n + i] : s->p[e->at * n + i - n];
    double whole = vary(&(nevh__axis){e, term, instance, k}, fabs(x)).whole;
    *energy = fmax(*energy, isfinite(whole) ? whole : 0);
}

/* Variations over the sizes that the orbit has later, or where nothing has one over
   coordinates of 1, with which momenta at least go together. */
static void find_from_rest(nevh__step_selection *e, const nevh__planned *term,
                           size_t instance, size_t k, size_t i,
                           double *energy) {
    double size = e->sizes ? e->sizes[i] : i < e->field->n ? 1 : 0;
    double whole = vary(&(nevh__axis){e, term, instance, k}, size).whole;
    *energy = fmax(*energy, isfinite(whole) ? whole : 0);
}

/* Numbers of each component, n each: the largest variations of H. */
typedef struct {
    double *energy; /* within lengths, or 0; then those that are decided for */
    double *other;  /* of momenta, and of other terms within the lengths */
    double *along;  /* over sizes of the orbit */
    double *later;  /* within lengths at its end */
    bool *curved;   /* some variable has a length */
    bool *taken;    /* sizes of the orbit are */
} variations;

/* Within lengths at the end of the orbit: 0 where H is quadratic in each variable. */
static bool find_later(nevh__step_selection *e, double later[]) {
    size_t bytes = 2 * e->field->n * sizeof *e->length;
    double *lengths = nevh__copy(e->length, 2 * e->field->n, sizeof *lengths);
    if (!lengths)
        return false;
    e->at = e->samples.most;
    e->samples.t[e->at] = e->samples.t[0];
    visit_all(e, find_curved, later);
    e->at = 0;
    memcpy(e->length, lengths, bytes);
    free(lengths);
    return true;
}

/* Sizes of the orbit from the start are taken where these are far beyond those that the
   start has: then H varies there by much more.  NAN: they are not. */
static bool look_along_orbit(nevh__step_selection *e, variations *v,
                             double sizes[]) {
    size_t n = e->field->n;
    double none = nevh__has_gradients(e->field) ? as_at_rest : 0;
    bool any = false, less = false, taken = false;
    for (size_t k = 0; k < n; k++)
        any |= !v->curved[e->component[k]] && v->energy[e->component[k]] == 0;
    bool found = nevh__sizes_from_start(e, any, sizes);
    double little = found ? far_less : none;
    e->sizes = found ? sizes : NULL;
    visit_all(e, find_from_rest, v->along);
    for (size_t c = 0; c < n; c++)
        less |= !v->curved[c] && v->energy[c] < little * v->along[c];
    if (found && less && !find_later(e, v->later))
        return false;
    for (size_t c = 0; c < n; c++) {
        bool far = v->later[c] == 0 && v->energy[c] < little * v->along[c];
        v->taken[c] = !v->curved[c] && (v->energy[c] == 0 || far);
        v->energy[c] = v->taken[c] ? v->along[c] : v->energy[c];
        taken |= v->taken[c];
    }
    for (size_t i = 0; i < 2 * n; i++)
        sizes[i] = v->taken[e->component[i % n]] ? sizes[i] : NAN;
    e->sizes = taken && found ? sizes : NULL;
    return true;
}

/* The same of momenta alone. */
static void find_kinetic(nevh__step_selection *e, const nevh__planned *term,
                         size_t instance, size_t k, size_t i, double *energy) {
    if (i >= e->field->n)
        find_energy(e, term, instance, k, i, energy);
}

/* The rest: where H varies by that energy. */
static void find_straight(nevh__step_selection *e, const nevh__planned *term,
                          size_t instance, size_t k, size_t i, double *energy) {
    double guess = first_guess(e, i), length = guess;
    bool curved = e->length[i] > 0;
    if (curved)
        return;
    if (*energy > 0)
        length =
            energy_length(&(nevh__axis){e, term, instance, k}, guess, *energy);
    if (isnan(length))
        return;
    e->length[i] = e->length[i] < 0 ? -fmin(-e->length[i], length) : -length;
}

/* Copies a lane of the states given to sample `at`. */
static void lengths_load(nevh__step_selection *e, size_t lane, size_t at) {
    const nevh_options *o = e->options;
    size_t n = e->field->n, width = o->width ? o->width : 1;
    e->samples.t[at] = o->t;
    for (size_t k = 0; k < n; k++) {
        e->samples.q[at * n + k] = o->q ? o->q[k * width + lane] : 0;
        e->samples.p[at * n + k] = o->p ? o->p[k * width + lane] : 0;
    }
}

static bool same_state(const nevh_options *o, size_t n, size_t a, size_t b) {
    for (size_t i = 0; i < n * o->width; i += o->width)
        if ((o->q && o->q[i + a] != o->q[i + b]) ||
            (o->p && o->p[i + a] != o->p[i + b]))
            return false;
    return true;
}

/* The first lane becomes a sample, and the last ones that have a shorter length
   than those before. */
static void find_over_lanes(nevh__step_selection *e, double *energy) {
    size_t width = e->options->width ? e->options->width : 1;
    size_t stride = (width + TRIED_LANES - 1) / TRIED_LANES;
    for (size_t lane = 0; lane < width; lane += stride) {
        if (lane && same_state(e->options, e->field->n, lane, lane - stride))
            continue; /* nothing would be shorter */
        e->at = e->lanes;
        e->shortened = lane == 0;
        lengths_load(e, lane, e->at);
        visit_all(e, find_curved, energy);
        if (e->shortened && e->lanes < MOST_LANES - 1)
            e->lanes++;
        else if (e->shortened)
            lengths_load(e, lane, e->lanes - 1);
    }
    e->samples.count = e->lanes;
    e->at = 0;
}

bool nevh__keep_lengths(const nevh__step_selection *e) {
    nevh_field *f = e->field;
    if (e->options->width > 1)
        return true; /* which lanes matter would be to keep, too */
    f->length = nevh__copy(e->length, 2 * f->n, sizeof *f->length);
    return f->length;
}

/* Energies by which components vary; sizes: room, 2n. */
static bool find_energies(nevh__step_selection *e, variations *v,
                          double sizes[]) {
    size_t n = e->field->n, curved = 0, first = 0;
    find_over_lanes(e, v->energy);
    for (size_t c = 0; c < n; c++) {
        first += e->component[c] == c;
        curved += e->component[c] == c && v->energy[c] > 0;
        v->curved[c] = v->energy[c] > 0;
    }
    if (curved) {
        visit_all(e, find_kinetic, v->other);
        visit_all(e, find_within, v->other);
    }
    if (curved < first)
        visit_all(e, find_energy, v->along);
    for (size_t c = 0; c < n; c++) {
        if (!v->curved[c])
            v->energy[c] = v->along[c];
        else if (v->energy[c] < out_of_reach * v->other[c])
            v->energy[c] = v->other[c];
        v->along[c] = 0;
    }
    return curved == first || look_along_orbit(e, v, sizes);
}

/* Returns the lengths of one orbit that need not be looked for; NULL: there are none. */
static const double *known_lengths(const nevh__step_selection *e) {
    const nevh_options *o = e->options;
    return e->field->length ? e->field->length : o->width > 1 ? NULL : o->scale;
}

bool nevh__find_lengths(nevh__step_selection *e) {
    size_t n = e->field->n;
    double last = 1;
    const double *known = known_lengths(e);
    if (known) {
        lengths_load(e, 0, 0);
        e->lanes = e->samples.count = 1;
        memcpy(e->length, known, 2 * n * sizeof *known);
        return true;
    }
    double *room = nevh__array(6 * n, sizeof *room);
    bool *flags = nevh__array(2 * n, sizeof *flags);
    variations v = {room,         room + n, room + 2 * n,
                    room + 3 * n, flags,    flags + n};
    bool fine = room && flags && find_energies(e, &v, room + 4 * n);
    if (fine)
        visit_all(e, find_straight, v.energy); /* kept apart by their sign */
    e->sizes = NULL;
    free(room);
    free(flags);
    for (size_t i = 0; fine && i < 2 * n; i++) {
        last = e->length[i] != 0 ? fabs(e->length[i]) : last;
        e->length[i] = e->options->scale ? e->options->scale[i] : last;
    }
    return fine;
}
