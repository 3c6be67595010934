/* nevh: numbers as text, the same in every locale.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PRINT_PRIVATE_H
#define NEVH_PRINT_PRIVATE_H

#include <stdarg.h>
#include <stddef.h>

/* snprintf, vsnprintf and strtod, of the C locale: the decimal point is a point,
   whatever the caller's locale has. */
int nevh__print(char text[], size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
int nevh__vprint(char text[], size_t size, const char *format, va_list);
double nevh__read_number(const char *text);

#endif
