/* nevh tests: forge FILE NAME=VALUE... changes numbers in the state of an
   interrupted run (bytes, step, row, t), and its digest, so that it is whole.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/trajectory.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    SIZES = 16 + 5 * 8,
    MOST = 1 << 20
}; /* before the progress, as resume.c */

static uint64_t fnv(const unsigned char *at, size_t count) {
    uint64_t digest = 0xCBF29CE484222325u;
    while (count--)
        digest = (digest ^ *at++) * 0x100000001B3u;
    return digest;
}

static void change(progress_of_run *at, const char *what) {
    const char *value = strchr(what, '=') + 1;
    uint64_t count = strtoull(value, NULL, 10);
    if (strncmp(what, "bytes=", 6) == 0)
        at->bytes = count;
    else if (strncmp(what, "step=", 5) == 0)
        at->step = count;
    else if (strncmp(what, "row=", 4) == 0)
        at->row = count;
    else if (strncmp(what, "t=", 2) == 0)
        at->t = strtod(value, NULL);
}

int main(int argc, char **argv) {
    static unsigned char all[MOST];
    progress_of_run at;
    FILE *file = argc > 2 ? fopen(argv[1], "r+b") : NULL;
    size_t size = file ? fread(all, 1, sizeof all, file) : 0;
    uint64_t digest;
    if (size < SIZES + sizeof at + sizeof digest || size == sizeof all)
        return 2;
    memcpy(&at, all + SIZES, sizeof at);
    for (int i = 2; i < argc; i++)
        change(&at, argv[i]);
    memcpy(all + SIZES, &at, sizeof at);
    digest = fnv(all, size - sizeof digest);
    memcpy(all + size - sizeof digest, &digest, sizeof digest);
    rewind(file);
    bool whole = fwrite(all, 1, size, file) == size;
    return fclose(file) == 0 && whole ? 0 : 2;
}
