/* nevh list: what there is.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "commands.h"
#include "tool.h"
#include <string.h>

static const char *fits(const nevh_integrator *s) {
    unsigned needs = nevh_integrator_needs(s);
    if (needs & NEVH_PARTS)
        return "A + V(q), A a form";
    if (needs & NEVH_QUADRATIC_KINETIC)
        return "T(p) + V(q), T quadratic";
    if (needs & NEVH_SEPARABLE)
        return "T(p) + V(q)";
    return needs & NEVH_AUTONOMOUS ? "H(q, p)" : "any";
}

static void add_integrator(table *t, const nevh_integrator *s, bool all) {
    int gradients = nevh_integrator_gradients(s);
    table_text(t, nevh_integrator_name(s));
    table_number(t, nevh_integrator_order(s));
    table_text(t, nevh_claim_name(nevh_integrator_symplectic(s)));
    table_text(t, nevh_claim_name(nevh_integrator_symmetric(s)));
    table_text(t, nevh_claim_name(nevh_integrator_explicit(s)));
    table_text(t, nevh_claim_name(nevh_integrator_preserves_energy(s)));
    table_text(t, nevh_integrator_adaptive(s) ? "yes" : "no");
    if (gradients)
        table_number(t, gradients);
    else
        table_text(t, NULL);
    table_text(t, fits(s));
    if (!all)
        return;
    table_text(t, nevh_integrator_native(s) ? "yes" : "no");
    table_text(t, nevh_integrator_aliases(s));
    table_text(t, nevh_integrator_source(s));
}

static int list_integrators(table *t, const options *o) {
    table_column(t, "integrator");
    table_key(t);
    table_titles(t, "order,sym-\nplectic,sym-\nmetric,ex-\nplicit,"
                    "energy\nkept,adap-\ntive,gra-\ndients,needs H =");
    table_break(t);
    if (o->all)
        table_titles(t, "native,elsewhere,source");
    for (size_t i = 0; nevh_integrators()[i]; i++)
        add_integrator(t, nevh_integrators()[i], o->all);
    return TOOL_OK;
}

static int list_gradients(table *t, const options *o) {
    (void)o;
    table_titles(t, "gradient,order,from");
    for (size_t i = 0; nevh_gradients()[i]; i++) {
        const nevh_gradient *g = nevh_gradients()[i];
        int order = nevh_gradient_order(g);
        table_text(t, nevh_gradient_name(g));
        if (order)
            table_number(t, order);
        else
            table_text(t, NULL);
        table_text(t, order             ? "values of H"
                      : g == nevh_exact ? "derivatives of H"
                                        : "values of H over complex "
                                          "numbers");
    }
    return TOOL_OK;
}

static int list_models(table *t, const options *o) {
    (void)o;
    table_titles(t, "model,degrees of\nfreedom,title");
    for (size_t i = 0; nevh_models()[i]; i++) {
        const nevh_model *m = nevh_models()[i];
        table_text(t, m->name);
        table_number(t, (double)m->n);
        table_text(t, m->title);
    }
    return TOOL_OK;
}

static int list_scenes(table *t, const options *o) {
    list names = {0}, files = {0};
    table_titles(t, "scene,degrees of\nfreedom,title");
    int status = TOOL_OK;
    if (o->all)
        table_column(t, "source");
    scenes_installed(&names, &files);
    for (size_t i = 0; i < names.count && !status; i++) {
        nevh_scene *scene = tool_owned(nevh_scene_read(files.item[i]));
        bool good = nevh_scene_status(scene) == NEVH_OK;
        status = outputs_check(o, scene, files.item[i]);
        table_text(t, names.item[i]);
        table_number(t, good ? (double)nevh_scene_dof(scene) : 0);
        table_text(t, good ? nevh_scene_title(scene) : "has errors");
        if (o->all)
            table_text(t, good ? nevh_scene_source(scene) : NULL);
        nevh_scene_free(scene);
    }
    if (!names.count)
        status = scenes_missing();
    return status;
}

static int list_all(const options *o) {
    /* in the order of the operands */
    static int (*const lists[])(table *, const options *) = {
        list_integrators, list_gradients, list_models, list_scenes};
    list names = {0};
    page p = {.table = table_new()};
    const char *name = o->operands.count == 2 ? o->operands.item[1] : NULL;
    int status = TOOL_USAGE;
    size_t i = 0;
    list_split_at(&names, list_command.operands, '|');
    while (name && i < names.count && strcmp(name, names.item[i]) != 0)
        i++;
    if (!name)
        tool_refuse("nevh list takes one of integrators, gradients, models, "
                    "scenes");
    else if (i == names.count)
        tool_unknown("kind", name, &names);
    else if (!lists[i](p.table, o))
        status = output_page(o, &p, TOOL_OK);
    return status;
}

const command list_command = {
    .name = "list",
    .operand = "WHAT",
    .operands = "integrators|gradients|models|scenes",
    .brief = "integrators, gradients, models or scenes",
    .help = "integrators, gradients, models or scenes",
    .examples = "list integrators\n"
                "list scenes",
    .options = "TABLE all",
    .run = list_all,
};
