// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Film: what the emulated camera sees, a board held in one pose after the other, in a loop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "pixel_formats.hpp"

namespace calvin::v4l2 {

inline constexpr int kPoses = 40;
inline constexpr int kFramesPerPose = 15;
inline constexpr ImageSize kFullSize = {640, 480};

// The camera whose image is kFullSize; sizes of its shape are the same image, scaled.
[[nodiscard]] Camera film_camera(ImageSize size);

// checkerboard:9x6:25mm, or what the environment variable CALVIN_V4L2_BOARD names for that camera.
[[nodiscard]] Board film_board(int camera = 0);

// What the camera's controls make of the picture.
struct Look {
  double zoom = 1;    // factor on the focal length
  double blur = 0.5;  // px, 1 sigma
  double exposure = 1;

  friend bool operator==(const Look&, const Look&) = default;
};

class Film {
 public:
  // Each camera sees a session of its own.
  Film(const PixelFormat& format, ImageSize size, int camera = 0);

  [[nodiscard]] SE3 camera_from_board(std::uint32_t frame) const;
  // What frames show from now on.
  void show(const Look& look);
  // The bytes of a frame; rendered when first asked for, so that opening the device is instant.
  [[nodiscard]] const std::vector<std::uint8_t>& frame(std::uint32_t frame);
  // Renders every picture that it has from now on, as many as fit into so many bytes, but one.
  void render_all(std::size_t bytes);

 private:
  const PixelFormat* format_;
  Camera camera_;
  Board board_;
  Motion motion_;
  Look look_;
  BoardRenderer renderer_;
  std::vector<std::vector<std::uint8_t>> frames_;  // one for each pose
};

}  // namespace calvin::v4l2
