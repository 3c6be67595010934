/* nevh: elementary functions of one number, and of vectors under the names that GCC
   calls.
   SPDX-License-Identifier: GPL-3.0-or-later

   GCC calls a function that was declared with simd("notinbranch") for N numbers by
   _ZGVxNNv_, x being b for SSE, c for AVX, d for AVX2 and e for AVX-512 [H. J. Lu et
   al., "Vector function application binary interface" for x86-64]. */
#define NEVH__ELEMENTARY
#include <nevh/simd.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "elementary/elementary_list.h"
#include "elementary/elementary_number.h"

#define ONE(name, f, family)                                                   \
    double nevh_simd_##name(double x) {                                        \
        return nevh__one_##f(x);                                               \
    }
#define TWO(name, f, family)                                                   \
    double nevh_simd_##name(double x, double y) {                              \
        return nevh__one_##f(x, y);                                            \
    }
NEVH__EACH_ONE(ONE)
NEVH__EACH_TWO(TWO)
#undef ONE
#undef TWO

#if defined __GNUC__ && defined __x86_64__
#undef NEVH__INLINE
#define NEVH__INLINE __attribute__((always_inline)) TARGET static inline
#undef NEVH__RARE
#define NEVH__RARE __attribute__((cold, noinline)) TARGET
#define TARGET     __attribute__((target("sse2")))
#define VECTOR     two_numbers
#define ABI(rest)  _ZGVbN2##rest
#define NAME(f)    two_##f
typedef double two_numbers __attribute__((vector_size(16), aligned(8)));
#define NEVH__SIDE   2
#define NEVH__NUMBER two_numbers
#define NEVH__PAIR   two_pair
#define NEVH__E(f)   two_##f
#include "elementary/elementary_vectors.h"

#define TARGET    __attribute__((target("avx")))
#define VECTOR    four_numbers
#define ABI(rest) _ZGVcN4##rest
#define NAME(f)   four_##f
typedef double four_numbers __attribute__((vector_size(32), aligned(8)));
#define NEVH__SIDE   4
#define NEVH__NUMBER four_numbers
#define NEVH__PAIR   four_pair
#define NEVH__E(f)   four_##f
#include "elementary/elementary_vectors.h"

#define TARGET       __attribute__((target("avx2")))
#define VECTOR       four_numbers
#define ABI(rest)    _ZGVdN4##rest
#define NAME(f)      four_avx2_##f
#define NEVH__SIDE   4
#define NEVH__NUMBER four_numbers
#define NEVH__PAIR   four_avx2_pair
#define NEVH__E(f)   four_avx2_##f
#include "elementary/elementary_vectors.h"

#define TARGET    __attribute__((target("avx512f,avx512dq,avx512vl,avx512bw")))
#define VECTOR    eight_numbers
#define ABI(rest) _ZGVeN8##rest
#define NAME(f)   eight_##f
typedef double eight_numbers __attribute__((vector_size(64), aligned(8)));
#define NEVH__SIDE   8
#define NEVH__NUMBER eight_numbers
#define NEVH__PAIR   eight_pair
#define NEVH__E(f)   eight_##f
#include "elementary/elementary_vectors.h"
#endif
