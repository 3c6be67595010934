/* nevh: the operations of a tape, forwards, over columns side by side.
   SPDX-License-Identifier: GPL-3.0-or-later

   Included twice: NEVH__F(f) is the form of the function f, and NEVH__RUN the name
   of what is defined.  Both are undefined at the end.  Where NEVH__PLAIN is
   defined, functions take small arguments, and it runs operations of others. */
/* Applies an operation to whole vectors; numbers are not advanced. */
#define EACH(row, value)                                                       \
    for (size_t i = 0; i < columns; i += 8) {                                  \
        const double *x = from_a + i * step_a, *z = from_b + i * step_b;       \
        NEVH_LANES(lane, 8) {                                                  \
            double a = x[lane], b = z[lane];                                   \
            (void)b;                                                           \
            (row)[i + lane] = value;                                           \
        }                                                                      \
    }
#define CASE(kind, identifier, name, arity, value, by_a, by_b, ...)            \
    case NEVH__##identifier:                                                   \
        EACH(to, value)                                                        \
        break;

NEVH_SIMD static double *NEVH__RUN(const nevh__rows *r,
                                   const nevh__instruction *from,
                                   const nevh__instruction *until,
                                   double *journal) {
    size_t columns = r->columns;
    for (const nevh__instruction *at = from; at < until; at++) {
        const double *from_a = nevh__rows_at(r, at->a);
        const double *from_b = nevh__rows_at(r, at->b);
        size_t step_a = at->a.kind != NEVH__NUMBER;
        size_t step_b = at->b.kind != NEVH__NUMBER;
        bool last = r->out && at + 1 == until;
#ifdef NEVH__PLAIN
        if (nevh__is_far(at, from_a, step_a ? columns : NEVH__LANES)) {
            nevh__rows one = *r;
            one.out = last ? r->out : NULL;
            journal = NEVH__PLAIN(&one, at, at + 1, journal);
            continue;
        }
#endif
        double *to = last ? r->out : r->slots + at->to * columns;
        double *also = r->slots + at->also * columns;
        if (journal && !at->fresh)
            journal = write_row(journal, to, columns);
        if (journal && !at->also_fresh)
            journal = write_row(journal, also, columns);
        switch (at->operation) {
            NEVH__OPERATIONS(CASE)
        case NEVH__SINCOS:
            EACH(to, NEVH__F(sincos)(a, also + i + lane))
        }
    }
    return journal;
}
#undef CASE
#undef EACH
#undef NEVH__F
#undef NEVH__RUN
#undef NEVH__PLAIN
