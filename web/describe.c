/* nevh: the live page's module: what is in a scene, as JSON.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "page.h"
#include "lesson.h"
#include <math.h>
#include <nevh/extend.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    char *text;
    size_t used, room;
    bool lacking; /* memory */
} json;

static void put_bytes(json *j, const char *bytes, size_t count) {
    while (!j->lacking && j->used + count + 1 > j->room) {
        char *more = realloc(j->text, j->room = 2 * j->room + 1000);
        j->lacking = !more;
        j->text = more ? more : j->text;
    }
    if (j->lacking)
        return;
    memcpy(j->text + j->used, bytes, count);
    j->text[j->used += count] = '\0';
}

__attribute__((format(printf, 2, 3))) static void put(json *j,
                                                      const char *format, ...) {
    char line[400];
    va_list arguments;
    va_start(arguments, format);
    int count = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    put_bytes(j, line, count > 0 ? (size_t)count : 0);
}

static void put_string(json *j, const char *text) {
    put_bytes(j, "\"", 1);
    for (; text && *text; text++)
        if ((unsigned char)*text < ' ')
            put(j, "\\u%04x", (unsigned)*text);
        else if (*text == '"' || *text == '\\')
            put(j, "\\%c", *text);
        else
            put_bytes(j, text, 1);
    put_bytes(j, "\"", 1);
}

static void put_key(json *j, const char *name, const char *text) {
    put(j, ",\"%s\":", name);
    put_string(j, text);
}

static void put_number(json *j, double number) {
    if (isfinite(number))
        put(j, "%.17g", number);
    else
        put(j, "null");
}

static void put_list(json *j, const char *name, size_t count,
                     const char *const item[]) {
    put(j, ",\"%s\":[", name);
    for (size_t i = 0; i < count; i++) {
        put(j, i ? "," : "");
        put_string(j, item[i]);
    }
    put(j, "]");
}

static void put_momentum_label(json *j, const page *g, const char *coordinate) {
    char name[256];
    bool fits =
        snprintf(name, sizeof name, "p_%s", coordinate) < (int)sizeof name;
    put_key(j, "momentum", fits ? nevh_scene_label(g->scene, name) : "");
}

static void put_coordinates(json *j, const page *g) {
    put(j, ",\"coordinates\":[");
    for (size_t k = 0; k < g->n; k++) {
        const char *name = nevh_scene_coordinate(g->scene, k);
        put(j, "%s{\"start\":[", k ? "," : "");
        put_number(j, g->start ? g->start[k] : NAN);
        put(j, ",");
        put_number(j, g->start ? g->start[g->n + k] : NAN);
        put(j, "],\"period\":%.17g", nevh_scene_period(g->scene, k));
        put_key(j, "name", name);
        put_key(j, "label", nevh_scene_label(g->scene, name));
        put_momentum_label(j, g, name);
        put(j, "}");
    }
    put(j, "]");
}

static void put_equations(json *j, const page *g) {
    put(j, ",\"equations\":[");
    for (size_t i = 0; i < nevh_scene_equation_count(g->scene); i++) {
        nevh_scene_equation e = nevh_scene_equation_at(g->scene, i);
        put(j, "%s{\"on\":%s", i ? "," : "", e.on ? "true" : "false");
        put_key(j, "section", e.section);
        put_key(j, "name", e.name);
        put_key(j, "value", e.value);
        put(j, "}");
    }
    put(j, "]");
}

static void put_parts(json *j, const page *g) {
    put(j, ",\"parts\":[");
    for (size_t i = 0; i < nevh_scene_part_count(g->scene); i++) {
        nevh_scene_part part = nevh_scene_part_at(g->scene, i);
        put(j, "%s{\"count\":%zu", i ? "," : "", part.count);
        put_key(j, "kind", part.kind);
        put_key(j, "name", part.name);
        put_list(j, "items", part.count, part.item);
        put(j, "}");
    }
    put(j, "]");
}

/* What follows from the weights of a scheme of the scene's. */
static void put_facts(json *j, const nevh_integrator *x) {
    nevh_scheme_facts facts;
    char text[400];
    put(j, ",\"gradients\":%d,\"limit\":", nevh_integrator_gradients(x));
    put_number(j, nevh_stability_limit(x));
    if (!nevh_integrator_facts(x, &facts))
        put_key(j, "lacks", nevh_scheme_shortfall(&facts, text, sizeof text));
}

static void put_integrator(json *j, const nevh_integrator *x, bool own) {
    if (!lesson_has(nevh_integrator_name(x)))
        return;
    put(j, "%s{\"order\":%d,\"own\":%s", j->text[j->used - 1] == '[' ? "" : ",",
        nevh_integrator_order(x), own ? "true" : "false");
    put_key(j, "name", nevh_integrator_name(x));
    put_key(j, "symplectic", nevh_claim_name(nevh_integrator_symplectic(x)));
    put_key(j, "symmetric", nevh_claim_name(nevh_integrator_symmetric(x)));
    if (own)
        put_facts(j, x);
    put(j, "}");
}

static void put_integrators(json *j, const page *g) {
    put(j, ",\"integrators\":[");
    for (size_t i = 0; nevh_scene_integrator(g->scene, i) && !j->lacking; i++)
        put_integrator(j, nevh_scene_integrator(g->scene, i), true);
    const nevh_integrator *const *all = nevh_integrators();
    for (; *all && !j->lacking; all++)
        put_integrator(j, *all, false);
    put(j, "]");
}

static void put_sections(json *j, const page *g) {
    put(j, ",\"sections\":[");
    for (size_t i = 0; i < nevh_scene_section_count(g->scene); i++) {
        const nevh_scene_section *x = nevh_scene_section_at(g->scene, i);
        put(j, "%s{\"every\":%.17g", i ? "," : "", x->every);
        put_key(j, "name", x->name);
        put_key(j, "left", x->left);
        put_key(j, "right", x->right);
        put_list(j, "items", x->items, x->item);
        put(j, "}");
    }
    put(j, "]");
}

static void put_run(json *j, const page *g) {
    const nevh_scene_run *run = g->run;
    put(j, ",\"run\":{\"t_start\":%.17g,\"t_end\":", run->t_start);
    put_number(j, run->t_end);
    put(j, ",\"dt\":[");
    for (size_t i = 0; i < run->dts; i++)
        put(j, "%s%.17g", i ? "," : "", run->dt[i]);
    put(j, "]");
    put_list(j, "integrators", run->integrators, run->integrator);
    put_list(j, "gradients", run->gradients, run->gradient);
    lesson_pace usual = lesson_usual(g->scene);
    put(j, ",\"step\":%.17g,\"rate\":%.17g}", usual.dt, usual.rate);
}

char *page_scene_text(page *g) {
    json j = {0};
    bool timed = !(nevh_system_traits(g->system) & NEVH_AUTONOMOUS);
    bool friction = nevh_system_friction(g->system, NULL);
    put(&j, "{\"balance\":%d,\"timed\":%d,\"friction\":%d", g->balance, timed,
        friction);
    put_key(&j, "title", nevh_scene_title(g->scene));
    put_key(&j, "source", nevh_scene_source(g->scene));
    put_key(&j, "t_label", nevh_scene_label(g->scene, "t"));
    put_key(&j, "energy_label", nevh_scene_label(g->scene, "energy"));
    put_coordinates(&j, g);
    put_equations(&j, g);
    put_parts(&j, g);
    put_integrators(&j, g);
    put_sections(&j, g);
    if (g->run)
        put_run(&j, g);
    put(&j, "}");
    if (!j.lacking)
        return j.text;
    free(j.text);
    return NULL;
}
