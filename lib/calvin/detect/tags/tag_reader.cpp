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
#include <utility>

#include "calvin/detect/tags/tag_cells.hpp"

namespace calvin::detect {

namespace {

constexpr int kMostOutside = 4;  // cells around the bits within a rim: the rim is one of them

// The number of bits of which two tags of a dictionary differ at least, however they are turned,
// and a tag from itself where it is turned.
int distance_of(const MarkerDictionary& dictionary) {
  if (dictionary.distance > 0) return dictionary.distance;
  const QuarterTurn turned(dictionary);
  int least = dictionary.bit_count();
  for (std::size_t i = 0; i < dictionary.codes.size(); ++i) {
    std::uint64_t code = dictionary.codes[i];
    for (int turns = 0; turns < 4; ++turns) {
      for (std::size_t k = turns == 0 ? i + 1 : i; k < dictionary.codes.size(); ++k) {
        least = std::min(least, std::popcount(code ^ dictionary.codes[k]));
      }
      code = turned(code);
    }
  }
  return least;
}

}  // namespace

TagReader::TagReader(const TagStyle& style, double gap)
    : TagReader(style, gap,
                std::make_shared<const CodeIndex>(
                    *style.dictionary, std::max((distance_of(*style.dictionary) - 1) / 2, 0))) {}

TagReader::TagReader(const TagStyle& style, double gap, std::shared_ptr<const CodeIndex> codes)
    : style_(style),
      gap_(style.dictionary->outside > 0 ? 1 : gap * style.cells()),
      codes_(std::move(codes)) {
  const MarkerDictionary& dictionary = *style.dictionary;
  // In the middle of a narrow gap: beyond it there may be another tag.
  constexpr double kMost = 0.7;  // cells
  around_ = std::min(kMost, 0.5 * gap_);
  has_light_bits_ =
      dictionary.outside == 0 && std::ranges::all_of(dictionary.codes, [&](std::uint64_t code) {
        return std::popcount(code) > codes_->most_wrong();
      });
  const auto is_bit = [&](int col, int row) { return dictionary.bit_at(col, row) >= 0; };
  for (int row = -1 - kMostOutside; row <= dictionary.side + kMostOutside; ++row) {
    for (int col = -1 - kMostOutside; col <= dictionary.side + kMostOutside; ++col) {
      if (is_bit(col, row) || is_bit(col - 1, row) || is_bit(col + 1, row) ||
          is_bit(col, row - 1) || is_bit(col, row + 1)) {
        looked_at_.push_back({col, row});
      }
    }
  }
}

std::optional<TagBits> TagReader::bits_of(const ImageView& image, const Quad& quad) const {
  constexpr double kMostWrong = 0.1;  // of the cells of the border
  TagCells cells(image, quad, style_, around_);
  if (has_light_bits_ && cells.are_plain()) return std::nullopt;
  cells.take_levels();
  if (!cells.are_tags(kMostWrong)) return std::nullopt;
  const MarkerDictionary& dictionary = *style_.dictionary;
  constexpr int kStride = 16;
  std::array<double, std::size_t{kStride} * kStride> light;
  const auto at = [&](int col, int row) -> double& {
    return light[static_cast<std::size_t>((row + 1 + kMostOutside) * kStride + col + 1 +
                                          kMostOutside)];
  };
  const int last = dictionary.side + style_.border;
  for (const GridPlace cell : looked_at_) {
    const auto own = cells.lightness(cell.col + style_.border, cell.row + style_.border);
    const bool is_around =
        std::min(cell.col, cell.row) < -style_.border || std::max(cell.col, cell.row) >= last;
    // Around a tag there need be no picture.
    if (!own && !(is_around && dictionary.bit_at(cell.col, cell.row) < 0)) return std::nullopt;
    at(cell.col, cell.row) = own.value_or(0);
  }
  TagBits bits;
  for (int bit = 0; bit < dictionary.bit_count(); ++bit) {
    const auto [col, row] = dictionary.place_of(bit);
    const double own = at(col, row);
    const double beside = at(col - 1, row) + at(col + 1, row);
    // As in AprilTag 3, blur and ink that has run are taken off by a Laplacian.
    const double sharp = own + 0.25 * (4 * own - beside - at(col, row - 1) - at(col, row + 1));
    const bool is_light_set = !dictionary.has_light_rim();
    bits.plain = bits.plain << 1 | ((own > 0.5) == is_light_set ? 1U : 0U);
    bits.sharpened = bits.sharpened << 1 | ((sharp > 0.5) == is_light_set ? 1U : 0U);
  }
  return bits;
}

std::optional<TagCode> TagReader::find(const TagBits& bits) const {
  auto best = codes_->nearest(bits.plain);
  if (bits.plain != bits.sharpened && !(best && best->wrong == 0)) {
    const auto sharpened = codes_->nearest(bits.sharpened);
    if (sharpened && (!best || sharpened->wrong < best->wrong)) best = sharpened;
  }
  if (best && style_.april) best->turns = (best->turns + 2) % 4;
  return best;
}

TagPattern TagReader::pattern_of(int id) const {
  TagPattern tag;
  tag.dictionary = style_.dictionary;
  tag.side = style_.dictionary->side;
  tag.border = style_.border;
  tag.gap = gap_;
  tag.inverted = style_.inverted;
  tag.bits = style_.dictionary->codes[static_cast<std::size_t>(id)];
  if (style_.april) tag.bits = half_turned(tag.bits, style_.dictionary->bit_count());
  return tag;
}

TagMatch TagReader::match(const ImageView& image, const Quad& quad, const TagPattern& tag) const {
  TagMatch all;
  TagCells cells(image, quad, style_, around_);
  cells.take_levels();
  if (!cells.has_contrast()) return all;
  const int last = tag.cells() - 1;
  const auto compare = [&](int col, int row, int& seen, int& right) {
    const auto light = cells.lightness(col, row);
    if (!light) return;
    ++seen;
    right += (*light > 0.5) == tag.is_light(col, row) ? 1 : 0;
  };
  for (int row = 0; row <= last; ++row) {
    for (int col = 0; col <= last; ++col) {
      const bool is_border = std::min({col, row, last - col, last - row}) < tag.border;
      if (is_border) compare(col, row, all.border_seen, all.border_right);
    }
  }
  for (int bit = 0; bit < tag.dictionary->bit_count(); ++bit) {
    const auto [col, row] = tag.dictionary->place_of(bit);
    compare(col + tag.border, row + tag.border, all.seen, all.right);
  }
  return all;
}

double TagReader::evidence(int wrong) const {
  const int count = style_.dictionary->bit_count();
  double codes = 0;  // with at most so many wrong bits
  double with = 1;
  for (int k = 0; k <= wrong; ++k) {
    codes += with;
    with *= static_cast<double>(count - k) / (k + 1);
  }
  return count * std::log(2.0) - std::log(codes);
}

}  // namespace calvin::detect
