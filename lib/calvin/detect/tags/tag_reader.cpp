// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks at the cells of a quad, and for the nearest code of a dictionary.

#include "calvin/detect/tags/tag_reader.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"

namespace calvin::detect {

namespace {

constexpr double kLeastContrast = 8;  // grey levels, from dark to light

// The bits of a tag that is turned by a quarter: the first row becomes the last column.
std::uint64_t turned(std::uint64_t bits, int side) {
  std::uint64_t all = 0;
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) {
      // The new bit at (col, row) was at (row, side - 1 - col).
      const int from = side * side - 1 - ((side - 1 - col) * side + row);
      all = all << 1 | (bits >> from & 1);
    }
  }
  return all;
}

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

// A grey level that changes over a quad: at the place (x, y) in cells, a + b x + c y.
class Plane {
 public:
  void add(double x, double y, double grey) {
    const Eigen::Vector3d row(1, x, y);
    products_ += row * row.transpose();
    right_ += grey * row;
  }
  void fit() { levels_ = products_.ldlt().solve(right_); }
  [[nodiscard]] double at(double x, double y) const {
    return levels_[0] + levels_[1] * x + levels_[2] * y;
  }

 private:
  Eigen::Matrix3d products_ = Eigen::Matrix3d::Zero();
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
        border_(reader.style_.border),
        inverted_(reader.style_.inverted),
        map_(from_cells(quad, side_)),
        spread_(shortest_side(quad) / side_ > 2 ? 0.2 : 0) {
    take_levels(reader.around_);
  }

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
    const auto grey = mean_at(x, y);
    if (!grey) return std::nullopt;
    return lightness(x, y, *grey);
  }

 private:
  [[nodiscard]] double lightness(double x, double y, double grey) const {
    const double dark = dark_.at(x, y);
    const double contrast = light_.at(x, y) - dark;
    return (grey - dark) / (inverted_ ? std::min(contrast, -1.0) : std::max(contrast, 1.0));
  }
  [[nodiscard]] std::optional<double> grey_in(double x, double y) const {
    const Eigen::Vector3d p = map_ * Eigen::Vector3d(x, y, 1);
    const auto grey =
        grey_at(image_, static_cast<float>(p.x() / p.z()), static_cast<float>(p.y() / p.z()));
    if (!grey) return std::nullopt;
    return static_cast<double>(*grey);
  }
  // Of four places about the middle of a cell, where a cell has more than a few pixels.
  [[nodiscard]] std::optional<double> mean_at(double x, double y) const {
    if (spread_ == 0) return grey_in(x, y);
    double sum = 0;
    for (const double dx : {-spread_, spread_}) {
      for (const double dy : {-spread_, spread_}) {
        const auto grey = grey_in(x + dx, y + dy);
        if (!grey) return std::nullopt;
        sum += 0.25 * *grey;
      }
    }
    return sum;
  }

  struct Sample {
    double x;
    double y;
    double grey;
  };
  void take_levels(double around);

  const ImageView& image_;
  int side_;
  int border_;
  bool inverted_;
  Eigen::Matrix3d map_;
  double spread_;  // cells
  Plane dark_;     // of the border
  Plane light_;    // of what is around it
  double contrast_ = 0;
  int border_seen_ = 0;
  int border_wrong_ = 0;
  int around_seen_ = 0;
  int around_wrong_ = 0;
};

void TagReader::Cells::take_levels(double around) {
  std::vector<Sample> border;
  std::vector<Sample> outside;
  for (int row = 0; row < side_; ++row) {
    for (int col = 0; col < side_; ++col) {
      const bool is_bit = std::min({col, row, side_ - 1 - col, side_ - 1 - row}) >= border_;
      const auto grey = is_bit ? std::nullopt : mean_at(col + 0.5, row + 0.5);
      if (grey) border.push_back({col + 0.5, row + 0.5, *grey});
    }
  }
  for (int i = 0; i < side_; ++i) {
    const double along = i + 0.5;
    const double far = side_ + around;
    for (const auto& [x, y] :
         {std::pair{along, -around}, {far, along}, {along, far}, {-around, along}}) {
      if (const auto grey = grey_in(x, y)) outside.push_back({x, y, *grey});
    }
  }
  border_seen_ = static_cast<int>(border.size());
  around_seen_ = static_cast<int>(outside.size());
  if (2 * border_seen_ < side_ || 2 * around_seen_ < side_) return;
  for (const Sample& s : border) dark_.add(s.x, s.y, s.grey);
  for (const Sample& s : outside) light_.add(s.x, s.y, s.grey);
  dark_.fit();
  light_.fit();
  const double middle = 0.5 * side_;
  contrast_ = (light_.at(middle, middle) - dark_.at(middle, middle)) * (inverted_ ? -1 : 1);
  const auto is_light = [&](const Sample& s) { return lightness(s.x, s.y, s.grey) > 0.5; };
  border_wrong_ = static_cast<int>(std::ranges::count_if(border, is_light));
  around_wrong_ = around_seen_ - static_cast<int>(std::ranges::count_if(outside, is_light));
}

TagReader::TagReader(const TagStyle& style, double gap)
    : TagReader(style, gap, std::max((distance_of(*style.dictionary) - 1) / 2, 0)) {}

TagReader::TagReader(const TagStyle& style, double gap, int most_wrong)
    : style_(style), gap_(gap * style.cells()), most_wrong_(most_wrong) {
  // In the middle of a narrow gap: beyond it there may be another tag.
  constexpr double kMost = 0.7;  // cells
  around_ = std::min(kMost, 0.5 * gap_);
}

std::optional<TagBits> TagReader::bits_of(const ImageView& image, const Quad& quad) const {
  constexpr double kMostWrong = 0.1;  // of the cells of the border
  const Cells cells(image, quad, *this);
  if (!cells.are_tags(kMostWrong)) return std::nullopt;
  const int side = style_.dictionary->side;
  // The bits and the cells around them, but for those at the corners.
  const int around = side + 2;
  std::vector<double> light(static_cast<std::size_t>(around * around));
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
  const auto plain = nearest(bits.plain);
  if (bits.plain == bits.sharpened) return plain;
  const auto sharpened = nearest(bits.sharpened);
  if (!plain || !sharpened) return plain ? plain : sharpened;
  return sharpened->wrong < plain->wrong ? sharpened : plain;
}

namespace {

// std::popcount() is a call of a function where the processor is any x86-64.
int bits_in(std::uint64_t v) {
  v -= v >> 1 & 0x5555555555555555U;
  v = (v & 0x3333333333333333U) + (v >> 2 & 0x3333333333333333U);
  v = (v + (v >> 4)) & 0x0f0f0f0f0f0f0f0fU;
  return static_cast<int>(v * 0x0101010101010101U >> 56);
}

}  // namespace

std::optional<TagCode> TagReader::nearest(std::uint64_t bits) const {
  const int side = style_.dictionary->side;
  TagCode best;
  best.wrong = most_wrong_ + 1;
  for (int turns = 0; turns < 4; ++turns) {
    for (std::size_t id = 0; id < style_.dictionary->codes.size(); ++id) {
      const int wrong = bits_in(bits ^ style_.dictionary->codes[id]);
      if (wrong < best.wrong) best = {static_cast<int>(id), (4 - turns) % 4, wrong};
    }
    bits = turned(bits, side);
  }
  if (best.wrong > most_wrong_) return std::nullopt;
  if (style_.april) best.turns = (best.turns + 2) % 4;
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
  const Cells cells(image, quad, *this);
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
