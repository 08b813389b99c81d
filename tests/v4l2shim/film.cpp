// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Renders each pose of the board when it is first asked for.

#include "film.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "calvin/core/text.hpp"

namespace calvin::v4l2 {

namespace {

constexpr std::uint64_t kSeed = 1;

Camera zoomed(const Camera& camera, double zoom) {
  Calibration calibration = camera.to_calibration();
  for (Parameter& p : calibration.parameters) {
    if (p.name == "fx" || p.name == "fy") p.value *= zoom;
  }
  return Camera::make(calibration).value_or(camera);
}

}  // namespace

Camera film_camera(ImageSize size) {
  const bool same_view = size.width * kFullSize.height == size.height * kFullSize.width;
  return same_view ? default_camera(kFullSize).scaled(size) : default_camera(size);
}

Board film_board(int camera) {
  const char* text = std::getenv("CALVIN_V4L2_BOARD");
  const auto texts = split(text == nullptr ? kDefaultBoard : text, ';');
  const auto at = static_cast<std::size_t>(camera);
  const auto board = parse_board(texts[at < texts.size() ? at : 0]);
  if (board) return *board;
  std::fprintf(stderr, "CALVIN_V4L2_BOARD: %s\n", board.error().message.c_str());
  return *parse_board(kDefaultBoard);
}

Film::Film(const PixelFormat& format, ImageSize size, int camera)
    : format_(&format),
      camera_(film_camera(size)),
      board_(film_board(camera)),
      motion_(MotionKind::kRandom, camera_, board_, kSeed + static_cast<std::uint64_t>(camera)),
      renderer_(camera_),
      frames_(kPoses) {}

SE3 Film::camera_from_board(std::uint32_t frame) const {
  return motion_.camera_from_board(static_cast<double>(frame / kFramesPerPose % frames_.size()));
}

void Film::show(const Look& look) {
  if (look == look_) return;
  look_ = look;
  renderer_ = BoardRenderer(zoomed(camera_, look.zoom));
  for (auto& bytes : frames_) bytes.clear();
}

const std::vector<std::uint8_t>& Film::frame(std::uint32_t frame) {
  auto& bytes = frames_[frame / kFramesPerPose % frames_.size()];
  if (bytes.empty()) {
    RenderOptions options;
    options.noise = 1;
    options.blur = look_.blur;
    options.exposure = look_.exposure;
    options.seed = frame / kFramesPerPose;
    const GrayImage image = renderer_.render(board_, camera_from_board(frame), options);
    bytes = format_->encode(image);
  }
  return bytes;
}

void Film::render_all(std::size_t bytes) {
  const std::size_t most = bytes / std::max<std::size_t>(1, frame(0).size());
  frames_.resize(std::clamp<std::size_t>(most, 1, frames_.size()));
  for (std::uint32_t pose = 0; pose < frames_.size(); ++pose) {
    [[maybe_unused]] const auto& rendered = frame(pose * kFramesPerPose);
  }
}

}  // namespace calvin::v4l2
