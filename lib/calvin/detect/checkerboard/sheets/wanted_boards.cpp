// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a search for several boards at once takes: the most that one of them asks for.

#include "calvin/detect/checkerboard/sheets/wanted_boards.hpp"

#include <algorithm>

namespace calvin::detect {

namespace {

constexpr double kLeastShare = 0.2;  // of a board's corners
constexpr int kLeastCoded = 5;       // corners of a board with a code, of which any part will do
// Peaks of the response that are looked at, the strongest first.
constexpr int kPointsPerCorner = 15;
constexpr int kFewestPoints = 800;
// How far a neighbour may be.
constexpr float kLargestSquare = 2.2F;  // times the image's longer side per square of the board
constexpr float kLeastReach = 48;       // px of the level
constexpr float kMostReach = 144;       // px of the smallest level
constexpr float kFineReach = 64;        // px of other levels: smaller ones have looked further

}  // namespace

Surroundings surroundings_of(const std::vector<WantedBoard>& wanted) {
  Surroundings all;
  for (const WantedBoard& w : wanted) all = all.with(w.pattern.surroundings);
  return all;
}

int most_points(const std::vector<WantedBoard>& wanted) {
  int most = 0;
  for (const WantedBoard& w : wanted) most = std::max(most, w.pattern.grid.count());
  return most;
}

SearchOptions search_options(const std::vector<WantedBoard>& wanted, const Pyramid& pyramid,
                             int level) {
  const ImageView& image = pyramid.level(level);
  const auto across = static_cast<float>(std::max(image.width, image.height));
  const float most = level + 1 < pyramid.levels() ? kFineReach : kMostReach;
  SearchOptions options;
  options.least_nodes = most_points(wanted);
  options.most_points = 0;
  options.most_groups = 3;
  options.reach = 0;
  options.surroundings = surroundings_of(wanted);
  for (const WantedBoard& w : wanted) {
    const int points = w.pattern.grid.count();
    const double share = kLeastShare * static_cast<double>(points);
    const int least = w.pattern.code ? kLeastCoded : std::max(6, static_cast<int>(share));
    options.least_nodes = std::min(options.least_nodes, least);
    options.most_points += w.sheets * (kPointsPerCorner + w.pattern.code_corners) * points;
    options.most_groups += static_cast<std::size_t>(w.sheets);
    // The largest squares are those of a board of which a part fills the image.
    const auto squares = static_cast<float>(std::max(w.pattern.grid.cols, w.pattern.grid.rows) + 1);
    const float longest = 2 - w.pattern.surroundings.gap;
    options.reach = std::max(options.reach, kLargestSquare * longest * across / squares);
  }
  options.most_points = std::max(kFewestPoints, options.most_points);
  options.reach = std::clamp(options.reach, kLeastReach, most);
  return options;
}

}  // namespace calvin::detect
