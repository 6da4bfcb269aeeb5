// SPDX-License-Identifier: GPL-3.0-or-later
// Preloaded by the campaign of kills: the system calls that bring something to a folder, counted,
// and one of them made to fail or to be the last thing that the process does.
//
//   DOOM_FOLDER  calls on files and names below it count
//   DOOM_CALL    which of them fails, from 1; 0: none
//   DOOM_ERROR   with which errno; 0: the process is killed before the call
//   DOOM_COUNT   file that gets the number of calls at the end
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

static atomic_long calls;

static long number(const char* name) {
  const char* given = getenv(name);
  return given == NULL ? 0 : strtol(given, NULL, 10);
}

// Writes the path of an open file; whether there is one.
static int path_of(int descriptor, char* path, size_t size) {
  char name[64];
  snprintf(name, sizeof name, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(name, path, size - 1);
  if (length < 0) return 0;
  path[length] = 0;
  return 1;
}

// A relative path begins at this folder, or at the working directory.
static int below_at(int at, const char* path) {
  const char* folder = getenv("DOOM_FOLDER");
  char whole[PATH_MAX];
  if (folder == NULL || path == NULL) return 0;
  if (path[0] != '/') {
    const int known =
        at == AT_FDCWD ? getcwd(whole, sizeof whole) != NULL : path_of(at, whole, sizeof whole);
    if (!known || strlen(whole) + strlen(path) + 2 > sizeof whole) return 0;
    strcat(whole, "/");
    strcat(whole, path);
    path = whole;
  }
  return strncmp(path, folder, strlen(folder)) == 0;
}

static int below(const char* path) {
  return below_at(AT_FDCWD, path);
}

static int below_of(int descriptor) {
  char path[PATH_MAX];
  return path_of(descriptor, path, sizeof path) && below(path);
}

// Whether this call fails; errno is set.
static int doomed(int counts) {
  if (!counts || atomic_fetch_add(&calls, 1) + 1 != number("DOOM_CALL")) return 0;
  const long error = number("DOOM_ERROR");
  if (error == 0) raise(SIGKILL);
  errno = (int)error;
  return 1;
}

__attribute__((destructor)) static void told(void) {
  const char* path = getenv("DOOM_COUNT");
  const long counted = atomic_load(&calls);
  if (path == NULL || counted == 0) return;
  FILE* file = fopen(path, "w");
  if (file != NULL) {
    fprintf(file, "%ld\n", counted);
    fclose(file);
  }
}

// Opening counts where it may make the file.
#define MODE(flags, mode)                                      \
  mode_t mode = 0;                                             \
  if (((flags)&O_CREAT) || ((flags)&O_TMPFILE) == O_TMPFILE) { \
    va_list more;                                              \
    va_start(more, flags);                                     \
    mode = (mode_t)va_arg(more, unsigned);                     \
    va_end(more);                                              \
  }

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int descriptor, const void* content, size_t count) {
  if (doomed(below_of(descriptor))) return -1;
  return syscall(SYS_write, descriptor, content, count);
}

ssize_t writev(int descriptor, const struct iovec* parts, int count) {
  if (doomed(below_of(descriptor))) return -1;
  return NEXT(writev)(descriptor, parts, count);
}

ssize_t pwrite64(int descriptor, const void* content, size_t count, off64_t offset) {
  if (doomed(below_of(descriptor))) return -1;
  return NEXT(pwrite64)(descriptor, content, count, offset);
}

int fsync(int descriptor) {
  if (doomed(below_of(descriptor))) return -1;
  return NEXT(fsync)(descriptor);
}

int rename(const char* before, const char* after) {
  if (doomed(below(after))) return -1;
  return NEXT(rename)(before, after);
}

int mkdir(const char* path, mode_t mode) {
  if (doomed(below(path))) return -1;
  return NEXT(mkdir)(path, mode);
}

int rmdir(const char* path) {
  if (doomed(below(path))) return -1;
  return NEXT(rmdir)(path);
}

int unlink(const char* path) {
  if (doomed(below(path))) return -1;
  return NEXT(unlink)(path);
}

int unlinkat(int at, const char* path, int flags) {
  if (doomed(below_at(at, path))) return -1;
  return NEXT(unlinkat)(at, path, flags);
}

int open64(const char* path, int flags, ...) {
  MODE(flags, mode)
  if (doomed((flags & O_CREAT) && below(path))) return -1;
  return NEXT(open64)(path, flags, mode);
}

int openat64(int at, const char* path, int flags, ...) {
  MODE(flags, mode)
  if (doomed((flags & O_CREAT) && below_at(at, path))) return -1;
  return NEXT(openat64)(at, path, flags, mode);
}
