// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Encodes gray pictures in the formats of the emulated camera.

#include "pixel_formats.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

namespace calvin::v4l2 {

namespace {

// Limited range, as video has it.
std::uint8_t luma(std::uint8_t gray) {
  return static_cast<std::uint8_t>(16 + (gray * 219 + 127) / 255);
}

std::vector<std::uint8_t> yuyv(const GrayImage& image) {
  std::vector<std::uint8_t> bytes(image.pixels.size() * 2, 128);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) bytes[2 * i] = luma(image.pixels[i]);
  return bytes;
}

// Sizes are even.
std::vector<std::uint8_t> nv12(const GrayImage& image) {
  std::vector<std::uint8_t> bytes(image.pixels.size() * 3 / 2, 128);
  std::transform(image.pixels.begin(), image.pixels.end(), bytes.begin(), luma);
  return bytes;
}

std::vector<std::uint8_t> grey(const GrayImage& image) { return image.pixels; }

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

constexpr std::array<PixelFormat, 4> kPixelFormats = {{
    {"YUYV", V4L2_PIX_FMT_YUYV, "YUYV 4:2:2", 2, 16, yuyv},
    {"MJPG", V4L2_PIX_FMT_MJPEG, "Motion-JPEG", 0, 16, jpeg},
    {"NV12", V4L2_PIX_FMT_NV12, "Y/UV 4:2:0", 1, 12, nv12},
    {"GREY", V4L2_PIX_FMT_GREY, "8-bit Greyscale", 1, 8, grey},
}};

}  // namespace

std::span<const PixelFormat> pixel_formats() { return kPixelFormats; }

const PixelFormat* find_pixel_format(std::uint32_t fourcc) {
  const auto* const found =
      std::find_if(kPixelFormats.begin(), kPixelFormats.end(),
                   [&](const PixelFormat& format) { return format.fourcc == fourcc; });
  return found == kPixelFormats.end() ? nullptr : found;
}

}  // namespace calvin::v4l2
