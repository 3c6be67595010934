/* nevh: a sweep is run, by several threads.

   Members are given out in chunks, in order.  Where no parameter is varied a
   thread has one ensemble, whose lanes take chunk after chunk; else it takes
   the members of a chunk that share their parameters together, or, where these
   are few, members whose formulas differ in numbers alone.  Those whose
   parameters change nothing but where they start are run by one ensemble, that of
   the scene as it is; so is a member, whichever others there are.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/worker_private.h"
#include <fenv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void nevh__worker_finish(nevh__worker *w, uint64_t member,
                         const double varied[], nevh_member_status status,
                         const char *message, const double outcomes[]) {
    nevh_sweep *s = w->sweep;
    size_t n = s->ensemble->n_varied;
    memcpy(w->values, varied, n * sizeof *varied);
    for (size_t k = n; k < s->columns; k++)
        w->values[k] = outcomes ? outcomes[k - n] : NAN;
    nevh__sweep_hand_on(s, member, status, message, w->values);
}

/* Chunks. */

/* From who shares the members out. */
static void ask_for_chunk(nevh_sweep *s) {
    uint64_t first = 0, count = 0, members = nevh_sweep_members(s);
    if (!s->chunks(s->chunks_data, &first, &count)) {
        s->chunks = NULL;
        return;
    }
    s->next = first < members ? first : members;
    s->end = count < members - s->next ? s->next + count : members;
}

static bool goes_on(const nevh_sweep *s) {
    return !s->stopped && !s->ending;
}

/* The end of the next chunk; where it begins, if none is to be taken now. */
static uint64_t chunk_end(const nevh_sweep *s) {
    if (!nevh__sweep_window_has_room(s) || !goes_on(s))
        return s->next;
    return s->end - s->next < NEVH__CHUNK ? s->end : s->next + NEVH__CHUNK;
}

/* Takes the next one; waits for room where it may. */
static bool take_chunk(nevh__worker *w, bool may_wait) {
    nevh_sweep *s = w->sweep;
    pthread_mutex_lock(&s->lock);
    while (may_wait && !nevh__sweep_window_has_room(s) && goes_on(s) &&
           s->next < s->end)
        pthread_cond_wait(&s->moved, &s->lock);
    if (s->chunks && s->next == s->end && goes_on(s))
        ask_for_chunk(s);
    uint64_t from = s->next, to = chunk_end(s);
    s->next = to;
    pthread_mutex_unlock(&s->lock);
    w->at = w->count = 0;
    for (uint64_t i = from; i < to; i++)
        if (!s->wanted || s->wanted(s->data, i))
            w->list[w->count++] = i;
        else if (s->waiting)
            nevh__sweep_hand_on(s, i, NEVH_MEMBER_MISSING, "", NULL);
    w->group_end = w->count;
    return to > from;
}

/* The values of what is varied of a member, by its number. */
static double *varied_values(nevh__worker *w, uint64_t member,
                             double varied[]) {
    const nevh__scene_ensemble *e = w->sweep->ensemble;
    for (size_t i = 0; i < e->n_varied; i++)
        varied[i] = nevh__varied_value(e, &e->varied[i], member);
    return varied;
}

/* The next member of the group that has a start. */
static bool next(void *data, uint64_t *member, double q[], double p[]) {
    nevh__worker *w = data;
    nevh_sweep *s = w->sweep;
    for (;;) {
        if (s->ending)
            return false;
        while (w->at == w->group_end)
            if (s->ensemble->parameters || !take_chunk(w, false))
                return false;
        nevh__report report = {0};
        *member = w->list[w->order ? w->order[w->at] : w->at];
        w->at++;
        double *varied = varied_values(w, *member, w->room);
        if (!nevh__variant_start(s, &w->variant, varied, q, p, w->v, &report))
            return true;
        nevh__worker_finish(w, *member, varied, NEVH_MEMBER_NO_START,
                            report.text, NULL);
    }
}

static int done(void *data, const nevh_member_result *r) {
    nevh__worker *w = data;
    double *varied = varied_values(w, r->member, w->room);
    nevh__report ignored = {0};
    if (w->sweep->ensemble->solves) /* once more, for the solution */
        nevh__variant_start(w->sweep, &w->variant, varied, w->q, w->p, w->v,
                            &ignored);
    nevh__worker_finish(w, r->member, varied,
                        r->status ? NEVH_MEMBER_FAILED : NEVH_MEMBER_DONE,
                        r->message, r->values);
    return w->sweep->stopped;
}

/* Ensembles. */

static void out_of_memory(nevh_sweep *s) {
    pthread_mutex_lock(&s->lock);
    s->failed = s->stopped = true;
    pthread_cond_broadcast(&s->moved);
    pthread_mutex_unlock(&s->lock);
}

bool nevh__sweep_variant(nevh_sweep *s, const double varied[], nevh__variant *x,
                         nevh__report *report) {
    pthread_mutex_lock(&s->lock); /* the scene is one */
    bool made = nevh__variant_make(s, varied, x, report);
    pthread_mutex_unlock(&s->lock);
    return made;
}

/* An ensemble of so many members of a variant; NULL after a message. */
static nevh_ensemble *open(nevh_sweep *s, const nevh__variant *x,
                           size_t members, nevh__report *report) {
    nevh_options o;
    double *room = nevh__array(2 * x->model->n, sizeof *room);
    nevh_ensemble *e = NULL;
    if (room) {
        nevh_ensemble_options is = nevh__variant_options(s, x, &o, room);
        if (!is.width && members < NEVH__LANES)
            is.width = 1;
        e = nevh_ensemble_new(x->model->system, &is);
    }
    nevh__ensemble_set_stop(e, &s->ending);
    free(room);
    if (!e || nevh_ensemble_status(e))
        nevh__fail(report, nevh_ensemble_status(e), "%s",
                   nevh_ensemble_message(e));
    if (!report->status)
        return e;
    nevh_ensemble_free(e);
    return NULL;
}

/* Members of the group, whose ensemble could not be made. */
static void refuse_group(nevh__worker *w, const nevh__report *report) {
    if (report->status == NEVH_ENOMEM) {
        out_of_memory(w->sweep);
        return;
    }
    for (; w->at < w->group_end; w->at++) {
        uint64_t member = w->list[w->order ? w->order[w->at] : w->at];
        nevh__worker_finish(w, member, varied_values(w, member, w->room),
                            NEVH_MEMBER_FAILED, report->text, NULL);
    }
}

/* Members of the group, which only start elsewhere. */
static void share(nevh__worker *w) {
    nevh_sweep *s = w->sweep;
    size_t n = s->scene->model->n, n_varied = s->ensemble->n_varied;
    for (; w->at < w->group_end; w->at++) {
        size_t at = w->order[w->at];
        double *q = w->starts + at * 2 * n, *varied = w->varied + at * n_varied;
        nevh__report report = {0};
        if (nevh__variant_start(s, &w->variant, varied, q, q + n, w->v,
                                &report))
            nevh__worker_finish(w, w->list[at], varied, NEVH_MEMBER_NO_START,
                                report.text, NULL);
        else
            w->sharing[w->n_sharing++] = at;
    }
}

static bool next_sharing(void *data, uint64_t *member, double q[], double p[]) {
    nevh__worker *w = data;
    size_t n = w->sweep->scene->model->n;
    if (w->sweep->ending || w->shared_at == w->n_sharing)
        return false;
    size_t at = w->sharing[w->shared_at++];
    *member = at;
    memcpy(q, w->starts + at * 2 * n, n * sizeof *q);
    memcpy(p, w->starts + at * 2 * n + n, n * sizeof *p);
    return true;
}

static int done_sharing(void *data, const nevh_member_result *r) {
    nevh__worker *w = data;
    nevh__worker_finish(w, w->list[r->member],
                        w->varied + r->member * w->sweep->ensemble->n_varied,
                        r->status ? NEVH_MEMBER_FAILED : NEVH_MEMBER_DONE,
                        r->message, r->values);
    return w->sweep->stopped;
}

static void run_sharing(nevh__worker *w) {
    nevh__report report = {0};
    w->shared_at = 0;
    if (w->n_sharing && !w->shared)
        w->shared = open(w->sweep, &w->scene, SIZE_MAX, &report);
    if (w->shared)
        nevh_ensemble_run(w->shared, next_sharing, done_sharing, w);
    else if (w->n_sharing)
        out_of_memory(w->sweep); /* cannot fail for another reason */
    w->n_sharing = 0;
}

/* The group by an ensemble of its own; the whole sweep where no parameter is
   varied. */
static void run_own(nevh__worker *w) {
    nevh_sweep *s = w->sweep;
    nevh__report report = {0};
    bool parameters = s->ensemble->parameters;
    nevh_ensemble *e = open(
        s, &w->variant, parameters ? w->group_end - w->at : SIZE_MAX, &report);
    if (!e) {
        refuse_group(w, &report);
        return;
    }
    do
        nevh_ensemble_run(e, next, done, w);
    while (!parameters && goes_on(s) && take_chunk(w, true));
    nevh_ensemble_free(e);
}

static void run_group(nevh__worker *w, const double varied[], bool apart) {
    nevh_sweep *s = w->sweep;
    nevh__report report = {0};
    bool parameters = s->ensemble->parameters;
    if (!nevh__sweep_variant(s, varied, &w->variant, &report))
        refuse_group(w, &report);
    else if (parameters && w->scene.model &&
             nevh__variants_alike(s, &w->scene, &w->variant))
        share(w);
    else if (parameters && !apart && nevh__lane_members_pay(w))
        nevh__lane_members_add(w); /* with others */
    else
        run_own(w);
    nevh__variant_free(&w->variant);
}

/* 0 if two members of the list have the same parameters; less than 0 if those of
   a are smaller. */
static int compare(const nevh__worker *w, size_t a, size_t b) {
    const nevh__scene_ensemble *e = w->sweep->ensemble;
    for (size_t i = 0; i < e->n_varied; i++) {
        double x = w->varied[a * e->n_varied + i];
        double y = w->varied[b * e->n_varied + i];
        if (e->varied[i].is == NEVH__PARAMETER && x != y)
            return x < y ? -1 : 1;
    }
    return 0;
}

/* Insertion sort, which is stable: chunks are short, and mostly in order. */
static void sort(nevh__worker *w) {
    for (size_t i = 0; i < w->count; i++) {
        size_t k = i;
        for (; k > 0 && compare(w, i, w->order[k - 1]) < 0; k--)
            w->order[k] = w->order[k - 1];
        w->order[k] = i;
    }
}

/* Members that are left, each apart. */
static void run_left(nevh__worker *w, const size_t left[], size_t count) {
    for (size_t i = 0; i < count && goes_on(w->sweep); i++) {
        w->at = left[i];
        w->group_end = w->at + 1;
        run_group(w, w->varied + w->order[w->at] * w->sweep->ensemble->n_varied,
                  true);
    }
}

static void run_chunk_by_groups(nevh__worker *w) {
    for (size_t i = 0; i < w->count; i++)
        varied_values(w, w->list[i],
                      w->varied + i * w->sweep->ensemble->n_varied);
    sort(w);
    while (w->at < w->count && goes_on(w->sweep)) {
        size_t first = w->order[w->at];
        w->group_end = w->at + 1;
        while (w->group_end < w->count &&
               compare(w, first, w->order[w->group_end]) == 0)
            w->group_end++;
        run_group(w, w->varied + first * w->sweep->ensemble->n_varied, false);
    }
    run_sharing(w);
    size_t left = nevh__lane_members_run(w);
    run_left(w, w->lanes.left, left);
}

static void *work(void *data) {
    nevh__worker *w = data;
    nevh_sweep *s = w->sweep;
    nevh__report report = {0};
    if (s->ensemble->parameters) {
        nevh__sweep_variant(s, NULL, &w->scene, &report);
        nevh__lane_members_open(w);
    }
    if (report.status == NEVH_ENOMEM)
        out_of_memory(s);
    else if (s->ensemble->parameters)
        while (take_chunk(w, true))
            run_chunk_by_groups(w);
    else if (take_chunk(w, true))
        run_group(w, w->varied, false);
    return NULL;
}

static bool equip(nevh__worker *w, nevh_sweep *s) {
    size_t n = s->scene->model->n, varied = s->ensemble->n_varied;
    *w = (nevh__worker){.sweep = s};
    w->list = nevh__array(NEVH__CHUNK, sizeof *w->list);
    w->values = nevh__array(s->columns, sizeof *w->values);
    w->varied = nevh__array(NEVH__CHUNK * varied, sizeof *w->varied);
    w->q = nevh__array(n, sizeof *w->q);
    w->p = nevh__array(n, sizeof *w->p);
    w->v = nevh__array(n, sizeof *w->v);
    w->room = nevh__array(varied, sizeof *w->room);
    bool orders = s->ensemble->parameters;
    if (orders) {
        w->order = nevh__array(NEVH__CHUNK, sizeof *w->order);
        w->sharing = nevh__array(NEVH__CHUNK, sizeof *w->sharing);
        w->starts = nevh__array(NEVH__CHUNK * 2 * n, sizeof *w->starts);
    }
    return w->list && w->values && w->varied && w->q && w->p && w->v &&
           w->room &&
           (!orders || (w->order && w->sharing && w->starts &&
                        nevh__lane_members_equip(&w->lanes, n)));
}

static void dismiss(nevh__worker *w) {
    free(w->list);
    free(w->values);
    free(w->varied);
    free(w->q);
    free(w->p);
    free(w->v);
    free(w->room);
    free(w->order);
    free(w->sharing);
    free(w->starts);
    nevh__lane_members_free(&w->lanes);
    nevh_ensemble_free(w->shared);
    nevh__variant_free(&w->scene);
}

void nevh_sweep_stop(nevh_sweep *s) {
    if (s)
        s->ending = 1;
}

static int run(nevh_sweep *s, nevh_wanted_fn wanted, nevh_sweep_fn tell_fn,
               void *data) {
    s->wanted = wanted;
    s->tell = tell_fn;
    s->data = data;
    s->stopped = s->failed = false;
    s->by_lane = 0;
    size_t threads = s->is.threads;
    nevh__worker *all = nevh__array(threads, sizeof *all);
    bool ready = all && nevh__sweep_window_open(s);
    for (size_t i = 0; ready && i < threads; i++)
        ready = equip(&all[i], s);
    fenv_t own; /* as in nevh_stepper_new; threads inherit it */
    feholdexcept(&own);
    for (size_t i = 1; ready && i < threads; i++)
        all[i].started = !pthread_create(&all[i].thread, NULL, work, &all[i]);
    if (ready)
        work(&all[0]);
    for (size_t i = 0; all && i < threads; i++) {
        if (all[i].started)
            pthread_join(all[i].thread, NULL);
        dismiss(&all[i]);
    }
    fesetenv(&own);
    free(all);
    nevh__sweep_window_close(s);
    if (!ready || s->failed)
        return nevh__no_memory(&s->report);
    bool ended = s->ending;
    s->ending = 0;
    return s->stopped || ended
               ? nevh__fail(&s->report, NEVH_STOPPED, "the sweep was to stop")
               : NEVH_OK;
}

/* Returns the status of a sweep that could not be planned. */
static int begin(nevh_sweep *s) {
    if (s->report.status && s->report.status != NEVH_STOPPED)
        return s->report.status;
    s->report = (nevh__report){0};
    return NEVH_OK;
}

int nevh_sweep_run(nevh_sweep *s, uint64_t first, uint64_t count,
                   nevh_wanted_fn wanted, nevh_sweep_fn tell_fn, void *data) {
    int status = s ? begin(s) : NEVH_EINVAL;
    if (status)
        return status;
    uint64_t members = nevh_sweep_members(s);
    s->first = s->next = s->low = first < members ? first : members;
    s->end = count < members - s->first ? s->first + count : members;
    s->chunks = NULL;
    return run(s, wanted, tell_fn, data);
}

int nevh_sweep_run_chunks(nevh_sweep *s, nevh_chunk_fn chunks,
                          void *chunks_data, nevh_wanted_fn wanted,
                          nevh_sweep_fn tell_fn, void *data) {
    int status = s ? begin(s) : NEVH_EINVAL;
    if (status)
        return status;
    if (s->is.ordered || !chunks)
        return NEVH_EINVAL;
    s->first = s->next = s->low = s->end = 0;
    s->chunks = chunks;
    s->chunks_data = chunks_data;
    return run(s, wanted, tell_fn, data);
}
