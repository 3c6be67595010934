/* nevh: the schemes and what is known of them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_INTEGRATOR_H
#define NEVH_INTEGRATOR_H

#include <nevh/status.h>
#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct nevh_integrator nevh_integrator;

/* A claim about a scheme.  UNPROVEN is an answer; EXTENDED holds in the larger
   space that the scheme works in (with a second copy of the state, or the density
   of its steps), not for (q, p) alone. */
typedef enum { NEVH_NO, NEVH_YES, NEVH_UNPROVEN, NEVH_EXTENDED } nevh_claim;
/* "no", "yes", "unproven", "extended". */
NEVH_API const char *nevh_claim_name(nevh_claim);

/* Explicit, for H = T(p) + V(q); mclachlan_atela4, rkn11b and rkn14a need a T
   quadratic in p. */
NEVH_API extern const nevh_integrator *const nevh_symplectic_euler_a;
NEVH_API extern const nevh_integrator *const nevh_symplectic_euler_b;
NEVH_API extern const nevh_integrator *const nevh_verlet;
NEVH_API extern const nevh_integrator *const nevh_position_verlet;
NEVH_API extern const nevh_integrator *const nevh_ruth3;
NEVH_API extern const nevh_integrator *const nevh_mclachlan_atela4;
NEVH_API extern const nevh_integrator *const nevh_mclachlan_sb3a4;
NEVH_API extern const nevh_integrator *const nevh_mclachlan_sb3a5;
NEVH_API extern const nevh_integrator *const nevh_forest_ruth;
NEVH_API extern const nevh_integrator *const nevh_pefrl;
NEVH_API extern const nevh_integrator *const nevh_suzuki4;
NEVH_API extern const nevh_integrator *const nevh_blanes_moan4;
NEVH_API extern const nevh_integrator *const nevh_blanes_moan6;
NEVH_API extern const nevh_integrator *const nevh_rkn6b;
NEVH_API extern const nevh_integrator *const nevh_rkn11b;
NEVH_API extern const nevh_integrator *const nevh_rkn14a;
NEVH_API extern const nevh_integrator *const nevh_yoshida6;
NEVH_API extern const nevh_integrator *const nevh_kahan_li6;
NEVH_API extern const nevh_integrator *const nevh_kahan_li8;
NEVH_API extern const nevh_integrator *const nevh_suzuki_umeno8;
NEVH_API extern const nevh_integrator *const nevh_sofroniou_spaletta10;
/* Explicit, by parts, for H = A + B where A has all momenta and is moved exactly: a
   quadratic form with constant coefficients, or p^2/2m - k/|q| of bodies about a
   centre.  B = V(t, q) kicks.  With e for the size of B beside A, errors are e h^2
   (wisdom_holman), e h^4 ... e h^8 with e^2 h^2 (saba2 ... saba4), e h^8 + e^2 h^4
   (aba84), e h^8 + e^2 h^6 + e^3 h^4 (aba864), and e h^10 + e^2 h^6 + e^3 h^4
   (aba1064). */
NEVH_API extern const nevh_integrator *const nevh_wisdom_holman;
NEVH_API extern const nevh_integrator *const nevh_saba2;
NEVH_API extern const nevh_integrator *const nevh_saba3;
NEVH_API extern const nevh_integrator *const nevh_saba4;
NEVH_API extern const nevh_integrator *const nevh_aba84;
NEVH_API extern const nevh_integrator *const nevh_aba864;
NEVH_API extern const nevh_integrator *const nevh_aba1064;
/* The same in the order kick, A, kick, of order 2, where A may have any V(q) that is to
   be fast, too: these kick in nevh_options.substeps steps of Verlet's, between which
   the rest of A is moved exactly.  B is evaluated once a step.  The step has to stay
   below half of the shortest period of A: near it, it resonates. */
NEVH_API extern const nevh_integrator *const nevh_respa;
/* The substeps of "respa+16", 16; 0: the name is none such, or NULL. */
NEVH_API size_t nevh_substeps_named(const char *name);
/* Implicit, for any H: Gauss-Legendre, named by order (twice the stages). */
NEVH_API extern const nevh_integrator *const nevh_midpoint;
NEVH_API extern const nevh_integrator *const nevh_gauss4;
NEVH_API extern const nevh_integrator *const nevh_gauss6;
NEVH_API extern const nevh_integrator *const nevh_gauss8;
NEVH_API extern const nevh_integrator *const nevh_gauss10;
NEVH_API extern const nevh_integrator *const nevh_gauss12;
NEVH_API extern const nevh_integrator *const nevh_gauss14;
NEVH_API extern const nevh_integrator *const nevh_gauss16;
NEVH_API extern const nevh_integrator *const nevh_gauss18;
NEVH_API extern const nevh_integrator *const nevh_gauss20;
/* Implicit, for any H: Lobatto IIIA-IIIB pairs, named by order (twice the
   stages, less 2).  lobatto2 is the general Stoermer-Verlet method; like that,
   and unlike Gauss, they are unstable where h steps over fast oscillations. */
NEVH_API extern const nevh_integrator *const nevh_lobatto2;
NEVH_API extern const nevh_integrator *const nevh_lobatto4;
NEVH_API extern const nevh_integrator *const nevh_lobatto6;
/* Explicit, for any H: Tao's, in a doubled phase space; named by order. */
NEVH_API extern const nevh_integrator *const nevh_tao2;
NEVH_API extern const nevh_integrator *const nevh_tao4;
NEVH_API extern const nevh_integrator *const nevh_tao6;
/* Implicit, for any H: they keep the energy instead of the symplectic form.
   Itoh and Abe's take values of H and no derivative. */
NEVH_API extern const nevh_integrator *const nevh_itoh_abe;
NEVH_API extern const nevh_integrator *const nevh_itoh_abe_symmetric;
NEVH_API extern const nevh_integrator *const nevh_gonzalez;
NEVH_API extern const nevh_integrator *const nevh_avf;
/* Verlet with steps of their own length, h being nominal; the second destroys
   what the first keeps. */
NEVH_API extern const nevh_integrator *const nevh_adaptive_verlet;
NEVH_API extern const nevh_integrator *const nevh_naive_adaptive_verlet;
/* Not symplectic: the references.  Those that adapt take one step of h where
   the tolerance is 0, and as many as the tolerance needs where it is not: the
   end of a step of h is landed on exactly, so that smaller h, where they cut
   such steps short, change the last digits.  nevh_gsl_msadams, whose order
   goes from 1 to 12, needs a tolerance, and begins anew with every step. */
NEVH_API extern const nevh_integrator *const nevh_euler;
NEVH_API extern const nevh_integrator *const nevh_implicit_euler;
NEVH_API extern const nevh_integrator *const nevh_explicit_midpoint;
NEVH_API extern const nevh_integrator *const nevh_heun;
NEVH_API extern const nevh_integrator *const nevh_ralston;
NEVH_API extern const nevh_integrator *const nevh_adams_bashforth2;
NEVH_API extern const nevh_integrator *const nevh_rk3;
NEVH_API extern const nevh_integrator *const nevh_rk4;
NEVH_API extern const nevh_integrator *const nevh_dopri5;
NEVH_API extern const nevh_integrator *const nevh_dop853;
NEVH_API extern const nevh_integrator *const nevh_dprkn12;
NEVH_API extern const nevh_integrator *const nevh_gsl_rkf45;
NEVH_API extern const nevh_integrator *const nevh_gsl_rk8pd;
NEVH_API extern const nevh_integrator *const nevh_gsl_msadams;
/* Taylor series of the orbit, of an order that the tolerance asks for: the one
   for many digits, down to rounding (1e-16; the order grows by one a digit and
   a half).  Only for formulas, as scenes have them, that are analytic: no
   gradient is taken, the derivatives of all orders follow from the formula.
   The end of a step of h is a value of the series there, so that h changes no
   digit of the orbit, but: no series is longer than 8 steps of h, or one where
   H reads t. */
NEVH_API extern const nevh_integrator *const nevh_taylor;

/* All schemes, ended by NULL. */
NEVH_API const nevh_integrator *const *nevh_integrators(void);
/* Finds a scheme by name or alias; NULL if there is none. */
NEVH_API const nevh_integrator *nevh_integrator_named(const char *name);

NEVH_API const char *nevh_integrator_name(const nevh_integrator *);
/* Names in other packages, separated by commas; "" if there are none. */
NEVH_API const char *nevh_integrator_aliases(const nevh_integrator *);
/* Paper and equation. */
NEVH_API const char *nevh_integrator_source(const nevh_integrator *);
NEVH_API int nevh_integrator_order(const nevh_integrator *);
NEVH_API int nevh_integrator_stages(const nevh_integrator *);
/* Evaluations of dH/dq in one step of a long run; 0 where it depends on the
   iterations that the step needs. */
NEVH_API int nevh_integrator_gradients(const nevh_integrator *);
/* The evaluations of dH/dq in one sweep of an implicit scheme's iteration; 0 if it
   takes only values of H, or does not iterate. */
NEVH_API int nevh_integrator_sweep_gradients(const nevh_integrator *);
/* True if a tolerance makes it take as many substeps within h as it needs. */
NEVH_API bool nevh_integrator_adaptive(const nevh_integrator *);
/* True if it has no fixed steps: planning without a tolerance is refused. */
NEVH_API bool nevh_integrator_needs_tolerance(const nevh_integrator *);
/* True if it requires formulas: terms that are functions in C are refused. */
NEVH_API bool nevh_integrator_needs_formulas(const nevh_integrator *);
/* True if h is a nominal step, and the scheme chooses the time that a step takes:
   see nevh_stepper_time. */
NEVH_API bool nevh_integrator_own_time(const nevh_integrator *);
NEVH_API nevh_claim nevh_integrator_symplectic(const nevh_integrator *);
NEVH_API nevh_claim nevh_integrator_symmetric(const nevh_integrator *);
NEVH_API nevh_claim nevh_integrator_explicit(const nevh_integrator *);
NEVH_API nevh_claim nevh_integrator_preserves_energy(const nevh_integrator *);
/* The traits of H that it needs, an or of nevh_trait. */
NEVH_API unsigned nevh_integrator_needs(const nevh_integrator *);

#ifdef __cplusplus
}
#endif
#endif
