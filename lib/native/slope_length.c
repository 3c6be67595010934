/* nevh: how long the text of slopes is, and how many values they take.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "native/operation_text_private.h"
#include "native/slope_private.h"
#include <math.h>

/* More text than MOST_BROADCAST is called instead of being repeated.  Of two
   vectors at once the numbers of MOST_OF_TWO operations are still near. */
enum { MOST_OPERATIONS = 800, MOST_BROADCAST = 800, MOST_OF_TWO = 20 };

/* Points of a term's differences by the half's variables. */
static size_t points_of(const nevh_field *f, const nevh__planned *term,
                        bool kick) {
    size_t points = 0;
    for (int i = 0; i < 2; i++) {
        const nevh__pass *pass = &term->pass[i];
        size_t variables =
            kick ? pass->first_p - pass->begin : pass->end - pass->first_p;
        points += 2 * pass->pairs * variables;
    }
    if (!f->gradient->offsets)
        points = f->gradient == nevh_exact ? 0 : kick ? term->nq : term->np;
    return points * term->term->decl.count;
}

void nevh__slope_values(const nevh_field *f, bool kick, uint64_t values[]) {
    for (size_t i = 0; i < f->n_terms; i++)
        values[i] += nevh__is_wanted(f, &f->terms[i], kick)
                         ? points_of(f, &f->terms[i], kick)
                         : 0;
}

/* The length of one half's text, in operations; INFINITY: there is none, and
   w->refusal has the reason. */
static double half_operations(nevh__writer *w, const nevh_field *f, bool kick) {
    bool wide = nevh__side_by_side(w);
    double operations = 0;
    for (size_t i = 0; i < f->n_terms; i++) {
        const nevh__planned *term = &f->terms[i];
        const nevh_term *is = &term->term->decl;
        if (!nevh__is_wanted(f, term, kick))
            continue;
        if (!nevh__is_tape(is)) {
            w->refusal = "a term is no formula";
            return INFINITY;
        }
        double times = (double)is->count;
        if (w->loops && nevh__is_loop(term))
            times = f->gradient == nevh_exact
                        ? 1
                        : (double)points_of(f, term, kick) / times;
        else if (f->gradient != nevh_exact)
            times =
                (double)points_of(f, term, kick) /
                (double)(f->gradient->offsets && wide ? nevh__lanes_together()
                                                      : 1);
        operations += times * (double)nevh__tape_length(is->params);
    }
    return operations;
}

bool nevh__slopes_fit(nevh__writer *w, const nevh_field *f, size_t calls) {
    double most = w->readable ? 10 * MOST_OPERATIONS : MOST_OPERATIONS;
    double kick = half_operations(w, f, true);
    double drift = half_operations(w, f, false);
    if ((kick > most || drift > most) && !w->refusal)
        w->refusal = "its formulas are too long";
    if (nevh__has_lanes(w) && f->gradient != nevh_exact &&
        !f->gradient->offsets)
        w->refusal = w->stages ? "stages stand side by side"
                               : "orbits stand side by side";
    if (!w->readable && (kick + drift) * (double)calls > MOST_BROADCAST)
        nevh__write(w, "#undef SLOPE\n"
                       "#define SLOPE static __attribute__((noinline))\n");
    return !w->refusal;
}

static bool calls_functions(const nevh__tape *tape) {
    for (size_t i = 0; i < tape->length; i++)
        if (nevh__operation_calls(tape->code[i].operation))
            return true;
    return false;
}

/* Measured on the pendulum, Kepler's problem, Henon-Heiles and the double pendulum:
   where a step has but two slopes it fits the registers, unless it calls functions;
   points of differences are many vectors already. */
size_t nevh__vectors_at_once(const nevh__writer *w, const nevh_field *f,
                             size_t slopes) {
    double operations = 0;
    bool calls = false;
    if (w->by_lane || w->width % (2 * NEVH__LANES) != 0)
        return 1;
    for (size_t i = 0; i < f->n_terms; i++) {
        const nevh_term *is = &f->terms[i].term->decl;
        if (!nevh__is_tape(is))
            return 1;
        operations += (double)is->count * (double)nevh__tape_length(is->params);
        calls |= calls_functions(is->params);
    }
    bool two = operations <= MOST_OF_TWO &&
               (slopes > 2 || (calls && f->gradient == nevh_exact));
    return two ? 2 : 1;
}
