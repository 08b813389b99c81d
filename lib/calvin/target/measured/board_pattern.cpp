// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Offsets of corners against what a stretched print or another gap would make of them.

#include "calvin/target/measured/board_pattern.hpp"

#include <cmath>

#include <fmt/format.h>

namespace calvin {

namespace {

// Of the squares of the offsets. Of n corners that are off each by itself a change explains 1 / (2
// n) by chance; a lens or a bend that looks like it in part leaves more than this to explain.
constexpr double kLeastExplained = 0.7;
constexpr std::size_t kFewestCorners = 12;

// Displacements of all corners, along x and then along y, in standard deviations.
class Displacements {
 public:
  Displacements(const Grid& grid, const std::vector<SeenOffset>& corners, OffsetsOf of)
      : corners_(corners) {
    const auto whole = [](const Eigen::Vector2d& at, int column) -> Eigen::Vector2d {
      if (column == 0) return {1, 0};
      if (column == 1) return {0, 1};
      if (column == 2) return {-at.y(), at.x()};
      if (column == 3) return at;
      if (column == 4) return {at.x(), -at.y()};
      return {at.y(), at.x()};
    };
    const int columns = of == OffsetsOf::kMeasurement ? 6 : 4;
    for (int column = 0; column < columns; ++column) {
      const Eigen::VectorXd v = left_by_whole([&](const SeenOffset& c) {
        return whole({grid.distance_to(c.place.col), grid.distance_to(c.place.row)}, column);
      });
      if (v.norm() > 0) whole_.push_back(v.normalized());
    }
  }

  // What motions of the whole board leave of displacements: `of` has one per corner.
  template <typename Of>
  [[nodiscard]] Eigen::VectorXd left_by_whole(const Of& of) const {
    Eigen::VectorXd v(2 * static_cast<Eigen::Index>(corners_.size()));
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Eigen::Vector2d by = of(corners_[i]);
      for (Eigen::Index k = 0; k < 2; ++k) {
        v[2 * static_cast<Eigen::Index>(i) + k] = by[k] * std::sqrt(corners_[i].information[k]);
      }
    }
    for (const Eigen::VectorXd& w : whole_) v -= w * w.dot(v);
    return v;
  }

 private:
  const std::vector<SeenOffset>& corners_;
  std::vector<Eigen::VectorXd> whole_;
};

}  // namespace

std::optional<BoardPattern> board_pattern(const Grid& grid, const std::vector<SeenOffset>& corners,
                                          OffsetsOf of) {
  if (corners.size() < kFewestCorners) return std::nullopt;
  const Displacements displacements(grid, corners, of);
  const Eigen::VectorXd offsets =
      displacements.left_by_whole([](const SeenOffset& c) { return c.offset; });
  std::optional<BoardPattern> best;
  double explained = kLeastExplained * offsets.squaredNorm();
  const auto add = [&](BoardPattern pattern, const auto& by) {
    const Eigen::VectorXd moved = displacements.left_by_whole(by);
    const double squares = moved.squaredNorm();
    const double both = moved.dot(offsets);
    if (!(squares > 0) || !(both * both / squares > explained)) return;
    explained = both * both / squares;
    pattern.value = pattern.printed + both / squares;
    best = pattern;
  };
  if (of == OffsetsOf::kResiduals) {
    add({BoardPattern::Kind::kAspect, 0, 0, grid.pitch},
        [&](const SeenOffset& c) -> Eigen::Vector2d {
          return {grid.distance_to(c.place.col) / 2, -grid.distance_to(c.place.row) / 2};
        });
  }
  if (grid.gap > 0) {
    const double share = grid.gap / grid.pitch;
    add({BoardPattern::Kind::kGap, share, share, grid.pitch},
        [&](const SeenOffset& c) -> Eigen::Vector2d {
          return {c.place.col / 2 * grid.pitch, c.place.row / 2 * grid.pitch};
        });
  }
  return best;
}

std::string to_words(const BoardPattern& pattern) {
  if (pattern.kind == BoardPattern::Kind::kGap) {
    return fmt::format("as gaps of {:.3g} of a tag ({:.3g} mm) instead of {:.3g} would have them",
                       pattern.value, 1e3 * pattern.value * pattern.pitch, pattern.printed);
  }
  return fmt::format("as a board would have them that is longer along its {} than by its text",
                     pattern.value > 0 ? "rows" : "columns");
}

std::string advice(const BoardPattern& pattern) {
  return pattern.kind == BoardPattern::Kind::kGap
             ? "Measure the gaps, and give them in the text of the board."
             : "Measure the board both ways: some printers stretch it.";
}

}  // namespace calvin
