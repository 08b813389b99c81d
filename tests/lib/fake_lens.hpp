// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A camera without hardware: paths with "lens" in them are V4L2 nodes that answer what a test
// wants. One source file of a program includes it. tests/v4l2shim is a whole camera, which the
// sanitizers do not take.
#pragma once

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <map>
#include <mutex>
#include <thread>

namespace calvin::fake_lens {

struct Control {
  int value = 0;
  std::uint32_t flags = 0;
};

// What the node answers.
struct Node {
  int open_error = 0;   // of errno
  int error = 0;        // of every request
  int interrupted = 0;  // requests that a signal interrupts before the next one is answered
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::map<std::uint32_t, Control> controls;
};

inline std::mutex lock;
inline Node node;                        // lock
inline std::atomic<int> opened = 0;      // times
inline std::atomic<bool> hangs = false;  // open() does, as of a driver that waits for its camera
inline std::atomic<int> hanging = 0;

template <typename F>
void change(F f) {
  const std::lock_guard guard(lock);
  f(node);
}

inline void set(std::uint32_t id, int value, std::uint32_t flags = 0) {
  change([&](Node& n) { n.controls[id] = {value, flags}; });
}

inline std::array<std::atomic<bool>, 4096> is_ours;

inline bool ours(int fd) {
  return fd >= 0 && fd < static_cast<int>(is_ours.size()) && is_ours[static_cast<std::size_t>(fd)];
}

inline int open_node(const char* path, int flags, mode_t mode) {
  const bool fake = std::strstr(path, "lens") != nullptr;
  if (fake) {
    ++hanging;
    while (hangs) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    --hanging;
    ++opened;
    const std::lock_guard guard(lock);
    if (node.open_error != 0) {
      errno = node.open_error;
      return -1;
    }
  }
  const int fd = ::openat(AT_FDCWD, fake ? "/dev/null" : path, flags, mode);
  if (fd >= 0 && fd < static_cast<int>(is_ours.size())) {
    is_ours[static_cast<std::size_t>(fd)] = fake;
  }
  return fd;
}

// 0 or an errno.
inline int answer(unsigned long request, void* argument) {
  const std::lock_guard guard(lock);
  if (node.interrupted > 0) {
    --node.interrupted;
    return EINTR;
  }
  if (node.error != 0) return node.error;
  if (request == VIDIOC_QUERYCAP) {
    auto& capability = *static_cast<v4l2_capability*>(argument);
    capability = {};
    std::snprintf(reinterpret_cast<char*>(capability.card), sizeof(capability.card), "Fake camera");
    std::snprintf(reinterpret_cast<char*>(capability.bus_info), sizeof(capability.bus_info),
                  "usb-fake-1");
    capability.device_caps = node.capabilities;
    capability.capabilities =
        node.capabilities | V4L2_CAP_DEVICE_CAPS | V4L2_CAP_VIDEO_CAPTURE;  // of all its nodes
    return 0;
  }
  if (request == VIDIOC_QUERYCTRL) {
    auto& query = *static_cast<v4l2_queryctrl*>(argument);
    const auto found = node.controls.find(query.id);
    if (found == node.controls.end()) return EINVAL;
    query.flags = found->second.flags;
    return 0;
  }
  if (request == VIDIOC_G_CTRL) {
    auto& control = *static_cast<v4l2_control*>(argument);
    const auto found = node.controls.find(control.id);
    if (found == node.controls.end()) return EINVAL;
    if ((found->second.flags & V4L2_CTRL_FLAG_WRITE_ONLY) != 0) return EACCES;
    control.value = found->second.value;
    return 0;
  }
  return ENOTTY;
}

}  // namespace calvin::fake_lens

// In the place of the C library's, for the libraries too. With 64-bit offsets open() is open64().
extern "C" {
int fake_lens_open(const char* path, int flags, mode_t mode) asm("open64");
int fake_lens_open(const char* path, int flags, mode_t mode) {
  return calvin::fake_lens::open_node(path, flags, mode);
}
int fake_lens_ioctl(int fd, unsigned long request, void* argument) asm("ioctl");
int fake_lens_ioctl(int fd, unsigned long request, void* argument) {
  if (!calvin::fake_lens::ours(fd)) {
    return static_cast<int>(::syscall(SYS_ioctl, fd, request, argument));
  }
  const int error = calvin::fake_lens::answer(request, argument);
  if (error == 0) return 0;
  errno = error;
  return -1;
}
}
