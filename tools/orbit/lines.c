/* nevh: a file that only ever holds whole lines.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "trajectory.h"
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MUCH = 1 << 15, PAGE = 1 << 12 };

static int unwritten(line_file *l) {
    l->stuck = true;
    return tool_refuse("%s cannot be written: %s",
                       l->name ? l->name : "the output", strerror(errno));
}

static const char writer[] = "run";

int lines_open(line_file *l, const char *name) {
    *l = (line_file){
        .name = name, .file = STDOUT_FILENO, .digest = digest_begin()};
    if (!name)
        return TOOL_OK;
    l->file = -1;
    if (output_claim(&l->claimed, name, writer))
        return TOOL_USAGE;
    l->waits = true;
    l->file = fcntl(fileno(l->claimed.stream), F_DUPFD_CLOEXEC, 0);
    l->regular = file_is_regular(l->file);
    return l->file < 0 ? unwritten(l) : TOOL_OK;
}

/* Replaces the earlier file once the first lines could be written. */
static void replace_file(line_file *l) {
    l->waits = false;
    if (output_close(&l->claimed, l->stuck ? TOOL_USAGE : TOOL_OK))
        l->stuck = true;
}

static int open_again(line_file *l, const char *name) {
    *l = (line_file){.name = name, .file = open(name, O_RDWR | O_CLOEXEC)};
    if (l->file < 0)
        return unwritten(l);
    l->regular = file_is_regular(l->file);
    if (l->regular && flock(l->file, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK)
        return tool_refuse("%s: another %s is writing it", name, writer);
    return TOOL_OK;
}

/* Digests the first bytes; false if the file has fewer. */
static bool digest_file(int file, uint64_t bytes, uint64_t *digest) {
    char block[1 << 14];
    *digest = digest_begin();
    while (bytes) {
        size_t most = bytes < sizeof block ? (size_t)bytes : sizeof block;
        ssize_t count = read(file, block, most);
        if (count <= 0)
            return false;
        *digest = digest_add(*digest, block, (size_t)count);
        bytes -= (uint64_t)count;
    }
    return true;
}

int lines_reopen(line_file *l, const char *name, uint64_t bytes,
                 uint64_t digest) {
    if (open_again(l, name))
        return TOOL_USAGE;
    if (!l->regular || !digest_file(l->file, bytes, &l->digest) ||
        l->digest != digest)
        return tool_refuse("%s is not as the interrupted run left it: nothing "
                           "was changed",
                           name);
    l->bytes = bytes;
    return ftruncate(l->file, (off_t)bytes) ? unwritten(l) : TOOL_OK;
}

void lines_print(line_file *l, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    if (length < 0 || l->used + (size_t)length >= l->capacity) {
        l->capacity = 2 * l->capacity + (size_t)length + MUCH;
        l->text = tool_enlarge(l->text, l->capacity, 1);
    }
    va_start(arguments, format);
    vsnprintf(l->text + l->used, l->capacity - l->used, format, arguments);
    va_end(arguments);
    l->used += (size_t)length;
}

void lines_comment(line_file *l, const char *text) {
    for (size_t length; *text; text += length + (text[length] == '\n')) {
        length = strcspn(text, "\n");
        lines_print(l, "# %.*s\n", (int)length, text);
    }
}

/* Bytes of whole lines up to the end of a page of the file, or of the one line
   that goes beyond.  Linux cuts a write short between two pages when the
   process is killed meanwhile; so but few bytes are written where that may
   break a line. */
static size_t next_part(const line_file *l, size_t from) {
    const char *text = l->text + from;
    size_t count = l->used - from, capacity = PAGE - (l->bytes + from) % PAGE;
    if (!l->regular || count <= capacity)
        return count;
    const char *end = memrchr(text, '\n', capacity);
    end = end ? end : memchr(text + capacity, '\n', count - capacity);
    return end ? (size_t)(end - text) + 1 : count;
}

static size_t write_part(line_file *l, size_t from, size_t count) {
    size_t written = 0;
    while (!l->stuck && written < count) {
        ssize_t now = write(l->file, l->text + from + written, count - written);
        if (now >= 0)
            written += (size_t)now;
        else if (errno != EINTR)
            unwritten(l);
    }
    return written;
}

/* Bytes up to the last end of a line. */
static size_t whole_lines(const char *text, size_t count) {
    while (count && text[count - 1] != '\n')
        count--;
    return count;
}

int lines_flush(line_file *l) {
    size_t written = 0;
    while (!l->stuck && written < l->used)
        written += write_part(l, written, next_part(l, written));
    size_t whole = whole_lines(l->text, written);
    l->digest = digest_add(l->digest, l->text, whole);
    l->bytes += whole;
    l->used = 0;
    if (whole < written && l->regular && ftruncate(l->file, (off_t)l->bytes))
        unwritten(l);
    if (l->waits)
        replace_file(l);
    return l->stuck ? TOOL_USAGE : TOOL_OK;
}

int lines_end(line_file *l) {
    return l->used >= MUCH ? lines_flush(l) : TOOL_OK;
}

void lines_close(line_file *l) {
    if (l->waits)
        output_close(&l->claimed, TOOL_USAGE);
    l->waits = false;
    if (l->name && l->file >= 0)
        close(l->file);
}
