/* nevh: the operations of a tape, backwards: adjoints of columns side by side.
   SPDX-License-Identifier: GPL-3.0-or-later

   Included twice, as tape_run.h is; NEVH__NAMED(name) is a function of a form. */
/* One operation's adjoints g times its derivative by one argument are added to
   those of the argument, d; its last use comes first, and adds to nothing. */
#define EACH(product)                                                          \
    for (size_t i = 0; i < columns; i += 8) {                                  \
        const double *x = from_a + i * step_a, *z = from_b + i * step_b;       \
        NEVH_LANES(lane, 8) {                                                  \
            double a = x[lane], b = z[lane], y = from_y[i + lane];             \
            double g = from_g[i + lane];                                       \
            (void)a, (void)b, (void)y, (void)g;                                \
            d[i + lane] = sum[i + lane] + product;                             \
        }                                                                      \
    }                                                                          \
    break;
#define CASE_A(kind, identifier, name, arity, value, by_a, by_b, ...)          \
    case NEVH__##identifier:                                                   \
        EACH(by_a)
#define CASE_B(kind, identifier, name, arity, value, by_a, by_b, ...)          \
    case NEVH__##identifier:                                                   \
        EACH(by_b)
#define ROWS(argument)                                                         \
    size_t columns = s->rows.columns;                                          \
    const double *from_a = nevh__rows_at(&s->rows, at->a);                     \
    const double *from_b = nevh__rows_at(&s->rows, at->b);                     \
    const double *from_y = s->rows.slots + at->to * columns;                   \
    const double *from_g = s->base[NEVH__SLOT] + at->to * columns;             \
    const double *sum = argument.last ? nothing : d;                           \
    size_t step_a = at->a.kind != NEVH__NUMBER;                                \
    size_t step_b = at->b.kind != NEVH__NUMBER

NEVH__INLINE void
NEVH__NAMED(hand_on_a)(const sweep *s, const nevh__instruction *at, double *d) {
    ROWS(at->a);
    const double *from_cosine = s->rows.slots + at->also * columns;
    const double *from_g_cosine = s->base[NEVH__SLOT] + at->also * columns;
    switch (at->operation) {
        NEVH__OPERATIONS(CASE_A)
    case NEVH__SINCOS:
        EACH(nevh__chain(g, from_cosine[i + lane]) -
             nevh__chain(from_g_cosine[i + lane], y))
    }
}

NEVH__INLINE void
NEVH__NAMED(hand_on_b)(const sweep *s, const nevh__instruction *at, double *d) {
    ROWS(at->b);
    switch (at->operation) { NEVH__OPERATIONS(CASE_B) }
}

/* journal: where it ends; returns where it then does. */
NEVH_SIMD static const double *NEVH__NAMED(backwards)(const sweep *s, size_t from,
                                                      size_t until,
                                                      const double *journal) {
    const nevh__instruction *code = s->tape->code;
    for (const nevh__instruction *at = code + until; at-- > code + from;) {
#ifdef NEVH__PLAIN
        if (nevh__is_far(at, nevh__rows_at(&s->rows, at->a),
                         at->a.kind == NEVH__NUMBER ? NEVH__LANES
                                                    : s->rows.columns)) {
            size_t i = (size_t)(at - code);
            journal = NEVH__PLAIN(s, i, i + 1, journal);
            continue;
        }
#endif
        double *d_a = adjoint(s, at->a), *d_b = adjoint(s, at->b);
        if (d_a)
            NEVH__NAMED(hand_on_a)(s, at, d_a);
        if (d_b)
            NEVH__NAMED(hand_on_b)(s, at, d_b);
        if (!at->also_fresh)
            journal = put_back(s, at->also, journal);
        if (!at->fresh)
            journal = put_back(s, at->to, journal);
    }
    return journal;
}
#undef EACH
#undef CASE_A
#undef CASE_B
#undef ROWS
#undef NEVH__F
#undef NEVH__NAMED
#undef NEVH__PLAIN
