// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads the settings of the emulated cameras from the environment.

#include "settings.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "calvin/core/text.hpp"
#include "pixel_formats.hpp"

namespace calvin::v4l2 {

namespace {

constexpr ImageSize kDefaultSize = {640, 480};

const char* environment(const char* name, const char* otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : text;
}

const char* paths() { return environment("CALVIN_V4L2_DEVICE", "/dev/video0"); }

// The part of a camera, where parts are separated by commas; empty where there is none.
std::string part(std::string_view list, int camera) {
  const auto parts = split(list, ',');
  const auto at = static_cast<std::size_t>(camera);
  return std::string(at < parts.size() ? parts[at] : "");
}

std::uint32_t count(std::string_view text, int otherwise, int most) {
  return static_cast<std::uint32_t>(std::clamp(parse_int(text).value_or(otherwise), 0, most));
}

std::vector<std::uint32_t> offered_fourccs() {
  const std::string_view wanted = environment("CALVIN_V4L2_FORMATS", "YUYV,MJPG");
  std::vector<std::uint32_t> fourccs;
  for (const PixelFormat& format : pixel_formats()) {
    if (wanted.find(format.name) != std::string_view::npos) fourccs.push_back(format.fourcc);
  }
  if (fourccs.empty()) fourccs.push_back(V4L2_PIX_FMT_YUYV);
  return fourccs;
}

std::vector<ImageSize> offered_sizes() {
  std::istringstream wanted(environment("CALVIN_V4L2_SIZES", "640x480,320x240"));
  std::vector<ImageSize> sizes;
  ImageSize size;
  for (char by = 0, comma = 0; wanted >> size.width >> by >> size.height; wanted >> comma) {
    if (size.width >= 16 && size.height >= 16) sizes.push_back({size.width & ~1, size.height & ~1});
  }
  if (sizes.empty()) sizes.push_back(kDefaultSize);
  return sizes;
}

}  // namespace

int camera_at(const char* path) noexcept {
  if (path == nullptr || *path == '\0') return -1;
  std::string_view rest = paths();
  for (int camera = 0; camera < kMaxCameras; ++camera) {
    const auto comma = rest.find(',');
    if (rest.substr(0, comma) == path) return camera;
    if (comma == std::string_view::npos) return -1;
    rest.remove_prefix(comma + 1);
  }
  return -1;
}

Settings::Settings(int number)
    : camera(number),
      path(part(paths(), number)),
      rate(std::max(1U, count(environment("CALVIN_V4L2_FPS", ""), 30, 1000))),
      sizes(offered_sizes()),
      fourccs(offered_fourccs()),
      ring(std::size_t{count(environment("CALVIN_V4L2_RING", ""), 0, 4000)} << 20),
      lose(count(part(environment("CALVIN_V4L2_LOSE", ""), number), 0, 1'000'000)),
      unplug(count(part(environment("CALVIN_V4L2_UNPLUG", ""), number), 0, 1'000'000'000)),
      plug(part(environment("CALVIN_V4L2_PLUG", ""), number)),
      counters(environment("CALVIN_V4L2_COUNTERS", "")) {}

}  // namespace calvin::v4l2
