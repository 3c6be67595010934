/* nevh sweep: the header of a file, its records, and blocks of them.

   They are read, not mapped: a file that another program cuts, or a disk that is
   full where a file has a hole, would end a program that reads a map.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "store.h"
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

enum { ALIGNED = 64 };
enum { BLOCK_BYTES = 1 << 18, DIGEST_BYTES = 7, BEFORE_VALUES = 8 };

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
        text_extend(&all,
                    code == '\'' || code == '\\' ? "\\%c"
                    : code < 0x7F                ? "%c"
                    : code < 0x10000             ? "\\u%04x"
                                                 : "\\U%08x",
                    code);
    }
    text_extend(&all, "'");
    return all;
}

char *store_header(store *s) {
    char *fields = text_print("%s", "('status', '|u1'), ('', '|V7')");
    for (size_t i = 0; i < s->columns->count; i++)
        text_extend(&fields, ", (%s, '<f8')", python_text(s->columns->item[i]));
    char *text = text_print("{'descr': [%s], 'fortran_order': False, 'shape': "
                            "(%" PRIu64 ",), }",
                            fields, s->count);
    size_t length = strlen(text);
    s->header = (STORE_BEFORE_TEXT + length + ALIGNED) / ALIGNED * ALIGNED;
    char *all = tool_allocate(s->header, 1);
    size_t rest = s->header - STORE_BEFORE_TEXT;
    memcpy(all, "\x93NUMPY\x02\x00", 8);
    for (int i = 0; i < 4; i++)
        all[8 + i] = (char)(rest >> 8 * i & 0xFF);
    memset(all + STORE_BEFORE_TEXT, ' ', rest);
    memcpy(all + STORE_BEFORE_TEXT, text, length);
    all[s->header - 1] = '\n';
    return all;
}

/* Records. */

/* Little-endian, whatever the machine. */
static void put(unsigned char *to, uint64_t bits, int bytes) {
    for (int i = 0; i < bytes; i++)
        to[i] = (unsigned char)(bits >> 8 * i & 0xFF);
}

static uint64_t get(const unsigned char *from, int bytes) {
    uint64_t bits = 0;
    for (int i = 0; i < bytes; i++)
        bits |= (uint64_t)from[i] << 8 * i;
    return bits;
}

/* There are many bit patterns that are NaN; one is written. */
static uint64_t bits_of(double number) {
    uint64_t bits = 0x7FF8000000000000u;
    if (!isnan(number))
        memcpy(&bits, &number, sizeof bits);
    return bits;
}

/* Digest of member, status and values; its 7 bytes are not all 0, as they are in
   records of versions that wrote none. */
static uint64_t digest_of(const store *s, const unsigned char record[],
                          uint64_t member) {
    unsigned char number[8];
    put(number, member, 8);
    uint64_t d = digest_add(digest_begin(), number, sizeof number);
    d = digest_add(d, record, 1);
    d = digest_add(d, record + BEFORE_VALUES, s->record - BEFORE_VALUES);
    d &= UINT64_MAX >> 8;
    return d ? d : 1;
}

void record_write(const store *s, unsigned char record[],
                  const nevh_sweep_result *r) {
    record[0] = (unsigned char)r->status;
    for (size_t k = 0; k < s->columns->count; k++)
        put(record + BEFORE_VALUES + 8 * k, bits_of(r->values[k]), 8);
    put(record + 1, digest_of(s, record, r->member), DIGEST_BYTES);
}

nevh_member_status record_read(const store *s, const unsigned char record[],
                               uint64_t member, double values[]) {
    uint64_t digest = get(record + 1, DIGEST_BYTES);
    for (size_t k = 0; values && k < s->columns->count; k++) {
        uint64_t bits = get(record + BEFORE_VALUES + 8 * k, 8);
        memcpy(&values[k], &bits, sizeof bits);
    }
    bool whole = record[0] <= NEVH_MEMBER_NO_START &&
                 (digest == 0 || digest == digest_of(s, record, member));
    return whole ? (nevh_member_status)record[0] : NEVH_MEMBER_MISSING;
}

bool block_reach(store_block *b, int file, uint64_t header, size_t record,
                 uint64_t all, uint64_t i) {
    uint64_t most = BLOCK_BYTES / record + 1;
    if (i >= b->first && i - b->first < b->count)
        return true;
    if (!b->bytes)
        b->bytes = tool_allocate(most, record);
    b->first = i / most * most;
    b->count = 0;
    uint64_t wanted = all - b->first < most ? all - b->first : most;
    size_t size = (size_t)wanted * record, done = 0;
    while (done < size) {
        ssize_t now = pread(file, b->bytes + done, size - done,
                            (off_t)(header + b->first * record + done));
        if (now < 0 && errno == EINTR)
            continue;
        if (now == 0)
            errno = EIO; /* it was cut */
        if (now <= 0)
            return false;
        done += (size_t)now;
    }
    b->count = wanted;
    return true;
}
