/* nevh tests: what the registries say.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include "schemes_private.h"
#include <nevh/extend.h>
#include <string.h>

TEST_EACH(scheme_is_described, registered_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    ck_assert_int_gt((int)strlen(nevh_integrator_name(scheme)), 0);
    ck_assert_int_gt((int)strlen(nevh_integrator_source(scheme)), 10);
    ck_assert_ptr_nonnull(nevh_integrator_aliases(scheme));
    ck_assert_int_ge(nevh_integrator_order(scheme), 1);
    ck_assert_int_ge(nevh_integrator_stages(scheme), 1);
    ck_assert_ptr_nonnull(scheme->kernel);
    if (nevh_integrator_explicit(scheme) == NEVH_YES)
        ck_assert(nevh_integrator_gradients(scheme) >= 1 ||
                  nevh_integrator_adaptive(scheme));
}

TEST_EACH(scheme_is_found_by_its_names, registered_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    ck_assert_ptr_eq(nevh_integrator_named(nevh_integrator_name(scheme)),
                     scheme);
    char names[200];
    strcpy(names, nevh_integrator_aliases(scheme));
    for (char *name = strtok(names, ","); name; name = strtok(NULL, ","))
        ck_assert_ptr_eq(nevh_integrator_named(name + strspn(name, " ")),
                         scheme);
}

TEST(unknown_names) {
    const char *const names[] = {"", "verlot", "verle", "verlet2", ",", " "};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        ck_assert_ptr_null(nevh_integrator_named(names[i]));
        ck_assert_ptr_null(nevh_gradient_named(names[i]));
        ck_assert_ptr_null(nevh_model_named(names[i]));
    }
    ck_assert_ptr_null(nevh_integrator_named(NULL));
    ck_assert_ptr_null(nevh_gradient_named(NULL));
    ck_assert_ptr_null(nevh_model_named(NULL));
}

TEST(public_pointers_are_listed) {
#define EXPORTED(id) nevh_##id,
    const nevh_integrator *const schemes[] = {NEVH__SCHEMES(EXPORTED)};
    int count = sizeof schemes / sizeof *schemes;
    ck_assert_int_eq(registered_count(), count);
    for (int i = 0; i < count; i++)
        ck_assert_ptr_eq(nevh_integrators()[i], schemes[i]);
}

TEST(gradients_are_listed) {
    const nevh_gradient *const methods[] = {nevh_central2,     nevh_central4,
                                            nevh_central6,     nevh_central8,
                                            nevh_complex_step, nevh_exact};
    const char *const names[] = {"central2", "central4",     "central6",
                                 "central8", "complex-step", "exact"};
    for (int i = 0; i < 6; i++) {
        ck_assert_ptr_eq(nevh_gradients()[i], methods[i]);
        ck_assert_str_eq(nevh_gradient_name(methods[i]), names[i]);
        ck_assert_ptr_eq(nevh_gradient_named(names[i]), methods[i]);
        ck_assert_int_eq(nevh_gradient_order(methods[i]),
                         i < 4 ? 2 * i + 2 : 0);
    }
    ck_assert_ptr_null(nevh_gradients()[6]);
}

TEST(claims_have_names) {
    ck_assert_str_eq(nevh_claim_name(NEVH_NO), "no");
    ck_assert_str_eq(nevh_claim_name(NEVH_YES), "yes");
    ck_assert_str_eq(nevh_claim_name(NEVH_UNPROVEN), "unproven");
    ck_assert_str_eq(nevh_claim_name(NEVH_EXTENDED), "extended");
    ck_assert_str_eq(nevh_claim_name((nevh_claim)9), "unknown");
}

TEST(statuses_have_texts) {
    ck_assert_str_eq(nevh_status_text(NEVH_OK), "no error");
    ck_assert_str_eq(nevh_status_text(-7), "unknown status");
#define DIFFERS(name, number, text)                                            \
    ck_assert_str_eq(nevh_status_text(number), text);
    NEVH_STATUS_LIST(DIFFERS)
#undef DIFFERS
}
