// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The search for each board of a list, and its result.

#include "calvin/detect/grids/grid_detector.hpp"

#include <algorithm>
#include <exception>
#include <optional>
#include <vector>

#include "calvin/detect/circles/circle_pattern.hpp"
#include "calvin/detect/grids/dot_grid.hpp"
#include "calvin/detect/grids/grid_lattice.hpp"
#include "calvin/detect/grids/line_grid.hpp"
#include "calvin/detect/pyramid.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin::detect {

namespace {

class GridDetector final : public Detector {
 public:
  explicit GridDetector(std::span<const Board> boards) {
    for (const Board& board : boards) {
      const auto& grid = *board.as<UnboundedGrid>();
      std::optional<CirclePattern> dots;
      if (grid.pattern == GridPattern::kDots) dots.emplace(board);
      wanted_.push_back({board, std::move(dots)});
    }
  }

  std::vector<Detection> detect_all(const ImageView& image,
                                    std::stop_token stop) noexcept override {
    try {
      constexpr ImageSize kSmallestLevel = {48, 32};
      pyramid_.build(image, Pyramid::kMaxLevels, kSmallestLevel);
      std::vector<Detection> all;
      for (std::size_t i = 0; i < wanted_.size(); ++i) {
        all.push_back(is_first(i) ? detect(i, stop) : Detection{});
        all.back().board = i;
        all.back().observation.board = wanted_[i].board.text();
        all.back().observation.image_size = image.size();
      }
      return all;
    } catch (const std::exception&) {
      return {};  // no memory
    }
  }

 private:
  struct Wanted {
    Board board;
    std::optional<CirclePattern> dots;  // absent for lines
  };

  // Whether a board is the first one of the list that looks so.
  [[nodiscard]] bool is_first(std::size_t i) const {
    return std::none_of(wanted_.begin(), wanted_.begin() + static_cast<std::ptrdiff_t>(i),
                        [&](const Wanted& w) { return w.board.looks_like(wanted_[i].board); });
  }

  [[nodiscard]] Detection detect(std::size_t i, const std::stop_token& stop) {
    const Wanted& wanted = wanted_[i];
    const auto& grid = *wanted.board.as<UnboundedGrid>();
    Detection result;
    Observation seen = wanted.dots ? find_dot_grid(pyramid_, *wanted.dots, stop)
                                   : find_line_grid(pyramid_, grid, stop);
    if (static_cast<int>(seen.ids.size()) < kFewestGridPoints) return result;
    result.observation = std::move(seen);
    result.observation.ambiguous = wanted.board.symmetries();
    result.reason = Reason::kAccepted;
    return result;
  }

  std::vector<Wanted> wanted_;
  Pyramid pyramid_;
};

}  // namespace

bool is_unbounded_grid(const Board& board) { return board.as<UnboundedGrid>() != nullptr; }

std::unique_ptr<Detector> make_grid_detector(std::span<const Board> boards) {
  return std::make_unique<GridDetector>(boards);
}

}  // namespace calvin::detect
