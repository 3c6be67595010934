/* nevh sweep: a file of records.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "store.h"
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum { ALIGNED = 64, BEFORE_TEXT = 12, MOST_REASONS = 1000, FORGET = 1 << 14 };
static const char magic[] = "nevh sweep, 1\n";
static const char reasons_begin[] = "\n[not done]\n";

char *store_name(const char *file, uint64_t task, uint64_t tasks) {
    size_t length = strlen(file);
    if (!tasks)
        return text_print("%s", file);
    if (length > 4 && strcmp(file + length - 4, ".npy") == 0)
        length -= 4;
    return text_print("%.*s.%" PRIu64 "-of-%" PRIu64 ".npy", (int)length, file,
                      task, tasks);
}

static int unwritten(const store *s) {
    return tool_refuse("%s cannot be written: %s; what is there stays, and "
                       "--resume goes on with it",
                       s->name, strerror(errno));
}

/* All bytes, or false. */
static bool write_at(const store *s, const void *bytes, size_t count,
                     uint64_t at) {
    const char *from = bytes;
    if (s->write)
        return s->write(bytes, count, at);
    while (count) {
        ssize_t now = pwrite(s->file, from, count, (off_t)at);
        if (now < 0 && errno == EINTR)
            continue;
        if (now <= 0)
            return false;
        from += now;
        at += (uint64_t)now;
        count -= (size_t)now;
    }
    return true;
}

/* The header. */

/* A text as Python writes it, in ASCII. */
static char *python_text(const char *text) {
    char *all = text_print("'");
    const unsigned char *at = (const unsigned char *)text;
    while (*at) {
        unsigned code = *at++;
        int more = code >= 0xF0 ? 3 : code >= 0xE0 ? 2 : code >= 0xC0 ? 1 : 0;
        code &= more ? 0x3Fu >> more : 0x7Fu;
        for (; more && *at; more--)
            code = code << 6 | (*at++ & 0x3Fu);
        char *longer = text_print(code == '\'' || code == '\\' ? "%s\\%c"
                                  : code < 0x7F                ? "%s%c"
                                  : code < 0x10000             ? "%s\\u%04x"
                                                               : "%s\\U%08x",
                                  all, code);
        free(all);
        all = longer;
    }
    char *whole = text_print("%s'", all);
    free(all);
    return whole;
}

/* The header, as long as s->header says, which is set; to be freed. */
static char *make_header(store *s) {
    char *fields = text_print("%s", "('status', '|u1'), ('', '|V7')");
    for (size_t i = 0; i < s->columns->count; i++) {
        char *name = python_text(s->columns->item[i]);
        char *longer = text_print("%s, (%s, '<f8')", fields, name);
        free(name);
        free(fields);
        fields = longer;
    }
    char *text = text_print("{'descr': [%s], 'fortran_order': False, 'shape': "
                            "(%" PRIu64 ",), }",
                            fields, s->count);
    size_t length = strlen(text);
    s->header = (BEFORE_TEXT + length + ALIGNED) / ALIGNED * ALIGNED;
    char *all = tool_allocate(s->header, 1);
    size_t rest = s->header - BEFORE_TEXT;
    memcpy(all, "\x93NUMPY\x02\x00", 8);
    for (int i = 0; i < 4; i++)
        all[8 + i] = (char)(rest >> 8 * i & 0xFF);
    memset(all + BEFORE_TEXT, ' ', rest);
    memcpy(all + BEFORE_TEXT, text, length);
    all[s->header - 1] = '\n';
    free(text);
    free(fields);
    return all;
}

static uint64_t whole_size(const store *s) {
    return s->header + s->record * s->count;
}

static void measure(store *s, const char *name) {
    s->name = text_print("%s", name);
    s->side = text_print("%s" ARRAY_TEXT_ENDING, name);
    s->record = 8 + 8 * s->columns->count;
    s->bytes = tool_allocate(s->record, 1);
    free(make_header(s));
}

static int map(store *s) {
    s->mapped = (size_t)whole_size(s);
    void *at = mmap(NULL, s->mapped, PROT_READ, MAP_SHARED, s->file, 0);
    if (at == MAP_FAILED)
        return tool_refuse("%s cannot be read: %s", s->name, strerror(errno));
    s->map = at;
    return TOOL_OK;
}

/* Header and records without status; the file is empty. */
static int init(store *s) {
    char *header = make_header(s);
    bool written = write_at(s, header, s->header, 0) &&
                   ftruncate(s->file, (off_t)whole_size(s)) == 0;
    int wrong = errno;
    free(header);
    if (written)
        return map(s);
    if (ftruncate(s->file, 0) != 0)
        wrong = errno;
    return tool_refuse("%s cannot be written: %s", s->name, strerror(wrong));
}

/* The side file. */

static char *read_side(const char *side) {
    FILE *f = regular_open(side);
    char *text = NULL;
    size_t used = 0, room = 0;
    while (f && !feof(f) && !ferror(f)) {
        if (used + 1 >= room)
            text = tool_enlarge(text, room = 2 * room + 4096, 1);
        used += fread(text + used, 1, room - used - 1, f);
    }
    if (text)
        text[used] = '\0';
    if (f)
        fclose(f);
    return text;
}

static int write_side(const store *s, const char *reasons) {
    output out;
    if (output_open(&out, s->side))
        return TOOL_USAGE;
    fprintf(out.stream,
            "%s%smembers_here: %" PRIu64 " from %" PRIu64 "\n%s%s%s", magic,
            s->settings, s->count, s->first, s->story, reasons_begin, reasons);
    return output_close(&out, TOOL_OK);
}

int store_range(const char *name, uint64_t *first, uint64_t *count) {
    char *side = text_print("%s" ARRAY_TEXT_ENDING, name);
    char *text = read_side(side);
    const char *at = text ? strstr(text, "\nmembers_here: ") : NULL;
    int status = TOOL_OK;
    if (!text)
        status = tool_refuse("there is nothing to resume: %s: %s", side,
                             strerror(errno));
    else if (strncmp(text, magic, strlen(magic)) != 0 || !at ||
             sscanf(at, " members_here: %" SCNu64 " from %" SCNu64, count,
                    first) != 2)
        status = tool_refuse("%s is not what nevh sweep wrote", side);
    free(text);
    free(side);
    return status;
}

/* The first line that differs. */
static int compare_settings(const store *s, const char *saved) {
    const char *now = s->settings;
    while (*now) {
        int a = (int)strcspn(saved, "\n"), b = (int)strcspn(now, "\n");
        bool same = a == b && strncmp(saved, now, (size_t)a) == 0;
        if (!same && strncmp(now, "scene:", 6) == 0)
            return tool_refuse("%s is of another scene, or of other "
                               "parameters, effects, variations or outcomes",
                               s->name);
        if (!same)
            return tool_refuse("%s is of another sweep: it has \"%.*s\", this "
                               "one \"%.*s\"",
                               s->name, a, saved, b, now);
        saved += a + (saved[a] == '\n');
        now += b + (now[b] == '\n');
    }
    return TOOL_OK;
}

static int check_side(const store *s) {
    uint64_t first, count;
    if (store_range(s->name, &first, &count))
        return TOOL_USAGE;
    char *text = read_side(s->side);
    int status = compare_settings(s, text + strlen(magic));
    if (!status && (first != s->first || count != s->count))
        status = tool_refuse("%s has members %" PRIu64 " ... %" PRIu64
                             ", not %" PRIu64 " ... %" PRIu64,
                             s->name, first, first + count - 1, s->first,
                             s->first + s->count - 1);
    free(text);
    return status;
}

/* That a file has this store's header and length. */
static int check_file(store *s) {
    struct stat found;
    char *header = make_header(s), *there = tool_allocate(s->header, 1);
    bool same = fstat(s->file, &found) == 0 && S_ISREG(found.st_mode);
    uint64_t size = same ? (uint64_t)found.st_size : 0;
    same = same && pread(s->file, there, s->header, 0) == (ssize_t)s->header &&
           memcmp(header, there, s->header) == 0;
    free(header);
    free(there);
    if (!same)
        return tool_refuse("%s is no file of this sweep: its header is another",
                           s->name);
    return size == whole_size(s)
               ? TOOL_OK
               : tool_refuse("%s has %" PRIu64 " bytes instead of %" PRIu64
                             ": it was cut, or added to",
                             s->name, size, whole_size(s));
}

static int open_locked(store *s, int how) {
    s->file = open(s->name, how | O_CLOEXEC, 0666);
    if (s->file < 0)
        return tool_refuse(how & O_CREAT ? "%s cannot be written: %s"
                                         : "there is nothing to resume: %s: %s",
                           s->name, strerror(errno));
    struct stat found;
    if (fstat(s->file, &found) != 0 || !S_ISREG(found.st_mode))
        return tool_refuse("%s is no file on a disk, as an array must be",
                           s->name);
    if (flock(s->file, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK)
        return tool_refuse("%s: another sweep is writing it", s->name);
    return TOOL_OK;
}

/* A sweep that was left is not thrown away by chance. */
uint64_t store_next(const store *s, uint64_t i) {
    return store_skip_hole(s->file, s->header, s->record, i, s->count);
}

static int check_unfinished(store *s) {
    uint64_t first, count, missing = 0;
    char *text = read_side(s->side);
    bool ours = text && strncmp(text, magic, strlen(magic)) == 0;
    free(text);
    struct stat found;
    if (!ours || fstat(s->file, &found) != 0 ||
        store_range(s->name, &first, &count))
        return TOOL_OK;
    unsigned char begin[BEFORE_TEXT];
    if (pread(s->file, begin, sizeof begin, 0) != (ssize_t)sizeof begin)
        return TOOL_OK;
    uint64_t header = BEFORE_TEXT + begin[8] + ((uint64_t)begin[9] << 8) +
                      ((uint64_t)begin[10] << 16);
    uint64_t size = (uint64_t)found.st_size;
    uint64_t record = count && size > header ? (size - header) / count : 0;
    uint64_t done = 0;
    for (uint64_t i = 0; record && i < count && !(done && missing); i++) {
        unsigned char status = 0;
        if (pread(s->file, &status, 1, (off_t)(header + i * record)) != 1)
            break;
        *(status ? &done : &missing) += 1;
        uint64_t next = store_skip_hole(s->file, header, record, i + 1, count);
        missing += next > i + 1;
        i = next - 1;
    }
    return done && missing
               ? tool_refuse("%s is an unfinished sweep: go on with --resume "
                             "%s, or remove it",
                             s->name, s->name)
               : TOOL_OK;
}

int store_create(store *s, const char *name) {
    measure(s, name);
    if (open_locked(s, O_RDWR | O_CREAT) || check_unfinished(s))
        return TOOL_USAGE;
    if (ftruncate(s->file, 0) != 0)
        return unwritten(s);
    return write_side(s, "") ? TOOL_USAGE : init(s);
}

int store_resume(store *s, const char *name) {
    struct stat found;
    measure(s, name);
    if (open_locked(s, O_RDWR) || check_side(s))
        return TOOL_USAGE;
    /* It was left before there were records. */
    if (fstat(s->file, &found) == 0 && (uint64_t)found.st_size <= s->header)
        return init(s);
    return check_file(s) ? TOOL_USAGE : map(s);
}

int store_attach(store *s, const char *name) {
    measure(s, name);
    s->file = open(s->name, O_RDONLY | O_CLOEXEC);
    if (s->file < 0)
        return tool_refuse("%s cannot be read: %s", s->name, strerror(errno));
    return check_side(s) || check_file(s) ? TOOL_USAGE : map(s);
}

/* Pages that were looked at on the way to a member are given back: memory does
   not grow with the file. */
static void forget_before(const store *s, size_t at) {
    size_t size = (size_t)sysconf(_SC_PAGESIZE);
    madvise((void *)s->map, at / size * size, MADV_DONTNEED);
}

nevh_member_status store_status(const store *s, uint64_t member) {
    uint64_t i = member - s->first;
    size_t at = (size_t)(s->header + i * s->record);
    if (i % FORGET == 0)
        forget_before(s, at);
    return (nevh_member_status)s->map[at];
}

static int add_reason(store *s, const nevh_sweep_result *r) {
    if (s->reasons++ >= MOST_REASONS)
        return TOOL_OK;
    char *line = text_print("%" PRIu64 ": %s\n", r->member, r->message);
    int file = open(s->side, O_WRONLY | O_APPEND | O_CLOEXEC);
    size_t count = strlen(line);
    bool written = file >= 0 && write(file, line, count) == (ssize_t)count;
    int status = written ? TOOL_OK
                         : tool_refuse("%s cannot be written: %s", s->side,
                                       strerror(errno));
    if (file >= 0)
        close(file);
    free(line);
    return status;
}

/* Little-endian, whatever the machine. */
static void put(char *to, double number) {
    uint64_t bits;
    if (isnan(number))
        bits = 0x7FF8000000000000u; /* there are many; one is written */
    else
        memcpy(&bits, &number, sizeof bits);
    for (int i = 0; i < 8; i++)
        to[i] = (char)(bits >> 8 * i & 0xFF);
}

int store_write(store *s, const nevh_sweep_result *r) {
    uint64_t at = s->header + (r->member - s->first) * s->record;
    unsigned char status = (unsigned char)r->status;
    memset(s->bytes, 0, 8);
    for (size_t k = 0; k < s->columns->count; k++)
        put(s->bytes + 8 + 8 * k, r->values[k]);
    if (r->status != NEVH_MEMBER_DONE && add_reason(s, r))
        return TOOL_USAGE;
    return write_at(s, s->bytes, s->record, at) && write_at(s, &status, 1, at)
               ? TOOL_OK
               : unwritten(s);
}

/* Reasons. */

typedef struct {
    uint64_t member;
    size_t order;
    char *line;
} reason;

static int by_member(const void *a, const void *b) {
    const reason *x = a, *y = b;
    if (x->member != y->member)
        return x->member < y->member ? -1 : 1;
    return x->order < y->order ? -1 : 1;
}

/* Lines in order of members, the last one of each that is still not done. */
static char *sorted(const store *s, char *lines) {
    size_t count = 0, room = 0;
    reason *all = NULL;
    for (char *line = strtok(lines, "\n"); line; line = strtok(NULL, "\n")) {
        uint64_t member;
        if (sscanf(line, "%" SCNu64 ":", &member) != 1 || member < s->first ||
            member - s->first >= s->count ||
            store_status(s, member) == NEVH_MEMBER_DONE)
            continue;
        if (count == room)
            all = tool_enlarge(all, room = 2 * room + 64, sizeof *all);
        all[count] = (reason){member, count, line};
        count++;
    }
    if (count)
        qsort(all, count, sizeof *all, by_member);
    size_t length = 0;
    for (size_t i = 0; i < count; i++)
        length += strlen(all[i].line) + 1;
    char *text = tool_allocate(length + 1, 1), *to = text;
    for (size_t i = 0; i < count; i++)
        if (i + 1 == count || all[i + 1].member != all[i].member)
            to += sprintf(to, "%s\n", all[i].line);
    free(all);
    return text;
}

int store_finish(store *s) {
    char *text = read_side(s->side);
    char *lines = text ? strstr(text, reasons_begin) : NULL;
    int status = TOOL_OK;
    if (lines) {
        char *reasons = sorted(s, lines + strlen(reasons_begin));
        status = write_side(s, reasons);
        free(reasons);
    }
    free(text);
    return !status && fsync(s->file) ? unwritten(s) : status;
}

void store_close(store *s) {
    if (s->map)
        munmap((void *)s->map, s->mapped);
    if (s->name && s->file >= 0)
        close(s->file);
    free(s->name);
    free(s->side);
    free(s->bytes);
}

/* Shards. */

static int copy_records(store *to, const store *from) {
    enum { MUCH = 1 << 20 };
    size_t size = from->record * from->count;
    uint64_t at = to->header + (from->first - to->first) * to->record;
    const char *records = (const char *)from->map + from->header;
    for (size_t done = 0; done < size; done += MUCH) {
        size_t now = size - done < MUCH ? size - done : MUCH;
        if (!write_at(to, records + done, now, at + done))
            return unwritten(to);
    }
    return TOOL_OK;
}

/* The reasons that the shard has. */
static int copy_reasons(const store *to, const store *from) {
    char *text = read_side(from->side);
    const char *lines = text ? strstr(text, reasons_begin) : NULL;
    FILE *f = lines ? fopen(to->side, "ae") : NULL;
    bool written = f && fputs(lines + strlen(reasons_begin), f) >= 0;
    written = f && fclose(f) == 0 && written;
    free(text);
    return written || !lines ? TOOL_OK
                             : tool_refuse("%s cannot be written: %s", to->side,
                                           strerror(errno));
}

int store_take(store *to, const char *shard, uint64_t first, uint64_t count) {
    store from = {.columns = to->columns,
                  .settings = to->settings,
                  .story = to->story,
                  .first = first,
                  .count = count};
    int status = store_resume(&from, shard);
    uint64_t missing = 0;
    for (uint64_t i = 0, next; !status && i < count; i = next) {
        next = store_next(&from, i);
        missing += next - i;
        if (next == i && next < count)
            missing +=
                store_status(&from, first + next++) == NEVH_MEMBER_MISSING;
    }
    if (missing)
        status = tool_refuse("%s lacks %" PRIu64 " of its %" PRIu64
                             " members: go on with --resume %s",
                             shard, missing, count, shard);
    if (!status)
        status = copy_records(to, &from);
    if (!status)
        status = copy_reasons(to, &from);
    store_close(&from);
    return status;
}
