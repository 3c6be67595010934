/* nevh tests: numbers by (seed, name, i).
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/random_private.h"
#include "support.h"
#include <math.h>

/* Random123, kat_vectors: philox4x32 10. */
static const struct {
    uint32_t counter[4], key[2], out[4];
} published[] = {
    {{0, 0, 0, 0}, {0, 0}, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
    {{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff},
     {0xffffffff, 0xffffffff},
     {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
    {{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
     {0xa4093822, 0x299f31d0},
     {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}},
};

TEST_EACH(generator_gives_published_vectors, 3) {
    uint32_t out[4];
    nevh__philox(published[_i].counter, published[_i].key, out);
    ck_assert_mem_eq(out, published[_i].out, sizeof out);
}

enum { DRAWS = 20000 };

TEST(draws_have_their_moments) {
    double sum = 0, squares = 0, fourth = 0, mean = 0, spread = 0;
    for (uint64_t i = 0; i < DRAWS; i++) {
        double u = nevh_uniform_at(7, "x", i), x = nevh_normal_at(7, "x", i);
        ck_assert(u > 0 && u < 1);
        mean += u / DRAWS;
        spread += (u - 0.5) * (u - 0.5) / DRAWS;
        sum += x / DRAWS;
        squares += x * x / DRAWS;
        fourth += x * x * x * x / DRAWS;
    }
    double error = 5 / sqrt(DRAWS); /* five standard errors of unit ones */
    ck_assert_double_lt(fabs(mean - 0.5), error * sqrt(1. / 12));
    ck_assert_double_lt(fabs(spread - 1. / 12), error * sqrt(1. / 180));
    ck_assert_double_lt(fabs(sum), error);
    ck_assert_double_lt(fabs(squares - 1), error * sqrt(2));
    ck_assert_double_lt(fabs(fourth - 3), error * sqrt(96));
}

/* Neighbours in i, seed and name have nothing in common. */
TEST(draws_are_independent) {
    double product[3] = {0};
    for (uint64_t i = 0; i < DRAWS; i++) {
        double x = nevh_normal_at(7, "x", i);
        product[0] += x * nevh_normal_at(7, "x", i + 1) / DRAWS;
        product[1] += x * nevh_normal_at(8, "x", i) / DRAWS;
        product[2] += x * nevh_normal_at(7, "y", i) / DRAWS;
    }
    for (int k = 0; k < 3; k++)
        ck_assert_double_lt(fabs(product[k]), 5 / sqrt(DRAWS));
}
