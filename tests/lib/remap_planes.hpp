// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Planes of all layouts that are undistorted, and compared with the reference.
#pragma once

#include <cstdlib>
#include <functional>
#include <random>
#include <vector>

#include "calvin/remap/undistorter.hpp"
#include "remap_reference.hpp"

namespace calvin::remap_planes {

using reference::Lens;

inline const std::vector<Lens> kLenses = {
    {"pinhole", "pinhole", {}},
    {"brown4 barrel", "brown4", {-0.28, 0.09, 5e-4, -7e-4}},
    {"brown4 pincushion", "brown4", {0.12, -0.02, -1e-3, 1e-3}},
    {"brown5", "brown5", {-0.3, 0.12, 1e-3, -5e-4, -0.02}},
    {"rational8", "rational8", {0.3, -0.02, 4e-4, -6e-4, 0.004, 0.6, 0.05, -0.003}},
    {"fisheye", "fisheye", {-0.02, 0.005, -0.003, 0.0005}},
};

struct NamedLayout {
  const char* name;
  PlaneLayout layout;
  int max = 255;  // the largest value of a sample
};
inline constexpr auto kLittle = SampleType::kU16Little;
inline constexpr auto kBig = SampleType::kU16Big;
inline const std::vector<NamedLayout> kLayouts = {
    {"GRAY8", {{}, 1, 1, 1, {16}}},
    {"I420 chroma, MPEG-2 siting", {{1, 1, true, false}, 1, 1, 1, {128}}},
    {"I420 chroma, JPEG siting", {{1, 1, false, false}, 1, 1, 1, {128}}},
    {"NV12 chroma", {{1, 1, true, false}, 2, 2, 1, {128, 127}}},
    {"YUY2 luma", {{}, 1, 2, 1, {16}}},
    {"YUY2 chroma", {{1, 0, true, false}, 2, 4, 2, {128, 126}}},
    {"RGB", {{}, 3, 3, 1, {1, 2, 3}}},
    {"BGRx", {{}, 4, 4, 1, {10, 20, 30, 255}}},
    {"GRAY16_LE", {{}, 1, 2, 2, {4099}, kLittle}, 65535},
    {"GRAY16_BE", {{}, 1, 2, 2, {4099}, kBig}, 65535},
    {"I420_10LE chroma", {{1, 1, true, false}, 1, 2, 2, {512}, kLittle, 0, std::nullopt, 10}, 1023},
    {"P010 chroma", {{1, 1, true, false}, 2, 4, 2, {512, 511}, kLittle, 6}, 1023},
    {"ARGB64_BE", {{}, 4, 8, 2, {65535, 1, 2, 3}, kBig}, 65535},
    {"I420 chroma, JPEG to MPEG-2 siting",
     {{1, 1, false, false}, 1, 1, 1, {128}, SampleType::kU8, 0, Subsampling{1, 1, true, false}}},
    {"I420 chroma of a part from an odd pixel on",
     {{1, 1, true, false, 1, 1},
      1,
      1,
      1,
      {128},
      SampleType::kU8,
      0,
      Subsampling{1, 1, true, false}}},
    {"P010 chroma of such a part",
     {{1, 1, false, false, 1, 1}, 2, 4, 2, {512, 511}, kLittle, 6, Subsampling{1, 1, false, false}},
     1023},
};

inline int bytes_of(const PlaneLayout& layout) { return layout.sample == SampleType::kU8 ? 1 : 2; }

// A sample as whoever reads the format takes it.
inline int read_sample(const std::uint8_t* at, const PlaneLayout& layout) {
  if (layout.sample == SampleType::kU8) return at[0];
  const int word = layout.sample == kLittle ? at[0] + 256 * at[1] : 256 * at[0] + at[1];
  return word / (1 << layout.shift);
}

// A plane with padding between the rows; every byte holds something to lose.
struct Plane {
  Plane(ImageSize samples, const PlaneLayout& layout)
      : stride(samples.width * layout.pixel_step + 13),
        bytes(static_cast<std::size_t>(stride * samples.height), 0xA5) {}

  std::ptrdiff_t stride;
  std::vector<std::uint8_t> bytes;
};

// Half smooth like a photograph, half as sharp as a picture can be; 0..1.
inline double scene(int x, int y, int c, int width, std::mt19937& random) {
  if (x > width / 2) return (random() & 1) != 0 ? 1 : 0;
  return 0.5 + 0.24 * std::sin(0.11 * x + c) + 0.24 * std::cos(0.07 * y - 0.02 * x + c);
}

inline ImageSize plane_size(ImageSize frame, const Subsampling& s) {
  return {(s.x_before + frame.width + (1 << s.x_shift) - 1) >> s.x_shift,
          (s.y_before + frame.height + (1 << s.y_shift) - 1) >> s.y_shift};
}
inline ImageSize output_size(ImageSize frame, const NamedLayout& named) {
  return plane_size(frame, named.layout.sites().output);
}

inline Plane make_scene(ImageSize samples, const NamedLayout& named) {
  const PlaneLayout& layout = named.layout;
  Plane plane(samples, layout);
  std::mt19937 random(7);
  for (int y = 0; y < samples.height; ++y) {
    for (int x = 0; x < samples.width; ++x) {
      for (int c = 0; c < layout.components; ++c) {
        std::uint8_t* at = plane.bytes.data() + y * plane.stride + x * layout.pixel_step +
                           c * layout.component_step;
        const auto value = std::lround(named.max * scene(x, y, c, samples.width, random))
                           << layout.shift;
        at[0] = static_cast<std::uint8_t>(layout.sample == kBig ? value >> 8 : value);
        if (bytes_of(layout) == 2) {
          at[1] = static_cast<std::uint8_t>(layout.sample == kBig ? value : value >> 8);
        }
      }
    }
  }
  return plane;
}

struct Planes {
  Plane input;
  Plane output;
};

struct Comparison {
  double worst = 0;      // grey levels of 8 bit
  double smooth = 0;     // the same where the picture is like a photograph
  double sum = 0;        // of all differences
  int valid = 0;         // samples compared
  int wrong_fill = 0;    // samples that should be filled, or should not
  int filled = 0;        // samples that are rightly filled
  int bytes_harmed = 0;  // of padding and of other components
};

// Every row where the counts are asked for; a third of them tells as much.
inline const int kRowStep = std::getenv("CALVIN_FULL") != nullptr ? 1 : 3;

// Where a pixel of an output comes from.
using PlaceFunction = std::function<reference::Place(double, double)>;

// Compares what undistorting `input` gave with the reference, every so many rows of it, but
// for what is `near_fold`: the reference does not know of tangential terms there.
inline Comparison compare(const Lens& lens, ImageSize frame, const PlaceFunction& place_of,
                          const NamedLayout& named, const Planes& planes, int row_step = kRowStep,
                          double near_fold = 2e-3) {
  const Plane& input = planes.input;
  const Plane& output = planes.output;
  const PlaneLayout& layout = named.layout;
  const Subsampling& s = layout.subsampling;
  const Subsampling t = layout.sites().output;
  const auto in_xs = reference::sites(frame.width, s.x_shift, s.x_cosited, s.x_before);
  const auto in_ys = reference::sites(frame.height, s.y_shift, s.y_cosited, s.y_before);
  const auto xs = reference::sites(frame.width, t.x_shift, t.x_cosited);
  const auto ys = reference::sites(frame.height, t.y_shift, t.y_cosited);
  const int width = static_cast<int>(xs.size());
  const int height = static_cast<int>(ys.size());
  const double fold = reference::fold(lens);
  const int left_half = frame.width / 2;
  std::vector<bool> ours(output.bytes.size());
  Comparison result;
  for (int j = 0; j < height; ++j) {
    const bool looked_at = j % row_step == 0 || j + 1 == height;
    for (int i = 0; i < width; ++i) {
      const auto [at, radius] = looked_at ? place_of(xs[i], ys[j]) : reference::Place();
      // How far inside the source, px; the sign decides, the neighbourhood of zero does not.
      const double inside =
          radius > fold ? -1.0
                        : std::min({at.u, at.v, frame.width - 1 - at.u, frame.height - 1 - at.v});
      const bool certain =
          looked_at && std::abs(inside) > 4e-3 && !(std::abs(radius - fold) < near_fold);
      for (int c = 0; c < layout.components; ++c) {
        const auto offset = j * output.stride + i * layout.pixel_step + c * layout.component_step;
        for (int b = 0; b < bytes_of(layout); ++b)
          ours[static_cast<std::size_t>(offset + b)] = true;
        if (!certain) continue;
        const int got = read_sample(output.bytes.data() + offset, layout);
        if (inside < 0) {
          ++(got == layout.fill[c] ? result.filled : result.wrong_fill);
          continue;
        }
        const auto read = [&](int x, int y) {
          return read_sample(input.bytes.data() + y * input.stride + x * layout.pixel_step +
                                 c * layout.component_step,
                             layout);
        };
        const double exact = reference::bilinear(
            read, static_cast<int>(in_xs.size()), static_cast<int>(in_ys.size()),
            reference::sample_at(in_xs, at.u), reference::sample_at(in_ys, at.v));
        ++result.valid;
        const double difference = std::abs(got - exact) * 255 / named.max;
        result.sum += difference;
        result.worst = std::max(result.worst, difference);
        if (at.u < left_half - 8) result.smooth = std::max(result.smooth, difference);
      }
    }
  }
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (!ours[i] && output.bytes[i] != 0xA5) ++result.bytes_harmed;
  }
  return result;
}

inline Comparison compare(const Lens& lens, const Undistorter& undistorter,
                          const NamedLayout& named, const Planes& planes, int row_step = kRowStep,
                          double near_fold = 2e-3) {
  const auto place_of = [&](double x, double y) {
    return reference::source_place(lens, undistorter.source(), undistorter.output(), x, y);
  };
  return compare(lens, undistorter.output().image_size(), place_of, named, planes, row_step,
                 near_fold);
}

inline Planes undistort(const Undistorter& undistorter, std::size_t layout,
                        const Sampling& sampling = {}) {
  const PlaneLayout& l = kLayouts[layout].layout;
  const ImageSize frame = undistorter.output().image_size();
  Planes planes{make_scene(plane_size(frame, l.subsampling), kLayouts[layout]),
                Plane(output_size(frame, kLayouts[layout]), l)};
  undistorter.apply(layout, {planes.input.bytes.data(), planes.input.stride},
                    {planes.output.bytes.data(), planes.output.stride}, sampling);
  return planes;
}

// Samples of two outputs that differ by more than `allowed`.
inline int count_apart(const Planes& a, const Planes& b, const NamedLayout& named,
                       ImageSize samples, double allowed) {
  int apart = 0;
  for (int y = 0; y < samples.height; ++y) {
    for (int x = 0; x < samples.width; ++x) {
      for (int c = 0; c < named.layout.components; ++c) {
        const auto at =
            y * a.output.stride + x * named.layout.pixel_step + c * named.layout.component_step;
        const int difference = read_sample(a.output.bytes.data() + at, named.layout) -
                               read_sample(b.output.bytes.data() + at, named.layout);
        if (std::abs(difference) > allowed) ++apart;
      }
    }
  }
  return apart;
}

// Undistorts all of kLayouts.
inline Undistorter undistorter_for(const Camera& source, const ViewOptions& options) {
  std::vector<PlaneLayout> layouts;
  for (const NamedLayout& l : kLayouts) layouts.push_back(l.layout);
  return Undistorter::make(source, options, layouts).value();
}
inline Undistorter undistorter_for(const Camera& source, double alpha) {
  return undistorter_for(source, ViewOptions{alpha, {}});
}

}  // namespace calvin::remap_planes
