// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The search for sheets of discs from level to level, and its results.

#include "calvin/detect/circles/circle_detector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "calvin/detect/circles/blob_points.hpp"
#include "calvin/detect/circles/blob_shape.hpp"
#include "calvin/detect/circles/circle_pattern.hpp"
#include "calvin/detect/circles/disc_lattice.hpp"
#include "calvin/detect/circles/disc_sheet.hpp"
#include "calvin/detect/pyramid.hpp"

namespace calvin::detect {

namespace {

constexpr int kFewestDiscs = 9;      // of a lattice
constexpr double kLeastShare = 0.7;  // of a board without marks that has to be seen
// px, of a level; in a smaller one discs of a board of the whole image are too small.
constexpr ImageSize kLeastLevel = {48, 32};
constexpr double kSame = 4;           // px, between the places of a disc in two levels
constexpr int kFewestWithMarks = 12;  // discs of a board with marks

Pixel mean_of(const std::vector<Pixel>& points) {
  Pixel mean;
  for (const Pixel& p : points) {
    mean.u += p.u / static_cast<double>(points.size());
    mean.v += p.v / static_cast<double>(points.size());
  }
  return mean;
}

double distance(const Pixel& a, const Pixel& b) { return std::hypot(a.u - b.u, a.v - b.v); }

// A sheet that was found.
struct FoundSheet {
  std::size_t pattern = 0;
  Observation observation;
  Pixel centre;
};

// Sheets of boards without a place yet that no picture has: a board of another size.
struct OtherSheet {
  int discs = 0;
  int cols = 0;
  int rows = 0;
  bool all = false;  // its margins are in view
  std::string text;
};

// Which discs lie where, so that none is taken twice. Keeps its memory.
class KnownDiscs {
 public:
  void begin(const std::vector<Ellipse>& discs) {
    for (auto& bucket : buckets_) bucket.clear();
    for (const Ellipse& e : discs) buckets_[bucket_of(e.x, e.y)].push_back(e);
  }
  // False for a disc whose centre lies within another one of about its size.
  [[nodiscard]] bool add(const Ellipse& e) {
    for (const double dx : {-kSide, 0.0, kSide}) {
      for (const double dy : {-kSide, 0.0, kSide}) {
        for (const Ellipse& other : buckets_[bucket_of(e.x + dx, e.y + dy)]) {
          constexpr double kWithin = 0.25;  // of the radius, squared
          if (other.square_distance_of(e) < kWithin) return false;
        }
      }
    }
    buckets_[bucket_of(e.x, e.y)].push_back(e);
    return true;
  }

 private:
  static constexpr double kSide = 32;  // px
  static constexpr std::size_t kBuckets = 1024;
  static std::size_t bucket_of(double x, double y) {
    const auto cell = [](double v) { return static_cast<std::size_t>(std::floor(v / kSide) + 64); };
    return (cell(x) * 31 + cell(y)) % kBuckets;
  }
  std::array<std::vector<Ellipse>, kBuckets> buckets_;
};

class CircleDetector final : public Detector {
 public:
  explicit CircleDetector(std::span<const Board> boards);

  std::vector<Detection> detect_all(const ImageView& image,
                                    std::stop_token stop) noexcept override {
    try {
      last_.clear();
      return detect(image, stop);
    } catch (const std::exception&) {
      return {};  // no memory
    }
  }
  std::vector<Detection> follow_all(const ImageView& image, std::uint64_t /*timestamp*/,
                                    std::stop_token stop) noexcept override {
    try {
      return detect(image, stop);
    } catch (const std::exception&) {
      return {};
    }
  }

 private:
  [[nodiscard]] std::vector<Detection> detect(const ImageView& image, const std::stop_token& stop);
  void search_level(int level, bool light, const std::stop_token& stop);
  void find_discs(int level, bool light, std::vector<Ellipse>& discs);
  void look_at(const DiscLattice& lattice, bool light);
  [[nodiscard]] bool name(DiscSheet& sheet, std::size_t pattern);
  void note_other(const DiscLattice& lattice, bool light);
  [[nodiscard]] bool is_known(const DiscLattice& lattice) const;
  [[nodiscard]] bool all_found() const;
  [[nodiscard]] std::vector<Detection> results(ImageSize size);

  std::vector<CirclePattern> patterns_;  // that differ
  std::vector<std::size_t> of_list_;
  int reach_ = 0;
  int fewest_ = std::numeric_limits<int>::max();  // discs of a board that is seen almost wholly
  MarkKinds marks_;                               // of any board
  Pyramid pyramid_;
  BlobSearch blob_search_;
  DiscGraph graph_;
  std::vector<Ellipse> discs_[2];  // dark, light
  KnownDiscs near_;
  std::vector<FoundSheet> found_;
  std::optional<OtherSheet> other_;
  std::vector<Pixel> last_;  // px, the centres of the results of the last frame
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
    fewest_ = std::min(fewest_, static_cast<int>(kLeastShare * discs));
  }
}

std::vector<Detection> CircleDetector::detect(const ImageView& image, const std::stop_token& stop) {
  found_.clear();
  other_.reset();
  for (auto& discs : discs_) discs.clear();
  pyramid_.build(image, Pyramid::kMaxLevels, kLeastLevel);
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
  return results(image.size());
}

// Discs of a sheet that is seen at an angle are found in several levels: those of smaller levels
// are kept.
void CircleDetector::search_level(int level, bool light, const std::stop_token& stop) {
  std::vector<Ellipse>& discs = discs_[light ? 1 : 0];
  const std::size_t before = discs.size();
  find_discs(level, light, discs);
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

// Adds the discs of a level, in px of the image.
void CircleDetector::find_discs(int level, bool light, std::vector<Ellipse>& discs) {
  constexpr std::uint8_t kThreshold = 6;  // grey levels
  constexpr std::size_t kMostPoints = 1500;
  constexpr double kReach = 10;  // px
  const ImageView& image = pyramid_.calm_level(level);
  const double scale = 1 << level;
  const auto up = [level](double v) {
    return static_cast<double>(Pyramid::to_image(static_cast<float>(v), level));
  };
  near_.begin(discs);
  for (const BlobPoint& p : blob_search_.find(image, light, kThreshold, kMostPoints)) {
    const auto found = measure_blob(image, p.x, p.y, light, kReach, kThreshold);
    if (!found) continue;
    Ellipse e = *found;
    e.x = up(e.x);
    e.y = up(e.y);
    for (double* square : {&e.xx, &e.xy, &e.yy}) *square *= scale * scale;
    if (near_.add(e)) discs.push_back(e);
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
  if (!sheet.fit(image, lattice, kFewestDiscs, marks_)) return;
  // The whole of a larger board is seen before a part of it is taken for a smaller one.
  for (int steps = 0; steps < reach_ && sheet.grow(image); ++steps) {
  }
  for (std::size_t i = 0; i < patterns_.size(); ++i) {
    if (patterns_[i].is_light() == light && name(sheet, i)) return;
  }
  note_other(sheet.lattice(), light);
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
      p.has_marks() ? kFewestWithMarks / static_cast<double>(p.discs().size()) : kLeastShare;
  const auto map = place_on(p, sheet.lattice(), marks, std::min(least, kLeastShare));
  if (!map) return false;
  FoundSheet found{pattern, sheet.observe(pyramid_.level(0), p, *map), {}};
  if (static_cast<int>(found.observation.ids.size()) < kFewestDiscs) return false;
  found.centre = mean_of(found.observation.uv);
  found_.push_back(std::move(found));
  return true;
}

void CircleDetector::note_other(const DiscLattice& lattice, bool light) {
  if (other_ && other_->discs >= lattice.count()) return;
  const auto like = std::ranges::find(patterns_, light, &CirclePattern::is_light);
  const auto board = board_of(lattice, like->board());
  if (!board) return;
  const auto is_in_view = [&](Cell c) {
    const Ellipse& e = *lattice.at(c);
    return std::ranges::all_of(kAround, [&](Cell way) {
      const Ellipse* before = lattice.at(c - way);
      if (lattice.at(c + way) != nullptr || before == nullptr) return true;
      const double x = 2 * e.x - before->x;
      const double y = 2 * e.y - before->y;
      const ImageView& image = pyramid_.level(0);
      return x >= 0 && y >= 0 && x < image.width && y < image.height;
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

bool CircleDetector::all_found() const {
  for (std::size_t i = 0; i < patterns_.size(); ++i) {
    const auto wanted = std::ranges::count(of_list_, i);
    if (std::ranges::count(found_, i, &FoundSheet::pattern) < wanted) return false;
  }
  return true;
}

std::vector<Detection> CircleDetector::results(ImageSize size) {
  std::ranges::sort(found_, {}, [](const FoundSheet& s) { return distance(s.centre, {}); });
  std::vector<Detection> all;
  std::vector<bool> given(found_.size(), false);
  const auto add = [&](std::size_t board, std::size_t pattern, std::optional<std::size_t> sheet) {
    Detection& result = all.emplace_back();
    result.board = board;
    if (sheet) {
      given[*sheet] = true;
      result.observation = std::move(found_[*sheet].observation);
      result.observation.ambiguous = patterns_[pattern].board().symmetries();
      result.reason = Reason::kAccepted;
    } else if (other_ && other_->all) {
      result.reason = Reason::kWrongBoard;
      result.seen_cols = other_->cols;
      result.seen_rows = other_->rows;
      result.seen_all = true;
      result.seen_board = other_->text;
    }
    result.observation.board = patterns_[pattern].board().text();
    result.observation.image_size = size;
  };
  // A sheet keeps its place from frame to frame: each board takes the one nearest to where it was.
  for (std::size_t i = 0; i < of_list_.size(); ++i) {
    std::optional<std::size_t> best;
    double least = 0;
    for (std::size_t s = 0; s < found_.size(); ++s) {
      if (given[s] || found_[s].pattern != of_list_[i]) continue;
      const double far =
          i < last_.size() ? distance(found_[s].centre, last_[i]) : distance(found_[s].centre, {});
      if (best && far >= least) continue;
      best = s;
      least = far;
    }
    add(i, of_list_[i], best);
  }
  for (std::size_t s = 0; s < found_.size(); ++s) {
    if (given[s]) continue;
    const auto board = std::ranges::find(of_list_, found_[s].pattern) - of_list_.begin();
    add(static_cast<std::size_t>(board), found_[s].pattern, s);
  }
  last_.resize(of_list_.size());
  for (std::size_t i = 0; i < of_list_.size(); ++i) {
    if (all[i].observation.found()) last_[i] = mean_of(all[i].observation.uv);
  }
  return all;
}

}  // namespace

std::unique_ptr<Detector> make_circle_detector(std::span<const Board> boards) {
  return std::make_unique<CircleDetector>(boards);
}

}  // namespace calvin::detect
