/* nevh tests: what targets of libFuzzer share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FUZZ_H
#define NEVH_FUZZ_H

#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static inline void insist(int holds) {
    if (!holds)
        abort();
}

/* The bytes and a 0, to be freed. */
static inline char *fuzz_text(const uint8_t *bytes, size_t size) {
    char *text = malloc(size + 1);
    insist(text != NULL);
    memcpy(text, bytes, size);
    text[size] = '\0';
    return text;
}

/* With -close_fd_mask=2 the next file would be stderr: that of a name in the
   folder for such files. */
static inline void fuzz_hush(void) {
    if (fcntl(STDERR_FILENO, F_GETFD) == -1)
        insist(open("/dev/null", O_WRONLY) == STDERR_FILENO);
}

/* A file of the folder where run.sh works. */
static inline char *fuzz_file(const char *name) {
    const char *folder = getenv("FUZZ_FOLDER");
    char *path = malloc(4096);
    insist(path != NULL);
    snprintf(path, 4096, "%s/%s", folder ? folder : ".", name);
    return path;
}

static inline void fuzz_write(const char *path, const void *bytes,
                              size_t size) {
    FILE *file = fopen(path, "wb");
    insist(file != NULL);
    insist(fwrite(bytes, 1, size, file) == size);
    insist(fclose(file) == 0);
}

#endif
