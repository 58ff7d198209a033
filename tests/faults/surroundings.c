/* A file system that refuses locks, and a clock that jumps: what no test can have for real without hurting the machine. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/time.h>
#include <time.h>

static int refused(void) {
    const char *number = getenv("FAULTS_LOCKS");
    if (number) errno = atoi(number);
    return number != NULL;
}

int flock(int file, int operation) {
    static int (*real)(int, int);
    if (refused()) return -1;
    if (!real) real = dlsym(RTLD_NEXT, "flock");
    return real(file, operation);
}

static int with_argument(const char *name, int file, int command, void *argument) {
    int (*real)(int, int, ...) = dlsym(RTLD_NEXT, name);
    int locks = command == F_SETLK || command == F_SETLKW || command == F_OFD_SETLK || command == F_OFD_SETLKW;
    return locks && refused() ? -1 : real(file, command, argument);
}

#define OVERRIDE(name)                                           \
    int name(int file, int command, ...) {                       \
        va_list arguments;                                       \
        va_start(arguments, command);                            \
        void *argument = va_arg(arguments, void *);              \
        va_end(arguments);                                       \
        return with_argument(#name, file, command, argument);    \
    }
OVERRIDE(fcntl)
OVERRIDE(fcntl64)

/* Each half second the clock of the wall is another: right, FAULTS_CLOCK seconds ahead, as many behind. */
int clock_gettime(clockid_t clock, struct timespec *now) {
    static int (*real)(clockid_t, struct timespec *);
    struct timespec steady;
    const char *jump = getenv("FAULTS_CLOCK");
    if (!real) real = dlsym(RTLD_NEXT, "clock_gettime");
    int result = real(clock, now);
    if (jump && clock == CLOCK_REALTIME && !real(CLOCK_MONOTONIC, &steady)) {
        long half = steady.tv_sec * 2 + steady.tv_nsec / 500000000;
        now->tv_sec += (half % 3 - 1) * atol(jump);
    }
    return result;
}
