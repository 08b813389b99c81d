// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Passes what a board is asked on to its kind.

#include "calvin/target/board.hpp"

#include <utility>

#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

template <typename Kind>
concept OnGrid = requires(const Kind& kind) {
  { kind.grid() } -> std::same_as<Grid>;
};

// Who answers what is asked about the control points of a board: the grid, where they lie on one.
template <typename Kind>
decltype(auto) points_of(const Kind& kind) {
  if constexpr (OnGrid<Kind>) {
    return kind.grid();
  } else {
    return (kind);
  }
}

}  // namespace

Board::Board() {
  // Never freed: a thread may outlive main() in a program that exits while a pipeline plays.
  static const auto& none = *new std::shared_ptr<const Kind>(std::make_shared<const Kind>());
  kind_ = none;
}

template <BoardKind OneKind>
Board::Board(OneKind kind) : kind_(std::make_shared<const Kind>(std::move(kind))) {}

template Board::Board(Checkerboard);
template Board::Board(MarkedCheckerboard);
template Board::Board(PuzzleBoard);
template Board::Board(CharucoBoard);
template Board::Board(CircleGrid);
template Board::Board(AsymmetricCircleGrid);
template Board::Board(AprilGrid);
template Board::Board(TagGrid);
template Board::Board(TagList);
template Board::Board(UnboundedGrid);
template Board::Board(PointBoard);
template Board::Board(PointLight);

bool operator==(const Board& a, const Board& b) {
  return a.kind_ == b.kind_ || *a.kind_ == *b.kind_;
}

std::string Board::text() const {
  return std::visit([](const auto& kind) { return kind.text(); }, *kind_);
}

Status Board::check() const {
  return std::visit([](const auto& kind) { return kind.check(); }, *kind_);
}

int Board::point_count() const noexcept {
  return std::visit([](const auto& kind) { return points_of(kind).count(); }, *kind_);
}

std::vector<int> Board::ids() const {
  return std::visit([](const auto& kind) { return points_of(kind).ids(); }, *kind_);
}

std::vector<Eigen::Vector3d> Board::points() const {
  return std::visit([](const auto& kind) { return points_of(kind).points(); }, *kind_);
}

std::optional<std::size_t> Board::index_of(int id) const noexcept {
  return std::visit([id](const auto& kind) { return points_of(kind).index_of(id); }, *kind_);
}

std::optional<Grid> Board::grid() const noexcept {
  return std::visit(
      [](const auto& kind) -> std::optional<Grid> {
        if constexpr (OnGrid<std::decay_t<decltype(kind)>>) return kind.grid();
        return std::nullopt;
      },
      *kind_);
}

std::vector<int> Board::neighbours(int id) const {
  return std::visit([id](const auto& kind) { return points_of(kind).neighbours(id); }, *kind_);
}

double Board::cell_size(int id) const noexcept {
  return std::visit([id](const auto& kind) { return points_of(kind).cell_size(id); }, *kind_);
}

BoardArea Board::extent() const noexcept {
  return std::visit([](const auto& kind) { return points_of(kind).extent(); }, *kind_);
}

BoardArea Board::outline() const noexcept {
  return std::visit([](const auto& kind) { return kind.outline(); }, *kind_);
}

std::vector<Relabelling> Board::symmetries() const {
  return std::visit([](const auto& kind) { return kind.symmetries(); }, *kind_);
}

bool Board::looks_like(const Board& other) const noexcept {
  return std::visit(
      [&other](const auto& kind) {
        const auto* same_kind = other.as<std::decay_t<decltype(kind)>>();
        return same_kind != nullptr && kind.looks_like(*same_kind);
      },
      *kind_);
}

}  // namespace calvin
