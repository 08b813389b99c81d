// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Identifies boards: searches a picture for every kind, and for those with a code in a mirror, too.

#include "calvin/detect/identify.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <optional>
#include <utility>

#include "calvin/detect/checkerboard/code/any/any_code.hpp"
#include "calvin/detect/checkerboard/sheets/sheet_search.hpp"
#include "calvin/detect/circles/circle_detector.hpp"
#include "calvin/detect/detector.hpp"
#include "calvin/detect/tags/search/any_tags.hpp"
#include "calvin/detect/tags/search/tag_spacing.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

// Of a tag's side: AprilGrids as Kalibr prints them, and others.
constexpr double kUsualSpacing = 0.3;
constexpr std::array kOtherSpacings = {0.25, 0.35, 0.2, 0.4, 0.5, 0.6};

bool has_code(const IdentifiedBoard& seen) {
  return seen.board.as<Checkerboard>() == nullptr && seen.board.as<CircleGrid>() == nullptr &&
         seen.board.as<AsymmetricCircleGrid>() == nullptr;
}

// A checkerboard as it is found by itself. Where squares may have markers in them their margins are
// looked at less closely, and what lies beside a board may pass for a row of it.
IdentifiedBoard find_alone(const ImageView& image, const Checkerboard& seen,
                           const std::stop_token& stop) {
  const auto detector = make_detector(seen);
  if (!detector) return {seen, false, false};
  const Detection alone = (*detector)->detect(image, stop);
  if (alone.observation.found()) return {seen, true, false};
  if (alone.reason != Reason::kWrongBoard || !alone.seen_all) return {seen, false, false};
  const auto [rows, cols] = std::minmax(alone.seen_cols, alone.seen_rows);
  return {Checkerboard{cols, rows, seen.size}, true, false};
}

// Adds the largest sheet of corners that are spaced as those of a pattern.
void find_squares(const ImageView& image, detect::Pattern pattern, const std::stop_token& stop,
                  std::vector<IdentifiedBoard>& seen) {
  const double side = pattern.grid.pitch;
  const bool are_alike = pattern.grid.gap == 0;
  detect::SheetSearch search({detect::WantedBoard{std::move(pattern), 1}});
  search.begin(image);
  if (!search.run(false, stop)) return;
  const auto other = search.other();
  if (!other) return;
  if (const auto board = parse_board(other->text)) {
    seen.push_back({*board, other->certain, false});
  } else if (are_alike && other->certain) {
    seen.push_back(find_alone(image, {other->cols, other->rows, side}, stop));
  }
}

// The AprilGrid whose gaps are about as wide as a spacing, with those that it has.
std::optional<IdentifiedBoard> find_april_grid(const ImageView& image, double side, double spacing,
                                               const std::stop_token& stop) {
  constexpr int kRounds = 3;
  constexpr double kSameSpacing = 0.012;  // of spacings
  std::optional<IdentifiedBoard> best;
  for (int i = 0; i < kRounds; ++i) {
    auto pattern = detect::any_april_grid(side, spacing);
    std::vector<IdentifiedBoard> seen;
    if (pattern) find_squares(image, *std::move(pattern), stop, seen);
    const auto* grid = seen.empty() ? nullptr : seen.front().board.as<AprilGrid>();
    if (grid == nullptr) return best;
    const auto detector = make_detector(seen.front().board);
    if (!detector) return best;
    const Detection corners = (*detector)->detect(image, stop);
    // Corners that gaps of this width do not explain are those of others.
    if (!corners.observation.found()) return best;
    const AprilGrid with_gaps = detect::with_seen_gaps(*grid, corners.observation);
    const auto board = parse_board(with_gaps.text());
    best = IdentifiedBoard{board ? *board : seen.front().board, seen.front().whole, false};
    if (std::abs(with_gaps.spacing - spacing) < kSameSpacing) break;
    spacing = with_gaps.spacing;
  }
  return best;
}

// The same where a few of its tags are seen.
std::optional<IdentifiedBoard> find_april_grid_of(const detect::TagsInView& tags,
                                                  const ImageView& image, double side,
                                                  const std::stop_token& stop) {
  const auto* grid = tags.grid ? tags.grid->board.as<AprilGrid>() : nullptr;
  std::optional<IdentifiedBoard> found;
  if (grid != nullptr) found = find_april_grid(image, side, grid->spacing, stop);
  for (const double spacing : kOtherSpacings) {
    if (found || !tags.of_april_tag) break;
    found = find_april_grid(image, side, spacing, stop);
  }
  return found;
}

std::vector<IdentifiedBoard> find_corners(const ImageView& image, double side,
                                          const std::stop_token& stop) {
  std::vector<IdentifiedBoard> seen;
  find_squares(image, detect::any_board_of_squares(side), stop, seen);
  if (auto grid = find_april_grid(image, side, kUsualSpacing, stop)) {
    seen.push_back(*std::move(grid));
  }
  return seen;
}

std::optional<IdentifiedBoard> find_circles(const ImageView& image, double side,
                                            const std::stop_token& stop) {
  // Larger than any grid in a picture, so that none of them is a part of it; with marks of both
  // kinds, so that these are looked for, where no other board has them.
  constexpr int kMany = 40;
  const std::vector<GridPlace> rings = {{0, 0}, {31, 2}, {5, 37}};
  const std::vector<GridPlace> large = {{39, 0}, {2, 23}, {17, 39}};
  const std::array<Board, 2> boards = {Board(CircleGrid{kMany, kMany, side, rings, large, false}),
                                       Board(CircleGrid{kMany, kMany, side, rings, large, true})};
  const auto detector = detect::make_circle_detector(boards);
  for (const Detection& seen : detector->detect_all(image, stop)) {
    if (!seen.seen_all || seen.seen_board.empty()) continue;
    const auto board = parse_board(seen.seen_board);
    if (!board) continue;
    if (const auto* grid = board->as<AsymmetricCircleGrid>()) {
      return IdentifiedBoard{AsymmetricCircleGrid{grid->cols, grid->rows, side, grid->inverted},
                             true, false};
    }
    return IdentifiedBoard{*board, true, false};
  }
  return std::nullopt;
}

std::vector<IdentifiedBoard> find_in_mirror(const ImageView& image, double side,
                                            const std::stop_token& stop) {
  std::vector<std::uint8_t> mirrored;
  mirrored.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (int row = 0; row < image.height; ++row) {
    const std::uint8_t* of_row = image.data + row * image.stride;
    for (int col = image.width - 1; col >= 0; --col) {
      mirrored.push_back(of_row[static_cast<std::ptrdiff_t>(col) * image.step]);
    }
  }
  auto all = find_corners({mirrored.data(), image.width, image.height, image.width, 1}, side, stop);
  std::erase_if(all, [](const IdentifiedBoard& seen) { return !has_code(seen); });
  for (IdentifiedBoard& seen : all) seen.mirrored = true;
  return all;
}

std::vector<IdentifiedBoard> find_boards(const ImageView& image, double side,
                                         const std::stop_token& stop) {
  auto all = find_corners(image, side, stop);
  if (std::ranges::none_of(all, has_code)) {
    const detect::TagsInView tags = detect::find_any_tags(image, side, stop);
    if (auto grid = find_april_grid_of(tags, image, side, stop)) {
      all.push_back(*std::move(grid));
    } else if (tags.grid) {
      all.push_back({tags.grid->board, tags.grid->whole, false});
    }
  }
  if (std::ranges::none_of(all, has_code)) {
    auto mirrored = find_in_mirror(image, side, stop);
    all.insert(all.end(), mirrored.begin(), mirrored.end());
  }
  if (auto circles = find_circles(image, side, stop)) all.push_back(*std::move(circles));
  if (std::ranges::any_of(all, has_code)) {
    std::erase_if(
        all, [](const IdentifiedBoard& seen) { return seen.board.as<Checkerboard>() != nullptr; });
  }
  std::stable_partition(all.begin(), all.end(), has_code);
  return all;
}

}  // namespace

std::vector<IdentifiedBoard> identify_boards(const ImageView& image, double side,
                                             std::stop_token stop) {
  if (image.data == nullptr || image.width <= 0 || image.height <= 0) return {};
  try {
    auto all = find_boards(image, side, stop);
    return stop.stop_requested() ? std::vector<IdentifiedBoard>() : all;
  } catch (const std::exception&) {
    return {};  // no memory
  }
}

}  // namespace calvin
