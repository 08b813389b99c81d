// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// An emulated V4L2 camera for programs started with LD_PRELOAD: takes the place of the C library's
// functions that v4l2src calls on a device. For tests only.
//
//   CALVIN_V4L2_DEVICE    the path that is the camera (/dev/video0), or those of several
//   CALVIN_V4L2_FPS       frames per second (30); poses change every 15 frames at any rate
//   CALVIN_V4L2_FORMATS   what it offers, of YUYV, MJPG, NV12 and GREY (YUYV,MJPG)
//   CALVIN_V4L2_SIZES     likewise, even ones (640x480,320x240)
//   CALVIN_V4L2_BOARD     the board that it sees (checkerboard:9x6:25mm)
//   CALVIN_V4L2_CONTROLS  where its controls stand at first (focus_automatic_continuous=1,
//                         focus_absolute=30,zoom_absolute=100), or none, of cameras without any
//   CALVIN_V4L2_RING      MB of pictures that are rendered before the first frame and shown again
//                         and again, so that a frame costs its copy; 0: each when it is first shown
//   CALVIN_V4L2_LOSE      one frame in so many is lost; 0: those alone that no buffer waits for
//   CALVIN_V4L2_UNPLUG    frames after which the cable is pulled; 0: never
//   CALVIN_V4L2_PLUG      a file: the cable is in while it exists, and UNPLUG removes it. Without
//                         one a camera that was unplugged is gone for the rest of the process
//   CALVIN_V4L2_COUNTERS  a file to which each stream appends a line of JSON when it ends
//
// Several cameras have the same formats, sizes and rate, and poses of their own. Of DEVICE, LOSE,
// UNPLUG and PLUG each takes its part between commas, and of BOARD between semicolons; where there
// are fewer boards, the others see the first.

// Headers must not turn open into open64, nor into its checked variant: both are defined here.
#undef _FILE_OFFSET_BITS
#undef _FORTIFY_SOURCE

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>

#include "device.hpp"

#define CALVIN_EXPORT extern "C" __attribute__((visibility("default")))

using namespace calvin::v4l2;

namespace {

// By descriptor. Atomic and never destroyed: close() is called from everywhere, after fork() and
// at exit too.
constexpr int kMaxDescriptors = 1024;
std::array<std::atomic<Device*>, kMaxDescriptors> devices;

std::atomic<Device*>* slot(int fd) {
  return fd >= 0 && fd < kMaxDescriptors ? &devices[static_cast<std::size_t>(fd)] : nullptr;
}

Device* device_of(int fd) {
  const auto* s = slot(fd);
  return s == nullptr ? nullptr : s->load();
}

template <typename Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

// Gives the caller one more descriptor of the device; -1 and errno where that fails.
int hand_out(Device* device, int flags) {
  const int fd =
      ::fcntl(device->ready_fd(), (flags & O_CLOEXEC) != 0 ? F_DUPFD_CLOEXEC : F_DUPFD, 0);
  auto* s = slot(fd);
  if (s == nullptr) {
    errno = EMFILE;
    return -1;
  }
  ++device->references;
  s->store(device);
  return fd;
}

int open_camera(int camera, int flags) {
  Device* device = nullptr;
  try {
    Settings settings(camera);
    if (!is_plugged_in(settings)) {
      errno = ENOENT;
      return -1;
    }
    device = new Device(std::move(settings), (flags & O_NONBLOCK) == 0);
  } catch (...) {
    errno = ENOMEM;
    return -1;
  }
  const int fd = hand_out(device, flags);
  if (fd < 0) delete device;
  return fd;
}

template <typename Stat>
int describe(int camera, Stat* info) {
  if (!is_plugged_in(Settings(camera))) {
    errno = ENOENT;
    return -1;
  }
  std::memset(info, 0, sizeof(*info));
  info->st_mode = S_IFCHR | 0660;
  info->st_nlink = 1;
  info->st_rdev = makedev(81, static_cast<unsigned>(camera));
  return 0;
}

}  // namespace

#define CALVIN_OPEN(name)                                                            \
  CALVIN_EXPORT int name(const char* path, int flags, ...) {                         \
    if (const int n = camera_at(path); n >= 0) return open_camera(n, flags);         \
    static const auto function = real<int(const char*, int, ...)>(#name);            \
    va_list arguments;                                                               \
    va_start(arguments, flags);                                                      \
    const bool creates = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE; \
    const mode_t mode = creates ? va_arg(arguments, mode_t) : 0;                     \
    va_end(arguments);                                                               \
    return function(path, flags, mode);                                              \
  }
CALVIN_OPEN(open)
CALVIN_OPEN(open64)

// What open() is in programs built with _FORTIFY_SOURCE.
#define CALVIN_OPEN_2(name)                                                  \
  CALVIN_EXPORT int name(const char* path, int flags) {                      \
    if (const int n = camera_at(path); n >= 0) return open_camera(n, flags); \
    static const auto function = real<int(const char*, int)>(#name);         \
    return function(path, flags);                                            \
  }
CALVIN_OPEN_2(__open_2)
CALVIN_OPEN_2(__open64_2)

#define CALVIN_STAT(name, Stat)                                               \
  CALVIN_EXPORT int name(const char* path, struct Stat* info) noexcept {      \
    if (const int n = camera_at(path); n >= 0) return describe(n, info);      \
    static const auto function = real<int(const char*, struct Stat*)>(#name); \
    return function(path, info);                                              \
  }
CALVIN_STAT(stat, stat)
CALVIN_STAT(stat64, stat64)

#define CALVIN_MMAP(name, Offset)                                                                \
  CALVIN_EXPORT void* name(void* address, std::size_t length, int protection, int flags, int fd, \
                           Offset offset) noexcept {                                             \
    static const auto function = real<void*(void*, std::size_t, int, int, int, Offset)>(#name);  \
    const Device* device = device_of(fd);                                                        \
    return function(address, length, protection, flags,                                          \
                    device == nullptr ? fd : device->memory_fd(), offset);                       \
  }
CALVIN_MMAP(mmap, off_t)
CALVIN_MMAP(mmap64, off64_t)

CALVIN_EXPORT int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  Device* device = device_of(fd);
  if (device == nullptr) {
    static const auto function = real<int(int, unsigned long, ...)>("ioctl");
    return function(fd, request, argument);
  }
  // Callers sign-extend the request.
  const int status = device->control(static_cast<std::uint32_t>(request), argument);
  if (status >= 0) return status;
  errno = -status;
  return -1;
}

CALVIN_EXPORT int dup(int fd) noexcept {
  if (Device* device = device_of(fd)) return hand_out(device, 0);
  static const auto function = real<int(int)>("dup");
  return function(fd);
}

CALVIN_EXPORT int close(int fd) {
  static const auto function = real<int(int)>("close");
  auto* s = slot(fd);
  Device* device = s == nullptr ? nullptr : s->exchange(nullptr);
  // A child process has the descriptors, but not the thread that a Device would wait for.
  if (device != nullptr && --device->references == 0 && device->process == ::getpid())
    delete device;
  return function(fd);
}
