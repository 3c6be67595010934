/* nevh: inside tables.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TABLE_PRIVATE_H
#define NEVH_TABLE_PRIVATE_H

#include "tool.h"

typedef enum { TABLE_EMPTY, TABLE_TEXT, TABLE_NUMBER } table_kind;
struct table {
    list title, cell; /* cells row by row */
    table_kind *kind;
    bool *group; /* whether the row that begins with this cell begins a group */
    bool begins;
    bool rounds;     /* numbers, to ten digits */
    bool *key;       /* of each column */
    bool below;      /* the last column is printed below its row */
    size_t breaking; /* the first column that may go below; 0: none may */
};

#endif
