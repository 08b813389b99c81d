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

namespace calvin {

namespace {

// The kinds of boards that one detector finds together.
struct Family {
  bool (*has)(const Board& board);
  std::unique_ptr<Detector> (*make)(std::span<const Board> boards);
  const char* points;  // what control points are called
};
constexpr std::array<Family, 2> kFamilies = {{
    {detect::has_pattern, detect::make_checkerboard_detector, "inner corners"},
    {detect::has_circle_pattern, detect::make_circle_detector, "circles"},
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
  // Two lines of points have no curvature, and are in any pattern of bricks.
  const BoardArea area = board.extent();
  const double narrowest = std::min(area.width(), area.height());
  constexpr double kTwoSteps = 1.99;  // of the grid, or of half of an asymmetric one
  const double step = board.grid() ? board.cell_size(0) : board.cell_size(0) / 2;
  if (narrowest < kTwoSteps * step) {
    return make_error(ErrorCode::kUnsupported,
                      fmt::format("The board {} cannot be detected: at least 3x3 {} are needed.",
                                  board.text(), family->points));
  }
  return {};
}

// Asks a detector of each family.
class DetectorOfSeveral final : public Detector {
 public:
  explicit DetectorOfSeveral(std::span<const Board> boards) : listed_(boards.size()) {
    for (const Family& family : kFamilies) {
      Part part;
      std::vector<Board> own;
      for (std::size_t i = 0; i < boards.size(); ++i) {
        if (family_of(boards[i]) != &family) continue;
        part.places.push_back(i);
        own.push_back(boards[i]);
      }
      if (own.empty()) continue;
      part.detector = family.make(own);
      parts_.push_back(std::move(part));
    }
  }

  std::vector<Detection> detect_all(const ImageView& image,
                                    std::stop_token stop) noexcept override {
    return join([&](Detector& d) { return d.detect_all(image, stop); });
  }
  std::vector<Detection> follow_all(const ImageView& image, std::uint64_t timestamp,
                                    std::stop_token stop) noexcept override {
    return join([&](Detector& d) { return d.follow_all(image, timestamp, stop); });
  }

 private:
  struct Part {
    std::unique_ptr<Detector> detector;
    std::vector<std::size_t> places;  // of its boards in the list
  };

  template <typename Ask>
  std::vector<Detection> join(Ask ask) noexcept {
    try {
      std::vector<Detection> all(listed_);
      for (const Part& part : parts_) {
        std::vector<Detection> some = ask(*part.detector);
        if (some.size() < part.places.size()) return {};  // no memory
        for (std::size_t i = 0; i < some.size(); ++i) {
          some[i].board = part.places[some[i].board];
          if (i < part.places.size()) {
            all[some[i].board] = std::move(some[i]);
          } else {
            all.push_back(std::move(some[i]));
          }
        }
      }
      return all;
    } catch (const std::exception&) {
      return {};
    }
  }

  std::size_t listed_;
  std::vector<Part> parts_;
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
  const Family* family = family_of(boards.front());
  const bool is_one = std::ranges::all_of(
      boards, [family](const Board& board) { return family_of(board) == family; });
  if (is_one) return family->make(boards);
  return std::make_unique<DetectorOfSeveral>(boards);
}

Result<std::unique_ptr<Detector>> make_detector(const Board& board) {
  return make_detector(std::span(&board, 1));
}

}  // namespace calvin
