/* nevh: members of a sweep whose systems differ in numbers alone, side by side.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/worker_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

bool nevh__lane_members_equip(nevh__lane_members *l, size_t n) {
    l->own = nevh__array(NEVH__CHUNK, sizeof *l->own);
    l->plan_at = nevh__array(2 * n, sizeof *l->plan_at);
    l->queue = nevh__array(NEVH__CHUNK, sizeof *l->queue);
    l->left = nevh__array(NEVH__CHUNK, sizeof *l->left);
    return l->own && l->plan_at && l->queue && l->left;
}

static void free_variants(nevh__lane_members *l) {
    for (size_t i = 0; l->own && i < NEVH__CHUNK; i++)
        nevh__variant_free(&l->own[i]);
}

void nevh__lane_members_free(nevh__lane_members *l) {
    free_variants(l);
    free(l->own);
    free(l->plan_at);
    free(l->queue);
    free(l->left);
    nevh_ensemble_free(l->ensemble);
    nevh__lane_form_free(&l->form);
}

/* The next of the queue that has a start; others are told of, or left. */
static bool worker_lanes_next(void *data, uint64_t *member, double q[],
                              double p[]) {
    nevh__worker *w = data;
    nevh_sweep *s = w->sweep;
    while (!s->ending && w->lanes.queue_at < w->lanes.n_queue) {
        size_t at = w->lanes.queue[w->lanes.queue_at++], i = w->order[at];
        double *varied = w->varied + i * s->ensemble->n_varied;
        nevh__report report = {0};
        nevh__variant_free(&w->lanes.own[i]);
        if (!nevh__sweep_variant(s, varied, &w->lanes.own[i], &report) ||
            !nevh__lane_form_fits(s, &w->lanes.form, &w->lanes.own[i])) {
            w->lanes.left[w->lanes.n_left++] = at;
            continue;
        }
        *member = at;
        if (!nevh__variant_start(s, &w->lanes.own[i], varied, q, p, w->v,
                                 &report))
            return true;
        nevh__worker_finish(w, w->list[i], varied, NEVH_MEMBER_NO_START,
                            report.text, NULL);
    }
    return false;
}

static const nevh__own *own_of(void *data, uint64_t member) {
    nevh__worker *w = data;
    nevh__lane_members *l = &w->lanes;
    const nevh__variant *x = &l->own[w->order[member]];
    nevh__variant_options(w->sweep, x, &l->options, l->plan_at);
    l->options.native = NEVH_NATIVE_NEVER; /* it steps where others fail */
    l->parts = (nevh__own){x->model->system, &l->options,
                           (const double *const *)l->form.of_field};
    return &l->parts;
}

static void worker_lanes_leave(void *data, uint64_t member) {
    nevh__worker *w = data;
    w->lanes.left[w->lanes.n_left++] = (size_t)member;
}

static int worker_lanes_done(void *data, const nevh_member_result *r) {
    nevh__worker *w = data;
    size_t i = w->order[r->member];
    nevh__worker_finish(w, w->list[i],
                        w->varied + i * w->sweep->ensemble->n_varied,
                        r->status ? NEVH_MEMBER_FAILED : NEVH_MEMBER_DONE,
                        r->message, r->values);
    nevh__variant_free(&w->lanes.own[i]);
    w->lanes.n_done++;
    return w->sweep->stopped;
}

/* A member's variant, by number of the sweep. */
static bool make_member(nevh__worker *w, uint64_t member, nevh__variant *x) {
    const nevh__scene_ensemble *e = w->sweep->ensemble;
    nevh__report ignored = {0};
    for (size_t i = 0; i < e->n_varied; i++)
        w->room[i] = nevh__varied_value(e, &e->varied[i], member);
    return nevh__sweep_variant(w->sweep, w->room, x, &ignored);
}

/* Looks at some members here and there, so that most numbers that differ are
   seen: in some a number is special, as 2^k. */
static bool make_form(nevh__worker *w) {
    enum { LOOKS = 12 };
    static const double golden = 0.6180339887498949;
    nevh_sweep *s = w->sweep;
    uint64_t count = nevh_sweep_members(s);
    nevh__variant x = {0};
    bool made = make_member(w, count / 2, &x) &&
                nevh__lane_form_begin(&w->lanes.form, &x);
    nevh__variant_free(&x);
    for (int i = 1; made && i <= LOOKS; i++) {
        double part = i * golden - floor(i * golden);
        if (make_member(w, (uint64_t)(part * (double)count), &x))
            nevh__lane_form_see(s, &w->lanes.form, &x);
        nevh__variant_free(&x);
    }
    return made && nevh__lane_form_finish(&w->lanes.form);
}

void nevh__lane_members_open(nevh__worker *w) {
    nevh_options o;
    nevh_ensemble *e = NULL;
    if (nevh_sweep_members(w->sweep) >= NEVH__LANES && make_form(w)) {
        nevh_ensemble_options is = nevh__variant_options(
            w->sweep, &w->lanes.form.base, &o, w->lanes.plan_at);
        e = nevh_ensemble_new(w->lanes.form.system, &is);
    }
    nevh__ensemble_set_stop(e, &w->sweep->ending);
    if (nevh__ensemble_vary(e, own_of, worker_lanes_leave))
        w->lanes.ensemble = e;
    else
        nevh_ensemble_free(e);
}

bool nevh__lane_members_pay(const nevh__worker *w) {
    bool compiled = nevh_ensemble_native(w->lanes.ensemble, NULL);
    return w->lanes.ensemble &&
           (compiled || w->sweep->is.native != NEVH_NATIVE_ALWAYS) &&
           w->group_end - w->at < NEVH__LANES;
}

void nevh__lane_members_add(nevh__worker *w) {
    for (; w->at < w->group_end; w->at++)
        w->lanes.queue[w->lanes.n_queue++] = w->at;
}

size_t nevh__lane_members_run(nevh__worker *w) {
    nevh__lane_members *l = &w->lanes;
    size_t queued = l->n_queue;
    l->queue_at = l->n_left = l->n_queue = 0;
    if (queued < NEVH__LANES) {
        memcpy(l->left, l->queue, queued * sizeof *l->left);
        return queued;
    }
    l->n_queue = queued;
    l->n_done = 0;
    nevh_ensemble_run(l->ensemble, worker_lanes_next, worker_lanes_done, w);
    pthread_mutex_lock(&w->sweep->lock);
    w->sweep->by_lane += l->n_done;
    pthread_mutex_unlock(&w->sweep->lock);
    free_variants(l);
    l->n_queue = 0;
    return l->n_left;
}
