// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The controls of the emulated camera: focus, zoom and exposure, and what switches them.
#pragma once

#include <linux/videodev2.h>

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "film.hpp"

namespace calvin::v4l2 {

// All that have a camera open share them, as in the kernel.
//
// Thread-safe.
class Controls {
 public:
  // Of the camera at that path, for as long as the process lives. It begins with the defaults, but
  // for what CALVIN_V4L2_CONTROLS says: "focus_absolute=40,zoom_absolute=120"; "none" is a camera
  // without controls.
  static Controls& of(const std::string& path);

  // The answer to ioctl(): 0 or a negative errno. ENOTTY for what is no request for controls.
  int control(std::uint32_t request, void* argument);

  // What the controls make of the picture.
  [[nodiscard]] Look look();

 private:
  Controls();
  void set_from_environment();
  int query(v4l2_queryctrl& query);
  int query(v4l2_query_ext_ctrl& query);
  static int query_menu(v4l2_querymenu& menu);
  int get(std::uint32_t id, __s32& value);
  int set(std::uint32_t id, __s32& value);
  int each(std::uint32_t request, v4l2_ext_controls& all);
  // With the lock held.
  [[nodiscard]] bool is_active(std::uint32_t id) const;

  std::mutex mutex_;
  std::map<std::uint32_t, __s32> values_;  // by id; those that the camera has
};

}  // namespace calvin::v4l2
