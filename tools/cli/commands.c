/* nevh: the names of the commands.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tool.h"

static const struct {
    unsigned bit;
    const char *name;
} names[] = {
    {FOR_COMPARE, "compare"},
    {FOR_RUN, "run"},
    {FOR_COST, "cost"},
    {FOR_RECOMMEND, "recommend"},
    {FOR_GRADIENTS, "gradients"},
    {FOR_CHECK, "check"},
    {FOR_EFFECTS, "effects"},
    {FOR_SECTION, "section"},
    {FOR_HARD, "hard"},
    {FOR_NEW, "new"},
    {FOR_LIST, "list"},
    {FOR_SWEEP, "sweep"},
    {FOR_EXPORT, "export"},
    {FOR_FLOW, "flow"},
    {FOR_REFERENCE, "reference"},
    {FOR_REPORT, "report"},
    {FOR_PORTRAIT, "portrait"},
    {FOR_CHAOS, "chaos"},
    {FOR_FREQUENCIES, "frequencies"},
    {FOR_FIT, "fit"},
    {FOR_PAGE, "page"},
};

const char *command_name(unsigned bit) {
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (names[i].bit == bit)
            return names[i].name;
    return "";
}
