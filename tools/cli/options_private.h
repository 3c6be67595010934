/* nevh: options: what they mean.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_OPTIONS_PRIVATE_H
#define NEVH_OPTIONS_PRIVATE_H

#include "tool.h"

/* Takes the argument of an option; TOOL_OK or, with a message, TOOL_USAGE. */
typedef int reader(options *, const char *argument);
reader read_with, read_without, read_set, read_variant, read_start,
    read_integrators, read_gradient, read_dt, read_tolerance, read_at,
    read_t_end, read_after, read_gradient_step, read_energy_error,
    read_state_error, read_every, read_samples, read_repeat, read_budget,
    read_match, read_by, read_format, read_file, read_plot, read_plot_script,
    read_plot_kind, read_columns, read_transform, read_observable, read_error,
    read_resume, read_from, read_quiet, read_portable, read_native, read_header,
    read_no_cache, read_all, read_allow_code, read_section, read_diagnostics,
    read_impact, read_shape, read_picture, read_vary, read_outcomes,
    read_threads, read_retry, read_exponents, read_starts, read_gali,
    read_stop_after, read_task, read_join, read_data, read_sigma, read_width,
    read_digits, read_help, read_version;
/* That the kind of picture is one of the command's.
   returns  TOOL_OK, or TOOL_USAGE with the message printed */
int plot_kind_check(const options *, unsigned bit);

#endif
