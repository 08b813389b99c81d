// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A mask of dots, step by step, and the connected parts of it.

#include "calvin/detect/grids/thresholded_dots.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>

namespace calvin::detect {

namespace {

constexpr double kMiddle = 0.3;  // of width and height: the part that tells threshold and size

// The middle of an image: [left, right) x [top, bottom), px.
struct Middle {
  int left;
  int right;
  int top;
  int bottom;

  explicit Middle(ImageSize size)
      : left(static_cast<int>((size.width - kMiddle * size.width) / 2)),
        right(size.width - left),
        top(static_cast<int>((size.height - kMiddle * size.height) / 2)),
        bottom(size.height - top) {}

  [[nodiscard]] bool has(int x, int y) const {
    return x >= left && x < right && y >= top && y < bottom;
  }
};

// The upper median of each pixel, the one to its left and the two above these. The border is
// mirrored.
GrayImage median_of_four(const ImageView& image) {
  GrayImage result(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const int left = std::max(x - 1, 0);
      const int above = std::max(y - 1, 0);
      std::array<std::uint8_t, 4> four = {image.at(left, above), image.at(x, above),
                                          image.at(left, y), image.at(x, y)};
      std::sort(four.begin(), four.end());
      result.row(y)[x] = four[2];
    }
  }
  return result;
}

// Grey levels in the middle of an image, counted in 512 bins from the least one to the greatest;
// the bin after which the variance between what is below and above is greatest, and its centre.
double otsu_threshold(const GrayImage& image) {
  constexpr int kBins = 512;
  const Middle middle(image.size());
  std::array<double, 256> levels{};
  for (int y = middle.top; y < middle.bottom; ++y) {
    for (int x = middle.left; x < middle.right; ++x) levels[image.view().at(x, y)] += 1;
  }
  const auto seen = [](double count) { return count > 0; };
  const auto first = std::find_if(levels.begin(), levels.end(), seen) - levels.begin();
  const auto last = 255 - (std::find_if(levels.rbegin(), levels.rend(), seen) - levels.rbegin());
  if (first >= last) return static_cast<double>(first);
  const double step = static_cast<double>(last - first) / kBins;
  std::array<double, kBins> bins{};
  for (auto level = first; level <= last; ++level) {
    const auto bin = static_cast<int>(static_cast<double>(level - first) / step);
    bins[static_cast<std::size_t>(std::min(bin, kBins - 1))] +=
        levels[static_cast<std::size_t>(level)];
  }
  const auto center = [&](int bin) { return static_cast<double>(first) + (bin + 0.5) * step; };
  double all = 0;
  double all_moment = 0;
  for (int i = 0; i < kBins; ++i) {
    all += bins[static_cast<std::size_t>(i)];
    all_moment += bins[static_cast<std::size_t>(i)] * center(i);
  }
  double below = 0;
  double moment = 0;
  double most = -1;
  double threshold = 0;
  for (int i = 0; i + 1 < kBins; ++i) {
    const double count = bins[static_cast<std::size_t>(i)];
    below += count;
    moment += count * center(i);
    const double apart = moment / below - (all_moment - moment) / (all - below);
    const double variance = below * (all - below) * apart * apart;
    // Of bins that are empty the first one counts, however sums are rounded.
    if (!(variance > most) || count == 0) continue;
    most = variance;
    threshold = center(i);
  }
  return threshold;
}

// 1 where there is a dot, whether it is bright or dark.
GrayImage mask_of(const GrayImage& image) {
  const double threshold = otsu_threshold(image);
  GrayImage mask(image.width, image.height);
  std::size_t bright = 0;
  for (std::size_t i = 0; i < mask.pixels.size(); ++i) {
    mask.pixels[i] = static_cast<double>(image.pixels[i]) > threshold ? 1 : 0;
    bright += mask.pixels[i];
  }
  if (2 * bright > mask.pixels.size()) {
    for (std::uint8_t& pixel : mask.pixels) pixel = pixel == 0 ? 1 : 0;
  }
  return mask;
}

enum class Neighbours { kFour = 4, kEight = 8 };

// Sets all pixels that are connected to (x, y) and have its value to another value; calls
// each(x, y) for them.
template <typename Each>
void flood(GrayImage& mask, int x, int y, Neighbours neighbours, std::uint8_t value,
           const Each& each) {
  constexpr std::array<std::array<int, 2>, 8> kSteps = {
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};
  const std::uint8_t from = mask.row(y)[x];
  if (from == value) return;
  std::vector<std::array<int, 2>> open = {{x, y}};
  mask.row(y)[x] = value;
  while (!open.empty()) {
    const auto [u, v] = open.back();
    open.pop_back();
    each(u, v);
    for (int i = 0; i < static_cast<int>(neighbours); ++i) {
      const auto [du, dv] = kSteps[static_cast<std::size_t>(i)];
      const int a = u + du;
      const int b = v + dv;
      if (a < 0 || b < 0 || a >= mask.width || b >= mask.height) continue;
      if (mask.row(b)[a] != from) continue;
      mask.row(b)[a] = value;
      open.push_back({a, b});
    }
  }
}

// Calls at(x, y) along the border.
template <typename At>
void along_border(ImageSize size, const At& at) {
  for (int x = 0; x < size.width; ++x) {
    at(x, 0);
    at(x, size.height - 1);
  }
  for (int y = 0; y < size.height; ++y) {
    at(0, y);
    at(size.width - 1, y);
  }
}

void clear_border(GrayImage& mask) {
  along_border(mask.size(), [&mask](int x, int y) {
    if (mask.row(y)[x] == 1) flood(mask, x, y, Neighbours::kEight, 0, [](int, int) {});
  });
}

// Where all of the cross of five pixels about a pixel has a value, beyond the border too.
GrayImage where_all(const GrayImage& mask, std::uint8_t value) {
  GrayImage result(mask.width, mask.height);
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      const auto has = [&](int u, int v) {
        return u < 0 || v < 0 || u >= mask.width || v >= mask.height ||
               mask.view().at(u, v) == value;
      };
      const bool all =
          has(x, y) && has(x - 1, y) && has(x + 1, y) && has(x, y - 1) && has(x, y + 1);
      result.row(y)[x] = all ? 1 : 0;
    }
  }
  return result;
}

// Without what is narrower than the cross.
GrayImage opened(const GrayImage& mask) {
  GrayImage result = where_all(where_all(mask, 1), 0);
  for (std::uint8_t& pixel : result.pixels) pixel = pixel == 0 ? 1 : 0;
  return result;
}

void fill_holes(GrayImage& mask) {
  along_border(mask.size(), [&mask](int x, int y) {
    if (mask.row(y)[x] == 0) flood(mask, x, y, Neighbours::kFour, 2, [](int, int) {});
  });
  for (std::uint8_t& pixel : mask.pixels) pixel = pixel == 2 ? 0 : 1;
}

struct Component {
  double area = 0;
  double u = 0;  // sums
  double v = 0;
  double uu = 0;
  double vv = 0;
  double uv = 0;
  bool is_inside = true;  // all of it in the middle, and not at its border
  bool is_thin = false;   // one pixel wide or high

  [[nodiscard]] Pixel center() const { return {u / area, v / area}; }
  // The longer half axis of the ellipse with these moments over the shorter one.
  [[nodiscard]] double stretch() const {
    const Pixel c = center();
    const double a = uu / area - c.u * c.u;
    const double b = vv / area - c.v * c.v;
    const double mixed = uv / area - c.u * c.v;
    const double root = std::hypot(a - b, 2 * mixed);
    return std::sqrt((a + b + root) / std::max(a + b - root, 1e-9));
  }
};

// Between the two in the middle of an even number of values.
double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

std::vector<Component> components_of(GrayImage mask) {
  const Middle middle(mask.size());
  std::vector<Component> parts;
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      if (mask.row(y)[x] == 0) continue;
      Component part;
      flood(mask, x, y, Neighbours::kFour, 0, [&](int u, int v) {
        part.area += 1;
        part.u += u;
        part.v += v;
        part.uu += u * u;
        part.vv += v * v;
        part.uv += u * v;
        part.is_inside = part.is_inside && middle.has(u - 1, v - 1) && middle.has(u + 1, v + 1);
      });
      part.is_thin =
          part.uu * part.area == part.u * part.u || part.vv * part.area == part.v * part.v;
      parts.push_back(part);
    }
  }
  return parts;
}

}  // namespace

std::vector<ThresholdedDot> thresholded_dots(const ImageView& image) {
  constexpr double kTolerance = 0.3;  // of areas, and of the ratio of axes
  if (image.width < 3 || image.height < 3) return {};
  GrayImage mask = mask_of(median_of_four(image));
  clear_border(mask);
  mask = opened(mask);
  fill_holes(mask);
  const std::vector<Component> parts = components_of(std::move(mask));
  std::vector<double> areas;
  for (const Component& part : parts) {
    if (part.is_inside) areas.push_back(part.area);
  }
  if (areas.empty()) return {};
  const double area = median(areas);
  const double least = std::floor((1 - kTolerance) * area);
  const double most = std::floor((1 + kTolerance) * area);
  std::vector<ThresholdedDot> dots;
  for (const Component& part : parts) {
    if (!(part.area > least && part.area < most) || part.is_thin) continue;
    if (part.stretch() < 1 + kTolerance) dots.push_back({part.center(), part.area});
  }
  return dots;
}

Observation at_thresholded_dots(const ImageView& image, const Observation& seen) {
  constexpr double kRow = 64;  // px
  const auto row_of = [](double v) { return static_cast<std::size_t>(std::max(v, 0.0) / kRow); };
  std::vector<std::vector<ThresholdedDot>> rows(row_of(image.height) + 2);
  for (const ThresholdedDot& dot : thresholded_dots(image)) {
    rows[row_of(dot.center.v)].push_back(dot);
  }
  Observation moved = seen;
  moved.ids.clear();
  moved.uv.clear();
  moved.sigma.clear();
  moved.velocity.clear();
  moved.patches = nullptr;
  for (std::size_t i = 0; i < seen.uv.size(); ++i) {
    const Pixel& at = seen.uv[i];
    const std::size_t middle = std::min(row_of(at.v), rows.size() - 2);
    for (std::size_t row = middle > 0 ? middle - 1 : 0; row <= middle + 1; ++row) {
      const auto dot = std::ranges::find_if(rows[row], [&at](const ThresholdedDot& d) {
        const double radius = std::sqrt(d.area / std::numbers::pi);
        return std::hypot(d.center.u - at.u, d.center.v - at.v) < radius;
      });
      if (dot == rows[row].end()) continue;
      moved.ids.push_back(seen.ids[i]);
      moved.uv.push_back(dot->center);
      break;
    }
  }
  return moved;
}

}  // namespace calvin::detect
