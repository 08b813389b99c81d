// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The choice of the detector by the kind of the board, and one that asks several.

#include "calvin/detect/detector.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/detect/checkerboard/code/pattern.hpp"
#include "calvin/detect/checkerboard/sheets/checkerboard_detector.hpp"
#include "calvin/detect/circles/circle_detector.hpp"
#include "calvin/detect/circles/circle_pattern.hpp"
#include "calvin/detect/grids/grid_detector.hpp"
#include "calvin/detect/light/light_detector.hpp"
#include "calvin/detect/tags/search/tag_detector.hpp"

namespace calvin {

namespace {

// The kinds of boards that one detector finds together.
struct Family {
  bool (*has)(const Board& board);
  std::unique_ptr<Detector> (*make)(std::span<const Board> boards);
  const char* points;  // what control points are called
  bool by_lattice;     // points are found by how they lie, not each part of a board by its code
};
constexpr std::array<Family, 5> kFamilies = {{
    {detect::has_pattern, detect::make_checkerboard_detector, "inner corners", true},
    {detect::has_circle_pattern, detect::make_circle_detector, "circles", true},
    {detect::is_unbounded_grid, detect::make_grid_detector, "points", false},
    {detect::has_tags, detect::make_tag_detector, "corners", false},
    {detect::is_light, detect::make_light_detector, "lights", false},
}};

const Family* family_of(const Board& board) {
  const auto family =
      std::ranges::find_if(kFamilies, [&](const Family& f) { return f.has(board); });
  return family == kFamilies.end() ? nullptr : &*family;
}

Status check_detectable(const Board& board) {
  const Family* family = family_of(board);
  if (family == nullptr) {
    return make_error(
        ErrorCode::kUnsupported,
        fmt::format("The board {} cannot be detected: there is no detector for boards "
                    "of its kind. Give its corners as a file of observations.",
                    board.text()));
  }
  if (const Status light = detect::check_light(board); !light) return light;
  if (!family->by_lattice) return {};
  // Two lines of points have no curvature, and are in any pattern of bricks.
  const BoardArea area = board.extent();
  const double narrowest = std::min(area.width(), area.height());
  constexpr double kTwoSteps = 1.99;  // of the grid, or of half of an asymmetric one
  const double step = board.grid() ? board.cell_size(0) : board.cell_size(0) / 2;
  constexpr int kFewest = 9;
  if (narrowest < kTwoSteps * step || board.point_count() < kFewest) {
    return make_error(ErrorCode::kUnsupported,
                      fmt::format("The board {} cannot be detected: at least 3x3 {} are needed.",
                                  board.text(), family->points));
  }
  return {};
}

// Boards that are looked for together: of one family, and where points are found by how they lie
// with lines that are spaced alike, as a lattice of one spacing is none of another.
struct Group {
  const Family* family = nullptr;
  double gap_share = 1;
  std::vector<Board> boards;
  std::vector<std::size_t> of_list;  // the place of each in the list
  std::unique_ptr<Detector> detector;
};

std::vector<Group> groups_of(std::span<const Board> boards) {
  std::vector<Group> groups;
  for (std::size_t i = 0; i < boards.size(); ++i) {
    const Family* family = family_of(boards[i]);
    const double share =
        family->by_lattice ? boards[i].grid().value_or(Grid{}).gap_share() : Group{}.gap_share;
    auto group = std::ranges::find_if(
        groups, [&](const Group& g) { return g.family == family && g.gap_share == share; });
    if (group == groups.end()) {
      groups.push_back({family, share, {}, {}, nullptr});
      group = groups.end() - 1;
    }
    group->boards.push_back(boards[i]);
    group->of_list.push_back(i);
  }
  return groups;
}

// Looks for the boards of several groups, one group after the other.
class GroupsDetector final : public Detector {
 public:
  GroupsDetector(std::vector<Group> groups, std::size_t listed)
      : groups_(std::move(groups)), listed_(listed) {
    for (Group& group : groups_) group.detector = group.family->make(group.boards);
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
  // In the order of the list, then the further sheets of each group.
  template <typename F>
  std::vector<Detection> by_all(F detect) noexcept {
    try {
      std::vector<Detection> all(listed_);
      for (const Group& group : groups_) {
        std::vector<Detection> found = detect(*group.detector);
        if (found.empty()) return {};  // no memory
        for (std::size_t i = 0; i < found.size(); ++i) {
          found[i].board = group.of_list[found[i].board];
          if (i < group.boards.size()) {
            all[group.of_list[i]] = std::move(found[i]);
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

  std::vector<Group> groups_;
  std::size_t listed_;
};

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
  if (std::ranges::count_if(boards, detect::is_light) > 1) {
    return make_error(ErrorCode::kUnsupported,
                      "Several lights at a time cannot be told apart: name dot once, or one wand.");
  }
  std::vector<Group> groups = groups_of(boards);
  if (groups.size() == 1) return groups.front().family->make(boards);
  return std::make_unique<GroupsDetector>(std::move(groups), boards.size());
}

Result<std::unique_ptr<Detector>> make_detector(const Board& board) {
  return make_detector(std::span(&board, 1));
}

}  // namespace calvin
