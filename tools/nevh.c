/* nevh: the command.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/ranks.h"
#include "config.h"
#include "cli/commands.h"
#include <errno.h>
#include <unistd.h>
#include <fcntl.h>
#include <fenv.h>
#include <gsl/gsl_errno.h>
#include <signal.h>
#include <string.h>

static int version(void) {
    puts("nevh " PACKAGE_VERSION "\nLicense GPL-3.0-or-later.  There is no "
         "warranty.");
    return TOOL_OK;
}

static int dispatch(const options *o) {
    const char *word = o->operands.count ? o->operands.item[0] : NULL;
    if (o->version)
        return version();
    if (o->help)
        return help_on(o, word);
    if (!word)
        return help_brief(stderr), TOOL_USAGE;
    const command *c = command_find(word);
    if (!c)
        return TOOL_USAGE;
    int status = command_check(c, o);
    return status ? status : c->run(o);
}

/* So that no file of ours is taken for one of these.  Who writes to one that was
   closed is told so. */
static void open_standard_files(void) {
    int file;
    do
        file = open("/dev/null", O_RDONLY);
    while (file >= 0 && file <= STDERR_FILENO);
    if (file >= 0)
        close(file);
}

/* A limit of a file's size is an error like another, and GSL, whose own handler
   aborts, is to say what it lacks.  No floating-point exception is trapped. */
static void set_process(void) {
    fenv_t ignored;
    feholdexcept(&ignored);
    open_standard_files();
    signal(SIGXFSZ, SIG_IGN);
    gsl_set_error_handler_off();
}

/* Flushes stdout and reports write errors. */
static int end_output(int status) {
    if (status != TOOL_USAGE && (fflush(stdout) || ferror(stdout)))
        return tool_refuse("the output cannot be written: %s", strerror(errno));
    return status;
}

int main(int argc, char **argv) {
    options o;
    ranks_exec(argv);
    set_process();
    int status = options_read(&o, argc, argv);
    if (!status)
        status = end_output(dispatch(&o));
    return status;
}
