/* nevh: native steps are planned and taken.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/adaptive_verlet_private.h"
#include "kernels/form_flow_private.h"
#include "kernels/parts_scheme_private.h"
#include "kernels/runge_kutta_private.h"
#include "kernels/splitting_private.h"
#include "kernels/tableau_private.h"
#include "kernels/tao_private.h"
#include "kernels/taylor_private.h"
#include "native/native_private.h"
#include "native/compiler_private.h"
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Seconds that the steps foreseen take from the tape, from which on loading what
   was compiled pays. */
static const double loading_pays = 2e-3;
/* Seconds that a compiler takes for a character, and how many times what it makes
   is used, being kept: numbers, steps and spans are no part of the text. */
static const double a_character = 6e-6, uses = 3;

static void end_compiler(nevh__native *x, bool wanted) {
    if (x->compiler)
        x->library = nevh__background_end(x->compiler, wanted, x->why);
    x->compiler = NULL;
}

bool nevh__native_await(nevh__native *x) {
    if (x)
        end_compiler(x, true);
    if (x && x->differs)
        snprintf(
            x->why, NEVH__WHY_NATIVE,
            "what the C compiler makes gives other digits: its own options "
            "change sums or products");
    return x && x->library && !x->differs;
}

void nevh__native_free(nevh__native *x) {
    if (!x)
        return;
    end_compiler(x, false);
    if (x->library)
        dlclose(x->library);
    free(x->numbers);
    free(x->own);
    free(x->weights);
    free(x->times);
    free(x->room);
    free(x->kick_values);
    free(x->drift_values);
    free(x);
}

static bool fill_splitting(nevh__native *x, const nevh_work *w) {
    const nevh_splitting *table = w->integrator->table;
    size_t count = nevh__splitting_operations(table);
    x->keeps = count % 2 == 1;
    x->flags_at = 3;
    x->kicks_first = table->first == NEVH_KICK;
    x->kicks = (count + x->kicks_first) / 2;
    x->drifts = count - x->kicks;
    return nevh__splitting_tables(table, &x->weights, &x->times);
}

static bool fill_runge_kutta(nevh__native *x, const nevh_work *w) {
    const nevh_butcher *table = w->integrator->table;
    bool adapts = nevh__adapts(w);
    x->kicks = x->drifts =
        table->stages - (adapts || table->last_is_first ? 1 : 0);
    x->adapts = adapts;
    x->first_drifts = 1;
    return true;
}

static bool fill_nystrom(nevh__native *x, const nevh_work *w) {
    const nevh_nystrom *table = w->integrator->table;
    bool diagonal = nevh__nystrom_kinetic_of(w).diagonal;
    size_t s = table->stages;
    x->adapts = nevh__adapts(w);
    x->kicks = x->adapts ? s - 1 : s;
    x->drifts = x->adapts ? (diagonal ? 0 : s + 1) : diagonal ? 1 : s;
    x->first_drifts = 1;
    return true;
}

/* The first slope is kept; weights: room for h, and what depends on it. */
static bool fill_tao(nevh__native *x, const nevh_work *w) {
    const nevh_splitting *table = w->integrator->table;
    size_t parts = 2 * table->count + 1;
    x->keeps = x->whole = true;
    x->flags_at = NEVH__TAO_BLOCKS;
    x->kicks = x->drifts = 3 * parts + 1;
    x->weights = nevh__array(3 * parts + 1, sizeof *x->weights);
    return x->weights;
}

/* Kicks and drifts of a step after an orbit's first; its length follows from slopes
   ahead and behind, or from that at its beginning. */
static bool fill_adaptive_verlet(nevh__native *x, const nevh_work *w) {
    const nevh__step_control *table = w->integrator->table;
    x->own_time = true;
    x->kicks = table->reversible ? 3 : 1;
    x->drifts = table->reversible ? 5 : 3;
    x->times = nevh__array(1, sizeof *x->times);
    return x->times;
}

/* The first slope of each kind is kept; kicks are of both halves, drifts inner kicks. */
static bool fill_parts(nevh__native *x, const nevh_work *w) {
    const nevh__parts_scheme *scheme = w->plan;
    x->keeps = x->whole = scheme->kept > 0;
    x->flags_at = 2 + scheme->kept;
    for (size_t i = 0; i < scheme->count; i++) {
        x->kicks += scheme->operations[i].kind == NEVH__OUTER_KICK;
        x->drifts += scheme->operations[i].kind == NEVH__INNER_KICK;
    }
    for (size_t i = 0; i < w->field->n_terms; i++) {
        x->kick_values[i] += x->drift_values[i];
        x->drift_values[i] = 0;
    }
    w->field->parts = 1u << NEVH__INNER;
    nevh__slope_values(w->field, true, x->drift_values);
    w->field->parts = 1u << NEVH__KICK;
    return true;
}

/* Kicks and drifts of one stage. */
static bool fill_stages(nevh__native *x, const nevh_work *w) {
    x->stages = (size_t)w->integrator->stages;
    x->kicks = x->drifts = 1;
    return true;
}

static const struct {
    const nevh_kernel *kernel;
    bool (*write)(nevh__writer *, nevh_work *);
    bool (*fill)(nevh__native *, const nevh_work *); /* NULL: of series */
    bool loops;   /* takes states of any length */
    bool by_lane; /* takes orbits that have constants of their own */
    bool watches; /* block_driver.h takes its steps */
} families[] = {
    {&nevh_splitting_kernel, nevh__write_splitting, fill_splitting, true, true,
     true},
    {&nevh_runge_kutta_kernel, nevh__write_runge_kutta, fill_runge_kutta, true,
     true, true},
    {&nevh_nystrom_kernel, nevh__write_nystrom, fill_nystrom, false, false,
     true},
    {&nevh_gauss_kernel, nevh__write_stages, fill_stages, false, true, false},
    {&nevh_lobatto_kernel, nevh__write_stages, fill_stages, false, true, false},
    {&nevh_implicit_euler_kernel, nevh__write_stages, fill_stages, false, true,
     false},
    {&nevh__implicit_kernel, nevh__write_stages, fill_stages, false, true,
     false},
    {&nevh__tao_kernel, nevh__write_tao, fill_tao, false, false, false},
    {&nevh__parts_kernel, nevh__write_parts, fill_parts, true, false, true},
    {&nevh__substeps_kernel, nevh__write_parts, fill_parts, true, false, true},
    {&nevh__adaptive_verlet_kernel, nevh__write_adaptive_verlet,
     fill_adaptive_verlet, false, false, false},
    {&nevh__taylor_kernel, nevh__write_series, NULL, false, false, false}};
/* The steps' copies of the state stand on the stack, but for those of loops. */
enum { MOST_NUMBERS = 8192 };
enum { FAMILIES = sizeof families / sizeof *families };

static size_t family_of_scheme(const nevh_integrator *scheme) {
    size_t i = 0;
    while (i < FAMILIES && families[i].kernel != scheme->kernel)
        i++;
    return i;
}

static size_t family_of(const nevh_work *w) {
    return family_of_scheme(w->integrator);
}

static bool of_series(const nevh_work *w) {
    return w->integrator->kernel == &nevh__taylor_kernel;
}

bool nevh_integrator_native(const nevh_integrator *scheme) {
    return scheme && family_of_scheme(scheme) < FAMILIES;
}

/* Difference noise is estimated for one orbit only. */
bool nevh__native_by_lane(const nevh_work *w) {
    size_t i = family_of(w);
    return i < FAMILIES && families[i].by_lane && w->width > 1 &&
           (families[i].fill != fill_stages ||
            w->field->gradient == nevh_exact);
}

static size_t stages_of(const nevh_work *w) {
    return families[family_of(w)].fill == fill_stages
               ? (size_t)w->integrator->stages
               : 1;
}

static bool has_loops(const nevh_work *w) {
    return w->width == 1 && families[family_of(w)].loops && !nevh__adapts(w) &&
           nevh__has_loops(w->field);
}

/* The reason why nothing is compiled; NULL: none is known yet. */
static const char *obstacle(const nevh_work *w) {
    return of_series(w)               ? NULL
           : family_of(w) == FAMILIES ? NEVH__ONLY_FAMILIES
           : w->accounts              ? "the balance of the energy is kept"
           : w->options->transform    ? "the step follows a formula of the user"
           : w->field->lanes && !nevh__native_by_lane(w)
               ? "orbits side by side have constants of their own"
           : w->width % NEVH__LANES && w->width > 1
               ? "orbits side by side fill no vectors"
           : w->n * w->width * stages_of(w) > MOST_NUMBERS && !has_loops(w)
               ? "the state is too large"
           : nevh__adapts(w) && w->width > 1
               ? "orbits side by side adapt to a tolerance each on its own"
               : NULL;
}

bool nevh__native_write(nevh__writer *text, nevh_work *w) {
    text->refusal = obstacle(w);
    text->width = w->width;
    text->field = w->field;
    text->by_lane = w->field->lanes > 0;
    text->loops = !text->refusal && has_loops(w);
    return !text->refusal && families[family_of(w)].write(text, w);
}

/* The text of what is compiled; false: there is none.  What the steps call is known
   once they are written. */
static bool write_text(nevh__writer *text, nevh_work *w) {
    if (!nevh__native_write(text, w) || text->failed)
        return false;
    nevh__write_prelude(text);
    return !text->failed;
}

/* Arguments of steps, but for numbers; false when memory is out. */
static bool native_fill(nevh__native *x, const nevh_work *w) {
    size_t terms = w->field->n_terms;
    if (of_series(w))
        return true;
    x->kick_values = nevh__array(terms, sizeof *x->kick_values);
    x->drift_values = nevh__array(terms, sizeof *x->drift_values);
    if (!x->kick_values || !x->drift_values)
        return false;
    nevh__slope_values(w->field, true, x->kick_values);
    nevh__slope_values(w->field, false, x->drift_values);
    return families[family_of(w)].fill(x, w);
}

/* Gradients that a series takes as long as, and an implicit step of few stages,
   which are taken side by side. */
enum { SERIES = 30, SWEEPS = 12 };

static double gradients_of(const nevh_work *w) {
    const nevh_integrator *scheme = w->integrator;
    if (of_series(w))
        return SERIES;
    if (families[family_of(w)].fill == fill_stages)
        return SWEEPS * (1 + (double)scheme->stages / NEVH__LANES);
    return scheme->gradients ? scheme->gradients : 1;
}

/* A guess of what the steps foreseen take from the tape. */
static double seconds_foreseen(const nevh_work *w) {
    static const double call = 4e-8, operation = 5e-9;
    double each = call;
    for (size_t i = 0; i < w->field->n_terms; i++) {
        const nevh_term *is = &w->field->terms[i].term->decl;
        if (is->gradient == nevh__tape_block_gradient)
            each += operation * (double)is->count *
                    (double)nevh__tape_length(is->params);
    }
    if (w->width > 1) /* vectors of them */
        each *= (double)w->width / 4;
    return w->options->steps_foreseen * gradients_of(w) * each;
}

/* Seconds that all uses of the compiled text save of the foreseen steps' time, less
   those of compiling it. */
static double saved_by(const nevh_work *w, size_t characters) {
    const char *cache = w->options->native_cache;
    double times = cache && !*cache ? 1 : uses;
    return times * seconds_foreseen(w) - a_character * (double)characters;
}

double nevh__native_saves(nevh_work *w) {
    nevh__writer text = {0};
    double seconds = NAN;
    if (w->native)
        return saved_by(w, w->native->characters);
    if (w->options->native != NEVH_NATIVE_AUTO || obstacle(w))
        return NAN;
    if (write_text(&text, w))
        seconds = saved_by(w, nevh__compiled_characters(&text));
    nevh__writer_free(&text);
    return seconds;
}

/* True if compiling a text takes less time than it saves. */
static bool compiling_pays(const nevh_work *w, size_t characters) {
    return w->options->native == NEVH_NATIVE_ALWAYS ||
           saved_by(w, characters) > 0;
}

bool nevh__native_pays(const nevh_work *w) {
    const nevh__native *x = w->native;
    return x && (x->library || x->compiler) && !x->differs &&
           compiling_pays(w, x->characters);
}

static bool native_take_steps(nevh__native *x) {
    nevh__compiled_steps steps;
    if (x->compiler)
        return true;
    *(void **)&steps = dlsym(x->library, "nevh_native_steps");
    x->steps = steps;
    return steps;
}

static bool take_series(nevh_work *w, nevh__native *x) {
    nevh__series_code *code;
    *(void **)&code = dlsym(x->library, "nevh_native_series");
    nevh__taylor_use(w, code, x->numbers, &x->differs);
    return code;
}

/* A table for each vector of lanes. */
static bool native_take_numbers(nevh__native *x, nevh__writer *text) {
    x->together = nevh__orbits_together(text);
    size_t tables = text->by_lane ? text->width / x->together : 1;
    x->pitch = text->count;
    x->numbers = nevh__array(tables * x->pitch, sizeof *x->numbers);
    for (size_t i = 0; x->numbers && i < tables * x->pitch; i++)
        x->numbers[i] = text->numbers[i % x->pitch];
    x->own = text->own;
    x->own_count = text->own_count;
    text->own = NULL;
    return x->numbers;
}

void nevh__native_lane_take(nevh_work *w, size_t lane) {
    const nevh__native *x = w->native;
    for (size_t i = 0; x && i < x->own_count; i++) {
        const nevh__lane_numbers *own = &x->own[i];
        x->numbers[lane / x->together * x->pitch + own->first +
                   lane % x->together] = own->times * own->row[lane];
    }
}

static bool native_make_room(nevh__native *x, size_t size) {
    x->room = nevh__array(size + NEVH__LANES, sizeof *x->room);
    return x->room;
}

/* Seconds that a compiler may take: many times what a text takes on a machine with
   other work; who asks for compiled steps in any case waits longer. */
static double patience(const nevh_work *w, size_t characters) {
    static const double slower = 25, least = 4;
    double seconds = least + slower * a_character * (double)characters;
    return w->options->native == NEVH_NATIVE_ALWAYS ||
                   seconds > NEVH__LONGEST_COMPILATION
               ? NEVH__LONGEST_COMPILATION
               : seconds;
}

/* One orbit does not wait for a compiler: its steps are the kernel's until there are
   others, which give the same bits. */
static bool native_load(const nevh_work *w, nevh__native *x, const char *text,
                        bool compile, char why[NEVH__WHY_NATIVE]) {
    const char *cache = w->options->native_cache;
    double seconds = compile ? patience(w, x->characters) : 0;
    bool waits = w->options->native == NEVH_NATIVE_ALWAYS || w->width > 1 ||
                 of_series(w);
    x->library = nevh__native_load(text, cache, waits ? seconds : 0, why);
    if (!x->library && compile && !waits) {
        x->compiler = nevh__background_begin(text, cache, seconds, &x->steps);
        if (!x->compiler)
            x->library = nevh__native_load(text, cache, seconds, why);
    }
    return x->library || x->compiler;
}

/* Steps that watch nothing, where what is to be watched has no text. */
static bool write_watching(nevh__writer *text, nevh_work *w,
                           const nevh__watched *watched) {
    size_t i = family_of(w);
    bool can =
        i < FAMILIES && families[i].watches && w->width > 1 && !w->field->lanes;
    text->watched = can ? watched : NULL;
    if (text->watched && write_text(text, w) && !text->refusal)
        return true;
    nevh__writer_free(text);
    *text = (nevh__writer){0};
    return write_text(text, w);
}

static bool native_plan(nevh_work *w, nevh__native *x, nevh__writer *text,
                        const nevh__watched *watched,
                        char why[NEVH__WHY_NATIVE]) {
    bool always = w->options->native == NEVH_NATIVE_ALWAYS;
    bool written = write_watching(text, w, watched);
    if (text->refusal && always)
        snprintf(why, NEVH__WHY_NATIVE, "%s", text->refusal);
    if (!written || !native_fill(x, w))
        return false;
    x->watches = text->watched;
    x->characters = nevh__compiled_characters(text);
    bool compile = compiling_pays(w, x->characters);
    if (!native_load(w, x, text->text, compile, why)) {
        if (!compile)
            why[0] = '\0';
        return false;
    }
    if (!native_take_numbers(x, text))
        return false;
    if (text->rows && !native_make_room(x, text->rows * nevh__padded(w->n)))
        return false;
    return of_series(w) ? take_series(w, x) : native_take_steps(x);
}

void nevh__native_plan(nevh_work *w, const nevh__watched *watched,
                       char why[NEVH__WHY_NATIVE]) {
    const nevh_options *o = w->options;
    bool always = o->native == NEVH_NATIVE_ALWAYS;
    nevh__writer text = {0};
    why[0] = '\0';
    if (w->native || o->native == NEVH_NATIVE_NEVER)
        return;
    if (obstacle(w)) {
        if (always)
            snprintf(why, NEVH__WHY_NATIVE, "%s", obstacle(w));
        return;
    }
    if (!always && seconds_foreseen(w) < loading_pays)
        return;
    nevh__native *x = nevh__array(1, sizeof *x);
    if (x && native_plan(w, x, &text, watched, why)) {
        w->native = x;
        why[0] = '\0';
    } else
        nevh__native_free(x);
    nevh__writer_free(&text);
}

/* The text of what is to be compiled; NULL: nothing is. */
static char *text_to_build(nevh_work *w) {
    const char *cache = w->options->native_cache;
    nevh__writer text = {0};
    char *found = NULL;
    if ((cache && !*cache) || w->native ||
        w->options->native != NEVH_NATIVE_AUTO || obstacle(w))
        return NULL;
    if (write_text(&text, w) && compiling_pays(w, strlen(text.text))) {
        found = text.text;
        text.text = NULL;
    }
    nevh__writer_free(&text);
    return found;
}

static size_t place_in(char *const texts[], size_t count, const char *text) {
    size_t i = 0;
    while (i < count && strcmp(texts[i], text) != 0)
        i++;
    return i;
}

void nevh__native_prepare(nevh_work *const all[], size_t count,
                          char (*why)[NEVH__WHY_NATIVE]) {
    char **texts = nevh__array(count, sizeof *texts);
    size_t *of = nevh__array(count, sizeof *of), found = 0, done = 0;
    double seconds = 0;
    const char *cache = count ? all[0]->options->native_cache : NULL;
    char problem[NEVH__WHY_NATIVE] = "";
    for (size_t i = 0; texts && of && i < count; i++) {
        char *text = text_to_build(all[i]);
        of[i] = text ? place_in(texts, found, text) : SIZE_MAX;
        if (text)
            seconds = fmax(seconds, patience(all[i], strlen(text)));
        if (of[i] == found)
            texts[found++] = text;
        else
            free(text);
    }
    if (found > 1)
        done = nevh__native_build(texts, found, cache, seconds, problem);
    for (size_t i = 0; found > 1 && i < count; i++)
        if (of[i] != SIZE_MAX && of[i] >= done)
            snprintf(why[i], NEVH__WHY_NATIVE, "%s", problem);
    while (found > 0)
        free(texts[--found]);
    free(texts);
    free(of);
}
