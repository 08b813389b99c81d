// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Renders each pose of the board when it is first asked for.

#include "film.hpp"

#include <cstdio>
#include <cstdlib>

namespace calvin::v4l2 {

namespace {

constexpr std::uint64_t kSeed = 1;

}  // namespace

Camera film_camera(ImageSize size) {
  const bool same_view = size.width * kFullSize.height == size.height * kFullSize.width;
  return same_view ? default_camera(kFullSize).scaled(size) : default_camera(size);
}

Board film_board() {
  const char* text = std::getenv("CALVIN_V4L2_BOARD");
  const auto board = parse_board(text == nullptr ? kDefaultBoard : text);
  if (board) return *board;
  std::fprintf(stderr, "CALVIN_V4L2_BOARD: %s\n", board.error().message.c_str());
  return *parse_board(kDefaultBoard);
}

Film::Film(const PixelFormat& format, ImageSize size)
    : format_(&format),
      camera_(film_camera(size)),
      board_(film_board()),
      motion_(MotionKind::kRandom, camera_, board_, kSeed),
      renderer_(camera_),
      frames_(kPoses) {}

SE3 Film::camera_from_board(std::uint32_t frame) const {
  return motion_.camera_from_board(frame / kFramesPerPose % kPoses);
}

const std::vector<std::uint8_t>& Film::frame(std::uint32_t frame) {
  auto& bytes = frames_[frame / kFramesPerPose % kPoses];
  if (bytes.empty()) {
    RenderOptions options;
    options.noise = 1;
    options.blur = 0.5;
    options.seed = frame / kFramesPerPose;
    const GrayImage image = renderer_.render(board_, camera_from_board(frame), options);
    bytes = format_->encode(image);
  }
  return bytes;
}

}  // namespace calvin::v4l2
