/* nevh sweep: a file of records.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "store.h"
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_REASONS = 1000 };
static const char magic[] = "nevh sweep, 1\n";
static const char reasons_begin[] = "\n[not done]\n";

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

static uint64_t whole_size(const store *s) {
    return s->header + s->record * s->count;
}

static void measure(store *s, const char *name) {
    s->name = text_print("%s", name);
    s->side = text_print("%s" ARRAY_TEXT_ENDING, name);
    s->place = s->side;
    s->record = 8 + 8 * s->columns->count;
    s->bytes = tool_allocate(s->record, 1);
    pthread_mutex_init(&s->block.lock, NULL);
}

/* As long as the whole file.  A file of a usual size takes all its space at once, so
   that no record lacks it later; one of very many members has holes. */
static bool reserve(const store *s) {
    const off_t usual = (off_t)1 << 30;
    off_t size = (off_t)whole_size(s);
    if (size <= usual && fallocate(s->file, 0, 0, size) == 0)
        return true;
    return (size > usual || errno == EOPNOTSUPP || errno == ENOSYS) &&
           ftruncate(s->file, size) == 0;
}

/* Header and records without status; the file is empty. */
static int init(store *s) {
    char *header = store_header(s);
    bool written = reserve(s) && write_at(s, header, s->header, 0);
    int wrong = errno;
    if (written)
        return TOOL_OK;
    if (ftruncate(s->file, 0) != 0)
        wrong = errno;
    return tool_refuse("%s cannot be written: %s", s->name, strerror(wrong));
}

/* The side file. */

static char *read_side(const char *side) {
    return file_read(regular_open(side), NULL);
}

static void print_side(const store *s, const char *reasons, FILE *f) {
    fprintf(f, "%s%smembers_here: %" PRIu64 " from %" PRIu64 "\n%s%s%s", magic,
            s->settings, s->count, s->first, s->story, reasons_begin, reasons);
}

static int write_side(const store *s, const char *reasons) {
    output out;
    if (output_open(&out, s->place))
        return TOOL_USAGE;
    print_side(s, reasons, out.stream);
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
    int status = compare_settings(s, read_side(s->side) + strlen(magic));
    if (!status && (first != s->first || count != s->count))
        status = tool_refuse("%s has members %" PRIu64 " ... %" PRIu64
                             ", not %" PRIu64 " ... %" PRIu64,
                             s->name, first, first + count - 1, s->first,
                             s->first + s->count - 1);
    return status;
}

/* Checks that a file has this store's header and length. */
static int check_file(store *s) {
    struct stat found;
    char *header = store_header(s), *there = tool_allocate(s->header, 1);
    bool same = fstat(s->file, &found) == 0 && S_ISREG(found.st_mode);
    uint64_t size = same ? (uint64_t)found.st_size : 0;
    same = same && pread(s->file, there, s->header, 0) == (ssize_t)s->header &&
           memcmp(header, there, s->header) == 0;
    if (!same)
        return tool_refuse("%s is no file of this sweep: its header is another",
                           s->name);
    return size == whole_size(s)
               ? TOOL_OK
               : tool_refuse("%s has %" PRIu64 " bytes instead of %" PRIu64
                             ": it was cut, or added to",
                             s->name, size, whole_size(s));
}

static const char writer[] = "sweep";

static int not_on_a_disk(const store *s) {
    return tool_refuse("%s is no file on a disk, as an array must be", s->name);
}

static int open_locked(store *s) {
    s->file = open(s->name, O_RDWR | O_CLOEXEC);
    if (s->file < 0)
        return tool_refuse("there is nothing to resume: %s: %s", s->name,
                           strerror(errno));
    if (!file_is_regular(s->file))
        return not_on_a_disk(s);
    if (flock(s->file, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK)
        return tool_refuse("%s: another %s is writing it", s->name, writer);
    return TOOL_OK;
}

uint64_t store_next(const store *s, uint64_t i) {
    return store_skip_hole(s->file, s->header, s->record, i, s->count);
}

/* True if some of the records are done and some are not. */
static bool is_begun(int file, uint64_t header, size_t record, uint64_t count) {
    store_block b = {.bytes = NULL};
    bool done = false, missing = false;
    for (uint64_t i = 0; i < count && !(done && missing); i++) {
        if (!block_reach(&b, file, header, record, count, i))
            break;
        unsigned char status = b.bytes[(i - b.first) * record];
        bool known = status && status <= NEVH_MEMBER_NO_START;
        *(known ? &done : &missing) = true;
        uint64_t next = store_skip_hole(file, header, record, i + 1, count);
        missing |= next > i + 1;
        i = next - 1;
    }
    return done && missing;
}

/* A sweep that was left is not thrown away by chance. */
static int check_unfinished(const store *s, int file) {
    uint64_t first, count;
    char *text = read_side(s->side);
    bool ours = text && strncmp(text, magic, strlen(magic)) == 0;
    struct stat found;
    if (!ours || fstat(file, &found) != 0 ||
        store_range(s->name, &first, &count))
        return TOOL_OK;
    unsigned char begin[STORE_BEFORE_TEXT];
    if (pread(file, begin, sizeof begin, 0) != (ssize_t)sizeof begin)
        return TOOL_OK;
    uint64_t header = STORE_BEFORE_TEXT + begin[8] + ((uint64_t)begin[9] << 8) +
                      ((uint64_t)begin[10] << 16);
    uint64_t size = (uint64_t)found.st_size;
    uint64_t record = count && size > header ? (size - header) / count : 0;
    return record && is_begun(file, header, record, count)
               ? tool_refuse("%s is an unfinished sweep: go on with --resume "
                             "%s, or remove it",
                             s->name, s->name)
               : TOOL_OK;
}

/* The side file beside it, written to the disk. */
static int begin_side(store *s) {
    if (output_open(&s->text, s->side))
        return TOOL_USAGE;
    s->place = s->text.temporary ? s->text.temporary : s->side;
    print_side(s, "", s->text.stream);
    if (!fflush(s->text.stream) && !ferror(s->text.stream))
        return TOOL_OK;
    int wrong =
        tool_refuse("%s cannot be written: %s", s->side, strerror(errno));
    output_close(&s->text, TOOL_USAGE);
    return wrong;
}

static int begin_array(store *s) {
    s->file = fcntl(fileno(s->array.stream), F_DUPFD_CLOEXEC, 0);
    if (!s->array.locks || !file_is_regular(s->file))
        return not_on_a_disk(s);
    return check_unfinished(s, s->array.former) ? TOOL_USAGE : init(s);
}

int store_create(store *s, const char *name) {
    struct stat found;
    measure(s, name);
    if (stat(name, &found) == 0 && !S_ISREG(found.st_mode) &&
        !S_ISDIR(found.st_mode))
        return not_on_a_disk(s);
    if (output_claim(&s->array, name, writer))
        return TOOL_USAGE;
    s->waits = !begin_array(s) && !begin_side(s);
    if (!s->waits)
        output_close(&s->array, TOOL_USAGE);
    return s->waits ? TOOL_OK : TOOL_USAGE;
}

/* The array first: one that is empty has no members of other settings, if the
   program ends between the two. */
int store_settle(store *s) {
    s->waits = false;
    s->place = s->side;
    int status = output_close(&s->array, TOOL_OK);
    return output_close(&s->text, status);
}

int store_resume(store *s, const char *name) {
    struct stat found;
    measure(s, name);
    if (open_locked(s) || check_side(s))
        return TOOL_USAGE;
    /* It was left before there were records. */
    if (fstat(s->file, &found) == 0 && (uint64_t)found.st_size <= s->header)
        return init(s);
    return check_file(s);
}

int store_attach(store *s, const char *name) {
    measure(s, name);
    s->file = open(s->name, O_RDONLY | O_CLOEXEC);
    if (s->file < 0)
        return tool_refuse("%s cannot be read: %s", s->name, strerror(errno));
    return check_side(s) || check_file(s) ? TOOL_USAGE : TOOL_OK;
}

/* Reads a member; one that cannot be read counts as missing. */
nevh_member_status store_read(store *s, uint64_t member, double values[]) {
    uint64_t i = member - s->first;
    store_block *b = &s->block;
    nevh_member_status status = NEVH_MEMBER_MISSING;
    pthread_mutex_lock(&b->lock);
    if (block_reach(b, s->file, s->header, s->record, s->count, i)) {
        const unsigned char *record = b->bytes + (i - b->first) * s->record;
        status = record_read(s, record, member, values);
        s->damaged += status == NEVH_MEMBER_MISSING && record[0];
    }
    pthread_mutex_unlock(&b->lock);
    return status;
}

static int add_reason(store *s, const nevh_sweep_result *r) {
    if (s->reasons++ >= MOST_REASONS)
        return TOOL_OK;
    char *line = text_print("%" PRIu64 ": %s\n", r->member, r->message);
    int file = open(s->place, O_WRONLY | O_APPEND | O_CLOEXEC);
    size_t count = strlen(line);
    bool written = file >= 0 && write(file, line, count) == (ssize_t)count;
    int status = written ? TOOL_OK
                         : tool_refuse("%s cannot be written: %s", s->side,
                                       strerror(errno));
    if (file >= 0)
        close(file);
    tool_release(line);
    return status;
}

/* Updates the block that was read before. */
static void refresh_block(store *s, uint64_t i) {
    store_block *b = &s->block;
    pthread_mutex_lock(&b->lock);
    if (i >= b->first && i - b->first < b->count)
        memcpy(b->bytes + (i - b->first) * s->record, s->bytes, s->record);
    pthread_mutex_unlock(&b->lock);
}

int store_write(store *s, const nevh_sweep_result *r) {
    uint64_t i = r->member - s->first, at = s->header + i * s->record;
    if (r->status != NEVH_MEMBER_DONE && add_reason(s, r))
        return TOOL_USAGE;
    record_write(s, s->bytes, r);
    unsigned char status = s->bytes[0];
    s->bytes[0] = 0;
    bool written =
        write_at(s, s->bytes, s->record, at) && write_at(s, &status, 1, at);
    s->bytes[0] = status;
    if (!written)
        return unwritten(s);
    refresh_block(s, i);
    return TOOL_OK;
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
static char *sorted(store *s, char *lines) {
    size_t count = 0;
    reason *all = NULL;
    for (char *line = strtok(lines, "\n"); line; line = strtok(NULL, "\n")) {
        uint64_t member;
        if (sscanf(line, "%" SCNu64 ":", &member) != 1 || member < s->first ||
            member - s->first >= s->count ||
            store_read(s, member, NULL) == NEVH_MEMBER_DONE)
            continue;
        all = tool_grown(all, count, sizeof *all);
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
    return text;
}

int store_finish(store *s) {
    if (s->damaged)
        tool_refuse("%s: %" PRIu64 " records were damaged after they were "
                    "written, and are run again",
                    s->name, s->damaged);
    s->damaged = 0;
    s->block.count = 0; /* other processes wrote, too */
    char *text = read_side(s->place);
    char *lines = text ? strstr(text, reasons_begin) : NULL;
    int status = TOOL_OK;
    if (lines)
        status = write_side(s, sorted(s, lines + strlen(reasons_begin)));
    return !status && fsync(s->file) ? unwritten(s) : status;
}

void store_close(store *s) {
    if (s->waits) {
        output_close(&s->array, TOOL_USAGE);
        output_close(&s->text, TOOL_USAGE);
    }
    if (s->name && s->file >= 0)
        close(s->file);
}

/* Shards. */

static int copy_records(store *to, store *from) {
    store_block *b = &from->block;
    for (uint64_t i = 0; i < from->count; i = b->first + b->count) {
        uint64_t at = (from->first + i - to->first) * to->record;
        if (!block_reach(b, from->file, from->header, from->record, from->count,
                         i))
            return tool_refuse("%s cannot be read: %s", from->name,
                               strerror(errno));
        if (!write_at(to, b->bytes, b->count * from->record, to->header + at))
            return unwritten(to);
    }
    return TOOL_OK;
}

/* The reasons that the shard has. */
static int copy_reasons(const store *to, const store *from) {
    char *text = read_side(from->side);
    const char *lines = text ? strstr(text, reasons_begin) : NULL;
    FILE *f = lines ? fopen(to->place, "ae") : NULL;
    bool written = f && fputs(lines + strlen(reasons_begin), f) >= 0;
    written = f && fclose(f) == 0 && written;
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
                store_read(&from, first + next++, NULL) == NEVH_MEMBER_MISSING;
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
