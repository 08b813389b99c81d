// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rounds of taking markers out and of fitting corners, until both agree.

#include "calvin/detect/checkerboard/sheets/board_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "calvin/detect/checkerboard/board_search.hpp"
#include "calvin/detect/checkerboard/code/code_match.hpp"
#include "calvin/detect/checkerboard/code/marker_reader.hpp"
#include "calvin/detect/checkerboard/fits/node_fit.hpp"

namespace calvin::detect {

namespace {

template <typename F>
float median_over(const Lattice& lattice, F value) {
  std::vector<float> all;
  lattice.for_each([&](Cell c, const Node& /*node*/) { all.push_back(value(c)); });
  if (all.empty()) return 0;
  const auto middle = all.begin() + std::ssize(all) / 2;
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

float usual_width(const Lattice& lattice) {
  return median_over(lattice, [&](Cell c) { return lattice.at(c).width; });
}

float usual_spacing(const Lattice& lattice) {
  return median_over(lattice, [&](Cell c) { return spacing_at(lattice, c); });
}

// Whether a board has markers that lie on the ground of their squares. Where they have the whole
// square, blur leaves of their rims enough to fit the corners of.
bool has_markers_inside(const Code& code) {
  return code.markers() != nullptr && code.markers()->around < 1;
}

// Whether blur runs markers into the edges beside them, as far as the widths of those are known.
bool reach_edges(const Lattice& lattice) {
  constexpr float kClear = 2.5F;  // edge widths
  if (lattice.surroundings().blurred) return true;
  return kClear * usual_width(lattice) > lattice.surroundings().aside * usual_spacing(lattice);
}

void take_dots(const PlacedBoard& board, Lattice& lattice) {
  if (board.code == nullptr || !board.code->has_dots()) return;
  set_dots(*board.code, board.alignment, lattice);
}

// Adds the corners of a board that markers have hidden.
void complete(const ImageView& image, const GridAlignment& alignment, Lattice& lattice) {
  BoardSearch::complete(image, lattice, 2 * alignment.cols * alignment.rows, true);
  lattice.for_each([&](Cell c, const Node& /*node*/) {
    const Cell from = c - alignment.origin;
    if (from.col < 0 || from.row < 0 || from.col >= alignment.cols || from.row >= alignment.rows) {
      lattice.remove(c);
    }
  });
}

}  // namespace

PlacedBoard placed_board(const Pattern& pattern, const GridAlignment& alignment,
                         const Lattice& lattice) {
  constexpr std::size_t kFew = 10;  // one of so many
  PlacedBoard board = {pattern.code.get(), alignment, {}};
  std::size_t unseen = 0;
  for (const int id : pattern.grid.ids()) {
    const GridPlace at = pattern.grid.place(id);
    board.cells.push_back(alignment.cell({at.col, at.row}));
    unseen += lattice.has(board.cells.back()) ? 0 : 1;
  }
  if (kFew * unseen > board.cells.size()) board.cells.clear();
  return board;
}

// px, RMS over the nodes.
float BoardRefinement::Round::step_size() const {
  float squares = 0;
  for (const Direction& s : step) squares += dot(s, s);
  return std::sqrt(squares / std::max(static_cast<float>(step.size()), 1.0F));
}

bool BoardRefinement::Round::is_within(const Limits& most) const {
  return step_size() <= most.of_sigma * sigma && std::abs(width_step) <= most.of_width * width;
}

bool BoardRefinement::refine(const ImageView& image, const PlacedBoard& board,
                             Refinement& refinement, Lattice& lattice) {
  take_dots(board, lattice);
  took_markers_off_ = false;
  if (board.code != nullptr && has_markers_inside(*board.code)) {
    return refine_beside_markers(image, board, refinement, lattice);
  }
  return refinement.refine(image, lattice, board.cells);
}

bool BoardRefinement::refine_again(const ImageView& image, const PlacedBoard& board,
                                   const FitGrid& before, Refinement& refinement,
                                   Lattice& lattice) {
  take_dots(board, lattice);
  took_markers_off_ = false;
  if (board.code != nullptr && has_markers_inside(*board.code) && reach_edges(lattice)) {
    return refine_without_markers(image, board, refinement, lattice);
  }
  return refinement.refine_again(image, before, lattice);
}

// What the fits beside markers tell of the blur may be wrong where they fail.
bool BoardRefinement::refine_beside_markers(const ImageView& image, const PlacedBoard& board,
                                            Refinement& refinement, Lattice& lattice) {
  start_ = lattice;
  if (!reach_edges(lattice)) {
    const bool all =
        refinement.refine(image, lattice, board.cells) && lattice.count() == start_.count();
    if (all && !reach_edges(lattice)) return true;
    if (!all) lattice = start_;
  }
  if (refine_without_markers(image, board, refinement, lattice)) return true;
  lattice = start_;
  lattice.set_blurred(false);
  return refinement.refine(image, lattice, board.cells);
}

bool BoardRefinement::refine_without_markers(const ImageView& image, const PlacedBoard& board,
                                             Refinement& refinement, Lattice& lattice) {
  constexpr int kRounds = 10;
  constexpr Limits kDone = {0.5F, 0.02F};
  constexpr Limits kNear = {3, 0.05F};      // as good as a corner that is only expected
  constexpr Limits kUseless = {10, 0.05F};  // beyond that, rounds lead nowhere
  constexpr float kWidest = 0.18F;          // of the squares: with more blur no corners are seen
  at_ = lattice;
  at_.set_blurred(true);
  bool completed = at_.count() == board.alignment.cols * board.alignment.rows;
  const float widest = kWidest * usual_spacing(at_);
  float width = std::min(usual_width(at_), widest);
  amplified_.reset();
  bool first = true;
  for (int round = 0; round < kRounds; ++round) {
    const ImageView view = ink_.taken_off(image, *board.code, board.alignment, at_, width);
    if (!first && !completed && now_.is_within(kNear)) {
      completed = true;
      first = true;
      complete(view, board.alignment, at_);
    }
    fitted_ = at_;
    if (!refinement.refine(view, fitted_, board.cells)) return false;
    take_round(width, first);
    if (completed && now_.is_within(kDone)) break;
    width = std::min(next_width(first), widest);
    move_nodes(first);
    first = false;
  }
  if (!(now_.sigma > 0) || !now_.is_within(kUseless)) return false;
  // What a round still moves is uncertain too.
  refinement.widen(std::hypot(amplified_.value_or(1), now_.step_size() / now_.sigma), fitted_);
  lattice = fitted_;
  lattice.set_blurred(false);
  took_markers_off_ = true;
  return true;
}

void BoardRefinement::take_round(float width, bool first) {
  constexpr float kSameWidth = 0.1F;
  std::swap(last_, now_);
  now_.from.clear();
  now_.step.clear();
  at_.for_each([&](Cell c, const Node& from) {
    const Node& to = fitted_.has(c) ? fitted_.at(c) : from;
    now_.from.push_back({from.x, from.y});
    now_.step.push_back({to.x - from.x, to.y - from.y});
  });
  now_.width = width;
  now_.width_step = usual_width(fitted_) - width;
  now_.sigma = median_over(fitted_, [&](Cell c) { return fitted_.at(c).sigma; });
  // Of the first round that the width has nothing to do with.
  if (!first && !amplified_ && std::abs(width - last_.width) < kSameWidth * width) {
    amplified_ = amplification();
  }
}

// How much the width of the edges changes with the one that markers are drawn with is known from
// two rounds; before, as it usually does: drawn narrower, they leave more of themselves.
float BoardRefinement::next_width(bool first) const {
  constexpr float kUsual = -0.55F;
  constexpr float kLeast = -1.5F;
  constexpr float kMost = 0.5F;
  constexpr float kTold = 0.003F;  // of the width: a change that tells
  float slope = kUsual;
  const float change = now_.width - last_.width;
  if (!first && std::abs(change) > kTold * now_.width) {
    slope = std::clamp(1 + (now_.width_step - last_.width_step) / change, kLeast, kMost);
  }
  return now_.width + now_.width_step / (1 - slope);
}

// Markers that are drawn off their place pull the corners beside them along, by up to half of it.
void BoardRefinement::move_nodes(bool first) {
  constexpr float kFurther = 1.3F;
  const float further = first ? 1 : kFurther;
  std::size_t i = 0;
  at_.for_each([&](Cell c, const Node& /*node*/) {
    Node node = fitted_.has(c) ? fitted_.at(c) : at_.at(c);
    node.x = now_.from[i].x + further * now_.step[i].x;
    node.y = now_.from[i].y + further * now_.step[i].y;
    at_.put(c, node);
    ++i;
  });
}

// How far all rounds together move the corners for what moves them by 1 in one round: the sigma of
// a fit, which takes the markers for known, is as much too small.
float BoardRefinement::amplification() const {
  constexpr float kMost = 3;
  float moved = 0;
  float taken_back = 0;
  for (std::size_t i = 0; i < now_.from.size() && i < last_.from.size(); ++i) {
    const Direction from = {now_.from[i].x - last_.from[i].x, now_.from[i].y - last_.from[i].y};
    const Direction step = {now_.step[i].x - last_.step[i].x, now_.step[i].y - last_.step[i].y};
    moved += dot(from, from);
    taken_back -= dot(from, step);
  }
  if (!(moved > 0)) return 1;
  return taken_back > 0 ? std::clamp(moved / taken_back, 1.0F, kMost) : kMost;
}

}  // namespace calvin::detect
