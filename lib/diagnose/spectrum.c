/* nevh: lines of a spectrum: the largest one is taken off the samples, then the next,
   and all are fitted together.

   Samples are at equal times: cosines and sines of a line are those of a few times,
   turned by a few angles.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/spectrum_private.h"
#include "system/system_private.h"
#include <gsl/gsl_fft_real.h>
#include <nevh/simd.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ORDER = 5, ROUNDS = 20 };
enum { ROW = 4 * NEVH__LANES }; /* samples at a time */
static const double pi = 3.14159265358979323846;

static double *row_of(const nevh__spectrum *a, size_t i) {
    return a->rows + i * a->padded;
}

/* Turns `count` cosines and sines by one angle. */
NEVH_SIMD static void spectrum_turn(size_t count, double angle,
                                    const double by_c[], const double by_s[],
                                    double cosine[], double sine[]) {
    double c = cos(angle), s = sin(angle);
    NEVH_LANES(i, count) {
        cosine[i] = c * by_c[i] - s * by_s[i];
        sine[i] = s * by_c[i] + c * by_s[i];
    }
}

/* The cosines and sines of w t: those of the first eight, turned to the next seven
   times as many, and so on, so that rounding is that of a few products. */
static void find_wave(const nevh__spectrum *a, double w, double cosine[],
                      double sine[]) {
    double h = 2 * a->half / (double)(a->count - 1);
    for (size_t i = 0; i < NEVH__LANES; i++) {
        cosine[i] = cos(w * a->time[i]);
        sine[i] = sin(w * a->time[i]);
    }
    for (size_t size = NEVH__LANES; size < a->padded; size *= 8)
        for (size_t at = size; at < 8 * size && at < a->padded; at += size)
            spectrum_turn(a->padded - at < size ? a->padded - at : size,
                          w * ((double)at * h), cosine, sine, cosine + at,
                          sine + at);
}

NEVH_SIMD static void spectrum_multiply(size_t count, const double x[],
                                        const double y[], double product[]) {
    NEVH_LANES(i, count) {
        product[i] = x[i] * y[i];
    }
}

/* sum += factor x */
NEVH_SIMD static void add_times(size_t count, double factor, const double x[],
                                double sum[]) {
    NEVH_LANES(i, count) {
        sum[i] += factor * x[i];
    }
}

/* Sums that do not wait for one another. */
NEVH_SIMD static double spectrum_dot(size_t count, const double x[],
                                     const double y[]) {
    nevh__vector sum[ROW / NEVH__IN_VECTOR] = {{0}};
    double parts[ROW], all = 0;
    for (size_t k = 0; k < count; k += ROW)
        for (size_t i = 0; i < ROW / NEVH__IN_VECTOR; i++)
            sum[i] += *(const nevh__vector *)(x + k + i * NEVH__IN_VECTOR) *
                      *(const nevh__vector *)(y + k + i * NEVH__IN_VECTOR);
    memcpy(parts, sum, sizeof parts);
    for (size_t i = 0; i < ROW; i += NEVH__LANES)
        all += nevh__sum_lanes(parts + i);
    return all;
}

/* (1 + cos(pi x))^order, whose sum with the trapezoidal rule is exact. */
void nevh__spectrum_window(nevh__spectrum *a, int order) {
    double sum = 0;
    find_wave(a, pi / a->half, a->window, row_of(a, 0));
    for (size_t k = 0; k < a->padded; k++) {
        double factor = k < a->count ? 1 + a->window[k] : 0;
        a->window[k] = factor;
        for (int i = 1; i < order; i++)
            a->window[k] *= factor;
        sum += a->window[k];
        row_of(a, 0)[k] = 1;
    }
    for (size_t k = 0; k < a->count; k++)
        a->window[k] /= sum;
}

/* The transform of the rest at w, and half the slope of its square. */
static double spectrum_transform(const nevh__spectrum *a, double w,
                                 double *slope) {
    double *weighted = row_of(a, 3 * a->lines + 1), *c = weighted + a->padded,
           *s = c + a->padded;
    find_wave(a, w, c, s);
    spectrum_multiply(a->padded, a->window, a->rest, weighted);
    double re = spectrum_dot(a->padded, weighted, c),
           im = -spectrum_dot(a->padded, weighted, s);
    spectrum_multiply(a->padded, weighted, a->time, weighted);
    double dre = -spectrum_dot(a->padded, weighted, s);
    double dim = -spectrum_dot(a->padded, weighted, c);
    *slope = re * dre + im * dim;
    return re * re + im * im;
}

/* The maximum of the square between two frequencies: its derivative falls through 0
   there. NAN if it does not fall from one to the other. */
double nevh__spectrum_peak(const nevh__spectrum *a, double low, double high) {
    double at_low, at_high, at_middle;
    spectrum_transform(a, low, &at_low);
    spectrum_transform(a, high, &at_high);
    if (!(at_low > 0 && at_high < 0))
        return NAN;
    int side = 0;
    double w = (low + high) / 2;
    for (int i = 0; i < 100 && high - low > 4e-16 * high; i++) {
        w = (low * at_high - high * at_low) / (at_high - at_low);
        if (!(w > low && w < high) || i % 3 == 2)
            w = (low + high) / 2;
        spectrum_transform(a, w, &at_middle);
        if (at_middle == 0)
            break;
        if (at_middle > 0) {
            low = w;
            at_low = at_middle;
            at_high *= side == 1 ? 0.5 : 1;
            side = 1;
        } else {
            high = w;
            at_high = at_middle;
            at_low *= side == -1 ? 0.5 : 1;
            side = -1;
        }
    }
    return w;
}

static double spectrum_refine(const nevh__spectrum *a, double low,
                              double high) {
    double w = nevh__spectrum_peak(a, low, high);
    return isnan(w) ? (low + high) / 2 : w;
}

/* The width of the window's peak on either side, in w. */
double nevh__spectrum_resolution(const nevh__spectrum *a) {
    return pi / a->half;
}

/* The largest of the transform. */
static double spectrum_search(nevh__spectrum *a) {
    memset(a->power, 0, a->size * sizeof *a->power);
    for (size_t k = 0; k < a->count; k++)
        a->power[k] = a->window[k] * a->rest[k];
    gsl_fft_real_radix2_transform(a->power, 1, a->size);
    double h = 2 * a->half / (double)(a->count - 1), most = 0;
    size_t best = 1;
    for (size_t j = 1; j < a->size / 2; j++) {
        double re = a->power[j], im = a->power[a->size - j];
        if (re * re + im * im > most) {
            most = re * re + im * im;
            best = j;
        }
    }
    double unit = 2 * pi / ((double)a->size * h), w = unit * (double)best;
    return spectrum_refine(a, fmax(w - unit, unit / 8), w + unit);
}

/* The residual of all lines but `but`. */
void nevh__spectrum_take_off(nevh__spectrum *a, size_t but) {
    double *c = row_of(a, 3 * a->lines + 1), *s = c + a->padded;
    for (size_t k = 0; k < a->count; k++)
        a->rest[k] = a->values[k] - a->mean;
    for (size_t i = 0; i < a->lines; i++) {
        if (i == but)
            continue;
        find_wave(a, a->w[i], c, s);
        add_times(a->padded, -a->cosine[i], c, a->rest);
        add_times(a->padded, -a->sine[i], s, a->rest);
    }
}

/* 1, then cosine and sine of each line, then what the line changes by where its
   frequency does, in units of 1/half: rows, n of them. */
static void find_basis(const nevh__spectrum *a, size_t n) {
    size_t lines = a->lines, padded = a->padded;
    for (size_t i = 0; i < lines; i++) {
        double *c = row_of(a, 2 * i + 1), *s = c + padded;
        find_wave(a, a->w[i], c, s);
        if (n == 2 * lines + 1)
            continue;
        double *move = row_of(a, 2 * lines + 1 + i);
        memset(move, 0, padded * sizeof *move);
        add_times(padded, a->sine[i] / a->half, c, move);
        add_times(padded, -a->cosine[i] / a->half, s, move);
        spectrum_multiply(padded, a->time, move, move);
    }
}

/* Solves m x = b, m symmetric and not negative, by Cholesky's factors; b becomes x.
   An unknown that depends on those before it is left at 0, where GSL's solvers would
   call its error handler, which aborts. */
static void spectrum_solve(double m[], double b[], size_t n) {
    static const double dependent = 1e-14;
    for (size_t j = 0; j < n; j++) {
        double *row = m + j * n, own = row[j];
        for (size_t i = 0; i < j; i++) {
            for (size_t k = 0; k < i; k++)
                row[i] -= row[k] * m[i * n + k];
            row[i] = m[i * n + i] > 0 ? row[i] / m[i * n + i] : 0;
            row[j] -= row[i] * row[i];
            b[j] -= row[i] * b[i];
        }
        row[j] = row[j] > dependent * own ? sqrt(row[j]) : 0;
        b[j] = row[j] > 0 ? b[j] / row[j] : 0;
    }
    for (size_t j = n; j-- > 0;) {
        for (size_t i = j + 1; i < n; i++)
            b[j] -= m[i * n + j] * b[i];
        b[j] = m[j * n + j] > 0 ? b[j] / m[j * n + j] : 0;
    }
}

/* Mean, cosines and sines by least squares under the window; with `moves`,
   together with changes of frequencies to first order, which are in it then. */
static bool spectrum_fit(nevh__spectrum *a, double moves[]) {
    size_t n = (moves ? 3 : 2) * a->lines + 1;
    double *m = nevh__array(n * n + n, sizeof *m);
    if (!m)
        return false;
    double *b = m + n * n, *part = row_of(a, n);
    find_basis(a, n);
    for (size_t i = 0; i < n; i++) {
        spectrum_multiply(a->padded, a->window, row_of(a, i), part);
        b[i] = spectrum_dot(a->padded, part, a->values);
        for (size_t j = 0; j <= i; j++)
            m[i * n + j] = spectrum_dot(a->padded, part, row_of(a, j));
    }
    spectrum_solve(m, b, n);
    a->mean = b[0];
    for (size_t i = 0; i < a->lines; i++) {
        a->cosine[i] = b[2 * i + 1];
        a->sine[i] = b[2 * i + 2];
        if (moves)
            moves[i] = b[2 * a->lines + 1 + i] / a->half;
    }
    free(m);
    return true;
}

double nevh__spectrum_amplitude(const nevh__spectrum *a, size_t i) {
    return nevh_simd_hypot(a->cosine[i], a->sine[i]);
}

/* All lines together, as their peaks overlap: Newton's method, as long as moves
   get smaller.  They end at what rounding does. */
static bool refine_all(nevh__spectrum *a) {
    static const double still = 1e-16, slower = 0.7;
    double before = nevh__spectrum_resolution(a);
    for (int i = 0; i < ROUNDS; i++) {
        double most = 0, part = 0;
        if (!spectrum_fit(a, a->move))
            return false;
        for (size_t k = 0; k < a->lines; k++) {
            most = fmax(most, fabs(a->move[k]));
            part = fmax(part, fabs(a->move[k]) / a->w[k]);
        }
        if (!(most < before))
            break;
        for (size_t k = 0; k < a->lines; k++)
            a->w[k] =
                fmax(a->w[k] + a->move[k], nevh__spectrum_resolution(a) / 8);
        if (part < still)
            break;
        before = slower * most;
    }
    return spectrum_fit(a, NULL);
}

/* The line that came last is left out again where it and another are one. */
static bool split_line(const nevh__spectrum *a) {
    for (size_t i = 0; i < a->lines; i++)
        for (size_t k = 0; k < i; k++)
            if (fabs(a->w[i] - a->w[k]) < nevh__spectrum_resolution(a) / 2)
                return true;
    return false;
}

/* Adds a line near w.  returns  false where memory is out */
static bool add_line(nevh__spectrum *a, double w, bool *split) {
    size_t bytes = a->lines * sizeof *a->w;
    memcpy(a->before, a->w, bytes);
    a->w[a->lines++] = w;
    if (!spectrum_fit(a, NULL) || !refine_all(a))
        return false;
    *split = split_line(a);
    if (!*split)
        return true;
    a->lines--;
    memcpy(a->w, a->before, bytes);
    return spectrum_fit(a, NULL) && refine_all(a);
}

static double largest_rest(const nevh__spectrum *a) {
    double most = 0;
    for (size_t k = 0; k < a->count; k++)
        most = fmax(most, fabs(a->rest[k]) * a->window[k] * (double)a->count);
    return most;
}

/* A line that is nearer to another than can be told apart. */
static bool is_double(const nevh__spectrum *a, double w) {
    for (size_t i = 0; i < a->lines; i++)
        if (fabs(a->w[i] - w) < nevh__spectrum_resolution(a))
            return true;
    return false;
}

bool nevh__spectrum_find_lines(nevh__spectrum *a, size_t most) {
    static const double nothing = 1e-12;
    double largest = 0;
    bool split;
    for (size_t k = 0; k < a->count; k++)
        largest = fmax(largest, fabs(a->values[k]));
    nevh__spectrum_window(a, ORDER);
    if (!spectrum_fit(a, NULL))
        return false;
    while (a->lines < most) {
        nevh__spectrum_take_off(a, a->lines);
        if (!(largest_rest(a) > nothing * largest))
            break;
        double w = spectrum_search(a);
        if (is_double(a, w))
            break;
        if (!add_line(a, w, &split))
            return false;
        if (split)
            break;
    }
    return true;
}

bool nevh__spectrum_open(nevh__spectrum *a, double h, size_t count,
                         const double values[], size_t most) {
    *a = (nevh__spectrum){
        .count = count, .half = h * (double)(count - 1) / 2, .size = 1};
    while (a->size < 2 * count)
        a->size *= 2;
    a->padded = (count + ROW - 1) / ROW * ROW;
    a->rest = nevh__array((3 * most + 8) * a->padded, sizeof(double));
    a->w = nevh__array(5 * most, sizeof(double));
    a->power = nevh__array(a->size, sizeof(double));
    if (!a->rest || !a->w || !a->power)
        return false;
    a->window = a->rest + a->padded;
    a->time = a->window + a->padded;
    a->values = a->time + a->padded;
    a->rows = a->values + a->padded;
    memcpy(a->values, values, count * sizeof *values);
    for (size_t k = 0; k < a->padded; k++)
        a->time[k] = a->half * (2 * (double)k / (double)(count - 1) - 1);
    a->cosine = a->w + most;
    a->sine = a->cosine + most;
    a->move = a->sine + most;
    a->before = a->move + most;
    return true;
}

void nevh__spectrum_close(nevh__spectrum *a) {
    free(a->rest);
    free(a->w);
    free(a->power);
}
