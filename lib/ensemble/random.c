/* nevh: numbers by (seed, name, i): Philox4x32-10.

   J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, Parallel random numbers:
   as easy as 1, 2, 3, Proc. SC11 (2011), section 3.3 and table 2: ten rounds of
   two 32 x 32 bit products each, the key raised between rounds by the golden
   ratio and by sqrt(3) - 1.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/random_private.h"
#include <gsl/gsl_cdf.h>
#include <nevh/ensemble.h>
#include <string.h>

enum { ROUNDS = 10 };

void nevh__philox(const uint32_t counter[4], const uint32_t key[2],
                  uint32_t out[4]) {
    uint32_t k0 = key[0], k1 = key[1];
    memcpy(out, counter, 4 * sizeof *out);
    for (int i = 0; i < ROUNDS; i++, k0 += 0x9E3779B9u, k1 += 0xBB67AE85u) {
        uint64_t a = (uint64_t)0xD2511F53u * out[0];
        uint64_t b = (uint64_t)0xCD9E8D57u * out[2];
        uint32_t next[4] = {(uint32_t)(b >> 32) ^ out[1] ^ k0, (uint32_t)b,
                            (uint32_t)(a >> 32) ^ out[3] ^ k1, (uint32_t)a};
        memcpy(out, next, sizeof next);
    }
}

static void halves(uint64_t x, uint32_t out[2]) {
    out[0] = (uint32_t)x;
    out[1] = (uint32_t)(x >> 32);
}

double nevh_uniform_at(uint64_t seed, const char *name, uint64_t i) {
    uint64_t digest = 0xCBF29CE484222325u; /* FNV-1a */
    uint32_t key[2], counter[4] = {0, 0, 1, 0}, out[4];
    for (; name && *name; name++)
        digest = (digest ^ (unsigned char)*name) * 0x100000001B3u;
    halves(seed, key);
    halves(digest, counter);
    nevh__philox(counter, key, out);
    memcpy(key, out, sizeof key);
    halves(i, counter);
    counter[2] = 0;
    nevh__philox(counter, key, out);
    uint64_t bits = ((uint64_t)out[1] << 32 | out[0]) >> 11;
    return ((double)bits + 0.5) * 0x1p-53;
}

double nevh_normal_at(uint64_t seed, const char *name, uint64_t i) {
    return gsl_cdf_ugaussian_Pinv(nevh_uniform_at(seed, name, i));
}
