/* nevh: options: the table, and how arguments are read.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_OPTIONS_PRIVATE_H
#define NEVH_OPTIONS_PRIVATE_H

#include "tool.h"

/* Reads the argument of an option into the member of the options that the row
   names; TOOL_OK or, with a message, TOOL_USAGE. */
typedef int reader(options *, const option_row *, const char *argument);
reader read_flag, read_text, read_line, read_names, read_settings,
    read_formulas, read_positive, read_count, read_choice, read_tolerance,
    read_section, read_exponents, read_data, read_output, read_stop_after,
    read_task;

#endif
