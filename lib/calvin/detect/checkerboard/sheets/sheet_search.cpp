// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The search through the levels of the pyramid, and what is reported of the sheets found.

#include "calvin/detect/checkerboard/sheets/sheet_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "calvin/detect/checkerboard/fits/guesses.hpp"
#include "calvin/detect/checkerboard/fits/scatter.hpp"
#include "calvin/detect/checkerboard/sheets/end_corners.hpp"

namespace calvin::detect {

namespace {

constexpr int kLeastSide = 16;  // px; no board is in a smaller image
constexpr int kExtraRows = 3;   // rows around a board that are kept, to see that it is larger
constexpr std::size_t kFurtherParts = 3;

// px, 1 sigma: the error that corners near each other have in common, which neither noise nor
// scatter show: what rendered pictures without noise leave beside their rounding. It does not
// average out over the views, so that sigmas of the noise alone would make a calibration seem
// better than it is.
constexpr double kBias = 0.0003;

int reach_of(const std::vector<WantedBoard>& wanted) {
  int most = 0;
  for (const WantedBoard& w : wanted)
    most = std::max({most, w.pattern.grid.cols, w.pattern.grid.rows});
  return most + kExtraRows;
}

// The element of a list that keeps the memory of those that are not in use, at its end.
template <typename T>
T& append(std::vector<T>& list, std::size_t& count, int reach, const Surroundings& surroundings) {
  if (count == list.size()) list.emplace_back(reach, surroundings);
  return list[count++];
}

}  // namespace

SheetSearch::SheetSearch(std::vector<WantedBoard> wanted)
    : wanted_(std::move(wanted)),
      reach_(reach_of(wanted_)),
      surroundings_(surroundings_of(wanted_)),
      most_points_(most_points(wanted_)),
      lattice_(reach_, surroundings_),
      trial_(reach_, surroundings_),
      best_(reach_, surroundings_),
      other_(reach_, surroundings_) {}

void SheetSearch::begin(const ImageView& image) {
  image_ = image;
  sheet_count_ = 0;
  part_count_ = 0;
  lattice_.set_blurred(false);
  other_.clear();
  other_is_sure_ = false;
}

int SheetSearch::missing(std::size_t wanted) const {
  const auto found =
      std::ranges::count_if(sheets(), [&](const Sheet& s) { return s.wanted == wanted; });
  return std::max(wanted_[wanted].sheets - static_cast<int>(found), 0);
}

int SheetSearch::missing() const {
  int sum = 0;
  for (std::size_t k = 0; k < wanted_.size(); ++k) sum += missing(k);
  return sum;
}

bool SheetSearch::confirm_prediction(std::size_t wanted, const FitGrid& before) {
  if (image_.data == nullptr) return false;
  const Pattern& pattern = wanted_[wanted].pattern;
  const PlacedBoard board = {
      pattern.code.get(), {0, {1, 0}, pattern.grid.cols, pattern.grid.rows}, {}};
  pyramid_.build(image_, 1);
  const ImageView& full = pyramid_.level(0);
  if (!refinement_.confirm(full, lattice_)) return false;
  const bool good =
      before.empty() ? board_refinement_.refine(full, board, refinement_, lattice_)
                     : board_refinement_.refine_again(full, board, before, refinement_, lattice_);
  if (!good || lattice_.count() < wanted_[wanted].pattern.grid.count()) return false;
  const Match match = this->match(wanted, lattice_);
  if (match.reason != Reason::kAccepted || is_taken(lattice_, 0)) return false;
  add_sheet(wanted, match, lattice_, false);
  return true;
}

bool SheetSearch::run(bool thorough, const std::stop_token& stop) {
  if (image_.data == nullptr || image_.width < kLeastSide || image_.height < kLeastSide) {
    return !stop.stop_requested();
  }
  if (stop.stop_requested()) return false;
  pyramid_.build(image_);
  bool again = thorough;
  for (int level = pyramid_.levels() - 1; level >= 0; --level) {
    if (stop.stop_requested()) return false;
    search_level(level);
    sort_parts();
    if (is_done(level) && !std::exchange(again, false)) break;
    if (missing() > 0) again = thorough;
  }
  accept_parts();
  return true;
}

int SheetSearch::least_group() const {
  if (missing() > 0) return 0;
  int least = most_points_;
  for (const WantedBoard& w : wanted_) least = std::min(least, w.pattern.grid.count());
  return least / 2 + 1;
}

void SheetSearch::search_level(int level) {
  SearchOptions options = search_options(wanted_, pyramid_, level);
  for (const Sheet& sheet : sheets()) options.taken.push_back(in_level(sheet.outline, level));
  const std::size_t before = sheet_count_ + part_count_;
  search_level(level, options);
  if (sheet_count_ + part_count_ > before || !may_be_blurred(level)) return;
  options.surroundings.blurred = true;
  search_level(level, options);
}

// Whether a board may be there whose markers blur has hidden: its corners are those of a plain
// checkerboard then. Squares that such blur leaves to be seen are large enough for smaller levels,
// and a picture with many corners beside markers is sharp.
bool SheetSearch::may_be_blurred(int level) const {
  return surroundings_.has_markers() && surroundings_.gap == 1 && level > 0 && missing() > 0 &&
         search_.corners() <= 3 * most_points_;
}

void SheetSearch::search_level(int level, const SearchOptions& options) {
  lattice_.set_blurred(options.surroundings.blurred);
  search_.detect_corners(pyramid_.calm_level(level), options);
  while (search_.next_size() > 0 && search_.next_size() >= least_group() &&
         search_.next(lattice_)) {
    // A level further up has seen what this is, or is a part of.
    if (!is_taken(lattice_, level) && !is_known_other(level)) look_at_lattice(level);
  }
}

void SheetSearch::look_at_lattice(int level) {
  const int enough = 2 * most_points_;
  BoardSearch::complete(pyramid_.calm_level(level), lattice_, enough, false);
  if (is_far_larger_than_all()) {
    const Box box = search_.box();
    refinement_.to_image(pyramid_, level, lattice_, false);
    OtherBoard seen = far_larger_board();
    if (!seen.certain) {  // as corners that the level does not show may be why
      complete_in_image(std::numeric_limits<int>::max());
      seen = far_larger_board();
    }
    if (note_other(seen, true)) {
      other_area_.box.add(Pyramid::to_image(box.left, level), Pyramid::to_image(box.top, level));
      other_area_.box.add(Pyramid::to_image(box.right, level),
                          Pyramid::to_image(box.bottom, level));
    }
    return;
  }
  refinement_.to_image(pyramid_, level, lattice_, true);
  complete_in_image(enough);
  if (is_taken(lattice_, 0)) return;
  match_boards();
  const bool accepted = match_.reason == Reason::kAccepted;
  if (accepted && match_.whole && accept(match_wanted_, match_, lattice_)) {
    if (sheets().back().whole) return;
    // A corner was lost from where this level has it: another one may have it nearer.
    --sheet_count_;
  }
  if (accepted) note_part(level);
  if (match_.reason == Reason::kWrongBoard) {
    (void)note_other({match_.seen_cols, match_.seen_rows, match_.size_is_certain, match_.seen},
                     match_.certain);
  }
}

// Adds corners that are too fine, or too near to the border, to be seen in the level. Where some
// were added and few are missing, those are expected better than before, or at all.
void SheetSearch::complete_in_image(int enough) {
  constexpr int kRounds = 3;
  constexpr double kMost = 0.7;  // of a board's corners
  for (int round = 0; round < kRounds; ++round) {
    const int before = lattice_.count();
    BoardSearch::complete(pyramid_.calm_level(0), lattice_, enough, true);
    confirm_guesses(pyramid_.level(0), lattice_);
    const bool is_nearly_whole = std::ranges::any_of(wanted_, [&](const WantedBoard& w) {
      const int points = w.pattern.grid.count();
      return lattice_.count() < points && lattice_.count() > kMost * points;
    });
    if (!is_nearly_whole || lattice_.count() <= before) return;
  }
}

bool SheetSearch::is_far_larger_than_all() const {
  // A code tells how large a board is.
  return std::all_of(wanted_.begin(), wanted_.end(), [&](const WantedBoard& w) {
    return !w.pattern.code && is_far_larger(lattice_, w.pattern.squares());
  });
}

// Named as the first board that is wanted would name it: with its longer side first, or not.
OtherBoard SheetSearch::far_larger_board() {
  const CellRange e = dense_extent(lattice_);
  const Grid& grid = wanted_.front().pattern.grid;
  OtherBoard seen = {e.cols(), e.rows(), is_size_certain(pyramid_.calm_level(0), lattice_), ""};
  if ((e.cols() >= e.rows()) != (grid.cols >= grid.rows)) std::swap(seen.cols, seen.rows);
  return seen;
}

// The board that leaves the least to be excused: a whole one, one whose colours are those of the
// board, one that is still missing, and then one of which more is in view.
bool SheetSearch::is_better(const Match& match, std::size_t wanted) const {
  const auto rank = [&](const Match& m, std::size_t k) {
    const int kind = m.reason == Reason::kAccepted ? 2 : m.reason == Reason::kWrongBoard ? 1 : 0;
    const bool accepted = m.reason == Reason::kAccepted;
    return std::tuple(kind, accepted && m.whole, accepted && !m.exchanged,
                      accepted && missing(k) > 0,
                      accepted ? -wanted_[k].pattern.grid.count() : int{m.certain});
  };
  return rank(match, wanted) > rank(match_, match_wanted_);
}

Match SheetSearch::match(std::size_t wanted, Lattice& lattice) {
  const ImageView& image = pyramid_.calm_level(0);
  const Pattern& pattern = wanted_[wanted].pattern;
  if (pattern.code) return code_match_.match(image, pattern.grid, *pattern.code, lattice);
  return match_board(image, pattern.squares(), lattice);
}

void SheetSearch::match_boards() {
  match_wanted_ = 0;
  if (wanted_.size() == 1) {
    match_ = match(0, lattice_);
    return;
  }
  // Each removes the nodes that are stray as far as its board goes.
  best_ = lattice_;
  match_ = match(0, best_);
  for (std::size_t k = 1; k < wanted_.size(); ++k) {
    trial_ = lattice_;
    Match match = this->match(k, trial_);
    if (!is_better(match, k)) continue;
    match_ = std::move(match);
    match_wanted_ = k;
    std::swap(best_, trial_);
  }
  std::swap(lattice_, best_);
}

void SheetSearch::note_part(int level) {
  const LatticeArea area(lattice_, 0);
  const std::span<Part> all = parts();
  auto part = std::ranges::find_if(all, [&](const Part& p) {
    const LatticeArea there(p.lattice, 0);
    return there.has_middle_of(area) || area.has_middle_of(there);
  });
  Part* to = part != all.end() ? &*part : nullptr;
  if (to == nullptr && all.size() < kFurtherParts + static_cast<std::size_t>(missing())) {
    to = &append(parts_, part_count_, reach_, surroundings_);
  } else {
    // In place of the smallest one, which is the last, where there is no room for more.
    if (to == nullptr) to = &all.back();
    if (lattice_.count() <= to->lattice.count()) return;
  }
  to->lattice = lattice_;
  to->match = match_;
  to->wanted = match_wanted_;
  to->level = level;
  sort_parts();
}

// Leaves those that are no part of a sheet that was found, the largest first.
void SheetSearch::sort_parts() {
  const std::span<Part> all = parts();
  const auto taken = std::partition(all.begin(), all.end(),
                                    [&](const Part& p) { return !is_taken(p.lattice, 0); });
  part_count_ = static_cast<std::size_t>(taken - all.begin());
  std::ranges::sort(
      parts(), [](const Part& a, const Part& b) { return a.lattice.count() > b.lattice.count(); });
}

// Whether a part is enough to be a sheet that nobody asked for: what a hand leaves of a sheet on
// its other side is none.
bool SheetSearch::is_large(const Part& part) const {
  return 2 * part.lattice.count() > wanted_[part.wanted].pattern.grid.count();
}

// Whether the rest of the board is covered or out of the image: most of it was seen, and a level
// with squares large enough has shown no more than the level before. For a few missing corners
// another level is worth its time.
bool SheetSearch::is_rest_hidden(const Part& part, int level) const {
  constexpr float kRoom = 10;    // px of the level
  constexpr double kFew = 0.04;  // of the board's corners
  const int points = wanted_[part.wanted].pattern.grid.count();
  const int unseen = points - part.lattice.count();
  const float narrowest = part.lattice.surroundings().gap * LatticeArea(part.lattice, 0).square;
  return unseen > kFew * points && unseen <= part.lattice.count() && part.level > level &&
         narrowest >= kRoom * static_cast<float>(1 << level);
}

bool SheetSearch::is_done(int level) const {
  const auto needed = static_cast<std::size_t>(missing());
  if (part_count_ < needed) return false;
  for (std::size_t i = 0; i < part_count_; ++i) {
    if ((i < needed || is_large(parts_[i])) && !is_rest_hidden(parts_[i], level)) return false;
  }
  return true;
}

void SheetSearch::accept_parts() {
  for (Part& part : parts()) {
    const LatticeArea area(part.lattice, 0);
    // A part of the board at one level may be seen as another board at the next.
    const bool is_other =
        other_.count() >= part.lattice.count() && LatticeArea(other_, 0).meets(area.box);
    const bool wanted = missing(part.wanted) > 0 || is_large(part);
    if (is_other || !wanted || is_taken(part.lattice, 0)) continue;
    (void)accept(part.wanted, part.match, part.lattice);
  }
}

bool SheetSearch::is_taken(const Lattice& lattice, int level) const {
  return std::ranges::any_of(
      sheets(), [&](const Sheet& sheet) { return is_of_sheet(sheet, lattice, level); });
}

bool SheetSearch::is_known_other(int level) const {
  if (!other_is_sure_ || !other_area_.has(LatticeArea(lattice_, level))) return false;
  // The board may lie on a floor of tiles, which is the other one.
  return std::none_of(wanted_.begin(), wanted_.end(), [&](const WantedBoard& w) {
    const int points = w.pattern.grid.count();
    return other_.count() > points && lattice_.count() <= points && 2 * lattice_.count() > points;
  });
}

bool SheetSearch::note_other(const OtherBoard& size, bool sure) {
  if (lattice_.count() <= other_.count()) return false;
  other_is_sure_ = sure;
  other_ = lattice_;
  other_area_ = LatticeArea(other_, 0);
  other_size_ = size;
  return true;
}

std::optional<OtherBoard> SheetSearch::other() const {
  if (other_.count() == 0 || is_taken(other_, 0)) return std::nullopt;
  return other_size_;
}

bool SheetSearch::accept(std::size_t wanted, Match match, Lattice& lattice) {
  const ImageView& image = pyramid_.level(0);
  const int before = lattice.count();
  const Pattern& pattern = wanted_[wanted].pattern;
  const PlacedBoard board = placed_board(pattern, match.alignment, lattice);
  if (!board_refinement_.refine(image, board, refinement_, lattice)) return false;
  if (!match.whole || lattice.count() < before) {
    // Some nodes may have been no corners, and the refined places of the others tell the edge of
    // the board from something that covers it up to the next row.
    match = this->match(wanted, lattice);
    if (match.reason != Reason::kAccepted) return false;
    if (!match.whole && !board_refinement_.took_markers_off() && lattice.has_even_steps()) {
      add_end_corners(image, pattern.grid, match.alignment, refinement_, lattice);
    }
    if (!match.whole) refinement_.widen_ends(lattice);
  }
  add_sheet(wanted, match, lattice, true);
  return true;
}

void SheetSearch::add_sheet(std::size_t wanted, const Match& match, const Lattice& lattice,
                            bool searched) {
  Sheet& sheet = append(sheets_, sheet_count_, reach_, surroundings_);
  const Grid& grid = wanted_[wanted].pattern.grid;
  sheet.wanted = wanted;
  sheet.searched = searched;
  sheet.lattice = lattice;
  sheet.fits = refinement_.fits();
  sheet.alignment = match.alignment;
  Observation& o = sheet.observation = {};
  const double ratio = static_cast<double>(scatter(lattice, pyramid_.level(0).size()));
  for (const int id : grid.ids()) {
    const GridPlace at = grid.place(id);
    const Cell cell = match.alignment.cell({at.col, at.row});
    if (!lattice.has(cell)) continue;
    const SaddleFit& fit = refinement_.at(cell);
    o.ids.push_back(id);
    o.uv.push_back({fit.x, fit.y});
    // What the corners of a row have in common is smooth: scatter does not see it.
    const double sigma =
        std::max(ratio * static_cast<double>(fit.sigma), static_cast<double>(fit.rounding));
    o.sigma.push_back(std::hypot(sigma, kBias));
  }
  o.ambiguous = match.ambiguous;
  o.blur = refinement_.blur(lattice);
  sheet.whole = static_cast<int>(o.ids.size()) == grid.count();
  sheet.outline = outline_of(o, grid);
}

}  // namespace calvin::detect
