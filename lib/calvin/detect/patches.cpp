// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cuts squares of pixels around corners out of an image.

#include "calvin/detect/patches.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "calvin/detect/checkerboard/corners/fit_radius.hpp"
#include "calvin/detect/checkerboard/corners/saddle_fit.hpp"

namespace calvin {

namespace {

// The largest distance of two control points that are neighbours, px; 0 where there are none.
double spacing_of(const Observation& seen, const Board& board) {
  std::map<int, Pixel> uv;
  for (std::size_t i = 0; i < seen.ids.size(); ++i) uv.emplace(seen.ids[i], seen.uv[i]);
  double largest = 0;
  for (const auto& [id, at] : uv) {
    for (const int neighbour : board.neighbours(id)) {
      const auto other = uv.find(neighbour);
      if (neighbour < id || other == uv.end()) continue;
      largest = std::max(largest, std::hypot(other->second.u - at.u, other->second.v - at.v));
    }
  }
  return largest;
}

}  // namespace

std::shared_ptr<const CornerPatches> cut_patches(const ImageView& image, const Observation& seen,
                                                 const Board& board) {
  constexpr double kRoom = 4;  // px: the corner moves, and the window has a rim
  // The window ends before the nearest line, which may be nearer than the farthest one is.
  const Grid grid = board.grid().value_or(Grid{1, 1, 1});
  const double spacing = spacing_of(seen, board) * grid.least_step() / grid.pitch;
  const float radius =
      std::min(detect::last_radius(static_cast<float>(spacing), static_cast<float>(seen.blur)),
               static_cast<float>(detect::kMaxFitRadius));
  auto patches = std::make_shared<CornerPatches>();
  patches->side = 2 * static_cast<int>(std::ceil(static_cast<double>(radius) + kRoom)) + 1;
  if (!seen.found() || image.width < patches->side || image.height < patches->side) return nullptr;
  const auto side = static_cast<std::size_t>(patches->side);
  const auto pixels = std::make_shared<std::uint8_t[]>(seen.uv.size() * side * side);
  std::uint8_t* to = pixels.get();
  for (const Pixel& p : seen.uv) {
    const int x = std::clamp(static_cast<int>(std::lround(p.u)) - patches->side / 2, 0,
                             image.width - patches->side);
    const int y = std::clamp(static_cast<int>(std::lround(p.v)) - patches->side / 2, 0,
                             image.height - patches->side);
    patches->origin.push_back({x, y});
    for (int row = y; row < y + patches->side; ++row) {
      if (image.step == 1) {
        to = std::copy_n(image.data + row * image.stride + x, patches->side, to);
        continue;
      }
      for (int column = x; column < x + patches->side; ++column) *to++ = image.at(column, row);
    }
  }
  patches->pixels = pixels;
  return patches;
}

ImageView patch_view(const CornerPatches& patches, std::size_t corner) {
  const auto side = static_cast<std::size_t>(patches.side);
  return {patches.pixels.get() + corner * side * side, patches.side, patches.side, patches.side, 1};
}

}  // namespace calvin
