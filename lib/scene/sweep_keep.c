/* nevh: what members leave, as records.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/sweep.h>
#include <stdio.h>
#include <string.h>

enum { HEAD = 8 }; /* the status, and bytes up to the first double */

int nevh_sweep_keep(void *records, const nevh_sweep_result *m) {
    nevh_sweep_records *r = records;
    if (!r || !m)
        return NEVH_EINVAL;
    if (m->status != NEVH_MEMBER_DONE && r->failed++ == 0) {
        r->failed_member = m->member;
        snprintf(r->message, sizeof r->message, "%s", m->message);
    }
    if (m->member < r->first || m->member - r->first >= r->count)
        return 0;
    size_t size = r->columns * sizeof *m->values;
    unsigned char *record =
        r->records + (size_t)(m->member - r->first) * (HEAD + size);
    memset(record, 0, HEAD);
    record[0] = (unsigned char)m->status;
    memcpy(record + HEAD, m->values, size);
    return 0;
}
