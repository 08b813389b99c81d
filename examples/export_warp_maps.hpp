// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Warps as maps in the files of others: one place of the source for each pixel of the output, or
// for some of them.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "calvin/remap/view.hpp"

namespace export_warp {

// Which pixel of the source each pixel of the output shows.
struct Warp {
  calvin::Camera source;
  calvin::ViewOptions options;
  calvin::OutputView view;

  [[nodiscard]] calvin::ImageSize input() const { return source.image_size(); }
  [[nodiscard]] calvin::ImageSize output() const { return view.camera.image_size(); }
  // px of the source, which may lie outside of it; absent where the camera sees nothing.
  [[nodiscard]] std::optional<calvin::Pixel> place(double u, double v) const {
    return calvin::transfer(view.camera, calvin::VirtualCamera(source), {u, v});
  }
};

template <typename T>
void append(std::string& bytes, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i) & 255);
  }
}
inline void append(std::string& bytes, float value) {
  append(bytes, std::bit_cast<std::uint32_t>(value));
}

// NXP DW100 (i.MX8M Plus): the array of the V4L2 control DEWARPING_16x16_VERTEX_MAP, little endian.
// A vertex for every 16th pixel of the output, the last ones where it ends; y above x, each in
// 1/16 px. Places outside of the source it does not know: the nearest one stands for them.
inline std::string dw100(const Warp& warp) {
  constexpr int kBlock = 16;
  const auto vertices = [](int length) { return (length + kBlock - 1) / kBlock + 1; };
  const auto fixed = [](double place, int length) {
    // The vertex behind the last pixel lies behind the last pixel of the source.
    const double last = std::min(0.0 + length, 4095 + 15.0 / 16);
    return static_cast<std::uint32_t>(std::lround(16 * std::clamp(place, 0.0, last)));
  };
  const calvin::ImageSize out = warp.output();
  const calvin::ImageSize in = warp.input();
  const calvin::Pixel middle = {(in.width - 1) / 2.0, (in.height - 1) / 2.0};
  std::string bytes;
  for (int row = 0; row < vertices(out.height); ++row) {
    for (int column = 0; column < vertices(out.width); ++column) {
      const auto place =
          warp.place(std::min(kBlock * column, out.width), std::min(kBlock * row, out.height));
      const calvin::Pixel at = place.value_or(middle);
      append(bytes, fixed(at.v, in.height) << 16 | fixed(at.u, in.width));
    }
  }
  return bytes;
}

// ffmpeg's remap filter: the nearest column (or row) of the source for each pixel, as PGM of 16
// bits. 65535, which is outside of every source, where there is none: pixels reach half a pixel
// beyond their centres, so that a view whose edge is that of the source is whole.
inline std::string ffmpeg_map(const Warp& warp, bool rows) {
  const calvin::ImageSize out = warp.output();
  const calvin::ImageSize in = warp.input();
  std::string bytes = fmt::format("P5\n{} {}\n65535\n", out.width, out.height);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      const auto place = warp.place(x, y);
      const bool inside = place && place->u > -0.5 && place->v > -0.5 &&
                          place->u < in.width - 0.5 && place->v < in.height - 0.5;
      const long nearest = inside ? std::lround(rows ? place->v : place->u) : 65535;
      bytes += static_cast<char>(nearest >> 8);
      bytes += static_cast<char>(nearest & 255);
    }
  }
  return bytes;
}

// STMap: an OpenEXR file of 32-bit floats, not compressed. Red is x, green is y, in parts of the
// source from outer edge to outer edge; y from below, as Nuke has it, or from above. Blue is 1
// where there is something to show.
inline std::string stmap(const Warp& warp, bool from_above) {
  const calvin::ImageSize out = warp.output();
  const calvin::ImageSize in = warp.input();
  std::string exr;
  append(exr, std::uint32_t{20000630});
  append(exr, std::uint32_t{2});  // version 2, one part of scan lines
  const auto attribute = [&exr](std::string_view name, std::string_view type,
                                const std::string& value) {
    exr.append(name) += '\0';
    exr.append(type) += '\0';
    append(exr, static_cast<std::uint32_t>(value.size()));
    exr += value;
  };
  std::string channels;
  for (const char* const name : {"B", "G", "R"}) {
    channels.append(name) += '\0';
    for (const std::uint32_t field : {2, 0, 1, 1}) append(channels, field);  // float; sampling
  }
  channels += '\0';
  std::string window;
  for (const int edge : {0, 0, out.width - 1, out.height - 1}) {
    append(window, static_cast<std::uint32_t>(edge));
  }
  std::string one;
  append(one, 1.0F);
  attribute("channels", "chlist", channels);
  attribute("compression", "compression", std::string(1, '\0'));
  attribute("dataWindow", "box2i", window);
  attribute("displayWindow", "box2i", window);
  attribute("lineOrder", "lineOrder", std::string(1, '\0'));
  attribute("pixelAspectRatio", "float", one);
  attribute("screenWindowCenter", "v2f", std::string(8, '\0'));
  attribute("screenWindowWidth", "float", one);
  exr += '\0';

  const auto row_bytes = static_cast<std::uint32_t>(3 * 4 * out.width);
  const std::uint64_t first = exr.size() + 8 * static_cast<std::uint64_t>(out.height);
  for (int y = 0; y < out.height; ++y) {
    append(exr, first + static_cast<std::uint64_t>(y) * (row_bytes + 8));
  }
  for (int y = 0; y < out.height; ++y) {
    append(exr, static_cast<std::uint32_t>(y));
    append(exr, row_bytes);
    std::string red;
    std::string green;
    for (int x = 0; x < out.width; ++x) {
      const auto place = warp.place(x, y);
      const double down = place ? (place->v + 0.5) / in.height : 0;
      append(exr, place ? 1.0F : 0.0F);
      append(green, static_cast<float>(from_above || !place ? down : 1 - down));
      append(red, static_cast<float>(place ? (place->u + 0.5) / in.width : 0));
    }
    exr += green;
    exr += red;
  }
  return exr;
}

}  // namespace export_warp
