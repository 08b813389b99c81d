// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How light the cells of a quad are.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include <Eigen/Core>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/corners/grey_at.hpp"
#include "calvin/detect/tags/point.hpp"
#include "calvin/detect/tags/tag_pattern.hpp"
#include "calvin/detect/tags/tag_style.hpp"

namespace calvin::detect {

// A grey level that changes over a quad: at the place (x, y) in cells from its middle, a + b x + c
// y.
class GreyPlane {
 public:
  void add(double x, double y, double grey) {
    count_ += 1;
    x_ += x;
    y_ += y;
    xx_ += x * x;
    xy_ += x * y;
    yy_ += y * y;
    right_ += grey * Eigen::Vector3d(1, x, y);
  }
  void fit();
  [[nodiscard]] double at(double x, double y) const {
    return levels_[0] + levels_[1] * x + levels_[2] * y;
  }

 private:
  double count_ = 0;
  double x_ = 0;
  double y_ = 0;
  double xx_ = 0;
  double xy_ = 0;
  double yy_ = 0;
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d levels_ = Eigen::Vector3d::Zero();
};

// The grey levels of the cells of a quad, beside those of its border and of what is around it.
class TagCells {
 public:
  // `around`: where the light around a tag is looked at, in cells from its border.
  TagCells(const ImageView& image, const Quad& quad, const TagStyle& style, double around)
      : image_(image),
        side_(style.cells()),
        middle_(0.5 * side_),
        border_(style.border),
        inverted_(style.inverted),
        map_(from_cells(quad, side_)),
        spread_(shortest_side(quad) / side_ > 2 ? 0.2 : 0),
        around_(around),
        is_inside_(is_inside(reach_of(style, around))) {}

  // Whether what the border is around is as dark as the border everywhere: fewer places are looked
  // at than for the bits. Only tags wholly in the image are told.
  [[nodiscard]] bool are_plain() const;

  // Comes before what follows.
  void take_levels();

  // Whether there is a border, darker than what is around it.
  [[nodiscard]] bool are_tags(double most_wrong) const {
    return has_contrast() && border_wrong_ <= most_wrong * static_cast<double>(border_seen_) &&
           around_wrong_ <= 2 * most_wrong * static_cast<double>(around_seen_) &&
           around_seen_ >= 2 * side_;
  }
  [[nodiscard]] bool has_contrast() const {
    constexpr double kLeast = 8;  // grey levels, from dark to light
    return contrast_ >= kLeast;
  }

  // Of a cell, 0 for the border and 1 for what is around it; absent outside of the image.
  [[nodiscard]] std::optional<double> lightness(int col, int row) const {
    const double x = col + 0.5;
    const double y = row + 0.5;
    const double grey = is_border(col, row) ? border_greys_[index(col, row)] : mean_at(x, y);
    if (std::isnan(grey)) return std::nullopt;
    return lightness(x, y, grey);
  }

 private:
  static constexpr int kMostCells = 12;  // along a side: the bits of a code are 64, a border is two

  [[nodiscard]] static std::size_t index(int col, int row) {
    return static_cast<std::size_t>(row * kMostCells + col);
  }
  [[nodiscard]] bool is_border(int col, int row) const {
    const int depth = std::min({col, row, side_ - 1 - col, side_ - 1 - row});
    return depth >= 0 && depth < border_;
  }
  // Cells around the border that are looked at: bits there, and one beside each.
  [[nodiscard]] static double reach_of(const TagStyle& style, double around) {
    const int outside = style.dictionary->outside;
    return outside > 0 ? outside + 1.0 : around;
  }
  // Whether all that is looked at is in the image, with a pixel around it: an image of a convex
  // region lies between those of its corners.
  [[nodiscard]] bool is_inside(double around) const {
    const double least = -std::max(around, 0.0);
    const double most = side_ - least;
    for (const auto& [x, y] :
         {std::pair{least, least}, {most, least}, {most, most}, {least, most}}) {
      const Eigen::Vector3d p = map_ * Eigen::Vector3d(x, y, 1);
      if (!(p.z() > 0 && p.x() >= p.z() && p.y() >= p.z() && p.x() <= p.z() * (image_.width - 3) &&
            p.y() <= p.z() * (image_.height - 3))) {
        return false;
      }
    }
    return true;
  }
  [[nodiscard]] double lightness(double x, double y, double grey) const {
    const double dark = dark_.at(x - middle_, y - middle_);
    const double contrast = light_.at(x - middle_, y - middle_) - dark;
    return (grey - dark) / (inverted_ ? std::min(contrast, -1.0) : std::max(contrast, 1.0));
  }
  // No number outside of the image.
  [[nodiscard]] double grey_in(double x, double y) const {
    const double scale = 1 / (map_(2, 0) * x + map_(2, 1) * y + map_(2, 2));
    const auto u = static_cast<float>(scale * (map_(0, 0) * x + map_(0, 1) * y + map_(0, 2)));
    const auto v = static_cast<float>(scale * (map_(1, 0) * x + map_(1, 1) * y + map_(1, 2)));
    if (!is_inside_) {
      const auto grey = grey_at(image_, u, v);
      return grey ? static_cast<double>(*grey) : std::numeric_limits<double>::quiet_NaN();
    }
    const int col = static_cast<int>(u);
    const int row = static_cast<int>(v);
    const float right = u - static_cast<float>(col);
    const float down = v - static_cast<float>(row);
    const std::uint8_t* upper = image_.data + row * image_.stride + col;
    const std::uint8_t* lower = upper + image_.stride;
    const auto between = [](const std::uint8_t* p, float share) {
      return static_cast<float>(p[0]) + share * static_cast<float>(p[1] - p[0]);
    };
    const float above = between(upper, right);
    return static_cast<double>(above + down * (between(lower, right) - above));
  }
  // Of four places about the middle of a cell, where a cell has more than a few pixels.
  [[nodiscard]] double mean_at(double x, double y) const {
    if (spread_ == 0) return grey_in(x, y);
    return 0.25 * (grey_in(x - spread_, y - spread_) + grey_in(x + spread_, y - spread_) +
                   grey_in(x - spread_, y + spread_) + grey_in(x + spread_, y + spread_));
  }

  struct Sample {
    double x;
    double y;
    double grey;
  };
  // Those that are in the image.
  struct Samples {
    std::array<Sample, 8 * kMostCells> all;
    int count = 0;
    void add(double x, double y, double grey) {
      if (!std::isnan(grey)) all[static_cast<std::size_t>(count++)] = {x, y, grey};
    }
    [[nodiscard]] std::span<const Sample> seen() const {
      return std::span(all).first(static_cast<std::size_t>(count));
    }
  };

  const ImageView& image_;
  int side_;
  double middle_;  // cells
  int border_;
  bool inverted_;
  Eigen::Matrix3d map_;
  double spread_;  // cells
  double around_;  // cells
  bool is_inside_;
  std::array<double, std::size_t{kMostCells} * kMostCells> border_greys_;
  GreyPlane dark_;   // of the border
  GreyPlane light_;  // of what is around it
  double contrast_ = 0;
  int border_seen_ = 0;
  int border_wrong_ = 0;
  int around_seen_ = 0;
  int around_wrong_ = 0;
};

}  // namespace calvin::detect
