/* nevh: memory of the command, all of which goes when the program ends.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <stdlib.h>
/* Before tool.h, which hides free from the rest of the command. */
static void (*const give_back)(void *) = free;
#include "tool.h"
#include <math.h>
#include <pthread.h>
#include <stddef.h>
#include <string.h>

/* Before each piece of memory; all of them are a list, the newest first. */
typedef struct block block;
struct block {
    _Alignas(max_align_t) block *older, *newer;
    size_t bytes; /* behind it */
};
static block *newest;
/* Members run in threads. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

/* Sets the links of a block's neighbours. */
static void relink(const block *b, block *older_has, block *newer_has) {
    if (b->older)
        b->older->newer = older_has;
    *(b->newer ? &b->newer->older : &newest) = newer_has;
}

void *tool_owned(void *memory) {
    if (!memory) {
        fputs("nevh: out of memory\n", stderr);
        exit(TOOL_FAILED);
    }
    return memory;
}

int tool_status(int status) {
    if (status == NEVH_ENOMEM)
        tool_owned(NULL);
    return status;
}

double tool_number(double number) {
    if (isnan(number) && errno == ENOMEM)
        tool_owned(NULL);
    return number;
}

static size_t bytes_of(size_t count, size_t size) {
    if (size && count > (SIZE_MAX - sizeof(block)) / size)
        tool_owned(NULL);
    return count * size;
}

void *tool_allocate(size_t count, size_t size) {
    size_t bytes = bytes_of(count, size);
    block *b = tool_owned(calloc(1, sizeof *b + bytes));
    b->bytes = bytes;
    pthread_mutex_lock(&lock);
    b->older = newest;
    relink(b, b, b);
    pthread_mutex_unlock(&lock);
    return b + 1;
}

void *tool_enlarge(void *memory, size_t count, size_t size) {
    if (!memory)
        return tool_allocate(count, size);
    size_t bytes = bytes_of(count, size);
    pthread_mutex_lock(&lock);
    block *b = realloc((block *)memory - 1, sizeof *b + bytes);
    if (b) {
        b->bytes = bytes;
        relink(b, b, b);
    }
    pthread_mutex_unlock(&lock);
    return (block *)tool_owned(b) + 1;
}

void *tool_grown(void *items, size_t count, size_t size) {
    size_t room = items ? ((block *)items - 1)->bytes / size : 0;
    return count < room ? items
                        : tool_enlarge(items, count ? 2 * count : 1, size);
}

void tool_release(void *memory) {
    block *b = memory ? (block *)memory - 1 : NULL;
    if (!b)
        return;
    pthread_mutex_lock(&lock);
    relink(b, b->newer, b->older);
    pthread_mutex_unlock(&lock);
    give_back(b);
}

void tool_release_all(void) {
    while (newest)
        tool_release(newest + 1);
}

/* Moves a text of libc to the list. */
static char *moved(char *text, size_t length) {
    char *copy = tool_allocate(length + 1, 1);
    memcpy(copy, text, length);
    give_back(text);
    return copy;
}

char *text_adopt(char *text) {
    return text ? moved(text, strlen(text)) : NULL;
}

FILE *text_open(text_file *t) {
    return t->file = tool_owned(open_memstream(&t->text, &t->size));
}

char *text_close(text_file *t) {
    if (fclose(t->file))
        tool_owned(NULL);
    return moved(tool_owned(t->text), t->size);
}
