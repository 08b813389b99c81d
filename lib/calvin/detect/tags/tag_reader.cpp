// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks at the cells of a quad, and for the nearest code of a dictionary.

#include "calvin/detect/tags/tag_reader.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include <Eigen/Cholesky>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"

namespace calvin::detect {

namespace {

constexpr double kLeastContrast = 8;  // grey levels, from dark to light

// The number of bits of which two tags of a dictionary differ at least, however they are turned,
// and a tag from itself where it is turned.
int distance_of(const MarkerDictionary& dictionary) {
  int least = dictionary.side * dictionary.side;
  for (std::size_t i = 0; i < dictionary.codes.size(); ++i) {
    std::uint64_t code = dictionary.codes[i];
    for (int turns = 0; turns < 4; ++turns) {
      for (std::size_t k = turns == 0 ? i + 1 : i; k < dictionary.codes.size(); ++k) {
        least = std::min(least, std::popcount(code ^ dictionary.codes[k]));
      }
      code = turned(code, dictionary.side);
    }
  }
  return least;
}

// A grey level that changes over a quad: at the place (x, y) in cells from its middle, a + b x + c
// y.
class Plane {
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
  void fit() {
    // Of places all around the middle each sum tells one number.
    constexpr double kNone = 1e-9;
    if (std::max({std::abs(x_), std::abs(y_), std::abs(xy_)}) < kNone) {
      levels_ = {right_[0] / count_, right_[1] / xx_, right_[2] / yy_};
      return;
    }
    Eigen::Matrix3d products;
    products << count_, x_, y_, x_, xx_, xy_, y_, xy_, yy_;
    levels_ = products.ldlt().solve(right_);
  }
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

}  // namespace

// The grey levels of the cells of a quad, beside those of its border and of what is around it.
class TagReader::Cells {
 public:
  Cells(const ImageView& image, const Quad& quad, const TagReader& reader)
      : image_(image),
        side_(reader.style_.cells()),
        middle_(0.5 * side_),
        border_(reader.style_.border),
        inverted_(reader.style_.inverted),
        map_(from_cells(quad, side_)),
        spread_(shortest_side(quad) / side_ > 2 ? 0.2 : 0),
        around_(reader.around_),
        is_inside_(is_inside(around_)) {}

  // Whether what the border is around is as dark as the border everywhere: fewer places are looked
  // at than for the bits. Only tags wholly in the image are told.
  [[nodiscard]] bool are_plain() const;

  // Comes before what follows.
  void take_levels();

  // Whether there is a border, darker than what is around it.
  [[nodiscard]] bool are_tags(double most_wrong) const {
    return contrast_ >= kLeastContrast &&
           border_wrong_ <= most_wrong * static_cast<double>(border_seen_) &&
           around_wrong_ <= 2 * most_wrong * static_cast<double>(around_seen_) &&
           around_seen_ >= 2 * side_;
  }
  [[nodiscard]] double contrast() const { return contrast_; }

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
    return std::min({col, row, side_ - 1 - col, side_ - 1 - row}) < border_;
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
  Plane dark_;   // of the border
  Plane light_;  // of what is around it
  double contrast_ = 0;
  int border_seen_ = 0;
  int border_wrong_ = 0;
  int around_seen_ = 0;
  int around_wrong_ = 0;
};

bool TagReader::Cells::are_plain() const {
  constexpr double kMost =
      0.25;  // of the contrast: twice that is no light bit when it is sharpened
  if (!is_inside_) return false;
  double dark = 0;
  double light = 0;
  for (const double along : {0.25 * side_, 0.75 * side_}) {
    for (const auto& [depth, sum] : {std::pair{0.5, &dark}, {-around_, &light}}) {
      const double far = side_ - depth;
      *sum += (grey_in(along, depth) + grey_in(far, along) + grey_in(along, far) +
               grey_in(depth, along)) /
              8;
    }
  }
  const double least = dark + kMost * (light - dark);
  for (int row = border_; row < side_ - border_; ++row) {
    for (int col = border_; col < side_ - border_; ++col) {
      const double grey = grey_in(col + 0.5, row + 0.5);
      if (inverted_ ? grey <= least : grey >= least) return false;
    }
  }
  return true;
}

void TagReader::Cells::take_levels() {
  Samples border;
  Samples outside;
  for (int row = 0; row < side_; ++row) {
    for (int col = 0; col < side_; ++col) {
      if (!is_border(col, row)) continue;
      const double grey = mean_at(col + 0.5, row + 0.5);
      border_greys_[index(col, row)] = grey;
      border.add(col + 0.5, row + 0.5, grey);
    }
  }
  for (int i = 0; i < side_; ++i) {
    const double along = i + 0.5;
    const double far = side_ + around_;
    for (const auto& [x, y] :
         {std::pair{along, -around_}, {far, along}, {along, far}, {-around_, along}}) {
      outside.add(x, y, grey_in(x, y));
    }
  }
  border_seen_ = border.count;
  around_seen_ = outside.count;
  if (2 * border_seen_ < side_ || 2 * around_seen_ < side_) return;
  for (const Sample& s : border.seen()) dark_.add(s.x - middle_, s.y - middle_, s.grey);
  for (const Sample& s : outside.seen()) light_.add(s.x - middle_, s.y - middle_, s.grey);
  dark_.fit();
  light_.fit();
  contrast_ = (light_.at(0, 0) - dark_.at(0, 0)) * (inverted_ ? -1 : 1);
  const auto is_light = [&](const Sample& s) { return lightness(s.x, s.y, s.grey) > 0.5; };
  border_wrong_ = static_cast<int>(std::ranges::count_if(border.seen(), is_light));
  around_wrong_ = around_seen_ - static_cast<int>(std::ranges::count_if(outside.seen(), is_light));
}

TagReader::TagReader(const TagStyle& style, double gap)
    : TagReader(style, gap, std::max((distance_of(*style.dictionary) - 1) / 2, 0)) {}

TagReader::TagReader(const TagStyle& style, double gap, int most_wrong)
    : style_(style), gap_(gap * style.cells()), codes_(*style.dictionary, most_wrong) {
  // In the middle of a narrow gap: beyond it there may be another tag.
  constexpr double kMost = 0.7;  // cells
  around_ = std::min(kMost, 0.5 * gap_);
  has_light_bits_ = std::ranges::all_of(style.dictionary->codes, [&](std::uint64_t code) {
    return std::popcount(code) > most_wrong;
  });
}

std::optional<TagBits> TagReader::bits_of(const ImageView& image, const Quad& quad) const {
  constexpr double kMostWrong = 0.1;  // of the cells of the border
  Cells cells(image, quad, *this);
  if (has_light_bits_ && cells.are_plain()) return std::nullopt;
  cells.take_levels();
  if (!cells.are_tags(kMostWrong)) return std::nullopt;
  const int side = style_.dictionary->side;
  // The bits and the cells around them, but for those at the corners.
  const int around = side + 2;
  constexpr std::size_t kMost = 10;  // a code has 64 bits
  std::array<double, kMost * kMost> light;
  const auto at = [&](int col, int row) -> double& {
    return light[static_cast<std::size_t>((row + 1) * around + col + 1)];
  };
  for (int row = -1; row <= side; ++row) {
    for (int col = -1; col <= side; ++col) {
      if ((col < 0 || col == side) && (row < 0 || row == side)) continue;
      const auto own = cells.lightness(col + style_.border, row + style_.border);
      if (!own) return std::nullopt;
      at(col, row) = *own;
    }
  }
  TagBits bits;
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) {
      const double own = at(col, row);
      const double beside = at(col - 1, row) + at(col + 1, row);
      // As in AprilTag 3, blur and ink that has run are taken off by a Laplacian.
      const double sharp = own + 0.25 * (4 * own - beside - at(col, row - 1) - at(col, row + 1));
      bits.plain = bits.plain << 1 | (own > 0.5 ? 1U : 0U);
      bits.sharpened = bits.sharpened << 1 | (sharp > 0.5 ? 1U : 0U);
    }
  }
  return bits;
}

std::optional<TagCode> TagReader::find(const TagBits& bits) const {
  auto best = codes_.nearest(bits.plain);
  if (bits.plain != bits.sharpened && !(best && best->wrong == 0)) {
    const auto sharpened = codes_.nearest(bits.sharpened);
    if (sharpened && (!best || sharpened->wrong < best->wrong)) best = sharpened;
  }
  if (best && style_.april) best->turns = (best->turns + 2) % 4;
  return best;
}

TagPattern TagReader::pattern_of(int id) const {
  TagPattern tag;
  tag.side = style_.dictionary->side;
  tag.border = style_.border;
  tag.gap = gap_;
  tag.inverted = style_.inverted;
  tag.bits = style_.dictionary->codes[static_cast<std::size_t>(id)];
  if (style_.april) tag.bits = turned(turned(tag.bits, tag.side), tag.side);
  return tag;
}

TagMatch TagReader::match(const ImageView& image, const Quad& quad, const TagPattern& tag) const {
  TagMatch all;
  Cells cells(image, quad, *this);
  cells.take_levels();
  if (cells.contrast() < kLeastContrast) return all;
  const int last = tag.cells() - 1;
  for (int row = 0; row <= last; ++row) {
    for (int col = 0; col <= last; ++col) {
      const auto light = cells.lightness(col, row);
      if (!light) continue;
      const bool is_border = std::min({col, row, last - col, last - row}) < tag.border;
      ++(is_border ? all.border_seen : all.seen);
      (is_border ? all.border_right : all.right) +=
          (*light > 0.5) == tag.is_light(col, row) ? 1 : 0;
    }
  }
  return all;
}

double TagReader::evidence(int wrong) const {
  const int count = style_.dictionary->side * style_.dictionary->side;
  double codes = 0;  // with at most so many wrong bits
  double with = 1;
  for (int k = 0; k <= wrong; ++k) {
    codes += with;
    with *= static_cast<double>(count - k) / (k + 1);
  }
  return count * std::log(2.0) - std::log(codes);
}

}  // namespace calvin::detect
