/* nevh: the tokens of a formula.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include "system/print_private.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DIGITS = 300 }; /* of one number */

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

static void skip_space(nevh__scanner *s) {
    for (;; s->column++)
        if (*s->at && strchr(" \t\r\n", *s->at))
            s->at++;
        else if (strncmp(s->at, "\xC2\xA0", 2) == 0) /* no-break space */
            s->at += 2;
        else
            return;
}

/* Bytes of an exponent, e-3, or 0. */
static size_t exponent_bytes(const char *at) {
    if (*at != 'e' && *at != 'E')
        return 0;
    size_t sign = at[1] == '+' || at[1] == '-';
    size_t bytes = 1 + sign;
    while (is_digit(at[bytes]))
        bytes++;
    return bytes > 1 + sign ? bytes : 0;
}

/* Digits are handed on without a decimal point, the exponent accordingly
   smaller: the locale's point does not matter. */
static double convert(const char *at, size_t mantissa, long exponent) {
    char text[DIGITS + 32];
    size_t digits = 0;
    bool fraction = false;
    for (size_t i = 0; i < mantissa; i++) {
        if (at[i] == '.')
            fraction = true;
        else
            text[digits++] = at[i];
        exponent -= fraction && at[i] != '.';
    }
    snprintf(text + digits, sizeof text - digits, "e%ld", exponent);
    return nevh__read_number(text);
}

static long exponent_of(const char *at, size_t bytes) {
    long value = 0, most = 99999;
    for (size_t i = 1; i < bytes; i++)
        if (is_digit(at[i]))
            value = value < most ? 10 * value + (at[i] - '0') : most;
    return bytes > 1 && at[1] == '-' ? -value : value;
}

static void scan_number(nevh__scanner *s, nevh__token *token) {
    const char *end = s->at;
    while (is_digit(*end))
        end++;
    if (*end == '.' && end[1] != '.') /* not 1..N */
        while (is_digit(*++end))
            continue;
    size_t mantissa = (size_t)(end - s->at), tail = exponent_bytes(end);
    token->bytes = token->length = mantissa + tail;
    token->kind = NEVH__NUMERAL;
    bool fits = mantissa <= DIGITS;
    if (fits)
        token->number = convert(s->at, mantissa, exponent_of(end, tail));
    if (fits && isfinite(token->number))
        return;
    token->kind = NEVH__INVALID;
    nevh__formula_fail(s->error, NEVH_EINVAL, token->column, token->length,
                       fits ? "this number is too large"
                            : "this number has too many digits");
}

static void scan_word(nevh__scanner *s, nevh__token *token) {
    const char *at = s->at;
    uint32_t code;
    size_t bytes = nevh__character(at, &code);
    while (bytes && (nevh__is_letter(code) || (code < 128 && is_digit(*at)))) {
        at += bytes;
        token->length++;
        bytes = nevh__character(at, &code);
    }
    token->bytes = (size_t)(at - s->at);
    token->kind = NEVH__WORD;
    if (token->bytes <= NEVH__NAME_LENGTH)
        return;
    token->kind = NEVH__INVALID;
    nevh__formula_fail(s->error, NEVH_EINVAL, token->column, token->length,
                       "this name is longer than %d bytes", NEVH__NAME_LENGTH);
}

/* The correction to suggest for a character without a meaning. */
static const char *instead(uint32_t code) {
    static const struct {
        uint32_t code;
        const char *text;
    } known[] = {
        {0x2212, "this is not the minus sign of the keyboard: write -"},
        {0x2010, "this is a hyphen: write -"},
        {0x2011, "this is a hyphen: write -"},
        {0x2013, "this is a dash: write -"},
        {0x2014, "this is a dash: write -"},
        {0xD7, "this is a multiplication sign: write *"},
        {0xB7, "this is a multiplication sign: write *"},
        {0x22C5, "this is a multiplication sign: write *"},
        {0x2217, "this is a multiplication sign: write *"},
        {0xF7, "this is a division sign: write /"},
        {0x2215, "this is a division sign: write /"},
        {0xB2, "write ^2"},
        {0xB3, "write ^3"},
        {0x221A, "write sqrt(...)"},
        {0x2211, "write sum(i = 1..N, ...)"},
        {0x2026, "write .. between the ends of a range"},
        {'%', "for a remainder write mod(a, b)"},
        {'|', "for an absolute value write abs(...)"},
        {'{', "write ( and )"},
        {'}', "write ( and )"},
        {'!', "there is no factorial"},
        {'<', "a formula has no comparisons"},
        {'>', "a formula has no comparisons"},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (known[i].code == code)
            return known[i].text;
    return "this character has no meaning in a formula";
}

static void scan_sign(nevh__scanner *s, nevh__token *token) {
    uint32_t code;
    token->bytes = nevh__character(s->at, &code);
    token->length = 1;
    token->kind = NEVH__INVALID;
    bool power = strncmp(s->at, "**", 2) == 0;
    bool dots = strncmp(s->at, "..", 2) == 0;
    if (power || dots) {
        token->bytes = token->length = 2;
        token->kind = power ? '^' : NEVH__DOTS;
    } else if (strchr("+-*/^()[],=", *s->at)) {
        token->kind = *s->at;
    } else if (token->bytes) {
        nevh__formula_fail(s->error, NEVH_EINVAL, token->column, 1, "%s",
                           instead(code));
    } else {
        nevh__formula_fail(s->error, NEVH_EINVAL, token->column, 1,
                           "this is not UTF-8");
    }
}

nevh__token nevh__scan(nevh__scanner *s) {
    skip_space(s);
    nevh__token token = {.at = s->at, .column = s->column};
    uint32_t code;
    nevh__character(s->at, &code);
    if (!*s->at)
        token.kind = NEVH__END;
    else if (is_digit(*s->at) || (*s->at == '.' && is_digit(s->at[1])))
        scan_number(s, &token);
    else if (nevh__is_letter(code))
        scan_word(s, &token);
    else
        scan_sign(s, &token);
    s->at += token.bytes;
    s->column += token.length;
    return token;
}
