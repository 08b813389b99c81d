// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/remap/map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

namespace calvin {

namespace {

// Fine enough for all but small pictures, px; and where the model ends.
constexpr int kFine = 4;
// Closer nodes must not be more than these.
constexpr int kMostFineNodes = 1 << 16;
// So many nodes that none of them shows anything tell that there is nothing to be seen.
constexpr int kEmptyNodes = 1 << 12;
// Places this far outside tell nothing more; differences of them still fit in 32 bits (lanes.hpp).
constexpr double kFar = 30000;

double clamp_far(double place, int length) { return std::clamp(place, -kFar, length + kFar); }

}  // namespace

RemapMap::RemapMap(ImageSize source, ImageSize output, int step)
    : source_(source), output_(output), step_(step) {
  // One node before the frame and two behind the last cell.
  columns_ = (output.width + step - 1) / step + 3;
  rows_ = (output.height + step - 1) / step + 3;
  const auto count = index(0, rows_);
  x_.resize(count);
  y_.resize(count);
}

bool RemapMap::fill(const PixelFunction& place_of, const std::stop_token& stop) {
  for (int r = 0; r < rows_; ++r) {
    if (stop.stop_requested()) return false;
    for (int c = 0; c < columns_; ++c) {
      const auto place = place_of({(c - 1.0) * step_, (r - 1.0) * step_});
      const bool found = place && std::isfinite(place->u) && std::isfinite(place->v);
      const auto i = index(c, r);
      x_[i] = found ? static_cast<float>(clamp_far(place->u, source_.width)) : kMissing;
      y_[i] = found ? static_cast<float>(clamp_far(place->v, source_.height)) : kMissing;
      if (!found) ++missing_;
    }
  }
  return true;
}

int RemapMap::cell_of(double pixel, int cells) const noexcept {
  return std::min(static_cast<int>(std::max(pixel, 0.0) / step_), cells - 1);
}

RemapMap::Cell RemapMap::cell(int cell_column, int cell_row) const noexcept {
  if (missing_ == 0) return Cell::kSmooth;
  int found = 0;
  for (int r = cell_row; r < cell_row + 4; ++r) {
    for (int c = cell_column; c < cell_column + 4; ++c) {
      if (!std::isnan(x_[index(c, r)])) ++found;
    }
  }
  return found == 16 ? Cell::kSmooth : found == 0 ? Cell::kEmpty : Cell::kMixed;
}

Pixel RemapMap::at(Pixel output) const noexcept {
  const int column = cell_of(output.u, columns_ - 3);
  const int row = cell_of(output.v, rows_ - 3);
  const auto across = cubic_weights(output.u / step_ - column);
  const auto down = cubic_weights(output.v / step_ - row);
  Pixel place;
  for (std::size_t r = 0; r < 4; ++r) {
    const auto first = index(column, row + static_cast<int>(r));
    for (std::size_t c = 0; c < 4; ++c) {
      const double weight = 1.0 * across[c] * down[r];
      place.u += weight * x_[first + c];
      place.v += weight * y_[first + c];
    }
  }
  return place;
}

// Whether nodes that are half as far apart would be too many.
bool RemapMap::is_finest() const noexcept {
  return step_ == 1 || (step_ <= kFine && 4 * rows_ * columns_ > kMostFineNodes);
}

bool RemapMap::matters(int cell_column, int cell_row) const noexcept {
  // The cell's corners, and what is bent reaches a little farther; where some of them are missing
  // the nodes around them too.
  const bool smooth = cell(cell_column, cell_row) == Cell::kSmooth;
  const int around = smooth ? 0 : 1;
  const auto reaches = [&](const std::vector<float>& places, int size) {
    float low = std::numeric_limits<float>::infinity();
    float high = -low;
    for (int r = cell_row + 1 - around; r <= cell_row + 2 + around; ++r) {
      for (int c = cell_column + 1 - around; c <= cell_column + 2 + around; ++c) {
        const float place = places[index(c, r)];
        if (std::isnan(place)) continue;
        low = std::min(low, place);
        high = std::max(high, place);
      }
    }
    const float more = smooth ? (high - low) / 4 : 0;
    return high + more > -1 && low - more < static_cast<float>(size);
  };
  return reaches(x_, source_.width) && reaches(y_, source_.height);
}

// Looks where interpolation is worst, in the middle of cells: of many every second one, as on a
// chessboard.
bool RemapMap::good_enough(const PixelFunction& place_of) const {
  constexpr int kFew = 500;
  // Wide cells would lose too much of it where the model ends.
  if (step_ == kCoarsest && !everywhere_smooth()) return false;
  const bool many = (rows_ - 3) * (columns_ - 3) > kFew;
  int smooth = 0;
  int mixed = 0;
  for (int r = 0; r < rows_ - 3; ++r) {
    for (int c = many ? r % 2 : 0; c < columns_ - 3; c += many ? 2 : 1) {
      const Cell kind = cell(c, r);
      if (kind == Cell::kMixed && matters(c, r)) ++mixed;
      if (kind != Cell::kSmooth || !matters(c, r)) continue;
      ++smooth;
      const Pixel middle = {(c + 0.5) * step_, (r + 0.5) * step_};
      const Pixel found = at(middle);
      const auto exact = place_of(middle);
      if (exact && !(std::abs(exact->u - found.u) <= tolerance() &&
                     std::abs(exact->v - found.v) <= tolerance())) {
        return false;
      }
    }
  }
  if (everywhere_smooth() || step_ <= kFine) return true;
  // Between missing nodes there may be something.
  if (smooth + mixed == 0) return rows_ * columns_ >= kEmptyNodes;
  // What lies in mixed cells is found place by place, by parabolas alone.
  return 2 * mixed <= smooth;
}

Result<RemapMap> RemapMap::build(ImageSize source, ImageSize output, const PixelFunction& place_of,
                                 const std::stop_token& stop) {
  try {
    for (int step = kCoarsest;; step /= 2) {
      RemapMap map(source, output, step);
      if (!map.fill(place_of, stop)) {
        return make_error(ErrorCode::kCancelled, "The work was cancelled.");
      }
      if (map.is_finest() || map.good_enough(place_of)) return map;
    }
  } catch (const std::bad_alloc&) {
    return make_error(ErrorCode::kInvalidArgument,
                      "There is not enough memory for a map of that size.");
  }
}

}  // namespace calvin
