// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Settings: what the environment says of an emulated camera. The head of shim.cpp lists it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "calvin/core/image.hpp"

namespace calvin::v4l2 {

inline constexpr int kMaxCameras = 16;

// The place of a path in CALVIN_V4L2_DEVICE; -1 where it is no camera. Called for every file that
// the process opens: allocates nothing.
[[nodiscard]] int camera_at(const char* path) noexcept;

struct Settings {
  // Of the camera at that place.
  explicit Settings(int number);

  int camera;
  std::string path;
  std::uint32_t rate;                  // frames per s
  std::vector<ImageSize> sizes;        // offered; the first is what the device begins with
  std::vector<std::uint32_t> fourccs;  // likewise
  std::size_t ring;                    // bytes; 0: pictures are rendered when they are first shown
  std::uint32_t lose;                  // one frame in so many is lost; 0: none
  std::uint32_t unplug;                // frames after which the cable is pulled; 0: never
  std::string plug;                    // file that exists while the cable is in; empty: none
  std::string counters;                // file; empty: none
};

}  // namespace calvin::v4l2
