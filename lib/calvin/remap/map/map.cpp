// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Builds the map: halves the distance of its nodes until the interpolation is good enough.

#include "calvin/remap/map/map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

namespace calvin {

namespace {

// The distance of nodes, px, below which only small pictures go, and pictures in which the model
// ends.
constexpr int kFine = 4;
// Nodes of a map that is finer than that, at most: 512 KB.
constexpr int kMaxFineNodes = 1 << 16;
// Where so many nodes show nothing of the source, the picture is taken as empty.
constexpr int kEmptyNodes = 1 << 12;
// Coordinates are clamped this far outside of the source, px: what is farther off is not seen
// anyway, and 32 bits hold differences of clamped ones in 1/2^14 of a sample (remap/map/runs.hpp).
constexpr double kFarOutside = 30000;

double clamp_far(double coord, int length) {
  return std::clamp(coord, -kFarOutside, length + kFarOutside);
}

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

bool RemapMap::fill(const PixelFunction& source_of, const std::stop_token& stop) {
  for (int r = 0; r < rows_; ++r) {
    if (stop.stop_requested()) return false;
    for (int c = 0; c < columns_; ++c) {
      const auto coord = source_of({(c - 1.0) * step_, (r - 1.0) * step_});
      const bool found = coord && std::isfinite(coord->u) && std::isfinite(coord->v);
      const auto i = index(c, r);
      x_[i] = found ? static_cast<float>(clamp_far(coord->u, source_.width)) : kMissing;
      y_[i] = found ? static_cast<float>(clamp_far(coord->v, source_.height)) : kMissing;
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
  Pixel coord;
  for (std::size_t r = 0; r < 4; ++r) {
    const auto first = index(column, row + static_cast<int>(r));
    for (std::size_t c = 0; c < 4; ++c) {
      const double weight = 1.0 * across[c] * down[r];
      coord.u += weight * x_[first + c];
      coord.v += weight * y_[first + c];
    }
  }
  return coord;
}

// Whether there would be too many nodes at half their distance.
bool RemapMap::is_finest() const noexcept {
  return step_ == 1 || (step_ <= kFine && 4 * rows_ * columns_ > kMaxFineNodes);
}

bool RemapMap::matters(int cell_column, int cell_row) const noexcept {
  // The corners of the cell tell, and a quarter of their extent more since the cell is bent. Where
  // nodes are missing, those around the corners count, too.
  const bool smooth = cell(cell_column, cell_row) == Cell::kSmooth;
  const int around = smooth ? 0 : 1;
  const auto reaches = [&](const std::vector<float>& coords, int size) {
    float low = std::numeric_limits<float>::infinity();
    float high = -low;
    for (int r = cell_row + 1 - around; r <= cell_row + 2 + around; ++r) {
      for (int c = cell_column + 1 - around; c <= cell_column + 2 + around; ++c) {
        const float coord = coords[index(c, r)];
        if (std::isnan(coord)) continue;
        low = std::min(low, coord);
        high = std::max(high, coord);
      }
    }
    const float more = smooth ? (high - low) / 4 : 0;
    return high + more > -1 && low - more < static_cast<float>(size);
  };
  return reaches(x_, source_.width) && reaches(y_, source_.height);
}

// Whether the interpolation is within the tolerance in the middles of cells, where it is worst. Of
// many cells every second one is looked at, as on a chessboard.
bool RemapMap::good_enough(const PixelFunction& source_of) const {
  constexpr int kFew = 500;
  // Where the model ends, large cells would lose too much of the picture.
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
      const auto exact = source_of(middle);
      if (exact && !(std::abs(exact->u - found.u) <= tolerance() &&
                     std::abs(exact->v - found.v) <= tolerance())) {
        return false;
      }
    }
  }
  if (everywhere_smooth() || step_ <= kFine) return true;
  // No cell shows anything; between nodes that are close enough there is nothing either.
  if (smooth + mixed == 0) return rows_ * columns_ >= kEmptyNodes;
  // Runs in mixed cells are costly: each of their middles is found by itself (PlaneMap::Middle).
  return 2 * mixed <= smooth;
}

Result<RemapMap> RemapMap::build(ImageSize source, ImageSize output, const PixelFunction& source_of,
                                 const std::stop_token& stop) {
  try {
    for (int step = kCoarsest;; step /= 2) {
      RemapMap map(source, output, step);
      if (!map.fill(source_of, stop)) {
        return make_error(ErrorCode::kCancelled, "The work was cancelled.");
      }
      if (map.is_finest() || map.good_enough(source_of)) return map;
    }
  } catch (const std::bad_alloc&) {
    return make_error(ErrorCode::kInvalidArgument,
                      "There is not enough memory for a map of that size.");
  }
}

}  // namespace calvin
