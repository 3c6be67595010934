/* The schemes and what is known of them: a table, or with a name (of nevh's or
   another package's) all about one scheme, or with --sources where they are
   from.  Look at the price of generality: what takes any H is implicit, works
   in a doubled phase space, or is not symplectic.  And none keeps both the
   energy and the symplectic form.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/nevh.h>
#include <stdio.h>
#include <string.h>

enum { COLUMNS = 10, LONGEST = 32, LINE = 79 };
typedef struct {
    char cell[COLUMNS][LONGEST];
} row;

static row describe(const nevh_integrator *scheme) {
    row r;
    int fixed = nevh_integrator_gradients(scheme);
    int sweep = nevh_integrator_sweep_gradients(scheme);
    unsigned needs = nevh_integrator_needs(scheme);
    const nevh_claim claims[] = {nevh_integrator_symplectic(scheme),
                                 nevh_integrator_symmetric(scheme),
                                 nevh_integrator_explicit(scheme),
                                 nevh_integrator_preserves_energy(scheme)};
    snprintf(r.cell[0], LONGEST, "%s", nevh_integrator_name(scheme));
    snprintf(r.cell[1], LONGEST, "%d", nevh_integrator_order(scheme));
    snprintf(r.cell[2], LONGEST, "%d", nevh_integrator_stages(scheme));
    strcpy(r.cell[3], claims[2] == NEVH_NO ? "values of H" : "as needed");
    if (fixed || sweep)
        snprintf(r.cell[3], LONGEST, fixed ? "%d" : "%d a sweep",
                 fixed + sweep);
    strcpy(r.cell[4], needs & NEVH_PARTS               ? "A + V(q)"
                      : needs & NEVH_QUADRATIC_KINETIC ? "T(p) + V(q)*"
                      : needs & NEVH_SEPARABLE         ? "T(p) + V(q)"
                                                       : "any");
    for (int i = 0; i < 4; i++)
        strcpy(r.cell[5 + i], nevh_claim_name(claims[i]));
    strcpy(r.cell[9], nevh_integrator_own_time(scheme)   ? "its own"
                      : nevh_integrator_adaptive(scheme) ? "adaptive"
                                                         : "fixed");
    return r;
}

static void print(const int width[], row r) {
    for (int c = 0; c < COLUMNS - 1; c++)
        printf(" %*s", c == 1 || c == 2 ? width[c] : -width[c], r.cell[c]);
    printf(" %s\n", r.cell[COLUMNS - 1]);
}

/* All rows, or one; columns as wide as they need for all. */
static void print_table(const nevh_integrator *one) {
    const nevh_integrator *const *all = nevh_integrators();
    const row head = {{"integrator", "order", "stages", "evaluations", "H",
                       "sympl.", "symm.", "expl.", "energy", "steps"}};
    int width[COLUMNS] = {0};
    for (int i = -1; i < 0 || all[i]; i++) {
        row r = i < 0 ? head : describe(all[i]);
        for (int c = 0; c < COLUMNS; c++)
            if ((int)strlen(r.cell[c]) > width[c])
                width[c] = (int)strlen(r.cell[c]);
    }
    print(width, head);
    for (int i = 0; all[i]; i++)
        if (!one || all[i] == one)
            print(width, describe(all[i]));
    puts("\n evaluations: of dH/dq in a step, or in a sweep over its stages"
         "\n *            with T quadratic in p"
         "\n extended:    in the larger phase space that the scheme works in");
}

/* Indented, in lines of at most LINE characters. */
static void print_text(const char *text) {
    for (int column = LINE, n; *text; text += n, text += *text == ' ') {
        n = (int)strcspn(text, " ");
        column = column + 1 + n > LINE ? 4 + n : column + 1 + n;
        printf("%s%.*s", column == 4 + n ? "\n    " : " ", n, text);
    }
}

static void print_source(const nevh_integrator *scheme) {
    printf("\n %s", nevh_integrator_name(scheme));
    print_text(nevh_integrator_aliases(scheme));
    print_text(nevh_integrator_source(scheme));
    puts("");
}

int main(int argc, char *argv[]) {
    const char *wanted = argc > 1 ? argv[1] : NULL;
    const nevh_integrator *one = nevh_integrator_named(wanted);
    if (wanted && strcmp(wanted, "--sources") == 0)
        for (const nevh_integrator *const *i = nevh_integrators(); *i; i++)
            print_source(*i);
    else if (wanted && !one)
        return fprintf(stderr, "there is no scheme %s\n", wanted), 1;
    else
        print_table(one);
    if (one)
        print_source(one);
    return 0;
}
