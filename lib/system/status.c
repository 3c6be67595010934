/* nevh: statuses and messages.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/system_private.h"
#include "system/print_private.h"
#include <gsl/gsl_errno.h>

_Static_assert((int)NEVH_OK == GSL_SUCCESS, "as GSL");
_Static_assert((int)NEVH_EDOM == GSL_EDOM, "as GSL");
_Static_assert((int)NEVH_EINVAL == GSL_EINVAL, "as GSL");
_Static_assert((int)NEVH_EFAILED == GSL_EFAILED, "as GSL");
_Static_assert((int)NEVH_ENOMEM == GSL_ENOMEM, "as GSL");
_Static_assert((int)NEVH_EMAXITER == GSL_EMAXITER, "as GSL");

const char *nevh_status_text(int status) {
#define ENTRY(name, number, text)                                              \
    case number:                                                               \
        return text;
    switch (status) {
        NEVH_STATUS_LIST(ENTRY)
    default:
        return "unknown status";
    }
#undef ENTRY
}

int nevh__vfail(nevh__report *report, int status, const char *format,
                va_list arguments) {
    report->status = status;
    nevh__vprint(report->text, sizeof report->text, format, arguments);
    return status;
}

int nevh__fail(nevh__report *report, int status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    nevh__vfail(report, status, format, arguments);
    va_end(arguments);
    return status;
}

int nevh__no_memory(nevh__report *report) {
    return nevh__fail(report, NEVH_ENOMEM, "out of memory");
}

int nevh__fail_as(nevh__report *report, const nevh__report *other) {
    *report = *other;
    return report->status;
}
