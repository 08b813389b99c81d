// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Files whose name has "hung" in it do not answer, as on a server that is down. One source file of
// a program includes it.
#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cstring>

#include <glib.h>

namespace calvin::check {

inline std::atomic<bool> down = false;
inline std::atomic<int> waiting = 0;

inline void wait_for_server(const char* path) {
  if (std::strstr(path, "hung") == nullptr) return;
  ++waiting;
  while (down) g_usleep(1000);
  --waiting;
}

inline bool is_waiting() { return waiting > 0; }

}  // namespace calvin::check

// In the place of the C library's, for the libraries too. With 64-bit offsets open() is open64().
extern "C" {
int hung_open(const char* path, int flags, mode_t mode) asm("open64");
int hung_open(const char* path, int flags, mode_t mode) {
  calvin::check::wait_for_server(path);
  return openat(AT_FDCWD, path, flags, mode);
}
int hung_stat64(const char* path, struct stat* info) asm("stat64");
int hung_stat64(const char* path, struct stat* info) {
  calvin::check::wait_for_server(path);
  return fstatat(AT_FDCWD, path, info, 0);
}
int hung_stat(const char* path, struct stat* info) asm("stat");
int hung_stat(const char* path, struct stat* info) { return hung_stat64(path, info); }
}
