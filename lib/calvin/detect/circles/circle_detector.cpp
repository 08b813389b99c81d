// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The search for sheets of discs from level to level, and its results.

#include "calvin/detect/circles/circle_detector.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "calvin/detect/circles/circle_pattern.hpp"
#include "calvin/detect/circles/disc_lattice.hpp"
#include "calvin/detect/circles/disc_search.hpp"
#include "calvin/detect/circles/disc_sheet.hpp"
#include "calvin/detect/circles/disc_tracker.hpp"
#include "calvin/detect/pyramid.hpp"
#include "calvin/detect/search_again.hpp"
#include "calvin/detect/sheet_list.hpp"
#include "calvin/geometry/pixels.hpp"

namespace calvin::detect {

namespace {

constexpr int kFewestDiscs = 9;        // of a lattice
constexpr double kLeastVisible = 0.7;  // of a board without marks that has to be seen
// px, of a level; in a smaller one discs of a board of the whole image are too small.
constexpr ImageSize kLeastLevel = {48, 32};
constexpr std::size_t kMostPoints = 1500;  // of a level, that may be discs
constexpr double kSame = 4;                // px, between the places of a disc in two levels
constexpr int kFewestWithMarks = 12;       // discs of a board with marks

// A sheet that was found.
struct FoundSheet {
  std::size_t pattern = 0;
  CellMap map;
  Observation observation;
  Pixel centre;
  DiscLattice discs{0};
};

// A sheet of the last frame.
struct FollowedSheet {
  std::size_t pattern = 0;
  CellMap map;
  DiscTracker tracker;
};

// Sheets of boards without a place yet that no picture has: a board of another size.
struct OtherSheet {
  int discs = 0;
  int cols = 0;
  int rows = 0;
  bool all = false;  // its margins are in view
  std::string text;
};

class CircleDetector final : public Detector {
 public:
  explicit CircleDetector(std::span<const Board> boards);

  std::vector<Detection> detect_all(const ImageView& image,
                                    std::stop_token stop) noexcept override {
    try {
      list_.forget();
      followed_.clear();
      begin(image);
      search(image, stop);
      return results(image.size());
    } catch (const std::exception&) {
      return {};  // no memory
    }
  }
  std::vector<Detection> follow_all(const ImageView& image, std::uint64_t timestamp,
                                    std::stop_token stop) noexcept override {
    try {
      begin(image);
      const bool was_followed = !is_search_due(timestamp) && follow(image.size(), timestamp);
      if (!was_followed) search(image, stop);
      remember(image.size(), timestamp, was_followed);
      return results(image.size());
    } catch (const std::exception&) {
      return {};
    }
  }

 private:
  void begin(const ImageView& image);
  [[nodiscard]] bool follow(ImageSize size, std::uint64_t timestamp);
  void remember(ImageSize size, std::uint64_t timestamp, bool was_followed);
  [[nodiscard]] bool is_search_due(std::uint64_t timestamp);
  void search(const ImageView& image, const std::stop_token& stop);
  void search_level(int level, bool light, const std::stop_token& stop);
  void look_at(const DiscLattice& lattice, bool light);
  [[nodiscard]] bool name(DiscSheet& sheet, std::size_t pattern);
  [[nodiscard]] bool observe(DiscSheet& sheet, std::size_t pattern, const CellMap& map);
  void note_other(const DiscSheet& sheet, bool light);
  [[nodiscard]] bool is_known(const DiscLattice& lattice) const;
  [[nodiscard]] bool all_found() const { return list_.is_satisfied(sheets()); }
  [[nodiscard]] std::vector<SheetOf> sheets() const;
  [[nodiscard]] std::vector<Detection> results(ImageSize size);

  std::vector<CirclePattern> patterns_;  // that differ
  std::vector<std::size_t> of_list_;
  int reach_ = 0;
  int fewest_ = std::numeric_limits<int>::max();  // discs of a board that is seen almost wholly
  MarkKinds marks_;                               // of any board
  Pyramid pyramid_;
  DiscSearch disc_search_{kMostPoints};
  DiscGraph graph_;
  std::vector<Ellipse> discs_[2];  // dark, light
  std::vector<FoundSheet> found_;
  std::optional<OtherSheet> other_;
  SheetList list_{{}};
  std::vector<FollowedSheet> followed_;
  int since_search_ = 0;  // frames
  std::uint64_t searched_ = kNoTimestamp;
};

CircleDetector::CircleDetector(std::span<const Board> boards) {
  for (const Board& board : boards) {
    const auto known = std::ranges::find(patterns_, board, &CirclePattern::board);
    of_list_.push_back(static_cast<std::size_t>(known - patterns_.begin()));
    if (known == patterns_.end()) patterns_.emplace_back(board);
    reach_ = std::max(reach_, patterns_[of_list_.back()].reach());
    for (const CirclePattern::Disc& disc : patterns_.back().discs()) {
      marks_.rings = marks_.rings || disc.mark == DiscMark::kRing;
      marks_.large = marks_.large || disc.mark == DiscMark::kLarge;
    }
    const auto discs = static_cast<int>(patterns_.back().discs().size());
    fewest_ = std::min(fewest_, static_cast<int>(kLeastVisible * discs));
  }
  list_ = SheetList(of_list_);
}

void CircleDetector::begin(const ImageView& image) {
  found_.clear();
  other_.reset();
  pyramid_.build(image, 1);  // what is followed needs no more
}

void CircleDetector::search(const ImageView& image, const std::stop_token& stop) {
  pyramid_.build(image, Pyramid::kMaxLevels, kLeastLevel);
  for (auto& discs : discs_) discs.clear();
  for (int level = pyramid_.levels() - 1; level >= 0 && !stop.stop_requested(); --level) {
    for (const bool light : {false, true}) {
      if (std::ranges::any_of(patterns_,
                              [&](const CirclePattern& p) { return p.is_light() == light; })) {
        search_level(level, light, stop);
      }
    }
    if (all_found()) break;
  }
  if (stop.stop_requested()) found_.clear();
  std::ranges::sort(found_, {}, [](const FoundSheet& s) { return distance(s.centre, {}); });
}

// Discs of a sheet that is seen at an angle are found in several levels: those of smaller levels
// are kept.
void CircleDetector::search_level(int level, bool light, const std::stop_token& stop) {
  std::vector<Ellipse>& discs = discs_[light ? 1 : 0];
  const std::size_t before = discs.size();
  disc_search_.add(pyramid_, level, light, discs);
  if (level > 0 && discs.size() == before) return;
  if (static_cast<int>(discs.size()) < kFewestDiscs) return;
  graph_.begin(discs);
  DiscLattice lattice(reach_ + 2);
  // Parts of boards are looked at when all discs are known: smaller levels show some of them alone.
  const int least = level > 0 ? std::max(fewest_, kFewestDiscs) : kFewestDiscs;
  while (!stop.stop_requested() && graph_.next(least, lattice)) {
    if (!is_known(lattice)) look_at(lattice, light);
  }
}

// Whether a lattice is of a sheet that was found in a smaller level.
bool CircleDetector::is_known(const DiscLattice& lattice) const {
  std::vector<Pixel> centres;
  for (const Cell c : lattice.cells()) centres.push_back({lattice.at(c)->x, lattice.at(c)->y});
  const Pixel centre = mean_of(centres);
  return std::ranges::any_of(found_, [&](const FoundSheet& sheet) {
    const auto to = [](const Pixel& from) {
      return [from](const Pixel& p) { return distance(p, from); };
    };
    const Pixel nearest = std::ranges::min(sheet.observation.uv, {}, to(centre));
    const Pixel own = std::ranges::min(centres, {}, to(nearest));
    return distance(own, nearest) < kSame;
  });
}

void CircleDetector::look_at(const DiscLattice& lattice, bool light) {
  DiscSheet sheet;
  const ImageView& image = pyramid_.level(0);
  if (!DiscSheet::may_be_discs(image, lattice)) return;
  if (!sheet.fit(image, lattice, kFewestDiscs, marks_) || !sheet.are_round(image)) return;
  // The whole of a larger board is seen before a part of it is taken for a smaller one.
  for (int steps = 0; steps < reach_ && sheet.grow(image); ++steps) {
  }
  for (std::size_t i = 0; i < patterns_.size(); ++i) {
    if (patterns_[i].is_light() == light && name(sheet, i)) return;
  }
  note_other(sheet, light);
}

bool CircleDetector::name(DiscSheet& sheet, std::size_t pattern) {
  const CirclePattern& p = patterns_[pattern];
  std::vector<SeenMark> marks;
  if (p.has_marks()) {
    marks = sheet.marks(pyramid_.level(0));
  } else {
    marks.resize(sheet.lattice().cells().size());
  }
  const double least =
      p.has_marks() ? kFewestWithMarks / static_cast<double>(p.discs().size()) : kLeastVisible;
  const auto maps = place_on(p, sheet.lattice(), marks, std::min(least, kLeastVisible));
  if (maps.empty()) return false;
  // Of the ways that are as good as each other the one with control point 0 at the top left.
  const CellMap map = std::ranges::min(maps, {}, [&](const CellMap& m) {
    const Ellipse* first = sheet.lattice().at(m.back(p.discs().front().cell));
    return first == nullptr ? 1e9 : std::hypot(first->x, first->y);
  });
  return observe(sheet, pattern, map);
}

bool CircleDetector::observe(DiscSheet& sheet, std::size_t pattern, const CellMap& map) {
  FoundSheet found;
  found.pattern = pattern;
  found.map = map;
  found.observation = sheet.observe(pyramid_.level(0), patterns_[pattern], map);
  if (static_cast<int>(found.observation.ids.size()) < kFewestDiscs) return false;
  found.centre = mean_of(found.observation.uv);
  found.discs = sheet.lattice();
  found_.push_back(std::move(found));
  return true;
}

// Looks for the sheets of the last frame where they are going; false where one is not there with
// all of its discs, or has come to another size.
bool CircleDetector::follow(ImageSize size, std::uint64_t timestamp) {
  if (followed_.empty()) return false;
  for (const FollowedSheet& followed : followed_) {
    const auto discs = followed.tracker.predict(size, timestamp);
    DiscSheet sheet;
    if (!discs || !sheet.fit(pyramid_.level(0), *discs, discs->count(), marks_) ||
        !observe(sheet, followed.pattern, followed.map) ||
        found_.back().discs.count() < discs->count()) {
      found_.clear();
      return false;
    }
  }
  return all_found();
}

void CircleDetector::remember(ImageSize size, std::uint64_t timestamp, bool was_followed) {
  if (!was_followed) {
    followed_.clear();
    for (const FoundSheet& sheet : found_) {
      followed_.push_back({sheet.pattern, sheet.map, DiscTracker()});
    }
    since_search_ = 0;
    searched_ = timestamp;
  }
  for (std::size_t i = 0; i < followed_.size(); ++i) {
    followed_[i].tracker.remember(found_[i].discs, size, timestamp);
  }
}

// Further sheets come into view: the whole image is searched once a second.
bool CircleDetector::is_search_due(std::uint64_t timestamp) {
  ++since_search_;
  if (timestamp == kNoTimestamp || searched_ == kNoTimestamp) {
    return since_search_ >= kSearchAgainFrames;
  }
  return timestamp < searched_ || timestamp - searched_ >= kSearchAgain;
}

void CircleDetector::note_other(const DiscSheet& sheet, bool light) {
  const DiscLattice& lattice = sheet.lattice();
  if (other_ && other_->discs >= lattice.count()) return;
  const auto like = std::ranges::find(patterns_, light, &CirclePattern::is_light);
  // Where no board has marks none are looked for, and large discs are no part of the lattice.
  std::vector<SeenMark> marks(lattice.cells().size());
  if (marks_.rings || marks_.large) marks = sheet.marks(pyramid_.level(0));
  const auto board = board_of(lattice, marks, like->board());
  if (!board) return;
  const auto is_in_view = [&](Cell c) {
    const Ellipse& e = *lattice.at(c);
    return std::ranges::all_of(kAround, [&](Cell way) {
      const Ellipse* before = lattice.at(c - way);
      if (lattice.at(c + way) != nullptr || before == nullptr) return true;
      const double x = 2 * e.x - before->x;
      const double y = 2 * e.y - before->y;
      const ImageView& image = pyramid_.level(0);
      // Of a disc there would be a good part in view: boards are printed to the edge of their
      // paper.
      const double beyond = e.radius() / 2;
      return x >= -beyond && y >= -beyond && x < image.width + beyond && y < image.height + beyond;
    });
  };
  OtherSheet other;
  other.discs = lattice.count();
  other.cols = lattice.extent().cols();
  other.rows = lattice.extent().rows();
  other.all = std::ranges::all_of(lattice.cells(), is_in_view);
  other.text = board->text();
  other_ = std::move(other);
}

std::vector<SheetOf> CircleDetector::sheets() const {
  std::vector<SheetOf> all;
  for (const FoundSheet& sheet : found_) all.push_back({sheet.pattern, sheet.centre});
  return all;
}

std::vector<Detection> CircleDetector::results(ImageSize size) {
  std::vector<Detection> all;
  for (const ListedSheet& listed : list_.assign(sheets())) {
    const Board& board = patterns_[of_list_[listed.board]].board();
    Detection& result = all.emplace_back();
    result.board = listed.board;
    if (listed.sheet) {
      result.observation = std::move(found_[*listed.sheet].observation);
      result.observation.ambiguous = board.symmetries();
      result.reason = Reason::kAccepted;
    } else if (other_ && other_->all) {
      result.reason = Reason::kWrongBoard;
      result.seen_cols = other_->cols;
      result.seen_rows = other_->rows;
      result.seen_all = true;
      result.seen_board = other_->text;
    }
    result.observation.board = board.text();
    result.observation.image_size = size;
  }
  return all;
}

}  // namespace

std::unique_ptr<Detector> make_circle_detector(std::span<const Board> boards) {
  return std::make_unique<CircleDetector>(boards);
}

}  // namespace calvin::detect
