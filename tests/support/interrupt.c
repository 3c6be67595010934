/* nevh: interruptions at places that tests ask for.  A library that LD_PRELOAD
   puts before nevh's own; the environment says what happens:

   INTERRUPT_STEP=k    before the k-th step of a run's trajectory ...
   INTERRUPT_WRITE=k   in the k-th write to a file, of which a part is written,
                       and before it when k is negative ...
   INTERRUPT_PWRITE=k  the same of the k-th write to a place in a file ...
   INTERRUPT_FULL=k    from the k-th of these on the disk is full
   INTERRUPT_SIGNAL=n  ... this signal comes.
   INTERRUPT_CLOCK=    each look at the monotonic clock takes 10 ms, or so many as
                       it says, and each at the time of computing 10 s
   INTERRUPT_SIGN=F    file F is made when there is an interruption

   SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>
#include <nevh/run.h>

enum { PAGE = 4096 };

static long asked(const char *name) {
    const char *text = getenv(name);
    return text ? atol(text) : 0;
}

static void interrupt(void) {
    const char *sign = getenv("INTERRUPT_SIGN");
    if (sign)
        close(open(sign, O_WRONLY | O_CREAT, 0666));
    raise((int)asked("INTERRUPT_SIGNAL"));
}

static int count_steps(void *data, size_t step, double t, const double q[],
                       const double p[]) {
    static long steps;
    (void)data, (void)step, (void)t, (void)q, (void)p;
    if (++steps == asked("INTERRUPT_STEP"))
        interrupt();
    return 0;
}

/* With an observer of each step before the others. */
int nevh_orbit_run(nevh_stepper *s, const nevh_orbit *o, double q[],
                   double p[]) {
    static int (*real)(nevh_stepper *, const nevh_orbit *, double *, double *);
    if (!real)
        real = (int (*)(nevh_stepper *, const nevh_orbit *, double *,
                        double *))dlsym(RTLD_NEXT, "nevh_orbit_run");
    nevh_orbit watched = *o;
    nevh_observer *all = malloc((o->n_observers + 1) * sizeof *all);
    if (!all || !asked("INTERRUPT_STEP")) {
        free(all);
        return real(s, o, q, p);
    }
    all[0] = (nevh_observer){count_steps, NULL, 1};
    for (size_t i = 0; i < o->n_observers; i++)
        all[i + 1] = o->observers[i];
    watched.observers = all;
    watched.n_observers++;
    int status = real(s, &watched, q, p);
    free(all);
    return status;
}

/* As Linux cuts a write short in a process that is killed: between pages. */
static size_t part_of(int file, size_t count) {
    off_t at = lseek(file, 0, SEEK_CUR);
    size_t room = PAGE - (size_t)(at < 0 ? 0 : at) % PAGE;
    return count < room ? count : room;
}

ssize_t write(int file, const void *bytes, size_t count) {
    static ssize_t (*real)(int, const void *, size_t);
    static long writes;
    if (!real)
        real = (ssize_t(*)(int, const void *, size_t))dlsym(RTLD_NEXT, "write");
    long at = asked("INTERRUPT_WRITE");
    if (at == 0 || file <= STDERR_FILENO || ++writes != labs(at))
        return real(file, bytes, count);
    ssize_t written = at > 0 ? real(file, bytes, part_of(file, count)) : 0;
    interrupt();
    return written;
}

static ssize_t write_at(int file, const void *bytes, size_t count, off_t to) {
    static ssize_t (*real)(int, const void *, size_t, off_t);
    static long writes;
    if (!real)
        real = (ssize_t(*)(int, const void *, size_t, off_t))dlsym(RTLD_NEXT,
                                                                   "pwrite");
    long at = asked("INTERRUPT_PWRITE"), full = asked("INTERRUPT_FULL");
    writes++;
    if (full && writes >= full) {
        errno = ENOSPC;
        return -1;
    }
    if (writes != labs(at))
        return real(file, bytes, count, to);
    size_t room = PAGE - (size_t)to % PAGE;
    ssize_t written =
        at > 0 ? real(file, bytes, count < room ? count : room, to) : 0;
    interrupt();
    return written;
}

ssize_t pwrite(int file, const void *bytes, size_t count, off_t to) {
    return write_at(file, bytes, count, to);
}

ssize_t pwrite64(int file, const void *bytes, size_t count, off64_t to) {
    return write_at(file, bytes, count, (off_t)to);
}

int clock_gettime(clockid_t which, struct timespec *now) {
    static int (*real)(clockid_t, struct timespec *);
    static long looks;
    if (!real)
        real = (int (*)(clockid_t, struct timespec *))dlsym(RTLD_NEXT,
                                                            "clock_gettime");
    if (which != CLOCK_MONOTONIC || !getenv("INTERRUPT_CLOCK"))
        return real(which, now);
    long step = asked("INTERRUPT_CLOCK"), ms = ++looks * (step ? step : 10);
    *now = (struct timespec){ms / 1000, ms % 1000 * 1000000};
    return 0;
}

clock_t clock(void) {
    static clock_t (*real)(void);
    static clock_t looks;
    if (!real)
        real = (clock_t(*)(void))dlsym(RTLD_NEXT, "clock");
    return getenv("INTERRUPT_CLOCK") ? ++looks * 10 * CLOCKS_PER_SEC : real();
}
