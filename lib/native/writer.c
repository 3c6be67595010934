/* nevh: C text in the making.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/writer_private.h"
#include "system/print_private.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool writer_make_room(nevh__writer *w, size_t more) {
    size_t room = w->room ? w->room : 4096;
    while (room < w->used + more + 1)
        room *= 2;
    if (room == w->room)
        return true;
    char *text = nevh__grow(w->text, room, 1);
    if (!text)
        return false;
    w->text = text;
    w->room = room;
    return true;
}

void nevh__write(nevh__writer *w, const char *format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int length = nevh__vprint(NULL, 0, format, arguments);
    w->failed |= length < 0 || !writer_make_room(w, (size_t)length);
    if (!w->failed)
        w->used += (size_t)nevh__vprint(w->text + w->used, w->room - w->used,
                                        format, again);
    va_end(again);
    va_end(arguments);
}

void nevh__writer_free(nevh__writer *w) {
    free(w->text);
    free(w->numbers);
    free(w->names);
    free(w->own);
    *w = (nevh__writer){0};
}

void nevh__writer_append(nevh__writer *w, double x) {
    if (w->count == w->number_room) {
        size_t room = w->number_room ? 2 * w->number_room : 64;
        double *numbers = nevh__grow(w->numbers, room, sizeof *numbers);
        if (!numbers) {
            w->failed = true;
            return;
        }
        w->numbers = numbers;
        w->number_room = room;
    }
    w->numbers[w->count++] = x;
}

size_t nevh__writer_share(nevh__writer *w, size_t count, const double x[]) {
    size_t first = w->count;
    for (size_t i = 0; i < w->shared_count; i++)
        if (w->shared[i].numbers == x && w->shared[i].count == count)
            return w->shared[i].first;
    for (size_t k = 0; k < count; k++)
        nevh__writer_append(w, x[k]);
    if (w->shared_count < NEVH__MOST_SHARED)
        w->shared[w->shared_count++] = (nevh__shared_numbers){x, count, first};
    return first;
}

void nevh__number_text(double x, char name[NEVH__NAME]) {
    double found = NAN;
    /* As few digits as give it back. */
    for (int digits = 15; found != x && digits <= 17; digits++) {
        nevh__print(name, NEVH__NAME, signbit(x) ? "(%.*g" : "%.*g", digits, x);
        found = nevh__read_number(name + (name[0] == '('));
    }
    if (!strpbrk(name, ".en"))
        strcat(name, ".0");
    if (name[0] == '(')
        strcat(name, ")");
}

void nevh__write_number(nevh__writer *w, double x, char name[NEVH__NAME]) {
    if (w->readable) {
        nevh__number_text(x, name);
        return;
    }
    snprintf(name, NEVH__NAME, "N[%zu]", w->count);
    nevh__writer_append(w, x);
}

static size_t place_of_own(nevh__writer *w, const double row[], double times) {
    size_t first = w->count;
    for (size_t i = 0; i < w->own_count; i++)
        if (w->own[i].row == row && w->own[i].times == times)
            return w->own[i].first;
    if (w->own_count == w->own_room) {
        size_t room = w->own_room ? 2 * w->own_room : 16;
        nevh__lane_numbers *own = nevh__grow(w->own, room, sizeof *own);
        if (!own) {
            w->failed = true;
            return first;
        }
        w->own = own;
        w->own_room = room;
    }
    w->own[w->own_count++] = (nevh__lane_numbers){row, times, first};
    for (size_t lane = 0; lane < nevh__orbits_together(w); lane++)
        nevh__writer_append(w, times * row[lane]);
    return first;
}

void nevh__write_own(nevh__writer *w, const double row[], double times,
                     char name[NEVH__NAME]) {
    snprintf(name, NEVH__NAME, "(*(const wide *)(N + %zu))",
             place_of_own(w, row, times));
}

void nevh__write_numbers(nevh__writer *w, const char *name, size_t count,
                         const double x[]) {
    nevh__write(w, "%s[%zu] = {", name, count);
    for (size_t i = 0; i < count; i++) {
        char number[NEVH__NAME];
        nevh__number_text(x[i], number);
        nevh__write(w, "%s%s", i == 0 ? "" : i % 3 ? ", " : ",\n    ", number);
    }
    nevh__write(w, "};\n");
}

void nevh__write_filled(nevh__writer *w, const char *text,
                        const char *const words[]) {
    while (*text) {
        size_t bytes = strcspn(text, "$");
        nevh__write(w, "%.*s", (int)bytes, text);
        text += bytes;
        if (!*text)
            break;
        nevh__write(w, "%s", words[text[1] - '1']);
        text += 2;
    }
}

void nevh__write_array(nevh__writer *w, const char *name, const char *table,
                       size_t count, const double x[]) {
    if (w->readable) {
        char begin[60];
        snprintf(begin, sizeof begin, "static const double %.30s", name);
        nevh__write_numbers(w, begin, count, x);
        return;
    }
    nevh__write(w, "#define %s (%s(%s + %zu))\n", name,
                w->loops ? "(const wide *)" : "", table, w->count);
    for (size_t k = 0; k < (w->loops ? nevh__padded(count) : count); k++)
        nevh__writer_append(w, k < count ? x[k] : 0);
}

void nevh__write_constant(nevh__writer *w, const char *name, double x) {
    char number[NEVH__NAME];
    nevh__write_number(w, x, number);
    nevh__write(
        w, w->readable ? "static const double %s = %s;\n" : "#define %s %s\n",
        name, number);
}

void nevh__write_form(nevh__writer *w, const char *name) {
    if (w->readable && w->form_count < NEVH__MOST_FORMS)
        w->forms[w->form_count++] = name;
    else
        nevh__write(w, "#define %s\n", name);
}
