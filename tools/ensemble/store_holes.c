/* nevh sweep: records that nobody has written, and that take no room in a file.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "config.h"
#include "store.h"
#include <errno.h>
#include <unistd.h>

/* The first of `count` records from i on that is no hole of the file: members that
   nobody has written are missing. */
uint64_t store_skip_hole(int file, uint64_t header, uint64_t record, uint64_t i,
                         uint64_t count) {
#ifdef SEEK_DATA
    enum { PAGE = 4096 }; /* holes end with pages, at the least */
    uint64_t at = header + i * record;
    if (i >= count || at % PAGE >= record)
        return i;
    off_t data = lseek(file, (off_t)at, SEEK_DATA);
    if (data < 0)
        return errno == ENXIO ? count : i;
    uint64_t next =
        (uint64_t)data > at ? ((uint64_t)data - header) / record : i;
    return next < count ? next : count;
#else
    (void)file, (void)header, (void)record, (void)count;
    return i;
#endif
}
