/* nevh: what a scene shows, draws, monitors and stops at.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <math.h>

/* An invariant that an effect breaks is not there while that is on. */
static bool is_there(const nevh_scene *s, const nevh__item *item) {
    for (size_t i = 0; i < item->n_without; i++)
        if (nevh__scene_effect(s, item->without[i].text)->on)
            return false;
    return true;
}

/* The i-th that is there; NULL beyond the last.
   count    out: how many there are before it */
static nevh__item *item_at(const nevh_scene *s, nevh_shown which, size_t i,
                           size_t *count) {
    *count = 0;
    for (size_t k = 0; s->model && k < s->model->shown[which].count; k++) {
        nevh__item *item = &s->model->shown[which].items[k];
        if (!is_there(s, item))
            continue;
        if (*count == i)
            return item;
        ++*count;
    }
    return NULL;
}

size_t nevh_scene_shown_count(const nevh_scene *s, nevh_shown which) {
    if (!s)
        return 0;
    size_t count;
    item_at(s, which, SIZE_MAX, &count);
    return count;
}

const char *nevh_scene_shown_name(const nevh_scene *s, nevh_shown which,
                                  size_t i) {
    if (!s)
        return "";
    size_t before;
    const nevh__item *item = item_at(s, which, i, &before);
    return item ? item->name : NULL;
}

int nevh_scene_shown_values(nevh_scene *s, nevh_shown which, double t,
                            const double q[], const double p[],
                            double values[]) {
    if (!nevh__scene_begin(s))
        return nevh__scene_fault(s);
    const nevh__items *all = &s->model->shown[which];
    nevh__state at = {t, q, p, false};
    for (size_t k = 0, i = 0; k < all->count; k++)
        if (is_there(s, &all->items[k]) &&
            !nevh__formula_value(s, &all->items[k].formula, &at, &values[i++]))
            return s->status;
    return NEVH_OK;
}

int nevh_scene_judged_value(nevh_scene *s, double t, const double q[],
                            const double p[], double *value) {
    if (!s || !value)
        return NEVH_EINVAL;
    nevh__state at = {t, q, p, false};
    *value = NAN;
    if (nevh__scene_begin(s) && s->judged)
        nevh__formula_value(s, &s->model->judged, &at, value);
    return s->status;
}

double nevh_scene_period(const nevh_scene *s, size_t k) {
    if (!s)
        return 0;
    return k < nevh_scene_dof(s) ? s->model->period[k] : 0;
}

size_t nevh_scene_part_count(const nevh_scene *s) {
    if (!s)
        return 0;
    return s->model ? s->model->n_drawn : 0;
}

nevh_scene_part nevh_scene_part_at(const nevh_scene *s, size_t i) {
    if (!s)
        return (nevh_scene_part){0};
    return i < nevh_scene_part_count(s) ? s->model->drawn[i].decl
                                        : (nevh_scene_part){0};
}

int nevh_scene_part_values(nevh_scene *s, size_t i, double t, const double q[],
                           const double p[], double values[]) {
    if (!nevh__scene_begin(s))
        return nevh__scene_fault(s);
    if (i >= s->model->n_drawn)
        return NEVH_EINVAL;
    nevh__drawn *part = &s->model->drawn[i];
    nevh__formula_values(s, part->values, part->decl.count,
                         (nevh__state){t, q, p, false}, values);
    return s->status;
}

const char *nevh_scene_stop_text(const nevh_scene *s) {
    if (!s)
        return "";
    return s->model ? s->model->stop.text : NULL;
}

bool nevh_scene_stops(nevh_scene *s) {
    if (!s)
        return false;
    return nevh_scene_stop_text(s);
}

int nevh_scene_stop_reached(nevh_scene *s, double t, const double q[],
                            const double p[], bool *reached) {
    if (!s || !reached)
        return NEVH_EINVAL;
    double value;
    *reached = false;
    if (!nevh__scene_begin(s) || !nevh_scene_stops(s))
        return s->status;
    nevh__stop *stop = &s->model->stop;
    nevh__state at = {t, q, p, false};
    if (!nevh__formula_value(s, &stop->formula, &at, &value))
        return s->status;
    *reached = stop->below ? value < stop->value : value > stop->value;
    return NEVH_OK;
}

int nevh_scene_stop_observe(void *scene, size_t step, double t,
                            const double q[], const double p[]) {
    bool reached = false;
    int status = nevh_scene_stop_reached(scene, t, q, p, &reached);
    (void)step;
    return status ? status : reached;
}
