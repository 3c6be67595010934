/* nevh: what bindings of other languages ask before they call anything.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_BINDING_H
#define NEVH_BINDING_H

#include <nevh/status.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of these headers, for #if. */
#define NEVH_VERSION_MAJOR 0
#define NEVH_VERSION_MINOR 1
#define NEVH_VERSION_PATCH 0

/* The version of the library, as "0.1.0".  Thread-safe. */
NEVH_API const char *nevh_version(void);

/* The bytes of a public structure by its name, as "nevh_options"; 0: none of
   that name is handed across.  A binding that declares structures anew compares
   its own sizes with these, and refuses a library with others.  Thread-safe. */
NEVH_API size_t nevh_size_of(const char *type);

#ifdef __cplusplus
}
#endif
#endif
