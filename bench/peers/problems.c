/* nevh: the problems' data.  The states at the end come from a Gauss method of
   order 16 in 113-bit arithmetic, independent of nevh; good to 20 digits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "problems.h"

#define SLOPES(name)                                                           \
    static int name##_slopes(double t, const double y[], double dy[],          \
                             void *unused) {                                   \
        (void)t, (void)unused;                                                 \
        name##_all(y, dy);                                                     \
        return 0;                                                              \
    }
SLOPES(pendulum)
SLOPES(double_pendulum)
SLOPES(kepler)
SLOPES(henon_heiles)
SLOPES(outer_sun)

#define MOMENTA(m, x, y, z) (m) * (x), (m) * (y), (m) * (z)

const problem problems[] = {
    {.name = "pendulum",
     .title = "Pendulum",
     .n = 1,
     .separable = true,
     .t_end = 100,
     .size = 1,
     .start = {2, 0},
     .end = {1.982325653157030515982941, 0.1796407425909401978724921},
     .slopes = pendulum_slopes},
    {.name = "double-pendulum",
     .title = "Double pendulum",
     .n = 2,
     .t_end = 10,
     .size = 1,
     .start = {1.5707963267948966, 0, 0, 0},
     .end = {0.1137118256716568201221664, -2.223609077492791711139523,
             -3.802044137210631439898684, 1.721351498235191875262862},
     .slopes = double_pendulum_slopes},
    {.name = "kepler",
     .title = "Kepler, e = 0.6",
     .n = 2,
     .separable = true,
     .t_end = 100,
     .size = 1,
     .start = {1 - 0.6, 0, 0, 2},
     .end = {-0.1041832044342322840550464, -0.6947417155679742850149844,
             1.23617776268706369627367, 0.564623251085780902059137},
     .slopes = kepler_slopes},
    {.name = "henon-heiles",
     .title = "Henon-Heiles, E = 1/8",
     .n = 2,
     .separable = true,
     .t_end = 100,
     .size = 1,
     .start = {0, 0.1, 0.49057789051960615, 0},
     .end = {0.1329957183343852788967454, 0.3760189573811590740470609,
             0.2953954457827294417819349, -0.1606396034768338961890406},
     .slopes = henon_heiles_slopes},
    {.name = "outer-sun",
     .title = "Outer solar system",
     .n = 3 * BODIES,
     .separable = true,
     .t_end = 100000,
     .size = 1e-6,
     .start = {0,
               0,
               0,
               -3.5023653,
               -3.8169847,
               -1.5507963,
               9.0755314,
               -3.0458353,
               -1.6483708,
               8.3101420,
               -16.2901086,
               -7.2521278,
               11.4707666,
               -25.7294829,
               -10.8169456,
               -15.5387357,
               -25.2225594,
               -3.1902382,
               0,
               0,
               0,
               MOMENTA(0.000954786104043, 0.00565429, -0.00412490, -0.00190589),
               MOMENTA(0.000285583733151, 0.00168318, 0.00483525, 0.00192462),
               MOMENTA(0.0000437273164546, 0.00354178, 0.00137102, 0.00055029),
               MOMENTA(0.0000517759138449, 0.00288930, 0.00114527, 0.00039677),
               MOMENTA(1 / 1.3e8, 0.00276725, -0.00170702, -0.00136504)},
     .end = {0.6197224011858143216272708,     -0.2483636156271377760225118,
             -0.1245068149012286598375582,    -0.6106288694610207692516514,
             -5.007131633628507869589254,     -2.133588958789222417679572,
             0.4154657294164806136767304,     8.072758790294459409242097,
             3.325166069868792064696923,      19.28017600753897753417974,
             6.371859337367577259512124,      2.511511051876684488211745,
             -29.32441074107549684618195,     3.35566363371025127398574,
             2.096386578642025867813791,      14.12135343202440494682271,
             -28.71152633143566508547563,     -13.07958855928588184700005,
             1.01749079352602288319858e-06,   -1.200251470970392554919066e-06,
             -6.067627579910039099424878e-07, 6.929673621889382917505871e-06,
             -1.16435159852500525247491e-06,  -6.665994325864636938858454e-07,
             -1.6779076233638732187307e-06,   -6.469943797736365656328389e-08,
             4.613166587113910613817603e-08,  -6.234320287395418551160788e-08,
             1.393273026014214002240993e-07,  6.1890815527705011017908e-08,
             -2.31200469481360437981481e-08,  -1.483247854426252022274806e-07,
             -6.013736049178447400991621e-08, 2.277524805648961117674917e-11,
             6.830797024223976618475534e-12,  -4.719666677169497642915039e-12},
     .slopes = outer_sun_slopes},
};
const size_t problem_count = sizeof problems / sizeof *problems;

double problem_error(const problem *p, const double ranges[],
                     const double y[]) {
    double most = 0;
    for (size_t i = 0; i < 2 * p->n; i++) {
        double error = fabs(y[i] - p->end[i]) / ranges[i];
        if (!(error <= most))
            most = error; /* also what is no number */
    }
    return most;
}
