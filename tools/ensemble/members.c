/* nevh: the starts of an ensemble, for pictures.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "members.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { MOST_MEMBERS = 10000, MOST_NAMED = 16 };

static int read_all(members *m, const plan *p, uint64_t count) {
    for (uint64_t i = 0; i < count; i++) {
        int status = nevh_scene_member_start(
            p->scene, i, m->q + m->count * m->n, m->p + m->count * m->n);
        if (!status)
            m->number[m->count++] = (size_t)i;
        else if (status == NEVH_EINVAL || status == NEVH_ENOMEM)
            return tool_refuse("%s: %s", p->name, nevh_scene_message(p->scene));
        else if (!m->startless++)
            m->why = text_print("member %" PRIu64 ": %s", i,
                                nevh_scene_message(p->scene));
    }
    return m->count ? TOOL_OK
                    : tool_refuse("%s: no member has a start; the first, %s",
                                  p->name, m->why);
}

/* The least and the largest energy. */
static void measure_energies(members *m, const plan *p) {
    nevh_field *f = plan_values(p);
    double t = p->run->t_start, h;
    for (size_t i = 0; i < m->count; i++)
        if (!nevh_field_value(f, 1, &t, m->q + i * m->n, m->p + i * m->n, &h)) {
            m->low = fmin(m->low, h);
            m->high = fmax(m->high, h);
        }
    nevh_field_free(f);
}

int members_check(const plan *p, const options *o) {
    for (size_t i = 0; i < o->settings.count; i++) {
        const char *setting = o->settings.item[i];
        const char *text = setting + 1 + strspn(setting + 1, " ");
        if (!strchr("@=", *setting))
            continue;
        size_t length = strcspn(text, "=");
        while (length && text[length - 1] == ' ')
            length--;
        bool varies =
            nevh_scene_varies(p->scene, text_print("%.*s", (int)length, text));
        if (varies)
            return tool_refuse("--%s %s: [ensemble] or --vary gives it to each "
                               "orbit; --vary '%s' gives all the same",
                               *setting == '@' ? "start" : "set", text, text);
    }
    return TOOL_OK;
}

int members_read(members *m, const plan *p) {
    uint64_t count = nevh_scene_members(p->scene);
    *m = (members){.n = p->n, .several = count > 0, .low = NAN, .high = NAN};
    if (count > MOST_MEMBERS)
        return tool_refuse("%s: %" PRIu64 " members are more than a picture "
                           "shows: vary fewer, at most %d",
                           p->name, count, MOST_MEMBERS);
    size_t room = count ? (size_t)count : 1;
    m->number = tool_allocate(room, sizeof *m->number);
    m->q = tool_allocate(room * p->n, sizeof *m->q);
    m->p = tool_allocate(room * p->n, sizeof *m->p);
    if (count) {
        int status = read_all(m, p, count);
        if (!status)
            measure_energies(m, p);
        return status;
    }
    memcpy(m->q, p->q, p->n * sizeof *m->q);
    memcpy(m->p, p->p, p->n * sizeof *m->p);
    m->count = 1;
    return TOOL_OK;
}

int members_tell(const members *m, const plan *p) {
    if (!m->startless)
        return TOOL_OK;
    tool_refuse("%s: %zu of %zu members have no start; the first, %s", p->name,
                m->startless, m->startless + m->count, m->why);
    return TOOL_FAILED;
}

void members_note(const members *m, list *notes) {
    if (m->several)
        list_print(notes,
                   m->startless ? "members: %zu, %zu without a start"
                                : "members: %zu",
                   m->count + m->startless, m->startless);
}

void members_note_energies(const members *m, const plan *p, list *notes) {
    static const double equal = 1e-6;
    bool apart = m->high - m->low > equal * fmax(fabs(m->low), fabs(m->high));
    if (m->count > 1 && p->n > 1 && apart && !p->time && !p->friction)
        list_print(
            notes,
            "energies: H = %.6g ... %.6g%s of the %zu orbits: they "
            "are not on one surface of energy, and their curves may "
            "cross; --vary 'p_%s = solve(H = %.6g, from %.3g)' gives all "
            "the same",
            m->low, m->high, p->energy_unit, m->count,
            nevh_scene_coordinate(p->scene, 0), m->high,
            p->p[0] != 0 ? p->p[0] : 1);
}

static bool differ(const members *m, const double values[], size_t k) {
    for (size_t i = 1; i < m->count; i++)
        if (values[i * m->n + k] != values[k])
            return true;
    return false;
}

char *members_start(const members *m, const plan *p, size_t i) {
    if (m->count < 2 || m->count > MOST_NAMED)
        return NULL;
    for (size_t k = 0; k < 2 * m->n; k++) {
        bool momentum = k >= m->n;
        const double *values = momentum ? m->p : m->q;
        if (differ(m, values, k % m->n))
            return text_print("start %s%s = %.4g", momentum ? "p_" : "",
                              nevh_scene_coordinate(p->scene, k % m->n),
                              values[i * m->n + k % m->n]);
    }
    return text_print("orbit %zu", m->number[i]);
}
