// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// PointBoard: control points at known places, in a plane or in space, each with an id of its own.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/grid.hpp"

namespace calvin {

// Points that need not lie on a grid, or in the plane z = 0 of the board frame: those of a plate, a
// cube or a room that was surveyed. Ids may have gaps. Where a point has a diameter it is the
// centre of a round dot, dark on light; dots are printed and rendered where all points have z = 0.
// Copies share what make() was given. What the functions answer is said of Board, in
// target/board.hpp.
class PointBoard {
 public:
  struct Dot {
    int id = 0;
    double x = 0;  // m, board frame
    double y = 0;
    double diameter = 0;  // m; 0: a point of no size
    double z = 0;         // m
    // The normal of the surface around a dot, any length; 0 0 0: that of the plane z = 0.
    std::array<double, 3> normal = {};

    friend bool operator==(const Dot&, const Dot&) = default;
  };

  // `name`, that of the file of its points or another, stands in the board's text: "points:NAME".
  // kInvalidArgument for a name of more than 4096 bytes, as long as a path may be, or with '#', ';'
  // or control characters, without 4 dots or with more than 10 000, for an id that is negative or
  // given twice, and for dots that touch or are no numbers, or whose normals are none.
  [[nodiscard]] static Result<PointBoard> make(std::string name, std::vector<Dot> dots);

  // A move is a copy, too: what was moved from is still a board.
  PointBoard(const PointBoard&) = default;
  PointBoard& operator=(const PointBoard&) = default;
  ~PointBoard() = default;

  // In the order of their ids.
  [[nodiscard]] const std::vector<Dot>& dots() const noexcept { return shared_->dots; }

  // Whether all points lie in the plane z = 0.
  [[nodiscard]] bool is_flat() const noexcept;

  [[nodiscard]] std::string text() const;
  [[nodiscard]] Status check() const { return {}; }
  [[nodiscard]] int count() const noexcept { return static_cast<int>(dots().size()); }
  [[nodiscard]] std::vector<int> ids() const;
  [[nodiscard]] std::vector<Eigen::Vector3d> points() const;
  [[nodiscard]] std::optional<std::size_t> index_of(int id) const noexcept;
  [[nodiscard]] std::vector<int> neighbours(int id) const;
  [[nodiscard]] double cell_size(int id) const noexcept;
  [[nodiscard]] BoardArea extent() const noexcept;
  [[nodiscard]] BoardArea outline() const noexcept;
  [[nodiscard]] std::vector<Relabelling> symmetries() const { return {}; }
  [[nodiscard]] bool looks_like(const PointBoard& other) const noexcept { return *this == other; }

  friend bool operator==(const PointBoard& a, const PointBoard& b) {
    return a.shared_ == b.shared_ || *a.shared_ == *b.shared_;
  }

 private:
  struct Shared {
    std::string name;
    std::vector<Dot> dots;
    friend bool operator==(const Shared&, const Shared&) = default;
  };

  explicit PointBoard(std::shared_ptr<const Shared> shared) : shared_(std::move(shared)) {}
  [[nodiscard]] BoardArea area(double diameters) const noexcept;

  std::shared_ptr<const Shared> shared_;
};

}  // namespace calvin
