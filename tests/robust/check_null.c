/* nevh tests: every public function takes NULL for an object.

   That is what an object looks like where memory is out, and what is found by a
   name that is none.  tests/build/symbols.sh sees that none is forgotten.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/extend.h>
#include <string.h>

enum { ROOM = 64 };
static double in[ROOM], out[ROOM];
static const size_t places[1] = {0};
static bool flag;
static nevh_separability separability;

/* What a function gives back: a status that is not NEVH_OK, a text that is there,
   a number that is 0, one that is 0 or NAN, an object that carries a status or is
   NULL, no pointer, or whatever. */
#define CALLS(X)                                                               \
    X(MADE, nevh_certain_new, (NULL, 0.1, in, in, 20))                         \
    X(ANY, nevh_certain_free, (NULL))                                          \
    X(STATUS, nevh_certain_status, (NULL))                                     \
    X(TEXT, nevh_certain_message, (NULL))                                      \
    X(STATUS, nevh_certain_go, (NULL, 0.1))                                    \
    X(STATUS, nevh_certain_go_to, (NULL, 0.1, 0))                              \
    X(ANY, nevh_certain_stop_at, (NULL, NULL))                                 \
    X(NUMBER, nevh_certain_series, (NULL))                                     \
    X(REAL, nevh_certain_value, (NULL, 0))                                     \
    X(REAL, nevh_certain_error, (NULL, 0))                                     \
    X(REAL, nevh_certain_size, (NULL, 0))                                      \
    X(NUMBER, nevh_certain_digits, (NULL, 0))                                  \
    X(ANY, nevh_certain_text, (NULL, 0))                                       \
    X(MADE, nevh_finer_new, (NULL, NULL))                                      \
    X(ANY, nevh_finer_free, (NULL))                                            \
    X(STATUS, nevh_finer_status, (NULL))                                       \
    X(TEXT, nevh_finer_message, (NULL))                                        \
    X(NUMBER, nevh_finer_how, (NULL))                                          \
    X(TEXT, nevh_finer_text, (NULL))                                           \
    X(POINTER, nevh_finer_integrator, (NULL))                                  \
    X(POINTER, nevh_finer_options, (NULL))                                     \
    X(REAL, nevh_finer_dt, (NULL))                                             \
    X(REAL, nevh_finer_part, (NULL))                                           \
    X(STATUS, nevh_finer_run, (NULL, 1, out, out, NULL, 0, NULL))              \
    X(POINTER, nevh_finer_stepper, (NULL))                                     \
    X(ANY, nevh_agree, (0, 0, 0, 0))                                           \
    X(MADE, nevh_energy_new, (NULL, NULL))                                     \
    X(ANY, nevh_energy_free, (NULL))                                           \
    X(STATUS, nevh_energy_status, (NULL))                                      \
    X(TEXT, nevh_energy_message, (NULL))                                       \
    X(STATUS, nevh_energy_follow, (NULL, NULL))                                \
    X(STATUS, nevh_energy_book, (NULL, NULL))                                  \
    X(REAL, nevh_energy_passed, (NULL, NULL))                                  \
    X(NUMBER, nevh_energy_passes_over, (NULL))                                 \
    X(NUMBER, nevh_energy_stays, (NULL))                                       \
    X(STATUS, nevh_energy_set_scale, (NULL, 0.1))                              \
    X(STATUS, nevh_energy_observe, (NULL, 0, 0.1, in, in))                     \
    X(STATUS, nevh_energy_expect, (NULL, NULL))                                \
    X(REAL, nevh_energy_error, (NULL, 0))                                      \
    X(ANY, nevh_energy_result, (NULL, 0))                                      \
    X(STATUS, nevh_symplecticity_defect, (NULL, 0.1, 0.1, in, in, in, out))    \
    X(STATUS, nevh_reversal_defect, (NULL, 0.1, 0.1, 1, in, in, in, out))      \
    X(REAL, nevh_stability_limit, (NULL))                                      \
    X(REAL, nevh_stability_growth, (NULL, 0.1))                                \
    X(REAL, nevh_stability_angle, (NULL, 0.1))                                 \
    X(MADE, nevh_shadow_new, (NULL, NULL, 0.1, NULL))                          \
    X(ANY, nevh_shadow_free, (NULL))                                           \
    X(STATUS, nevh_shadow_status, (NULL))                                      \
    X(TEXT, nevh_shadow_message, (NULL))                                       \
    X(NUMBER, nevh_shadow_order, (NULL))                                       \
    X(STATUS, nevh_shadow_value, (NULL, in, in, NULL, NULL))                   \
    X(STATUS, nevh_shadow_observe, (NULL, 0, 0, in, in))                       \
    X(ANY, nevh_shadow_result, (NULL))                                         \
    X(MADE, nevh_chaos_new, (NULL, NULL))                                      \
    X(ANY, nevh_chaos_free, (NULL))                                            \
    X(STATUS, nevh_chaos_status, (NULL))                                       \
    X(TEXT, nevh_chaos_message, (NULL))                                        \
    X(STATUS, nevh_chaos_restart, (NULL, in, in, 0))                           \
    X(STATUS, nevh_chaos_run, (NULL, 0.1))                                     \
    X(ANY, nevh_chaos_result, (NULL))                                          \
    X(REAL, nevh_chaos_exponent, (NULL, 0, NULL))                              \
    X(REAL, nevh_chaos_gali, (NULL, 2))                                        \
    X(NUMBER, nevh_chaos_is_tangent, (NULL, NULL))                             \
    X(ANY, nevh_chaos_counts, (NULL))                                          \
    X(STATUS, nevh_chaos_find, (NULL, NULL, 0, 1, 0, NULL))                    \
    X(STATUS, nevh_chaos_confirm, (NULL, 0, NULL))                             \
    X(TEXT, nevh_chaos_verdict_name, ((nevh_chaos_verdict)-1))                 \
    X(RATES, nevh_rates_new, (NULL, NULL))                                     \
    X(ANY, nevh_rates_free, (NULL))                                            \
    X(STATUS, nevh_rates_status, (NULL))                                       \
    X(TEXT, nevh_rates_message, (NULL))                                        \
    X(STATUS, nevh_rates_at, (NULL, 0.1, in, in, out, out))                    \
    X(NUMBER, nevh_scene_members, (NULL))                                      \
    X(NUMBER, nevh_scene_varies, (NULL, "x"))                                  \
    X(STATUS, nevh_scene_member_start, (NULL, 0, out, out))                    \
    X(STATUS, nevh_frequencies, (0.1, 64, NULL, 1, NULL, NULL))                \
    X(ANY, nevh_spectral_samples_free, (NULL))                                 \
    X(ANY, nevh_spectral_samples_restart, (NULL))                              \
    X(ANY, nevh_spectral_samples_take, (NULL, 0, 0.1, 0.1))                    \
    X(NUMBER, nevh_spectral_samples_straighten, (NULL, 1))                     \
    X(ANY, nevh_spectral_samples_values, (NULL, NULL, NULL))                   \
    X(MADE, nevh_loop_new, (NULL, NULL, NULL, NULL))                           \
    X(ANY, nevh_loop_free, (NULL))                                             \
    X(STATUS, nevh_loop_status, (NULL))                                        \
    X(TEXT, nevh_loop_message, (NULL))                                         \
    X(STATUS, nevh_loop_carry, (NULL))                                         \
    X(ANY, nevh_loop_result, (NULL, 0))                                        \
    X(NUMBER, nevh_loop_shape, (NULL, 0, 0, out, out))                         \
    X(MADE, nevh_ensemble_new, (NULL, NULL))                                   \
    X(ANY, nevh_ensemble_free, (NULL))                                         \
    X(STATUS, nevh_ensemble_status, (NULL))                                    \
    X(TEXT, nevh_ensemble_message, (NULL))                                     \
    X(NUMBER, nevh_ensemble_columns, (NULL))                                   \
    X(NUMBER, nevh_ensemble_width, (NULL))                                     \
    X(NUMBER, nevh_ensemble_native, (NULL, NULL))                              \
    X(NUMBER, nevh_sweep_native, (NULL, NULL))                                 \
    X(STATUS, nevh_ensemble_run, (NULL, NULL, NULL, NULL))                     \
    X(TEXT, nevh_gradient_name, (NULL))                                        \
    X(NUMBER, nevh_gradient_order, (NULL))                                     \
    X(MADE, nevh_field_new, (NULL, NULL))                                      \
    X(ANY, nevh_field_free, (NULL))                                            \
    X(STATUS, nevh_field_status, (NULL))                                       \
    X(TEXT, nevh_field_message, (NULL))                                        \
    X(STATUS, nevh_field_gradient, (NULL, 1, in, in, in, out, out))            \
    X(STATUS, nevh_field_value, (NULL, 1, in, in, in, out))                    \
    X(STATUS, nevh_field_effects, (NULL, 0.1, in, in, out))                    \
    X(STATUS, nevh_field_groups, (NULL, 0.1, in, in, 0, places, out))          \
    X(REAL, nevh_field_step, (NULL, "x", 0, 0))                                \
    X(NUMBER, nevh_field_step_count, (NULL))                                   \
    X(ANY, nevh_field_step_report, (NULL, 0))                                  \
    X(STATUS, nevh_field_energy_floor, (NULL, 0.1, in, in, 0.1, 1, out))       \
    X(ANY, nevh_field_counts, (NULL))                                          \
    X(NUMBER, nevh_field_effect_values, (NULL, "x"))                           \
    X(NUMBER, nevh_field_pieces, (NULL))                                       \
    X(POINTER, nevh_integrator_new, (NULL, NULL))                              \
    X(ANY, nevh_integrator_free, (NULL))                                       \
    X(STATUS, nevh_integrator_facts, (NULL, NULL))                             \
    X(POINTER, nevh_scene_integrator, (NULL, 0))                               \
    X(TEXT, nevh_integrator_name, (NULL))                                      \
    X(TEXT, nevh_integrator_aliases, (NULL))                                   \
    X(TEXT, nevh_integrator_source, (NULL))                                    \
    X(NUMBER, nevh_integrator_order, (NULL))                                   \
    X(NUMBER, nevh_integrator_stages, (NULL))                                  \
    X(NUMBER, nevh_integrator_gradients, (NULL))                               \
    X(NUMBER, nevh_integrator_sweep_gradients, (NULL))                         \
    X(NUMBER, nevh_integrator_adaptive, (NULL))                                \
    X(NUMBER, nevh_integrator_needs_tolerance, (NULL))                         \
    X(NUMBER, nevh_integrator_needs_formulas, (NULL))                          \
    X(NUMBER, nevh_integrator_own_time, (NULL))                                \
    X(NUMBER, nevh_integrator_symplectic, (NULL))                              \
    X(NUMBER, nevh_integrator_symmetric, (NULL))                               \
    X(NUMBER, nevh_integrator_explicit, (NULL))                                \
    X(NUMBER, nevh_integrator_preserves_energy, (NULL))                        \
    X(NUMBER, nevh_integrator_needs, (NULL))                                   \
    X(MADE, nevh_probe_new, (NULL, NULL))                                      \
    X(ANY, nevh_probe_free, (NULL))                                            \
    X(STATUS, nevh_probe_status, (NULL))                                       \
    X(TEXT, nevh_probe_message, (NULL))                                        \
    X(ANY, nevh_probe_finding, (NULL, 0))                                      \
    X(POINTER, nevh_probe_lengths, (NULL))                                     \
    X(MADE, nevh_reference_new, (NULL, NULL, 0.1, 0.1, in, in))                \
    X(MADE, nevh_reference_with, (NULL, NULL, 0.1, 0.1, in, in))               \
    X(ANY, nevh_reference_free, (NULL))                                        \
    X(STATUS, nevh_reference_status, (NULL))                                   \
    X(TEXT, nevh_reference_message, (NULL))                                    \
    X(TEXT, nevh_reference_text, (NULL))                                       \
    X(REAL, nevh_reference_error, (NULL))                                      \
    X(REAL, nevh_reference_horizon, (NULL))                                    \
    X(REAL, nevh_reference_ends, (NULL))                                       \
    X(REAL, nevh_solution_ends, (NULL, 0, 1, out, out))                        \
    X(STATUS, nevh_solution_smooth, (NULL, 0, 1, out, out, NULL, 0))           \
    X(POINTER, nevh_timing_new, (NULL, 0, 1, out, out))                        \
    X(ANY, nevh_timing_free, (NULL))                                           \
    X(NUMBER, nevh_timing_breaks, (NULL))                                      \
    X(ANY, nevh_reference_why, (NULL))                                         \
    X(REAL, nevh_reference_exponent, (NULL))                                   \
    X(REAL, nevh_reference_growth, (NULL))                                     \
    X(STATUS, nevh_reference_state, (NULL, 0.1, out, out))                     \
    X(STATUS, nevh_reference_state_after, (NULL, 0.1, out, out))               \
    X(REAL, nevh_reference_range, (NULL, 0))                                   \
    X(REAL, nevh_reference_own_range, (NULL, 0))                               \
    X(MADE, nevh_state_error_new, (NULL))                                      \
    X(ANY, nevh_state_error_free, (NULL))                                      \
    X(ANY, nevh_state_error_follow, (NULL, NULL))                              \
    X(ANY, nevh_state_error_hand, (NULL, NULL, NULL))                          \
    X(STATUS, nevh_state_error_observe, (NULL, 0, 0.1, in, in))                \
    X(REAL, nevh_state_error_result, (NULL))                                   \
    X(REAL, nevh_state_error_of, (NULL, 0))                                    \
    X(MADE, nevh_stepper_new, (NULL, NULL, NULL))                              \
    X(ANY, nevh_stepper_free, (NULL))                                          \
    X(STATUS, nevh_stepper_status, (NULL))                                     \
    X(TEXT, nevh_stepper_message, (NULL))                                      \
    X(STATUS, nevh_stepper_apply, (NULL, 0.1, 0.1, out, out))                  \
    X(REAL, nevh_stepper_time, (NULL))                                         \
    X(ANY, nevh_stepper_reset, (NULL))                                         \
    X(MADE, nevh_stepper_copy, (NULL))                                         \
    X(NUMBER, nevh_stepper_save_size, (NULL))                                  \
    X(ANY, nevh_stepper_save, (NULL, out))                                     \
    X(STATUS, nevh_stepper_load, (NULL, out, 0))                               \
    X(NUMBER, nevh_stepper_order, (NULL))                                      \
    X(REAL, nevh_stepper_gain, (NULL, 0))                                      \
    X(ANY, nevh_stepper_native, (NULL, NULL))                                  \
    X(ANY, nevh_stepper_compiles, (NULL))                                      \
    X(ANY, nevh_steppers_foresee, (NULL, 0, 1e9))                              \
    X(ANY, nevh_stepper_foresee, (NULL, 1e9))                                  \
    X(REAL, nevh_stepper_native_saves, (NULL, 1e9))                            \
    X(ANY, nevh_integrator_native, (NULL))                                     \
    X(POINTER, nevh_stepper_program, (NULL, NULL))                             \
    X(ANY, nevh_stepper_counts, (NULL))                                        \
    X(POINTER, nevh_stepper_field, (NULL))                                     \
    X(NUMBER, nevh_stepper_hierarchy, (NULL, NULL, 0, NULL))                   \
    X(NUMBER, nevh_stepper_body, (NULL, 0))                                    \
    X(STATUS, nevh_stepper_kick, (NULL, 0, out, out, out))                     \
    X(STATUS, nevh_run, (NULL, 0.1, 0.1, 1, out, out, NULL, 0))                \
    X(STATUS, nevh_run_until, (NULL, 0.1, 0.1, 0.1, out, out, NULL, 0))        \
    X(STATUS, nevh_run_at,                                                     \
      (NULL, 0.1, 0.1, 0.1, in, 1, out, NULL, out, out, NULL, 0))              \
    X(STATUS, nevh_orbit_run, (NULL, NULL, out, out))                          \
    X(NUMBER, nevh_stepper_taken, (NULL))                                      \
    X(ANY, nevh_scene_free, (NULL))                                            \
    X(STATUS, nevh_scene_status, (NULL))                                       \
    X(TEXT, nevh_scene_message, (NULL))                                        \
    X(STATUS, nevh_scene_set, (NULL, "x"))                                     \
    X(STATUS, nevh_scene_enable, (NULL, "x", true))                            \
    X(STATUS, nevh_scene_set_start, (NULL, "x"))                               \
    X(STATUS, nevh_scene_number, (NULL, "x", out))                             \
    X(POINTER, nevh_scene_write, (NULL, "x"))                                  \
    X(TEXT, nevh_scene_title, (NULL))                                          \
    X(TEXT, nevh_scene_source, (NULL))                                         \
    X(NUMBER, nevh_scene_dof, (NULL))                                          \
    X(TEXT, nevh_scene_coordinate, (NULL, 0))                                  \
    X(NUMBER, nevh_scene_array, (NULL, 0))                                     \
    X(TEXT, nevh_scene_label, (NULL, "x"))                                     \
    X(POINTER, nevh_scene_code_path, (NULL, 0))                                \
    X(NUMBER, nevh_scene_digest, (NULL))                                       \
    X(POINTER, nevh_scene_system, (NULL))                                      \
    X(POINTER, nevh_scene_exact_system, (NULL))                                \
    X(POINTER, nevh_scene_certain, (NULL, 20))                                 \
    X(STATUS, nevh_scene_exact_number, (NULL, "x", out, NULL))                 \
    X(STATUS, nevh_scene_start, (NULL, out, out))                              \
    X(POINTER, nevh_scene_run_settings, (NULL))                                \
    X(POINTER, nevh_scene_transform, (NULL))                                   \
    X(STATUS, nevh_scene_set_transform, (NULL, "x"))                           \
    X(NUMBER, nevh_scene_shown_count, (NULL, 0))                               \
    X(TEXT, nevh_scene_shown_name, (NULL, 0, 0))                               \
    X(STATUS, nevh_scene_shown_values, (NULL, 0, 0.1, in, in, out))            \
    X(STATUS, nevh_scene_set_judged, (NULL, "x"))                              \
    X(STATUS, nevh_scene_judged_value, (NULL, 0.1, in, in, out))               \
    X(REAL, nevh_scene_period, (NULL, 0))                                      \
    X(NUMBER, nevh_scene_section_count, (NULL))                                \
    X(POINTER, nevh_scene_section_at, (NULL, 0))                               \
    X(STATUS, nevh_scene_section_cross, (NULL, 0, 0.1, in, in, out))           \
    X(STATUS, nevh_scene_section_items, (NULL, 0, 0.1, in, in, out))           \
    X(NUMBER, nevh_scene_part_count, (NULL))                                   \
    X(NUMBER, nevh_scene_equation_count, (NULL))                               \
    X(ANY, nevh_scene_equation_at, (NULL, 0))                                  \
    X(POINTER, nevh_scene_equation_mathml, (NULL, 0))                          \
    X(POINTER, nevh_scene_gsl_function, (NULL, 0))                             \
    X(ANY, nevh_scene_part_at, (NULL, 0))                                      \
    X(STATUS, nevh_scene_part_values, (NULL, 0, 0.1, in, in, out))             \
    X(NUMBER, nevh_scene_stops, (NULL))                                        \
    X(TEXT, nevh_scene_stop_text, (NULL))                                      \
    X(STATUS, nevh_scene_stop_reached, (NULL, 0.1, in, in, &flag))             \
    X(STATUS, nevh_scene_stop_observe, (NULL, 0, 0.1, in, in))                 \
    X(MADE, nevh_sections_new, (NULL, NULL, 0, NULL, NULL))                    \
    X(ANY, nevh_sections_free, (NULL))                                         \
    X(STATUS, nevh_sections_status, (NULL))                                    \
    X(TEXT, nevh_sections_message, (NULL))                                     \
    X(STATUS, nevh_sections_observe, (NULL, 0, 0.1, in, in))                   \
    X(ANY, nevh_sections_counts, (NULL))                                       \
    X(STATUS, nevh_scene_vary, (NULL, NULL, 0))                                \
    X(STATUS, nevh_scene_set_outcomes, (NULL, "x"))                            \
    X(MADE, nevh_sweep_new, (NULL, NULL))                                      \
    X(ANY, nevh_sweep_free, (NULL))                                            \
    X(STATUS, nevh_sweep_status, (NULL))                                       \
    X(TEXT, nevh_sweep_message, (NULL))                                        \
    X(NUMBER, nevh_sweep_members, (NULL))                                      \
    X(NUMBER, nevh_sweep_columns, (NULL))                                      \
    X(NUMBER, nevh_sweep_varied, (NULL))                                       \
    X(TEXT, nevh_sweep_column, (NULL, 0))                                      \
    X(NUMBER, nevh_sweep_is_of_values, (NULL, 0))                              \
    X(NUMBER, nevh_sweep_is_verdict, (NULL, 0))                                \
    X(STATUS, nevh_sweep_run, (NULL, 0, 0, NULL, NULL, NULL))                  \
    X(STATUS, nevh_sweep_run_chunks, (NULL, NULL, NULL, NULL, NULL, NULL))     \
    X(STATUS, nevh_sweep_keep, (NULL, NULL))                                   \
    X(STATUS, nevh_scene_own_outcomes, (NULL, NULL, NULL, 0))                  \
    X(ANY, nevh_sweep_stop, (NULL))                                            \
    X(ANY, nevh_system_free, (NULL))                                           \
    X(STATUS, nevh_system_add, (NULL, NULL))                                   \
    X(STATUS, nevh_system_add_masses, (NULL, "x", in))                         \
    X(STATUS, nevh_system_add_friction, (NULL, "x", in))                       \
    X(STATUS, nevh_system_enable, (NULL, "x", true))                           \
    X(STATUS, nevh_system_set_speed, (NULL, "x", NEVH_SLOW))                   \
    X(STATUS, nevh_system_parts, (NULL, "x", NULL, NULL, NULL))                \
    X(STATUS, nevh_system_effect_parts, (NULL, NULL, NULL))                    \
    X(STATUS, nevh_system_status, (NULL))                                      \
    X(TEXT, nevh_system_message, (NULL))                                       \
    X(NUMBER, nevh_system_dof, (NULL))                                         \
    X(NUMBER, nevh_system_effect_count, (NULL))                                \
    X(TEXT, nevh_system_effect_name, (NULL, 0))                                \
    X(NUMBER, nevh_system_effect_on, (NULL, "x"))                              \
    X(NUMBER, nevh_system_friction, (NULL, out))                               \
    X(NUMBER, nevh_system_traits, (NULL))                                      \
    X(STATUS, nevh_system_probe, (NULL, 0.1, in, in, in, &separability))

/* The same of texts and outputs, of an object that is there. */
static const char scene_text[] =
    "[coordinates]\nx = 1\n[effects]\nkinetic = p_x^2/2\nspring = x^2/2\n"
    "[run]\nt_end = 1\ndt = 0.1\nintegrators = verlet\n";

static void refuse_scene(nevh_scene *s) {
    ck_assert_int_eq(nevh_scene_status(s), NEVH_EINVAL);
    ck_assert_ptr_nonnull(nevh_scene_message(s));
    nevh_scene_free(s);
}

TEST(null_texts_are_refused) {
    static const char *const nothing[] = {NULL};
    refuse_scene(nevh_scene_parse("x", NULL));
    refuse_scene(nevh_scene_parse(NULL, NULL));
    refuse_scene(nevh_scene_read(NULL));
    refuse_scene(nevh_scene_read_with(NULL, NULL));
    nevh_scene_free(nevh_scene_read_with(
        "/dev/null",
        &(nevh_scene_options){.effects = nothing, .n_effects = 1}));
    nevh_scene_free(nevh_scene_read_with(
        "/dev/null", &(nevh_scene_options){.n_effects = 1}));
    nevh_scene *s = nevh_scene_parse(NULL, scene_text);
    ck_assert_int_eq(nevh_scene_status(s), NEVH_OK);
    ck_assert_ptr_nonnull(nevh_scene_label(s, NULL));
    ck_assert_int_eq(nevh_scene_judged_value(s, 0, in, in, NULL), NEVH_EINVAL);
    ck_assert_int_eq(nevh_scene_stop_reached(s, 0, in, in, NULL), NEVH_EINVAL);
    nevh_sweep_free(nevh_sweep_new(s, NULL));
    const nevh_system *system = nevh_scene_system(s);
    ck_assert_int_eq(nevh_system_probe(system, 0, in, in, NULL, NULL),
                     NEVH_EINVAL);
    nevh_scene_free(s);
    ck_assert_int_eq(nevh_energy_verdict(NULL, 1), NEVH_UNDECIDED);
    ck_assert(nevh_uniform_at(1, NULL, 2) == nevh_uniform_at(1, "", 2));
    ck_assert(isfinite(nevh_normal_at(1, NULL, 2)));
}

#define STATUS(name, call) ck_assert_int_ne(call, NEVH_OK)
#define TEXT(name, call)   ck_assert_ptr_nonnull(call)
#define NUMBER(name, call) ck_assert((call) == 0)
#define REAL(name, call)                                                       \
    double found = call;                                                       \
    ck_assert(found == 0 || isnan(found))
#define MADE(name, call)    (void)(call)
#define RATES(name, call)   nevh_rates_free(call)
#define POINTER(name, call) ck_assert_ptr_null(call)
#define ANY(name, call)     (void)(call)

#define CALL(kind, name, arguments)                                            \
    static void call_##name(void) {                                            \
        kind(name, name arguments);                                            \
    }
CALLS(CALL)
#define ENTRY(kind, name, arguments) {#name, call_##name},
static const struct {
    const char *name;
    void (*call)(void);
} calls[] = {CALLS(ENTRY)};
enum { COUNT = sizeof calls / sizeof *calls };

/* Outputs stay as they were. */
TEST_EACH(null_is_taken, COUNT) {
    for (int i = 0; i < ROOM; i++)
        out[i] = 7;
    calls[_i].call();
    for (int i = 0; i < ROOM; i++)
        ck_assert_msg(out[i] == 7, "%s writes", calls[_i].name);
    ck_assert_msg(!flag, "%s writes", calls[_i].name);
}

/* A declaration is no object, and is needed; so is an integrator. */
TEST(null_is_refused) {
    nevh_system *s = nevh_system_new(1);
    nevh_stepper *m =
        nevh_stepper_new(s, nevh_integrator_named("verlot"), NULL);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_EINVAL);
    ck_assert_int_eq(nevh_system_add(s, NULL), NEVH_EINVAL);
    assert_says(nevh_system_message(s), "the term is NULL");
    nevh_stepper_free(m);
    nevh_system_free(s);
}
