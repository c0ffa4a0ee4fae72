/* Faults of system calls below a process, HDF5's own among them: preloaded, it stands between everybody and libc.

   Calls on files of one folder are counted from the moment that faults_arm is called; at one of them a fault happens.
   The outcome stands in a page that the process shares with the one that forked it. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

enum { MOST_FILES = 4096 };
/* What happens: a fault of 1 or more is an error number. */
enum { KILL = 0, INTERRUPT = -1, KILL_AFTER = -2, SHORT = -3, FULL = -4, TERMINATE = -5 };

struct outcome {
    long calls;
    char name[24];
    char caller[72];
};

static char folder[4096];
static size_t folder_length;
static long at = -1;
static int fault;
static volatile int full;
static struct outcome *outcome;
static char ours[MOST_FILES];

void faults_arm(const char *path, long call, int what, void *page) {
    strncpy(folder, path, sizeof folder - 1);
    folder_length = strlen(folder);
    at = call;
    fault = what;
    outcome = page;
    memset(outcome, 0, sizeof *outcome);
}

static int of_folder(const char *path) { return outcome && path && !strncmp(path, folder, folder_length); }
/* 1 for a file of the folder, 2 for the folder itself. */
static int of_file(int fd) { return outcome && fd >= 0 && fd < MOST_FILES ? ours[fd] : 0; }

/* Count a call; return the error that stands for it, 0 where it goes on, -1 where it is to do half, -2 to kill after. */
static int strike(const char *name, const void *from, int writes) {
    long number = __sync_fetch_and_add(&outcome->calls, 1);
    if (full && writes) return ENOSPC;
    if (number != at) return 0;
    Dl_info info;
    strncpy(outcome->name, name, sizeof outcome->name - 1);
    if (dladdr(from, &info) && info.dli_fname) {
        const char *slash = strrchr(info.dli_fname, '/');
        strncpy(outcome->caller, slash ? slash + 1 : info.dli_fname, sizeof outcome->caller - 1);
    }
    switch (fault) {
    case KILL: kill(getpid(), SIGKILL); for (;;) pause();
    case INTERRUPT: kill(getpid(), SIGINT); return 0;
    case TERMINATE: kill(getpid(), SIGTERM); return 0;
    case KILL_AFTER: return -2;
    case SHORT: return -1;
    case FULL: full = 1; return writes ? ENOSPC : 0;
    default: return fault;
    }
}

static void end(void) { kill(getpid(), SIGKILL); for (;;) pause(); }

#define REAL(type, name, ...) \
    static type (*real)(__VA_ARGS__); \
    if (!real) real = (type (*)(__VA_ARGS__))dlsym(RTLD_NEXT, name)

/* The call, unless an error stands for it. */
#define PASS(type, called, name, writes, concerns, call, failed) \
    do { \
        int struck = (concerns) ? strike(name, __builtin_return_address(0), writes) : 0; \
        if (struck > 0) { failed; } \
        type result = call; \
        if (struck == -2) end(); \
        return result; \
    } while (0)

#define ERROR { errno = struck; return -1; }

static int opened(int fd, const char *path) {
    if (fd >= 0 && fd < MOST_FILES) ours[fd] = !of_folder(path) ? 0 : path[folder_length] ? 1 : 2;
    return fd;
}

#define OPEN(symbol) \
    int symbol(const char *path, int flags, ...) { \
        REAL(int, #symbol, const char *, int, ...); \
        va_list list; \
        va_start(list, flags); \
        mode_t mode = (mode_t)va_arg(list, int); \
        va_end(list); \
        PASS(int, symbol, "open", (flags & O_CREAT) != 0, of_folder(path), opened(real(path, flags, mode), path), ERROR); \
    }
OPEN(open)
OPEN(open64)

int close(int fd) {
    REAL(int, "close", int);
    int struck = of_file(fd) ? strike("close", __builtin_return_address(0), 0) : 0;
    if (fd >= 0 && fd < MOST_FILES) ours[fd] = 0;
    int result = real(fd);
    if (struck == -2) end();
    if (struck > 0) { errno = struck; return -1; } /* closed all the same, as Linux does it */
    return result;
}

#define TRANSFER(symbol, name, writes, buffer) \
    ssize_t symbol(int fd, buffer data, size_t count) { \
        REAL(ssize_t, #symbol, int, buffer, size_t); \
        PASS(ssize_t, symbol, name, writes, of_file(fd), real(fd, data, struck == -1 ? (count + 1) / 2 : count), ERROR); \
    }
TRANSFER(read, "read", 0, void *)
TRANSFER(write, "write", 1, const void *)

#define TRANSFER_AT(symbol, type, name, writes, buffer) \
    ssize_t symbol(int fd, buffer data, size_t count, type position) { \
        REAL(ssize_t, #symbol, int, buffer, size_t, type); \
        PASS(ssize_t, symbol, name, writes, of_file(fd), \
             real(fd, data, struck == -1 ? (count + 1) / 2 : count, position), ERROR); \
    }
TRANSFER_AT(pread, off_t, "pread", 0, void *)
TRANSFER_AT(pread64, off64_t, "pread", 0, void *)
TRANSFER_AT(pwrite, off_t, "pwrite", 1, const void *)
TRANSFER_AT(pwrite64, off64_t, "pwrite", 1, const void *)

#define OF_FILE(symbol, name, writes) \
    int symbol(int fd) { \
        REAL(int, #symbol, int); \
        PASS(int, symbol, of_file(fd) == 2 ? "fsync of folder" : name, writes, of_file(fd), real(fd), ERROR); \
    }
OF_FILE(fsync, "fsync", 1)
OF_FILE(fdatasync, "fdatasync", 1)

#define TRUNCATE(symbol, type) \
    int symbol(int fd, type length) { \
        REAL(int, #symbol, int, type); \
        PASS(int, symbol, "ftruncate", 1, of_file(fd), real(fd, length), ERROR); \
    }
TRUNCATE(ftruncate, off_t)
TRUNCATE(ftruncate64, off64_t)

#define FALLOCATE(symbol, type) \
    int symbol(int fd, type start, type length) { \
        REAL(int, #symbol, int, type, type); \
        PASS(int, symbol, "posix_fallocate", 1, of_file(fd), real(fd, start, length), return struck); \
    }
FALLOCATE(posix_fallocate, off_t)
FALLOCATE(posix_fallocate64, off64_t)

int flock(int fd, int operation) {
    REAL(int, "flock", int, int);
    PASS(int, flock, "flock", 0, of_file(fd), real(fd, operation), ERROR);
}

#define OF_NAMES(symbol, name) \
    int symbol(const char *from, const char *to) { \
        REAL(int, #symbol, const char *, const char *); \
        PASS(int, symbol, name, 1, of_folder(from) || of_folder(to), real(from, to), ERROR); \
    }
OF_NAMES(rename, "rename")
OF_NAMES(link, "link")

int renameat2(int from_folder, const char *from, int to_folder, const char *to, unsigned flags) {
    REAL(int, "renameat2", int, const char *, int, const char *, unsigned);
    PASS(int, renameat2, "renameat2", 1, of_folder(from), real(from_folder, from, to_folder, to, flags), ERROR);
}

int unlink(const char *path) {
    REAL(int, "unlink", const char *);
    PASS(int, unlink, "unlink", 0, of_folder(path), real(path), ERROR);
}

int utimensat(int place, const char *path, const struct timespec times[2], int flags) {
    REAL(int, "utimensat", int, const char *, const struct timespec *, int);
    PASS(int, utimensat, "utimensat", 1, of_folder(path), real(place, path, times, flags), ERROR);
}
