/* nevh: scenes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _POSIX_C_SOURCE 200809L
#include "scene/scene_ensemble_private.h"
#include <fenv.h>
#include <nevh/sweep.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifndef __wasm__
#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

enum { MOST_BYTES = 1 << 24 };

void nevh__model_free(nevh__scene_model *m) {
    if (!m)
        return;
    nevh_system_free(m->system);
    nevh_system_free(m->transform);
    nevh__owned_free(&m->owned);
    nevh__owned_free(&m->owned_transform);
    nevh__owned_free(&m->owned_shown);
    free(m->velocities);
    free(m->velocity_buffer);
    nevh__names_free(m->names);
    nevh__pool_free(&m->pool);
    free(m);
}

typedef enum { DOUBLES, EXACT, AWAY } digits_kind;

static bool make_exact(nevh__scene_model *m, bool away) {
    m->exact = nevh__pool_take(&m->pool, 1, sizeof *m->exact);
    if (!m->exact)
        return false;
    m->exact->away = away;
    (away ? nevh__names_away : nevh__names_exact)(m->names);
    return true;
}

static bool fill_model(nevh_scene *s, nevh__scene_model *m,
                       digits_kind digits) {
    if (digits && !make_exact(m, digits == AWAY)) {
        nevh__scene_no_memory(s);
        return false;
    }
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    bool made = nevh__model_parameters(s, m) && nevh__model_coordinates(s, m) &&
                nevh__model_definitions(s, m) && nevh__model_values(s, m) &&
                nevh__model_terms(s, m) && nevh__model_shown(s, m) &&
                nevh__model_labels(s, m) && nevh__model_integrators(s, m) &&
                nevh__model_run(s, m) && nevh__model_ensemble(s, m);
    fesetenv(&own);
    return made;
}

static nevh__scene_model *new_model(nevh_scene *s, digits_kind digits) {
    nevh__scene_model *m = nevh__array(1, sizeof *m);
    if (!m || !(m->names = nevh__names_new())) {
        free(m);
        nevh__scene_no_memory(s);
        return NULL;
    }
    if (fill_model(s, m, digits))
        return m;
    nevh__model_free(m);
    return NULL;
}

static nevh__scene_model *model_once(nevh_scene *s, nevh__scene_model **made,
                                     digits_kind digits) {
    if (!nevh__scene_begin(s))
        return NULL;
    if (!*made)
        *made = new_model(s, digits);
    return *made;
}

nevh__scene_model *nevh__scene_exact(nevh_scene *s) {
    return model_once(s, &s->exact, EXACT);
}

nevh__scene_model *nevh__scene_away(nevh_scene *s) {
    return model_once(s, &s->away, AWAY);
}

/* The other models are for what was before a change. */
static void forget_exact(nevh_scene *s) {
    nevh__model_free(s->exact);
    nevh__model_free(s->away);
    s->exact = s->away = NULL;
}

/* After a change of the scene. */
static void take_model(nevh_scene *s, nevh__scene_model *model) {
    forget_exact(s);
    nevh__model_free(s->model);
    s->model = model;
}

nevh__scene_model *nevh__model_with(nevh_scene *s,
                                    const struct nevh__overrides *overrides) {
    s->overrides = overrides;
    nevh__scene_model *m = new_model(s, DOUBLES);
    s->overrides = NULL;
    return m;
}

static nevh_scene *new_scene(const char *name) {
    nevh_scene *s = nevh__array(1, sizeof *s);
    name = name ? name : "scene";
    if (s && (s->name = nevh__pool_keep(&s->pool, nevh__text("%s", name))))
        return s;
    free(s);
    return NULL;
}

static void scene_begin(nevh_scene *s, const nevh_scene_options *options,
                        const char *text, size_t bytes) {
    s->allow_code = options->allow_code;
    if (nevh__scene_cut(s, text, bytes) && nevh__scene_effects(s) &&
        nevh__scene_switch(s, options))
        s->model = new_model(s, DOUBLES);
}

static void scene_refuse(nevh_scene *s, int status, const char *why) {
    s->status = status;
    snprintf(s->message, sizeof s->message, "%.1000s: error: %s", s->name, why);
}

static void unreadable(nevh_scene *s, const char *why) {
    scene_refuse(s, NEVH_EFAILED, why);
}

nevh_scene *nevh_scene_parse(const char *name, const char *text) {
    nevh_scene *s = new_scene(name);
    if (s && text)
        scene_begin(s, &(nevh_scene_options){0}, text, strlen(text));
    else if (s)
        scene_refuse(s, NEVH_EINVAL, "the text is NULL");
    return s;
}

/* All of a file, freed by the caller; NULL when it is not to be read. */
static char *read_all(nevh_scene *s, FILE *file, size_t *bytes) {
    size_t capacity = 1 << 12;
    char *text = malloc(capacity);
    *bytes = 0;
    while (text && !s->status) {
        *bytes += fread(text + *bytes, 1, capacity - *bytes, file);
        if (ferror(file))
            unreadable(s, strerror(errno));
        else if (*bytes < capacity)
            return text;
        else if (capacity >= MOST_BYTES)
            unreadable(s, "the file is too large for a scene");
        char *grown = nevh__grow(text, capacity *= 2, 1);
        if (!grown)
            nevh__scene_no_memory(s);
        text = grown ? grown : text;
    }
    if (!text)
        nevh__scene_no_memory(s);
    free(text);
    return NULL;
}

#ifdef __wasm__
static FILE *open_file(const char *path) {
    return fopen(path, "rbe");
}
#else
/* Pipes are not waited for without end. */
static bool has_begun(int file) {
    enum { LONGEST = 10000 }; /* milliseconds */
    struct pollfd one = {.fd = file, .events = POLLIN};
    struct stat found;
    bool pipe = fstat(file, &found) == 0 && S_ISFIFO(found.st_mode);
    int ready = 1;
    do
        ready = pipe ? poll(&one, 1, LONGEST) : 1;
    while (ready < 0 && errno == EINTR);
    bool begun = ready > 0;
    errno = begun ? 0 : ETIMEDOUT;
    return begun && fcntl(file, F_SETFL, O_RDONLY) == 0;
}

static FILE *open_file(const char *path) {
    int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    FILE *opened = file >= 0 && has_begun(file) ? fdopen(file, "rb") : NULL;
    int why = errno;
    if (file >= 0 && !opened)
        close(file);
    errno = why;
    return opened;
}
#endif

nevh_scene *nevh_scene_read(const char *path) {
    return nevh_scene_read_with(path, NULL);
}

nevh_scene *nevh_scene_read_with(const char *path,
                                 const nevh_scene_options *options) {
    nevh_scene *s = new_scene(path);
    FILE *file = s && path ? open_file(path) : NULL;
    if (!file) {
        if (s && path)
            unreadable(s, errno == ETIMEDOUT
                              ? "nothing was written to this pipe for 10 s"
                              : strerror(errno));
        else if (s)
            scene_refuse(s, NEVH_EINVAL, "the path is NULL");
        return s;
    }
    size_t bytes;
    char *text = read_all(s, file, &bytes);
    fclose(file);
    if (text)
        scene_begin(s, options ? options : &(nevh_scene_options){0}, text,
                    bytes);
    free(text);
    return s;
}

void nevh_scene_free(nevh_scene *s) {
    if (!s)
        return;
    forget_exact(s);
    nevh__model_free(s->model);
    nevh__scene_unload_code(s);
    nevh__scene_forget_integrators(s);
    for (size_t i = 0; i < s->n_statements; i++)
        nevh__head_free(&s->statements[i].head);
    for (size_t i = 0; i < s->n_assignments; i++)
        nevh__head_free(&s->assignments[i]->head);
    for (size_t i = 0; i < s->n_starts; i++)
        nevh__head_free(&s->starts[i]->head);
    for (size_t i = 0; i < s->n_varies; i++)
        nevh__head_free(&s->varies[i]->head);
    nevh__pool_free(&s->pool);
    free(s->assignments);
    free(s->effect_names.entries);
    free(s->starts);
    free(s->varies);
    free(s);
}

int nevh_scene_status(const nevh_scene *s) {
    return s ? s->status : NEVH_ENOMEM;
}

const char *nevh_scene_message(const nevh_scene *s) {
    return s ? s->message : "out of memory";
}

/* A scene that was read starts each change afresh. */
bool nevh__scene_begin(nevh_scene *s) {
    if (!s || !s->model)
        return false;
    s->status = NEVH_OK;
    s->message[0] = '\0';
    return true;
}

int nevh__scene_fault(const nevh_scene *s) {
    return s ? s->status : NEVH_EINVAL;
}

/* NAME = FORMULA as a statement of its own, for which there is room in a list
   then; NULL on failure. */
static nevh__statement *new_assignment(nevh_scene *s, const char *text,
                                       nevh__statement ***list, size_t count) {
    size_t bytes = strlen(text);
    nevh__statement *statement =
        nevh__pool_take(&s->pool, 1, sizeof *statement);
    nevh__line *line = nevh__pool_take(&s->pool, 1, sizeof *line);
    char *copy = nevh__pool_take(&s->pool, bytes + 1, 1);
    nevh__statement **all = nevh__grow(*list, count + 1, sizeof *all);
    *list = all ? all : *list;
    if (!statement || !line || !copy || !all) {
        nevh__scene_no_memory(s);
        return NULL;
    }
    *line = (nevh__line){0, strcpy(copy, text), bytes};
    if (strpbrk(text, "\r\n")) {
        nevh__scene_fail_at(s, NEVH_EINVAL, line, 1, 1,
                            "an assignment is one line");
        return NULL;
    }
    return nevh__statement_parse(s, line, statement) ? statement : NULL;
}

static bool check_assignment(nevh_scene *s, const nevh__statement *statement) {
    size_t count = 0;
    const char **known =
        nevh__pool_take(&s->pool, s->n_statements, sizeof *known);
    if (!known)
        return nevh__scene_no_memory(s);
    if (!nevh__head_plain(s, statement))
        return false;
    for (size_t i = 0; i < s->n_statements; i++)
        if (s->statements[i].section == NEVH__PARAMETERS)
            known[count++] = s->statements[i].head.name;
    for (size_t i = 0; i < count; i++)
        if (strcmp(known[i], statement->head.name) == 0)
            return true;
    return nevh__scene_fail_word(s, &statement->key, "parameter",
                                 statement->head.name, known, count);
}

/* Takes the model anew, with what was put last on a list, or without it. */
static int keep_if_fine(nevh_scene *s, nevh__statement *statement, bool fine,
                        size_t *count) {
    nevh__scene_model *model = fine ? new_model(s, DOUBLES) : NULL;
    if (!model) {
        --*count;
        nevh__head_free(&statement->head);
        return s->status;
    }
    take_model(s, model);
    return NEVH_OK;
}

static int add_assignment(nevh_scene *s, const char *text,
                          nevh__statement ***list, size_t *count,
                          bool is_parameter) {
    nevh__statement *statement = new_assignment(s, text, list, *count);
    if (!statement)
        return s->status;
    (*list)[(*count)++] = statement;
    return keep_if_fine(s, statement,
                        !is_parameter || check_assignment(s, statement), count);
}

int nevh_scene_set(nevh_scene *s, const char *assignment) {
    return nevh__scene_begin(s) ? add_assignment(s, assignment, &s->assignments,
                                                 &s->n_assignments, true)
                                : nevh__scene_fault(s);
}

int nevh_scene_set_start(nevh_scene *s, const char *assignment) {
    return nevh__scene_begin(s)
               ? add_assignment(s, assignment, &s->starts, &s->n_starts, false)
               : nevh__scene_fault(s);
}

int nevh_scene_vary(nevh_scene *s, const char *const lines[], size_t count) {
    if (!nevh__scene_begin(s))
        return nevh__scene_fault(s);
    size_t before = s->n_varies;
    for (size_t i = 0; !s->status && i < count; i++) {
        nevh__statement *statement =
            new_assignment(s, lines[i], &s->varies, s->n_varies);
        if (statement)
            s->varies[s->n_varies++] = statement;
    }
    nevh__scene_model *model = s->status ? NULL : new_model(s, DOUBLES);
    if (!model) {
        while (s->n_varies > before)
            nevh__head_free(&s->varies[--s->n_varies]->head);
        return s->status;
    }
    take_model(s, model);
    return NEVH_OK;
}

static nevh__piece *new_piece(nevh_scene *s, const char *text) {
    size_t bytes = strlen(text);
    nevh__line *line = nevh__pool_take(&s->pool, 1, sizeof *line);
    nevh__piece *piece = nevh__pool_take(&s->pool, 1, sizeof *piece);
    char *copy = nevh__pool_take(&s->pool, bytes + 1, 1);
    if (!line || !piece || !copy) {
        nevh__scene_no_memory(s);
        return NULL;
    }
    *line = (nevh__line){0, strcpy(copy, text), bytes};
    return nevh__piece_take(s, &s->pool, line, 0, bytes, piece) ? piece : NULL;
}

int nevh_scene_number(nevh_scene *s, const char *formula, double *number) {
    if (!nevh__scene_begin(s))
        return nevh__scene_fault(s);
    nevh__piece *piece = new_piece(s, formula);
    return piece && nevh__piece_number(s, s->model, piece, number) ? NEVH_OK
                                                                   : s->status;
}

/* Takes the model anew with another text, or keeps both as they are. */
static int set_piece(nevh_scene *s, const nevh__piece **of, const char *text) {
    const nevh__piece *before = *of;
    nevh__piece *piece = new_piece(s, text);
    if (!piece)
        return s->status;
    *of = piece;
    nevh__scene_model *model = new_model(s, DOUBLES);
    if (model)
        take_model(s, model);
    else
        *of = before;
    return model ? NEVH_OK : s->status;
}

int nevh_scene_set_transform(nevh_scene *s, const char *formula) {
    return nevh__scene_begin(s) ? set_piece(s, &s->transform, formula)
                                : nevh__scene_fault(s);
}

int nevh_scene_set_outcomes(nevh_scene *s, const char *outcomes) {
    return nevh__scene_begin(s) ? set_piece(s, &s->outcomes, outcomes)
                                : nevh__scene_fault(s);
}

int nevh_scene_set_judged(nevh_scene *s, const char *formula) {
    if (!s)
        return NEVH_EINVAL;
    nevh__formula judged;
    if (!nevh__scene_begin(s))
        return s->status;
    const nevh__piece *piece = new_piece(s, formula);
    if (!piece || !nevh__formula_check(s, s->model, piece, &judged))
        return s->status;
    s->judged = piece;
    s->model->judged = judged;
    return NEVH_OK;
}

int nevh_scene_enable(nevh_scene *s, const char *effect, bool on) {
    if (!nevh__scene_begin(s))
        return nevh__scene_fault(s);
    nevh__switch *found = nevh__scene_find_effect(s, effect);
    if (!found || (on && !nevh__scene_load_code(s, effect)))
        return s->status;
    forget_exact(s);
    found->on = on;
    s->switched = true;
    return nevh_system_enable(s->model->system, effect, on);
}
