/* nevh cost: what a digit costs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "cost_private.h"
#include "plot/order_plot.h"
#include <math.h>
#include <string.h>

const double cost_target[COST_TARGETS] = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12};

static bool is_beaten(const costs *c, const study *l) {
    return !c->all && !cost_is_yardstick(l) &&
           study_is_behind(&c->search, l, c->study, c->count);
}

static void descend_all(costs *c) {
    static const double share = 0.65; /* the rest is for the targets */
    study *next;
    for (size_t i = 0; i < c->count; i++)
        study_begin(&c->search, &c->study[i]);
    while ((next = study_next(c->study, c->count)) &&
           !search_is_over(&c->search, share))
        if (is_beaten(c, next))
            next->end = STUDY_LIMIT;
        else
            study_descend(&c->search, next);
    for (size_t i = 0; i < c->count; i++)
        if (c->study[i].end == STUDY_OPEN)
            c->study[i].end = STUDY_LIMIT;
}

static double least_work(const costs *c, size_t target) {
    double least = INFINITY;
    for (size_t i = 0; i < c->count; i++) {
        const study *l = &c->study[i];
        const row *r = cost_cell(l, target);
        if (costs_count(c, l) && r)
            least = fmin(least, r->work);
    }
    return least;
}

/* True if the coarsest step that keeps the target may be a cheap one: it costs more
   than the last level that does not. */
static bool is_promising(const costs *c, const study *l, size_t target) {
    static const double nearly = 2;
    double least = least_work(c, target);
    size_t i = 0;
    while (i < l->count && study_error(&l->level[i]) > cost_target[target])
        i++;
    return i == 0 || l->level[i - 1].work < nearly * least;
}

static void refine_all(costs *c) {
    for (size_t k = 0; k < COST_TARGETS; k++)
        for (size_t i = 0; i < c->count; i++) {
            study *l = &c->study[i];
            if (c->all || cost_is_yardstick(l) || is_promising(c, l, k))
                study_refine(&c->search, l, cost_target[k], GRID_COARSE);
        }
}

/* The steps of what works least, or nearly so, to the last place. */
static void refine_cheapest(costs *c) {
    static const double nearly = 1.5;
    for (size_t k = 0; k < COST_TARGETS; k++) {
        double least = least_work(c, k);
        for (size_t i = 0; i < c->count; i++) {
            study *l = &c->study[i];
            const row *r = cost_cell(l, k);
            if (costs_count(c, l) && r && r->work <= nearly * least &&
                !cost_is_beyond(c, k))
                study_refine(&c->search, l, cost_target[k], 1);
        }
    }
}

/* True if its time may be the least. */
static bool may_win(const costs *c, const row *r, size_t target) {
    static const double nearly = 2.5;
    return r->work < nearly * least_work(c, target);
}

static bool is_compared(const costs *c, const study *l, const row *r,
                        size_t target) {
    return r && (c->all || cost_is_yardstick(l) ||
                 (costs_count(c, l) && may_win(c, r, target)));
}

static bool is_shown(const costs *c, const study *l, const row *r,
                     size_t target) {
    (void)target;
    return r && cost_shows(c, l);
}

/* The level of a study for a target. */
typedef struct {
    study *study;
    size_t level;
} cell;

/* The cells that are `wanted`, target by target; returns their number. */
static size_t find_cells(costs *c,
                         bool (*wanted)(const costs *, const study *,
                                        const row *, size_t target),
                         cell cells[]) {
    size_t count = 0;
    for (size_t k = 0; k < COST_TARGETS; k++)
        for (size_t i = 0; i < c->count; i++) {
            study *l = &c->study[i];
            const row *r = cost_cell(l, k);
            if (wanted(c, l, r, k))
                cells[count++] = (cell){l, (size_t)(r - l->level)};
        }
    return count;
}

static void choose_native(costs *c, const cell cells[], size_t count) {
    row **all = tool_allocate(count, sizeof *all);
    for (size_t i = 0; i < count; i++)
        all[i] = &cells[i].study->level[cells[i].level];
    rows_choose_native(&c->search.plan, all, count, true);
}

/* Times all cells. Compilation is decided for all of them before the first is
   timed. */
static void time_cells(costs *c) {
    cell *cells = tool_allocate(COST_TARGETS * c->count, sizeof *cells);
    size_t count = find_cells(c, is_compared, cells);
    choose_native(c, cells, count);
    for (size_t i = 0; i < count; i++)
        study_time(&c->search, cells[i].study, cells[i].level);
    count = find_cells(c, is_shown, cells);
    for (size_t i = 0; i < count; i++)
        study_time(&c->search, cells[i].study, cells[i].level);
}

/* Programs read the verdict of each row; the table has none, and an orbit
   followed further for it takes longer than all else. */
static void time_others(costs *c, bool shown) {
    for (size_t i = 0; i < c->count; i++)
        for (size_t k = 0; k < c->study[i].count; k++) {
            row *r = &c->study[i].level[k];
            if (shown && (!cost_shows(c, &c->study[i]) ||
                          search_out_of_time(&c->search, 1)))
                continue;
            study_time(&c->search, &c->study[i], k);
            if (!shown && r->ran)
                row_finish(&c->search.plan, r);
        }
}

/* Runs all studies. Only programs read levels that the table does not show. */
static void run_studies(costs *c, const options *o) {
    enum { LEVELS = 8 };
    bool for_people = o->format == FORMAT_TABLE;
    descend_all(c);
    refine_all(c);
    refine_cheapest(c);
    time_cells(c);
    for (size_t i = 0; i < c->count && !(for_people && !c->all); i++)
        study_fill(&c->search, &c->study[i], LEVELS);
    if (!for_people || c->all || plot_wanted(o))
        time_others(c, for_people);
}

static void make_studies(costs *c) {
    const plan *p = &c->search.plan;
    c->study = tool_allocate(p->gradients.count * p->integrators.count,
                             sizeof *c->study);
    for (size_t g = 0; g < p->gradients.count; g++)
        for (size_t i = 0; i < p->integrators.count; i++)
            c->study[c->count++] =
                study_new(p, p->integrators.item[i], p->gradients.item[g]);
}

bool costs_count(const costs *c, const study *l) {
    return !l->exact &&
           (!l->count || c->search.plan.by_state || !study_keeps_energy(l));
}

const row *cost_cell(const study *l, size_t target) {
    return study_cheapest(l, cost_target[target]);
}

const study *costs_cheapest(const costs *c, size_t target, bool gradients) {
    const study *best = NULL;
    double least = INFINITY;
    for (size_t i = 0; i < c->count; i++) {
        const study *l = &c->study[i];
        const row *r = cost_cell(l, target);
        if (costs_count(c, l) && r && r->seconds < least &&
            (!gradients || study_takes_gradients(l)))
            least = r->seconds, best = l;
    }
    return best;
}

/* Rows side by side, in the order of the studies. */
static row *list_rows(const costs *c,
                      bool (*wanted)(const costs *, const study *),
                      size_t *count) {
    size_t most = 0;
    for (size_t i = 0; i < c->count; i++)
        most += c->study[i].count;
    row *rows = tool_allocate(most, sizeof *rows);
    *count = 0;
    for (size_t i = 0; i < c->count; i++) {
        const study *l = &c->study[i];
        if (!l->count || (wanted && !wanted(c, l)))
            continue;
        memcpy(rows + *count, l->level, l->count * sizeof *rows);
        *count += l->count;
    }
    return rows;
}

static page make_page(const options *o, costs *c) {
    page result = {0};
    bool is_table = o->format == FORMAT_TABLE;
    size_t count;
    row *rows = list_rows(c, is_table ? cost_shows : NULL, &count);
    observe_orders(rows, count);
    result.table =
        is_table ? cost_table(c) : records(&c->search.plan, rows, count);
    if (!is_table || !o->quiet) {
        plan_notes(&c->search.plan, &result.before);
        row_notes(o, &c->search.plan, rows, count, &result.before);
        time_notes(&c->search.plan, &result.before);
        state_notes(&c->search.plan, &result.before);
        observable_notes(&c->search.plan, &result.before);
        cost_notes(c, &result.before);
        cost_words(c, &result.after);
        time_words(&c->search.plan, rows, count, &result.after);
    }
    return result;
}

bool costs_fail(const costs *c) {
    bool ran = false;
    for (size_t i = 0; i < c->count; i++)
        ran |= c->study[i].count && !study_failure(&c->study[i]);
    return c->all || !ran;
}

/* The first run of a scheme that was named that failed with a step that was asked for, or
   that ran with none; other steps, and other schemes, are a search. */
static const row *first_failure(const costs *c) {
    for (size_t i = 0; i < c->count && costs_fail(c); i++) {
        const row *failed = NULL;
        bool ran = false;
        for (size_t k = c->study[i].count; k-- > 0;) {
            const row *level = &c->study[i].level[k];
            ran |= level->ran;
            failed = level->failed ? level : failed;
        }
        if (failed && (!ran || c->search.dt))
            return failed;
    }
    return NULL;
}

/* On stderr, too, where the exit status says that rows failed. */
static int report_failures(const costs *c) {
    const row *failed = first_failure(c);
    return failed ? row_fails(&c->search.plan, failed) : TOOL_OK;
}

static int draw_costs(const options *o, const costs *c) {
    size_t count;
    if (o->plot.kind != PLOT_KIND_order)
        return cost_plot(o, c);
    row *rows = list_rows(c, cost_draws, &count);
    return order_plot(o, &c->search.plan, rows, count, ORDER_DT);
}

double cost_budget(const options *o) {
    return o->search.budget > 0 ? o->search.budget : SEARCH_BUDGET;
}

static int cost_plan(const options *o, plan *p, double whole) {
    output out;
    if (order_plot_check(o, o->dt.count ? o->dt.count : 2) || plot_check(o) ||
        output_open(&out, o->file))
        return TOOL_USAGE;
    costs c = {.search = search_begin(p, o, cost_budget(o)),
               .whole = whole,
               .all = o->integrators.count > 0};
    make_studies(&c);
    run_studies(&c, o);
    page result = make_page(o, &c);
    search_end(&c.search);
    bool first = plot_goes_first(o);
    int drawn = first ? draw_costs(o, &c) : TOOL_OK;
    page_print(&result, o, out.stream);
    int status = output_close(&out, report_failures(&c));
    if (plot_wanted(o) && !first)
        drawn = draw_costs(o, &c);
    if (drawn)
        status = TOOL_USAGE;
    return status;
}

static int cost(const options *o) {
    plan p;
    double whole = NAN;
    if (o->observable && option_given(o, "by") && !o->search.by)
        return tool_refuse("--by energy compares energies, and --observable "
                           "what it names: take one of them");
    if (o->search.against)
        return cost_lengths(o);
    int status = plan_make(&p, o);
    if (!status)
        status = plan_search(&p, o);
    if (!status && !o->t_end && !o->dt.count)
        whole = plan_shorten(&p, cost_budget(o));
    if (!status && (o->search.by || o->observable))
        status = plan_require_reference(&p);
    else if (!status && o->format != FORMAT_TABLE)
        status = plan_reference(&p, p.t_end);
    if (!status && o->observable)
        status = plan_observe(&p, o->observable);
    if (!status)
        status = cost_plan(o, &p, whole);
    plan_free(&p);
    return status;
}

const command cost_command = {
    .name = "cost",
    .operand = "SCENE",
    .brief = "what each digit costs",
    .help = "what each digit costs, for each integrator",
    .examples =
        "cost oscillator --t-end 20\n"
        "cost pendulum --against length --t-end 400 --integrators verlet,gauss6,rk4 --plot cost.svg",
    .options =
        "SCENE STEPS NATIVE TABLE PLOT by against observable repeat budget plot-kind",
    .draws = "order",
    .columns = RECORD_COLUMNS,
    .run = cost,
};
