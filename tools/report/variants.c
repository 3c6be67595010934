/* nevh report: a scene as it is given, or its variants.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "report_private.h"

/* With settings of its own after those that are given. */
static int variant_open(variant *v, const options *o, const char *name,
                        const char *scene) {
    v->name = name;
    v->given = *o;
    v->given.settings = (list){0};
    for (size_t i = 0; i < o->settings.count; i++)
        list_add(&v->given.settings, o->settings.item[i]);
    const option_row *set = option_find("set");
    if (name && set->read(&v->given, set, name))
        return TOOL_USAGE;
    return scene_open_named(&v->scene, scene, &v->given);
}

int variants_open(variants *all, const options *o, const char *scene) {
    int status = TOOL_OK;
    all->count = o->variants.count ? o->variants.count : 1;
    all->item = tool_allocate(all->count, sizeof *all->item);
    for (size_t i = 0; !status && i < all->count; i++)
        status =
            variant_open(&all->item[i], o,
                         o->variants.count ? o->variants.item[i] : NULL, scene);
    return status;
}

void variants_close(variants *all) {
    for (size_t i = 0; i < all->count; i++)
        nevh_scene_free(all->item[i].scene);
}
