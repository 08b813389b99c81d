// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Manual control points: pixels that a user points at, each with its place in the world. Together
// they are one view.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/image.hpp"
#include "calvin/detect/nearest/found_point.hpp"
#include "calvin/session/progress.hpp"
#include "calvin/solve/view.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// px, 1 sigma per coordinate of a point that was clicked and has nothing next to it: what a hand
// with a mouse comes to.
inline constexpr double kClickSigma = 1;

// How far from where somebody has clicked a corner or a disc is taken for what was meant, px: 5, or
// 0.5 % of the image's diagonal if that is more, since a large picture is shown smaller.
[[nodiscard]] double snap_reach(ImageSize size);

// What somebody points at.
struct PointChoice {
  Pixel at;
  std::optional<Eigen::Vector3d> world;  // m; absent: the next point of the board
  std::optional<double> sigma;           // px; present: it was measured, and is taken as it is
};

enum class PointVerdict {
  kAccepted,
  kOutside,
  kTwice,
  kNotOnBoard,
  kNoneLeft,
  kNoPlace,
  kNotThere
};
// "accepted", "outside", ...: the words of the `reason` field on the bus.
[[nodiscard]] std::string_view to_string(PointVerdict verdict) noexcept;

// What came of it.
struct PointAnswer {
  PointVerdict verdict = PointVerdict::kAccepted;
  std::optional<FoundPoint::Kind> snapped;  // to what was found next to it
  Pixel at;                                 // where the point is now
  std::optional<double> sigma;              // px
  std::optional<int> id;                    // on the board of the view
  std::optional<Eigen::Vector3d> world;     // m
  std::size_t count = 0;                    // points there are now
  std::string hint;                         // what to do next, sentences

  [[nodiscard]] bool accepted() const noexcept { return verdict == PointVerdict::kAccepted; }
};

// Not thread-safe.
class ManualPoints {
 public:
  // Forgets all points. Those to come are of pictures of that size and, where there is a board, its
  // points alone: one without a place is the first in the order of ids that has no pixel yet.
  void begin(ImageSize size, std::optional<Board> board);
  // How many parameters of the camera are to be estimated; 0 where it is known.
  void set_unknowns(int unknowns) noexcept { unknowns_ = unknowns; }
  // What the user is told when the points are enough, a sentence.
  void set_done_words(std::string words) { done_words_ = std::move(words); }

  // `found`: what is next to the pixel, if that was looked for. A place that has a pixel already
  // gets the new one.
  [[nodiscard]] PointAnswer add(const PointChoice& choice,
                                const std::optional<FoundPoint>& found = std::nullopt);
  // Those that were found where a known camera has them.
  [[nodiscard]] PointAnswer add_found(
      const std::vector<std::pair<PointChoice, FoundPoint>>& points);
  // All of a file, as far as they can be taken: how many, and in words what became of them.
  [[nodiscard]] PointAnswer add_all(const std::vector<PointChoice>& choices);
  // The newest one, or that of a number in the order in which they were chosen.
  [[nodiscard]] PointAnswer remove(std::optional<std::size_t> index = std::nullopt);

  [[nodiscard]] std::size_t count() const noexcept { return points_.size(); }
  [[nodiscard]] const std::optional<Board>& board() const noexcept { return board_; }
  // The newest ones, in the order in which they were chosen, as the picture shows them.
  [[nodiscard]] std::vector<PlacedPoint> placed(std::size_t most) const;
  // What to do next, a sentence; empty without a board and without points.
  [[nodiscard]] std::string hint() const;

  // The view that they are: of the board or, without one, of one that they make ("points:manual").
  // Absent where they are fewer than 4, or all of them or all but one lie on one line.
  [[nodiscard]] std::optional<View> view() const;
  // Whether they make a calibration without any other view: they lie in space and are as many as
  // the unknowns and the pose ask for, or 4 where the camera is known.
  [[nodiscard]] bool suffice() const;

 private:
  struct Point {
    int id = 0;
    Eigen::Vector3d world;
    Pixel at;
    double sigma = kClickSigma;
  };

  [[nodiscard]] Point* find(int id);
  // The place in points() of the board of the first point without a pixel.
  [[nodiscard]] std::optional<std::size_t> next() const;
  // How many suffice where they lie in space.
  [[nodiscard]] std::size_t needed() const;
  // Absent where the point has no place among those of the board; `verdict` says why.
  [[nodiscard]] std::optional<Point> place_of(const PointChoice& choice,
                                              PointVerdict& verdict) const;
  // The answer without words.
  [[nodiscard]] PointAnswer take(const PointChoice& choice, const std::optional<FoundPoint>& found);
  [[nodiscard]] PointAnswer refuse(const PointChoice& choice, PointVerdict verdict) const;
  [[nodiscard]] std::string words_of(const PointAnswer& answer) const;
  [[nodiscard]] std::string words_of_refused(const PointAnswer& answer) const;
  [[nodiscard]] std::string then_next(std::string words) const;
  // What the points lack that are there, if all of them are.
  [[nodiscard]] std::string lack() const;

  ImageSize size_;
  std::optional<Board> board_;
  std::vector<int> ids_;                 // of the board
  std::vector<Eigen::Vector3d> places_;  // likewise, m
  int unknowns_ = 0;
  std::string done_words_ = "Solve now (Return), or choose more.";
  std::vector<Point> points_;  // in the order in which they were chosen
  int next_id_ = 0;            // without a board
};

}  // namespace calvin
