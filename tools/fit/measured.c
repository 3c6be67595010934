/* nevh: measured points.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "measured.h"
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { NOT_USED = -1, TIME = -2, SIGMA = -3, SIGMA_OF_ONE = -4 };
enum { MOST_BYTES = 1 << 28 };

typedef struct {
    measured *m;
    const plan *plan;
    const list *named; /* NULL: the scene's names, and t */
    list header;
    int *use; /* of each field: a column, or one of the above */
    size_t *sigma_of;
    size_t line;
    bool sigmas;
} reader_of_points;

/* Text. */

/* NULL with errno; as a scene, a pipe is not waited for without end. */
static FILE *open_data(const char *file) {
    enum { LONGEST = 10000 }; /* milliseconds */
    int opened = open(file, O_RDONLY | O_NONBLOCK | O_CLOEXEC), ready = 1;
    struct pollfd one = {.fd = opened, .events = POLLIN};
    struct stat found;
    if (opened >= 0 && fstat(opened, &found) == 0 && S_ISFIFO(found.st_mode))
        ready = poll(&one, 1, LONGEST);
    if (opened < 0)
        return NULL;
    if (ready > 0 && fcntl(opened, F_SETFL, O_RDONLY) == 0)
        return fdopen(opened, "r");
    close(opened);
    errno = ready ? errno : ETIMEDOUT;
    return NULL;
}

static char *whole_file(const char *name) {
    char *file = data_file(name);
    FILE *f = open_data(file);
    const char *why = f                    ? NULL
                      : errno == ETIMEDOUT ? "nothing was written to this "
                                             "pipe for 10 s"
                                           : strerror(errno);
    size_t room = 1 << 16, used = 0;
    char *text = tool_allocate(room, 1);
    for (size_t got;
         !why && (got = fread(text + used, 1, room - used - 1, f));) {
        if (memchr(text + used, '\0', got))
            why = "it is no text";
        used += got;
        if (used > MOST_BYTES)
            why = "it is longer than 256 MB";
        else if (room - used < 2)
            text = tool_enlarge(text, room *= 2, 1);
    }
    if (!why && ferror(f))
        why = strerror(errno);
    text[used] = '\0';
    if (f)
        fclose(f);
    if (!why)
        return text;
    tool_refuse("--data %s cannot be read: %s", name, why);
    return NULL;
}

/* The next line that is neither empty nor a remark; NULL: there is none. */
static char *next_line(char **rest, size_t *number) {
    while (*rest && **rest) {
        char *line = *rest, *end = strchr(line, '\n');
        *rest = end ? end + 1 : NULL;
        if (end)
            *end = '\0';
        ++*number;
        line[strcspn(line, "\r")] = '\0';
        line += strspn(line, " \t");
        if (*line && *line != '#')
            return line;
    }
    return NULL;
}

/* Fields between commas, in quotes where they hold some. */
static void split(list *fields, char *line) {
    for (char *at = line; at;) {
        at += strspn(at, " \t");
        bool quoted = *at == '"';
        char *field = at += quoted,
             *end = field + strcspn(field, quoted ? "\"" : ",");
        char *comma = strchr(end, ',');
        while (!quoted && end > field && strchr(" \t", end[-1]))
            end--;
        *end = '\0';
        list_add(fields, field);
        at = comma ? comma + 1 : NULL;
    }
}

/* The header. */

static bool is_known(const reader_of_points *r, const char *name) {
    const plan *p = r->plan;
    if (r->named)
        return list_has(r->named, name);
    bool momentum = strncmp(name, "p_", 2) == 0;
    for (size_t k = 0; k < p->n; k++) {
        const char *x = nevh_scene_coordinate(p->scene, k);
        if (strcmp(name, x) == 0 || (momentum && strcmp(name + 2, x) == 0))
            return true;
    }
    const char *shown;
    for (size_t i = 0;
         (shown = nevh_scene_shown_name(p->scene, NEVH_OBSERVABLES, i)); i++)
        if (strcmp(name, shown) == 0)
            return true;
    return false;
}

static int use_of(reader_of_points *r, const list *only, const char *name) {
    measured *m = r->m;
    if (strcmp(name, "t") == 0 && !r->named)
        return TIME;
    if (strcmp(name, "sigma") == 0)
        return SIGMA;
    if (strncmp(name, "sigma_", 6) == 0)
        return SIGMA_OF_ONE;
    if (only->count && !list_has(only, name))
        return NOT_USED;
    if (!is_known(r, name) && !only->count) {
        list_add(&m->left_out, name);
        return NOT_USED;
    }
    list_add(&m->names, name);
    return (int)m->names.count - 1;
}

static int known_names(const reader_of_points *r, const char *name) {
    const plan *p = r->plan;
    const char *file = r->m->file;
    list known = {0};
    for (size_t i = 0; r->named && i < r->named->count; i++)
        list_add(&known, r->named->item[i]);
    for (size_t k = 0; !r->named && k < p->n; k++) {
        list_add(&known, nevh_scene_coordinate(p->scene, k));
        list_print(&known, "p_%s", nevh_scene_coordinate(p->scene, k));
    }
    for (size_t i = 0;
         !r->named && nevh_scene_shown_name(p->scene, NEVH_OBSERVABLES, i); i++)
        list_add(&known, nevh_scene_shown_name(p->scene, NEVH_OBSERVABLES, i));
    char *all = list_joined(&known);
    int status =
        name ? tool_refuse("--data %s: the scene has no %s to compare the "
                           "column of that name with; it has %s",
                           file, name, all)
             : tool_refuse("--data %s: no column is one of %s: %s", file,
                           r->named ? "these" : "the scene's", all);
    return status;
}

static int check_only(const reader_of_points *r, const list *only) {
    const measured *m = r->m;
    for (size_t i = 0; i < only->count; i++) {
        const char *name = only->item[i];
        if (!list_has(&r->header, name))
            return tool_refuse("--columns: %s has no column %s", m->file, name);
        if (!is_known(r, name))
            return known_names(r, name);
    }
    return m->names.count ? TOOL_OK : known_names(r, NULL);
}

static int check_header(const reader_of_points *r, const list *only) {
    const list *h = &r->header;
    list seen = {0};
    int status = TOOL_OK;
    for (size_t i = 0; !status && i < h->count; i++) {
        if (list_has(&seen, h->item[i]))
            status = tool_refuse("%s:%zu: there are two columns %s", r->m->file,
                                 r->line, h->item[i]);
        list_add(&seen, h->item[i]);
    }
    if (status)
        return status;
    if (!r->named && !list_has(h, "t"))
        return tool_refuse("%s:%zu: there is no column t; the first line names "
                           "the columns, separated by commas, as: t,%s",
                           r->m->file, r->line,
                           nevh_scene_coordinate(r->plan->scene, 0));
    return check_only(r, only);
}

static int find_sigmas(reader_of_points *r) {
    measured *m = r->m;
    for (size_t i = 0; i < r->header.count; i++) {
        const char *name = r->header.item[i];
        r->sigmas =
            r->sigmas || r->use[i] == SIGMA || r->use[i] == SIGMA_OF_ONE;
        if (r->use[i] != SIGMA_OF_ONE)
            continue;
        r->sigma_of[i] = measured_find(m, name + strlen("sigma_"));
        if (r->sigma_of[i] == m->columns &&
            !list_has(&r->header, name + strlen("sigma_")))
            return tool_refuse("%s:%zu: %s: there is no column %s", m->file,
                               r->line, name, name + strlen("sigma_"));
    }
    return TOOL_OK;
}

static int read_header(reader_of_points *r, char *line, const char *only) {
    measured *m = r->m;
    list taken = {0};
    if (only)
        list_split(&taken, only);
    split(&r->header, line);
    r->use = tool_allocate(r->header.count, sizeof *r->use);
    r->sigma_of = tool_allocate(r->header.count, sizeof *r->sigma_of);
    for (size_t i = 0; i < r->header.count; i++)
        r->use[i] = use_of(r, &taken, r->header.item[i]);
    m->columns = m->names.count;
    int status = check_header(r, &taken);
    m->period = tool_allocate(m->columns, sizeof *m->period);
    for (size_t k = 0; k < m->columns; k++)
        m->period[k] = plan_period(r->plan, m->names.item[k]);
    return status ? status : find_sigmas(r);
}

/* Rows. */

/* Squares of larger numbers overflow; larger angles have no digits left within a
   turn. */
static const double largest = 1e150, most_turns = 1e12;

static int check_size(const reader_of_points *r, size_t i, const char *text,
                      double number) {
    double period = r->use[i] >= 0 ? r->m->period[r->use[i]] : 0;
    if (period > 0 && fabs(number) > most_turns * period)
        return tool_refuse("%s:%zu: column %s: %s is so many turns that no "
                           "digits are left of the angle",
                           r->m->file, r->line, r->header.item[i], text);
    if (fabs(number) > largest)
        return tool_refuse("%s:%zu: column %s: the square of %s overflows; "
                           "take another unit",
                           r->m->file, r->line, r->header.item[i], text);
    return TOOL_OK;
}

static int read_cell(const reader_of_points *r, size_t i, const char *text,
                     double *number) {
    char *end;
    *number = strtod(text, &end);
    if (!*text)
        return tool_refuse("%s:%zu: column %s: a value is missing; leave out "
                           "the row, or the column",
                           r->m->file, r->line, r->header.item[i]);
    if (end == text || *end || !isfinite(*number))
        return tool_refuse("%s:%zu: column %s: \"%s\" is no number", r->m->file,
                           r->line, r->header.item[i], text);
    if ((r->use[i] == SIGMA || r->use[i] == SIGMA_OF_ONE) && !(*number > 0))
        return tool_refuse(
            "%s:%zu: column %s: a standard deviation is above 0, "
            "not %s",
            r->m->file, r->line, r->header.item[i], text);
    return check_size(r, i, text, *number);
}

static void put_cell(const reader_of_points *r, size_t i, double number,
                     double *value, double *sigma, bool own[]) {
    measured *m = r->m;
    if (r->use[i] == TIME)
        m->t[m->points] = number;
    if (r->use[i] >= 0)
        value[r->use[i]] = number;
    if (r->use[i] == SIGMA_OF_ONE && r->sigma_of[i] < m->columns) {
        sigma[r->sigma_of[i]] = number;
        own[r->sigma_of[i]] = true;
    }
    for (size_t k = 0; r->use[i] == SIGMA && k < m->columns; k++)
        if (!own[k])
            sigma[k] = number;
}

static int read_row(reader_of_points *r, char *line, bool own[]) {
    measured *m = r->m;
    list fields = {0};
    int status = TOOL_OK;
    split(&fields, line);
    if (fields.count != r->header.count)
        status = tool_refuse("%s:%zu: %zu values, and there are %zu columns",
                             m->file, r->line, fields.count, r->header.count);
    m->t = tool_enlarge(m->t, m->points + 1, sizeof *m->t);
    m->t[m->points] = 0;
    m->value =
        tool_enlarge(m->value, (m->points + 1) * m->columns, sizeof *m->value);
    m->sigma =
        tool_enlarge(m->sigma, (m->points + 1) * m->columns, sizeof *m->sigma);
    double *value = m->value + m->points * m->columns;
    double *sigma = m->sigma + m->points * m->columns;
    memset(own, 0, m->columns * sizeof *own);
    memset(sigma, 0, m->columns * sizeof *sigma);
    for (size_t i = 0; !status && i < fields.count; i++) {
        double number = 0;
        if (r->use[i] != NOT_USED)
            status = read_cell(r, i, fields.item[i], &number);
        put_cell(r, i, number, value, sigma, own);
    }
    for (size_t k = 0; !status && r->sigmas && k < m->columns; k++)
        if (!(sigma[k] > 0))
            status = tool_refuse("%s: column %s has no standard deviation: "
                                 "give sigma_%s, or sigma for all",
                                 m->file, m->names.item[k], m->names.item[k]);
    if (!status && !r->named && m->t[m->points] < r->plan->run->t_start)
        status = tool_refuse("%s:%zu: t = %g is before the run begins, at %g",
                             m->file, r->line, m->t[m->points],
                             r->plan->run->t_start);
    m->points += !status;
    return status;
}

typedef struct {
    double t;
    size_t at; /* in the file */
} place_in_time;

static int earlier(const void *a, const void *b) {
    const place_in_time *x = a, *y = b;
    return x->t != y->t ? (x->t > y->t) - (x->t < y->t)
                        : (x->at > y->at) - (x->at < y->at);
}

/* Rows of a table in that order. */
static double *reordered(double *from, const place_in_time order[], size_t rows,
                         size_t columns) {
    double *to = tool_allocate(rows * columns, sizeof *to);
    for (size_t i = 0; i < rows; i++)
        memcpy(to + i * columns, from + order[i].at * columns,
               columns * sizeof *to);
    return to;
}

/* In the order of time; points of one time as in the file. */
static void sort(measured *m) {
    place_in_time *order = tool_allocate(m->points, sizeof *order);
    for (size_t i = 0; i < m->points; i++)
        order[i] = (place_in_time){m->t[i], i};
    qsort(order, m->points, sizeof *order, earlier);
    m->t = reordered(m->t, order, m->points, 1);
    m->value = reordered(m->value, order, m->points, m->columns);
    m->sigma = reordered(m->sigma, order, m->points, m->columns);
}

static int read_text(reader_of_points *r, char *text, const char *only) {
    static const char bom[] = "\xEF\xBB\xBF"; /* as spreadsheets begin UTF-8 */
    char *rest = text + (strncmp(text, bom, 3) == 0 ? 3 : 0);
    char *line = next_line(&rest, &r->line);
    if (!line)
        return tool_refuse("--data %s is empty", r->m->file);
    int status = read_header(r, line, only);
    bool *own = tool_allocate(r->m->columns, sizeof *own);
    while (!status && (line = next_line(&rest, &r->line)))
        status = read_row(r, line, own);
    if (!status && !r->m->points)
        status = tool_refuse("--data %s has no rows", r->m->file);
    if (!status)
        sort(r->m);
    return status;
}

static int read_file_of(measured *m, const plan *p, const options *o,
                        const list *named, const char *only) {
    reader_of_points r = {.m = m, .plan = p, .named = named};
    *m = (measured){.file = o->fit.data};
    char *text = whole_file(o->fit.data);
    int status = text ? read_text(&r, text, only) : TOOL_USAGE;
    if (!r.sigmas)
        m->sigma = NULL;
    return status;
}

int measured_read(measured *m, const plan *p, const options *o,
                  const char *only) {
    return read_file_of(m, p, o, NULL, only);
}

int measured_read_named(measured *m, const plan *p, const options *o,
                        const list *names) {
    return read_file_of(m, p, o, names, NULL);
}

size_t measured_find(const measured *m, const char *name) {
    size_t k = 0;
    while (k < m->columns && strcmp(m->names.item[k], name) != 0)
        k++;
    return k;
}

double measured_residual(const measured *m, size_t point, size_t column,
                         double model) {
    double r = m->value[point * m->columns + column] - model;
    double period = m->period[column];
    return period > 0 ? r - period * round(r / period) : r;
}

void measured_bound(measured *m, plan *p, const options *o) {
    while (o->t_end && m->points && m->t[m->points - 1] > p->t_end) {
        m->points--;
        m->late++;
    }
    if (!o->t_end && m->points)
        p->t_end = m->t[m->points - 1];
}

row_times measured_times(const measured *m) {
    return (row_times){.by = BY_TIMES, .count = m->points, .time = m->t};
}

void measured_note(const measured *m, list *notes) {
    char *names = list_joined(&m->names), *others = list_joined(&m->left_out);
    list_print(notes, "measured: %zu points of %s in %s", m->points, names,
               m->file);
    if (m->left_out.count)
        list_print(notes, "left out, the scene has none of that name: %s",
                   others);
    if (m->late)
        list_print(notes, "left out, after the end: %zu points", m->late);
}
