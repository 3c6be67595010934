/* nevh: the folder of compiled steps.

   Files end with a digest of what is before it, so that one that was cut short
   is made anew instead of being loaded.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _XOPEN_SOURCE 700
#include "native/compiler_private.h"
#include "native/native_private.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { MOST_BYTES = 1 << 26, MOST_OBJECT = 1 << 24 };

static char *usual_folder(void) {
    const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    if (cache && cache[0] == '/')
        return nevh__text("%s/nevh", cache);
    return home && home[0] == '/' ? nevh__text("%s/.cache/nevh", home) : NULL;
}

/* The folders on the way, too. */
static void make_folders(char *path) {
    for (char *slash = path + 1; (slash = strchr(slash, '/')); slash++) {
        *slash = '\0';
        mkdir(path, 0700);
        *slash = '/';
    }
    mkdir(path, 0700);
}

/* True if others may put another folder in the place of one on the way; the sticky
   bit prevents it. */
static bool may_be_replaced(const char *folder) {
    char *path = nevh__text("%s", folder);
    bool open = !path;
    for (char *slash = path; !open && (slash = strrchr(path, '/'));) {
        struct stat found;
        slash[slash == path] = '\0';
        open = stat(path, &found) == 0 && (found.st_mode & S_IWOTH) &&
               !(found.st_mode & S_ISVTX);
        if (slash == path)
            break;
    }
    free(path);
    return open;
}

char *nevh__cache_folder(const char *given, char why[NEVH__WHY_NATIVE]) {
    struct stat found;
    char *folder = given ? nevh__text("%s", given) : usual_folder();
    if (!folder) {
        snprintf(why, NEVH__WHY_NATIVE, "there is no home folder");
        return NULL;
    }
    if (lstat(folder, &found) && errno == ENOENT)
        make_folders(folder);
    const char *wrong = NULL;
    if (lstat(folder, &found))
        wrong = "cannot be made";
    else if (!S_ISDIR(found.st_mode))
        wrong = "is no folder";
    else if (found.st_uid != geteuid())
        wrong = "is another user's";
    else if (found.st_mode & 022)
        wrong = "may be written to by others";
    else if (may_be_replaced(folder))
        wrong = "stands in a folder that others may write to";
    if (!wrong)
        return folder;
    snprintf(why, NEVH__WHY_NATIVE, "%.300s %s", folder, wrong);
    free(folder);
    return NULL;
}

static uint64_t digest(const char *bytes, size_t count) {
    uint64_t sum = 0xcbf29ce484222325u;
    for (size_t i = 0; i < count; i++) {
        sum = (sum ^ (unsigned char)bytes[i]) * 0x100000001b3u;
        sum ^= sum >> 29;
    }
    return sum;
}

/* A file that is loaded must be this user's, and written by nobody else. */
static bool is_own(const char *path) {
    struct stat file;
    return lstat(path, &file) == 0 && S_ISREG(file.st_mode) &&
           file.st_uid == geteuid() && !(file.st_mode & 022);
}

/* To be freed; NULL: it cannot be read, or is too large. */
static char *read_file(const char *path, size_t *count) {
    struct stat found;
    FILE *file = fopen(path, "rbe");
    char *bytes = NULL;
    if (!file)
        return NULL;
    if (!fstat(fileno(file), &found) && S_ISREG(found.st_mode) &&
        found.st_size > 0 && found.st_size < MOST_OBJECT)
        bytes = malloc((size_t)found.st_size + sizeof(uint64_t));
    *count = bytes ? fread(bytes, 1, (size_t)found.st_size, file) : 0;
    if (bytes && *count != (size_t)found.st_size) {
        free(bytes);
        bytes = NULL;
    }
    fclose(file);
    return bytes;
}

bool nevh__cache_is_whole(const char *path) {
    size_t count;
    uint64_t end;
    char *bytes = is_own(path) ? read_file(path, &count) : NULL;
    bool whole = bytes && count > sizeof end;
    if (whole) {
        memcpy(&end, bytes + count - sizeof end, sizeof end);
        whole = end == digest(bytes, count - sizeof end);
    }
    free(bytes);
    if (whole)
        utimensat(AT_FDCWD, path, NULL, 0); /* it is of use: others go first */
    return whole;
}

/* Removes files that a killed program left. */
static void remove_old(const char *folder, const char *name, time_t made) {
    enum { OLD = 3600 };
    char *path = NULL;
    if (strstr(name, ".so.") && time(NULL) - made > OLD)
        path = nevh__text("%s/%s", folder, name);
    if (path)
        nevh__folder_remove(path);
    free(path);
}

/* Bytes of all files; `oldest`: out, the one to go next. */
static double cache_look(const char *folder, char oldest[]) {
    double bytes = 0;
    struct stat found, first = {0};
    DIR *all = opendir(folder);
    oldest[0] = '\0';
    for (struct dirent *file; all && (file = readdir(all));) {
        if (fstatat(dirfd(all), file->d_name, &found, AT_SYMLINK_NOFOLLOW))
            continue;
        if (S_ISDIR(found.st_mode))
            remove_old(folder, file->d_name, found.st_mtime);
        if (!S_ISREG(found.st_mode))
            continue;
        bytes += (double)found.st_size;
        if (!oldest[0] || found.st_mtime < first.st_mtime) {
            first = found;
            snprintf(oldest, NAME_MAX + 1, "%s", file->d_name);
        }
    }
    if (all)
        closedir(all);
    return bytes;
}

static void cache_make_room(const char *folder) {
    char oldest[NAME_MAX + 1];
    while (cache_look(folder, oldest) > MOST_BYTES && oldest[0]) {
        char *path = nevh__text("%s/%s", folder, oldest);
        bool gone = path && unlink(path) == 0;
        free(path);
        if (!gone)
            return;
    }
}

static bool write_all(int file, const char *bytes, size_t count) {
    while (count) {
        ssize_t written = write(file, bytes, count);
        if (written < 0 && errno != EINTR)
            return false;
        if (written > 0) {
            bytes += written;
            count -= (size_t)written;
        }
    }
    return true;
}

/* Under another name first, so that nobody finds half of it. */
static bool write_file(const char *folder, const char *to, const char *bytes,
                       size_t count) {
    char *name = nevh__text("%s/new-XXXXXX", folder);
    int file = name ? mkstemp(name) : -1;
    bool there = file >= 0;
    if (there) {
        there = write_all(file, bytes, count);
        there = close(file) == 0 && there;
        there = there && rename(name, to) == 0;
        if (!there)
            unlink(name);
    }
    free(name);
    return there;
}

bool nevh__cache_store(const char *folder, const char *from, const char *to) {
    size_t count;
    char *bytes = read_file(from, &count);
    if (!bytes)
        return false;
    uint64_t end = digest(bytes, count);
    memcpy(bytes + count, &end, sizeof end);
    bool there = write_file(folder, to, bytes, count + sizeof end);
    free(bytes);
    if (there)
        cache_make_room(folder);
    return there;
}
