// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Renders each pose of the board, in YUYV or as JPEG, when it is first asked for.

#include "film.hpp"

#include <linux/videodev2.h>

#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

namespace calvin::v4l2 {

namespace {

constexpr std::uint64_t kSeed = 1;

// Limited range, as video has it.
std::vector<std::uint8_t> yuyv(const GrayImage& image) {
  std::vector<std::uint8_t> bytes(image.pixels.size() * 2, 128);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    bytes[2 * i] = static_cast<std::uint8_t>(16 + (image.pixels[i] * 219 + 127) / 255);
  }
  return bytes;
}

// Three components like every camera's, 4:2:2.
std::vector<std::uint8_t> jpeg(const GrayImage& image) {
  jpeg_compress_struct encoder{};
  jpeg_error_mgr errors{};
  encoder.err = jpeg_std_error(&errors);
  jpeg_create_compress(&encoder);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&encoder, &buffer, &size);
  encoder.image_width = static_cast<JDIMENSION>(image.width);
  encoder.image_height = static_cast<JDIMENSION>(image.height);
  encoder.input_components = 3;
  encoder.in_color_space = JCS_YCbCr;
  jpeg_set_defaults(&encoder);
  jpeg_set_quality(&encoder, 92, TRUE);
  encoder.comp_info[0].v_samp_factor = 1;
  jpeg_start_compress(&encoder, TRUE);
  std::vector<std::uint8_t> row(static_cast<std::size_t>(image.width) * 3, 128);
  const ImageView view = image.view();
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) row[static_cast<std::size_t>(x) * 3] = view.at(x, y);
    JSAMPROW rows[] = {row.data()};
    jpeg_write_scanlines(&encoder, rows, 1);
  }
  jpeg_finish_compress(&encoder);
  jpeg_destroy_compress(&encoder);
  std::vector<std::uint8_t> bytes(buffer, buffer + size);
  std::free(buffer);
  return bytes;
}

}  // namespace

Camera film_camera(ImageSize size) {
  const Camera full = default_camera(kFullSize);
  return size == kFullSize ? full : full.scaled(size);
}

Board film_board() {
  const char* text = std::getenv("CALVIN_V4L2_BOARD");
  const auto board = parse_board(text == nullptr ? kDefaultBoard : text);
  if (board) return *board;
  std::fprintf(stderr, "CALVIN_V4L2_BOARD: %s\n", board.error().message.c_str());
  return *parse_board(kDefaultBoard);
}

Film::Film(std::uint32_t fourcc, ImageSize size)
    : fourcc_(fourcc),
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
    bytes = fourcc_ == V4L2_PIX_FMT_MJPEG ? jpeg(image) : yuyv(image);
  }
  return bytes;
}

}  // namespace calvin::v4l2
