/* nevh: characters in UTF-8.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"

/* Bytes that a character takes which begins with this one; 0: none does. */
static size_t bytes_from(unsigned char first) {
    if (first < 0x80)
        return 1;
    if (first < 0xC2 || first > 0xF4)
        return 0;
    return first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
}

size_t nevh__character(const char *text, uint32_t *code) {
    const unsigned char *byte = (const unsigned char *)text;
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    static const unsigned char mask[] = {0, 0x7F, 0x1F, 0x0F, 0x07};
    size_t bytes = bytes_from(byte[0]);
    uint32_t value = byte[0] & mask[bytes];
    *code = 0;
    for (size_t i = 1; i < bytes; i++) {
        if ((byte[i] & 0xC0) != 0x80)
            return 0;
        value = value << 6 | (byte[i] & 0x3F);
    }
    bool surrogate = value >= 0xD800 && value < 0xE000;
    if (value < least[bytes] || value > 0x10FFFF || surrogate)
        return 0;
    *code = value;
    return bytes;
}

size_t nevh__characters(const char *text) {
    size_t count = 0;
    for (; *text; text++)
        count += ((unsigned char)*text & 0xC0) != 0x80;
    return count;
}

bool nevh__is_letter(uint32_t code) {
    static const uint32_t ranges[][2] = {
        {'A', 'Z'},       {'_', '_'},       {'a', 'z'},
        {0xC0, 0xD6},     {0xD8, 0xF6},     {0xF8, 0x24F}, /* Latin */
        {0x300, 0x36F},                                    /* dots above etc. */
        {0x370, 0x37D},   {0x37F, 0x386},   {0x388, 0x3FF}, /* Greek */
        {0x400, 0x52F},                                     /* Cyrillic */
        {0x1E00, 0x1FBC}, {0x1FC2, 0x1FCC}, {0x1FD0, 0x1FDB},
        {0x1FE0, 0x1FEC}, {0x1FF2, 0x1FFC}, /* Latin and Greek with accents */
        {0x2032, 0x2033},                   /* primes */
        {0x2080, 0x2089}, {0x2090, 0x209C}, /* subscripts */
        {0x210E, 0x210F}, {0x2113, 0x2113}, /* h, h-bar, l */
    };
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++)
        if (code >= ranges[i][0] && code <= ranges[i][1])
            return true;
    return false;
}
