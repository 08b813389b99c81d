// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Passes what a board is asked on to its kind.

#include "calvin/target/board.hpp"

#include <utility>

#include "calvin/target/kinds.hpp"

namespace calvin {

Board::Board() {
  static const auto kNone = std::make_shared<const Kind>();
  kind_ = kNone;
}

Board::Board(Checkerboard kind) : kind_(std::make_shared<const Kind>(kind)) {}

Board::Board(PointBoard kind) : kind_(std::make_shared<const Kind>(std::move(kind))) {}

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
  return std::visit([](const auto& kind) { return kind.point_count(); }, *kind_);
}

std::vector<int> Board::ids() const {
  return std::visit([](const auto& kind) { return kind.ids(); }, *kind_);
}

std::vector<Eigen::Vector3d> Board::points() const {
  return std::visit([](const auto& kind) { return kind.points(); }, *kind_);
}

std::optional<std::size_t> Board::index_of(int id) const noexcept {
  return std::visit([id](const auto& kind) { return kind.index_of(id); }, *kind_);
}

std::optional<Grid> Board::grid() const noexcept {
  return std::visit([](const auto& kind) { return kind.grid(); }, *kind_);
}

std::vector<int> Board::neighbours(int id) const {
  return std::visit([id](const auto& kind) { return kind.neighbours(id); }, *kind_);
}

double Board::cell_size(int id) const noexcept {
  return std::visit([id](const auto& kind) { return kind.cell_size(id); }, *kind_);
}

BoardArea Board::extent() const noexcept {
  return std::visit([](const auto& kind) { return kind.extent(); }, *kind_);
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
