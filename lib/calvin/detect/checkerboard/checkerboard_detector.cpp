// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The search through the levels of the pyramid, and what is reported of the board found.

#include "calvin/detect/checkerboard/checkerboard_detector.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include "calvin/detect/checkerboard/board_match.hpp"
#include "calvin/detect/checkerboard/board_search.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"
#include "calvin/detect/checkerboard/refine.hpp"
#include "calvin/detect/checkerboard/scatter.hpp"
#include "calvin/detect/checkerboard/tracker.hpp"
#include "calvin/detect/pyramid.hpp"

namespace calvin::detect {

namespace {

constexpr int kLeastSide = 16;       // px; no board is in a smaller image
constexpr int kExtraRows = 3;        // rows around a board that are kept, to see that it is larger
constexpr double kLeastShare = 0.2;  // of a board's corners
// Peaks of the response that are looked at, the strongest first.
constexpr int kPointsPerCorner = 15;
constexpr int kFewestPoints = 800;
// How far a neighbour may be.
constexpr float kLargestSquare = 2.2F;  // times the image's longer side per square of the board
constexpr float kLeastReach = 48;       // px of the level
constexpr float kMostReach = 144;       // px of the smallest level
constexpr float kFineReach = 64;        // px of other levels: smaller ones have looked further

// Where a lattice lies in the image, and how large its squares are there about, px.
struct Area {
  Box box;
  float square = 0;

  Area() = default;
  // In px of a level.
  Area(const Lattice& lattice, int level) {
    lattice.for_each([&](Cell /*cell*/, const Node& node) {
      box.add(Pyramid::to_image(node.x, level), Pyramid::to_image(node.y, level));
    });
    const auto nodes = static_cast<float>(std::max(lattice.count(), 1));
    square = std::sqrt((box.right - box.left) * (box.bottom - box.top) / nodes);
  }
  [[nodiscard]] bool meets(const Box& other) const {
    return box.left <= other.right && other.left <= box.right && box.top <= other.bottom &&
           other.top <= box.bottom;
  }
  // Whether the other area is likely a part of this one.
  [[nodiscard]] bool has(const Area& other) const {
    constexpr float kLike = 1.7F;  // ratio of the squares' sides
    const float u = 0.5F * (other.box.left + other.box.right);
    const float v = 0.5F * (other.box.top + other.box.bottom);
    return u >= box.left && u <= box.right && v >= box.top && v <= box.bottom &&
           other.square < kLike * square && square < kLike * other.square;
  }
};

class CheckerboardDetector final : public Detector {
 public:
  explicit CheckerboardDetector(const Checkerboard& board)
      : board_(board),
        text_(board.text()),
        tracker_(board),
        lattice_(std::max(board.cols, board.rows) + kExtraRows),
        part_(lattice_),
        other_(lattice_) {}

  Detection detect(const ImageView& image, std::stop_token stop) noexcept override {
    try {
      return search(image, stop);
    } catch (const std::exception&) {
      return {};  // no memory
    }
  }

  Detection follow(const ImageView& image, std::uint64_t timestamp,
                   std::stop_token stop) noexcept override {
    try {
      return follow_or_search(image, timestamp, stop);
    } catch (const std::exception&) {
      return {};
    }
  }

 private:
  [[nodiscard]] Detection empty_detection(const ImageView& image) const;
  Detection follow_or_search(const ImageView& image, std::uint64_t timestamp,
                             const std::stop_token& stop);
  // Whether all of the board is where `lattice_` predicts it.
  [[nodiscard]] bool confirm_prediction(const ImageView& image, Detection& result);
  Detection search(const ImageView& image, const std::stop_token& stop);
  void search_level(int level, Detection& result);
  [[nodiscard]] bool is_rest_hidden(int level) const;
  // Whether `lattice_`, in px of a level, is part of another board that a smaller level has seen.
  [[nodiscard]] bool is_known_other(int level) const;
  // Notes that `lattice_`, in px of the image, is a board of another size, or may be a part of one.
  // False where a larger one was noted.
  bool note_other(int cols, int rows, bool sure, Detection& result);
  [[nodiscard]] bool accept(Match match, Lattice& lattice, Detection& result);
  void report(const Match& match, const Lattice& lattice, Detection& result);

  Checkerboard board_;
  std::string text_;
  Tracker tracker_;
  Pyramid pyramid_;
  BoardSearch search_;
  Refinement refinement_;
  Lattice lattice_;
  GridAlignment alignment_;  // of the board reported last, in lattice_ where it was whole
  Lattice part_;             // the largest part of the board seen so far, in px of the image
  Match part_match_;         // of that part
  int part_level_ = 0;       // where that part was seen first
  Area other_area_;
  Lattice other_;               // the largest lattice of another board, in px of the image
  bool other_is_sure_ = false;  // whether other_ is no part of the board that is looked for
};

Detection CheckerboardDetector::empty_detection(const ImageView& image) const {
  Detection result;
  result.observation.board = text_;
  result.observation.image_size = image.size();
  return result;
}

Detection CheckerboardDetector::follow_or_search(const ImageView& image, std::uint64_t timestamp,
                                                 const std::stop_token& stop) {
  Detection result = empty_detection(image);
  const bool known = !stop.stop_requested() && tracker_.predict(image.size(), timestamp, lattice_);
  const bool followed = known && confirm_prediction(image, result);
  if (!followed) result = search(image, stop);
  if (static_cast<int>(result.observation.ids.size()) == board_.point_count()) {
    tracker_.remember(lattice_, refinement_.fits(), alignment_, image.size(), timestamp, !followed);
  } else {
    tracker_.forget();
  }
  return result;
}

bool CheckerboardDetector::confirm_prediction(const ImageView& image, Detection& result) {
  pyramid_.build(image, 1);
  const ImageView& full = pyramid_.level(0);
  if (!refinement_.confirm(full, lattice_)) return false;
  const FitGrid& before = tracker_.fits();
  const bool good = before.empty() ? refinement_.refine(full, lattice_)
                                   : refinement_.refine_again(full, before, lattice_);
  if (!good || lattice_.count() < board_.point_count()) return false;
  const Match match = match_board(full, board_, lattice_);
  if (match.reason != Reason::kAccepted) return false;
  report(match, lattice_, result);
  return true;
}

Detection CheckerboardDetector::search(const ImageView& image, const std::stop_token& stop) {
  Detection result = empty_detection(image);
  if (image.data == nullptr || image.width < kLeastSide || image.height < kLeastSide) {
    return result;
  }
  if (stop.stop_requested()) return result;
  pyramid_.build(image);
  part_.clear();
  other_.clear();
  other_is_sure_ = false;
  for (int level = pyramid_.levels() - 1; level >= 0; --level) {
    if (stop.stop_requested()) return {result.observation, Reason::kNotFound};
    search_level(level, result);
    if (result.observation.found()) return result;
    if (is_rest_hidden(level)) break;
  }
  // A part of the board at one level may be seen as another board at the next.
  const bool is_other =
      other_.count() >= part_.count() && Area(other_, 0).meets(Area(part_, 0).box);
  if (part_.count() > 0 && !is_other) (void)accept(part_match_, part_, result);
  return result;
}

void CheckerboardDetector::search_level(int level, Detection& result) {
  const ImageView& image = pyramid_.level(level);
  const ImageView& full = pyramid_.level(0);
  SearchOptions options;
  options.least_nodes =
      std::max(6, static_cast<int>(kLeastShare * static_cast<double>(board_.point_count())));
  options.most_points = std::max(kFewestPoints, kPointsPerCorner * board_.point_count());
  // The largest squares are those of a board of which a part fills the image.
  const auto across = static_cast<float>(std::max(image.width, image.height));
  const auto squares = static_cast<float>(std::max(board_.cols, board_.rows) + 1);
  const float most = level + 1 < pyramid_.levels() ? kFineReach : kMostReach;
  options.reach = std::clamp(kLargestSquare * across / squares, kLeastReach, most);
  const int enough = 2 * board_.point_count();
  search_.detect_corners(image, options);
  while (search_.next(lattice_)) {
    // A level further up has seen what this is, or is a part of.
    if (is_known_other(level)) continue;
    BoardSearch::complete(image, lattice_, enough, false);
    if (is_far_larger(lattice_, board_)) {
      const Box box = search_.box();
      refinement_.to_image(pyramid_, level, lattice_, false);
      if (note_other(lattice_.extent().cols(), lattice_.extent().rows(), true, result)) {
        other_area_.box.add(Pyramid::to_image(box.left, level), Pyramid::to_image(box.top, level));
        other_area_.box.add(Pyramid::to_image(box.right, level),
                            Pyramid::to_image(box.bottom, level));
      }
      continue;
    }
    refinement_.to_image(pyramid_, level, lattice_, true);
    // Corners that are too fine, or too near to the border, to be seen in the level.
    BoardSearch::complete(full, lattice_, enough, true);
    refinement_.confirm_guesses(full, lattice_);
    const Match match = match_board(full, board_, lattice_);
    if (match.reason == Reason::kAccepted && match.whole && accept(match, lattice_, result)) return;
    if (match.reason == Reason::kAccepted && lattice_.count() > part_.count()) {
      part_ = lattice_;
      part_match_ = match;
      part_level_ = level;
    }
    if (match.reason == Reason::kWrongBoard) {
      (void)note_other(match.seen_cols, match.seen_rows, match.certain, result);
    }
  }
}

// Whether the rest of the board is covered or out of the image: most of it was seen, and a level
// with squares large enough has shown no more than the level before. For a few missing corners
// another level is worth its time.
bool CheckerboardDetector::is_rest_hidden(int level) const {
  constexpr float kRoom = 10;    // px of the level
  constexpr double kFew = 0.04;  // of the board's corners
  const int missing = board_.point_count() - part_.count();
  return missing > kFew * board_.point_count() && missing <= part_.count() && part_level_ > level &&
         Area(part_, 0).square >= kRoom * static_cast<float>(1 << level);
}

bool CheckerboardDetector::is_known_other(int level) const {
  if (!other_is_sure_ || !other_area_.has(Area(lattice_, level))) return false;
  // The board may lie on a floor of tiles, which is the other one.
  const bool may_be_on_it = other_.count() > board_.point_count() &&
                            lattice_.count() <= board_.point_count() &&
                            2 * lattice_.count() > board_.point_count();
  return !may_be_on_it;
}

bool CheckerboardDetector::note_other(int cols, int rows, bool sure, Detection& result) {
  if (lattice_.count() <= other_.count()) return false;
  other_is_sure_ = sure;
  other_ = lattice_;
  other_area_ = Area(other_, 0);
  result.reason = Reason::kWrongBoard;
  result.seen_cols = cols;
  result.seen_rows = rows;
  return true;
}

// px, 1 sigma: the error that corners near each other have in common, which neither noise nor
// scatter show. It does not average out over the views, so that sigmas of the noise alone would
// make a calibration seem better than it is.
constexpr double kBias = 0.001;

bool CheckerboardDetector::accept(Match match, Lattice& lattice, Detection& result) {
  const ImageView& image = pyramid_.level(0);
  const int before = lattice.count();
  if (!refinement_.refine(image, lattice)) return false;
  if (!match.whole || lattice.count() < before) {
    // Some nodes may have been no corners, and the refined places of the others tell the edge of
    // the board from something that covers it up to the next row.
    match = match_board(image, board_, lattice);
    if (match.reason != Reason::kAccepted) return false;
  }
  report(match, lattice, result);
  return true;
}

void CheckerboardDetector::report(const Match& match, const Lattice& lattice, Detection& result) {
  Observation& o = result.observation;
  const double ratio = static_cast<double>(scatter(lattice, pyramid_.level(0).size()));
  const Grid grid = *board_.grid();
  for (const int id : board_.ids()) {
    const GridPlace at = grid.place(id);
    const Cell cell = match.alignment.cell({at.col, at.row});
    if (!lattice.has(cell)) continue;
    const SaddleFit& fit = refinement_.at(cell);
    o.ids.push_back(id);
    o.uv.push_back({fit.x, fit.y});
    o.sigma.push_back(std::hypot(ratio * static_cast<double>(fit.sigma), kBias));
  }
  o.ambiguous = match.ambiguous;
  o.blur = refinement_.blur(lattice);
  alignment_ = match.alignment;
  result.reason = Reason::kAccepted;
}

}  // namespace

std::unique_ptr<Detector> make_checkerboard_detector(const Checkerboard& board) {
  return std::make_unique<CheckerboardDetector>(board);
}

}  // namespace calvin::detect
