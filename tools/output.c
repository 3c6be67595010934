/* nevh: files that are there when they are whole.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tool.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* mkstemp lets only the owner read. */
static void allow_as_usual(int file) {
    mode_t mask = umask(0);
    umask(mask);
    fchmod(file, 0666 & ~mask);
}

int output_open(output *o, const char *name) {
    *o = (output){.stream = stdout};
    if (!name)
        return TOOL_OK;
    o->name = text_print("%s", name);
    o->temporary = text_print("%s.XXXXXX", name);
    int file = mkstemp(o->temporary);
    o->stream = file < 0 ? NULL : fdopen(file, "w");
    if (o->stream) {
        allow_as_usual(file);
        return TOOL_OK;
    }
    tool_refuse("%s cannot be written: %s", name, strerror(errno));
    free(o->name);
    free(o->temporary);
    return TOOL_USAGE;
}

static int write_all(output *o) {
    bool wrong = ferror(o->stream);
    return (o->name ? fclose(o->stream) : fflush(o->stream)) || wrong;
}

int output_close(output *o, int status) {
    errno = 0;
    int wrong = write_all(o);
    if (o->name && !wrong && status != TOOL_USAGE)
        wrong = rename(o->temporary, o->name);
    if (wrong)
        status = tool_refuse("%s cannot be written: %s",
                             o->name ? o->name : "the output", strerror(errno));
    if (o->name && status == TOOL_USAGE)
        unlink(o->temporary);
    free(o->name);
    free(o->temporary);
    return status;
}

int output_page(const options *o, const page *p, int status) {
    output out;
    if (output_open(&out, o->file))
        return TOOL_USAGE;
    page_print(p, o->format, out.stream);
    return output_close(&out, status);
}
