/* nevh: the colours and marks of integrators, in pictures, pages and Python.
   SPDX-License-Identifier: GPL-3.0-or-later

   The look of an integrator is its place in NEVH_LOOKS: its colour is
   NEVH_COLOURS[look % 8], its mark NEVH_MARKS[look % 9], its dash that of look % 5,
   so that 360 looks differ.  python/looks.awk reads these lines, too. */
#ifndef NEVH_LOOKS_H
#define NEVH_LOOKS_H

/* M. Okabe, K. Ito, Color Universal Design (2008), but for yellow, which is lost
   on white, and a dark red; vermilion, orange and sky blue are darker, for a contrast
   of 3 on white.  On white, and on black. */
#define NEVH_COLOURS(X)                                                        \
    X("#0072B2", "#4FA8E0")                                                    \
    X("#CB5500", "#F0803C")                                                    \
    X("#009E73", "#2FC79B")                                                    \
    X("#CC79A7", "#E39AC3")                                                    \
    X("#000000", "#FFFFFF")                                                    \
    X("#CA8600", "#F2B632")                                                    \
    X("#309DD3", "#9AD7FA")                                                    \
    X("#882255", "#C0568C")

/* As plot_private.h numbers them, as a letter, and as matplotlib has them where "hollow"
   is not filled. */
#define NEVH_MARKS(X)                                                          \
    X(PLOT_DISC, "●", "o")                                                     \
    X(PLOT_SQUARE + 1, "■", "s")                                               \
    X(PLOT_TRIANGLE + 1, "▲", "^")                                             \
    X(PLOT_DIAMOND + 1, "◆", "D")                                              \
    X(PLOT_SQUARE, "□", "s hollow")                                            \
    X(PLOT_CIRCLE, "○", "o hollow")                                            \
    X(PLOT_TRIANGLE, "△", "^ hollow")                                          \
    X(PLOT_DIAMOND, "◇", "D hollow")                                           \
    X(PLOT_CROSS, "×", "x")

/* All integrators, those first that often stand side by side: eight that follow each
   other differ in colour. */
#define NEVH_LOOKS(X)                                                          \
    X("verlet")                                                                \
    X("rk4")                                                                   \
    X("gauss4")                                                                \
    X("midpoint")                                                              \
    X("euler")                                                                 \
    X("blanes-moan4")                                                          \
    X("gauss6")                                                                \
    X("gauss8")                                                                \
    X("itoh-abe")                                                              \
    X("forest-ruth")                                                           \
    X("heun")                                                                  \
    X("dop853")                                                                \
    X("taylor")                                                                \
    X("adaptive-verlet")                                                       \
    X("dopri5")                                                                \
    X("symplectic-euler-a")                                                    \
    X("tao4")                                                                  \
    X("pefrl")                                                                 \
    X("blanes-moan6")                                                          \
    X("gauss12")                                                               \
    X("gauss10")                                                               \
    X("gauss16")                                                               \
    X("symplectic-euler-b")                                                    \
    X("position-verlet")                                                       \
    X("ruth3")                                                                 \
    X("mclachlan-atela4")                                                      \
    X("mclachlan-sb3a4")                                                       \
    X("mclachlan-sb3a5")                                                       \
    X("suzuki4")                                                               \
    X("rkn6b")                                                                 \
    X("rkn11b")                                                                \
    X("rkn14a")                                                                \
    X("yoshida6")                                                              \
    X("kahan-li6")                                                             \
    X("kahan-li8")                                                             \
    X("suzuki-umeno8")                                                         \
    X("sofroniou-spaletta10")                                                  \
    X("gauss14")                                                               \
    X("gauss18")                                                               \
    X("gauss20")                                                               \
    X("lobatto2")                                                              \
    X("lobatto4")                                                              \
    X("lobatto6")                                                              \
    X("tao2")                                                                  \
    X("tao6")                                                                  \
    X("implicit-euler")                                                        \
    X("itoh-abe-symmetric")                                                    \
    X("gonzalez")                                                              \
    X("avf")                                                                   \
    X("naive-adaptive-verlet")                                                 \
    X("explicit-midpoint")                                                     \
    X("ralston")                                                               \
    X("adams-bashforth2")                                                      \
    X("rk3")                                                                   \
    X("dprkn12")                                                               \
    X("gsl-rkf45")                                                             \
    X("gsl-rk8pd")                                                             \
    X("gsl-msadams")                                                           \
    X("aba864")                                                                \
    X("wisdom-holman")                                                         \
    X("respa")                                                                 \
    X("saba2")                                                                 \
    X("saba3")                                                                 \
    X("saba4")                                                                 \
    X("aba84")                                                                 \
    X("aba1064")

#endif
