// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The grey levels of PNG, PGM and PDF files.
#pragma once

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "calvin/core/file.hpp"
#include "calvin/core/image.hpp"
#include "calvin_config.h"
#include "temporary_folder.hpp"

#if CALVIN_HAVE_CAIRO
#include <cairo.h>

namespace calvin::scenes {

struct PngReader {
  std::string_view bytes;
};

inline cairo_status_t read_bytes(void* closure, unsigned char* data, unsigned int length) {
  auto* reader = static_cast<PngReader*>(closure);
  if (reader->bytes.size() < length) return CAIRO_STATUS_READ_ERROR;
  std::copy_n(reader->bytes.begin(), length, data);
  reader->bytes.remove_prefix(length);
  return CAIRO_STATUS_SUCCESS;
}

inline GrayImage decode_png(const std::string& png) {
  PngReader reader{png};
  cairo_surface_t* surface = cairo_image_surface_create_from_png_stream(read_bytes, &reader);
  EXPECT_EQ(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS);
  GrayImage image(cairo_image_surface_get_width(surface), cairo_image_surface_get_height(surface));
  const unsigned char* data = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  const int step = cairo_image_surface_get_format(surface) == CAIRO_FORMAT_A8 ? 1 : 4;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) image.row(y)[x] = data[y * stride + x * step];
  }
  cairo_surface_destroy(surface);
  return image;
}

// The grey levels of a binary PGM file.
inline GrayImage decode_pgm(const std::string& pgm) {
  int width = 0;
  int height = 0;
  int used = 0;
  if (std::sscanf(pgm.c_str(), "P5 %d %d 255%n", &width, &height, &used) != 2) return {};
  GrayImage image(width, height);
  const auto start = static_cast<std::size_t>(used) + 1;
  if (pgm.size() < start + image.pixels.size()) return {};
  std::copy_n(pgm.begin() + static_cast<std::ptrdiff_t>(start), image.pixels.size(),
              image.pixels.begin());
  return image;
}

// The first page; absent where there is no program to render it.
inline std::optional<GrayImage> decode_pdf(const std::string& pdf, double dpi) {
  const TemporaryFolder folder;
  EXPECT_TRUE(write_file(folder.path("page.pdf"), pdf).has_value());
  const std::string command = "cd '" + folder.path() + "' && pdftoppm -r " + std::to_string(dpi) +
                              " -gray -singlefile page.pdf page 2>/dev/null";
  if (std::system(command.c_str()) != 0) return std::nullopt;
  const auto pgm = read_file(folder.path("page.pgm"));
  EXPECT_TRUE(pgm.has_value());
  return pgm ? decode_pgm(*pgm) : GrayImage();
}

}  // namespace calvin::scenes

#endif
