/* nevh tests: the scenes that ship.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_SHIPPED_H
#define NEVH_TESTS_SHIPPED_H

#include "support.h"
#include <dirent.h>
#include <nevh/scene.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SHIPPED = 100 };
static char shipped[MOST_SHIPPED][64]; /* names of files, sorted */
static size_t n_shipped;

static inline const char *shipped_folder(void) {
    static char folder[4000];
    const char *source = getenv("srcdir");
    snprintf(folder, sizeof folder, "%s/scenes", source ? source : ".");
    return folder;
}

static inline int by_name(const void *a, const void *b) {
    return strcmp(a, b);
}

/* How many there are. */
static inline int find_shipped(void) {
    n_shipped = 0;
    DIR *folder = opendir(shipped_folder());
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        const char *end = strstr(entry->d_name, ".nevh");
        if (end && !end[5] && strlen(entry->d_name) < sizeof *shipped)
            strcpy(shipped[n_shipped++], entry->d_name);
    }
    if (folder)
        closedir(folder);
    qsort(shipped, n_shipped, sizeof *shipped, by_name);
    return (int)n_shipped;
}

static inline nevh_scene *read_shipped(const char *file) {
    char path[4100];
    snprintf(path, sizeof path, "%s/%s", shipped_folder(), file);
    nevh_scene *s = nevh_scene_read(path);
    ck_assert_msg(!nevh_scene_status(s), "%s", nevh_scene_message(s));
    return s;
}

#endif
