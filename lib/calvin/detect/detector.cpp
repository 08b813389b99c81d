// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The choice of the detector by the kind of the board.

#include "calvin/detect/detector.hpp"

#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/detect/checkerboard/code/pattern.hpp"
#include "calvin/detect/checkerboard/sheets/checkerboard_detector.hpp"

namespace calvin {

namespace {

Status check_detectable(const Board& board) {
  if (!detect::has_pattern(board)) {
    return make_error(
        ErrorCode::kUnsupported,
        fmt::format("The board {} cannot be detected: there is no detector for boards "
                    "of its kind. Give its corners as a file of observations.",
                    board.text()));
  }
  // Two lines of corners have no curvature, and are in any pattern of bricks.
  const Grid grid = board.grid().value_or(Grid{});
  if (grid.cols < 3 || grid.rows < 3) {
    return make_error(ErrorCode::kUnsupported,
                      fmt::format("The board {} cannot be detected: at least 3x3 inner corners are "
                                  "needed.",
                                  board.text()));
  }
  return {};
}

// The boards of a list whose lines of corners are spaced alike: a lattice of one spacing is none of
// another.
struct Family {
  double gap_share = 1;
  std::vector<Board> boards;
  std::vector<std::size_t> of_list;  // the place of each in the list
  std::unique_ptr<Detector> detector;
};

std::vector<Family> families_of(std::span<const Board> boards) {
  std::vector<Family> families;
  for (std::size_t i = 0; i < boards.size(); ++i) {
    const double share = boards[i].grid().value_or(Grid{}).gap_share();
    auto family = std::ranges::find(families, share, &Family::gap_share);
    if (family == families.end()) {
      families.push_back({share, {}, {}, nullptr});
      family = families.end() - 1;
    }
    family->boards.push_back(boards[i]);
    family->of_list.push_back(i);
  }
  return families;
}

// Looks for the boards of several families, one after the other.
class FamiliesDetector final : public Detector {
 public:
  explicit FamiliesDetector(std::vector<Family> families, std::size_t listed)
      : families_(std::move(families)), listed_(listed) {
    for (Family& family : families_) {
      family.detector = detect::make_checkerboard_detector(family.boards);
    }
  }

  std::vector<Detection> detect_all(const ImageView& image,
                                    std::stop_token stop) noexcept override {
    return by_all([&](Detector& detector) { return detector.detect_all(image, stop); });
  }
  std::vector<Detection> follow_all(const ImageView& image, std::uint64_t timestamp,
                                    std::stop_token stop) noexcept override {
    return by_all([&](Detector& detector) { return detector.follow_all(image, timestamp, stop); });
  }

 private:
  // In the order of the list, then the further sheets of each family.
  template <typename F>
  std::vector<Detection> by_all(F detect) noexcept {
    try {
      std::vector<Detection> all(listed_);
      for (const Family& family : families_) {
        std::vector<Detection> found = detect(*family.detector);
        if (found.empty()) return {};  // no memory
        for (std::size_t i = 0; i < found.size(); ++i) {
          found[i].board = family.of_list[found[i].board];
          if (i < family.boards.size()) {
            all[family.of_list[i]] = std::move(found[i]);
          } else {
            all.push_back(std::move(found[i]));
          }
        }
      }
      return all;
    } catch (const std::exception&) {
      return {};
    }
  }

  std::vector<Family> families_;
  std::size_t listed_;
};

std::unique_ptr<Detector> make_detector_of(std::span<const Board> boards) {
  std::vector<Family> families = families_of(boards);
  if (families.size() == 1) return detect::make_checkerboard_detector(boards);
  return std::make_unique<FamiliesDetector>(std::move(families), boards.size());
}

}  // namespace

Result<std::unique_ptr<Detector>> make_detector(std::span<const Board> boards) {
  if (boards.empty()) {
    return make_error(ErrorCode::kInvalidArgument, "There is no board to detect: name one.");
  }
  for (const Board& board : boards) {
    if (const Status status = check_detectable(board); !status) {
      return tl::unexpected<Error>(status.error());
    }
  }
  return make_detector_of(boards);
}

Result<std::unique_ptr<Detector>> make_detector(const Board& board) {
  return make_detector(std::span(&board, 1));
}

}  // namespace calvin
