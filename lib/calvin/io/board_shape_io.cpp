// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Measured boards as lists of numbers; the covariance is written by its leading modes.

#include "calvin/io/board_shape_io.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace calvin::io {

namespace {

constexpr int kModes = 12;
constexpr std::size_t kMostModes = 64;
constexpr double kLargestOffset = 10;  // m, of an offset, of its sigma and of a mode

Node number(double x) { return {Node::Kind::kPlain, fmt::format("{:.5g}", x), {}, {}}; }

template <typename Numbers>
Node numbers(const Numbers& values) {
  Node list = {Node::Kind::kList, {}, {}, {}};
  for (const double x : values) list.items.push_back(number(x));
  return list;
}

bool within(const std::vector<double>& row, double least, double most) {
  return std::all_of(row.begin(), row.end(), [&](double x) { return x >= least && x <= most; });
}

}  // namespace

Node shape_node(const BoardMeasurement& measured) {
  const CompactCovariance compacted = compact(measured.covariance, kModes);
  const Node empty = {Node::Kind::kList, {}, {}, {}};
  Node offsets = empty;
  Node own = empty;
  Node modes = empty;
  Node views = empty;
  for (std::size_t i = 0; i < measured.offsets.size(); ++i) {
    offsets.items.push_back(numbers(measured.offsets[i]));
    const Eigen::Vector3d of_point =
        compacted.own.segment<3>(3 * static_cast<Eigen::Index>(i)).cwiseSqrt();
    own.items.push_back(numbers(of_point));
  }
  for (Eigen::Index m = 0; m < compacted.modes.cols(); ++m) {
    if (!compacted.modes.col(m).isZero()) modes.items.push_back(numbers(compacted.modes.col(m)));
  }
  for (const ViewMark& view : measured.views) {
    // Hundredths of a pixel tell views apart.
    Node mark = empty;
    for (const double x : {view.mean.u, view.mean.v, view.spread.u, view.spread.v}) {
      mark.items.push_back({Node::Kind::kPlain, fmt::format("{:.3f}", x), {}, {}});
    }
    views.items.push_back(std::move(mark));
  }
  return {Node::Kind::kMap,
          {},
          {"offsets", "own", "modes", "views"},
          {std::move(offsets), std::move(own), std::move(modes), std::move(views)}};
}

Result<BoardMeasurement> read_shape(const Node& node, const Board& board) {
  if (const Status can = can_be_measured(board); !can) return tl::unexpected<Error>(can.error());
  std::optional<Error> error;
  Fields fields(node, "shape.", error);
  const auto offsets = fields.rows("offsets", 3);
  const auto own = fields.rows("own", 3);
  const auto points = static_cast<std::size_t>(board.point_count());
  const auto modes = fields.rows("modes", 3 * points);
  const auto views = fields.rows("views", 4);
  const auto all_within = [](const std::vector<std::vector<double>>& rows, double least) {
    return std::all_of(rows.begin(), rows.end(), [least](const std::vector<double>& row) {
      return within(row, least, kLargestOffset);
    });
  };
  if (!error && (offsets.size() != points || own.size() != points)) {
    fields.complain("offsets", fmt::format("has not the {} points of the board", points));
  }
  if (!error && modes.size() > kMostModes) fields.complain("modes", "has too many modes");
  constexpr double kLeastSigma = 1e-9;  // m
  if (!error && (!all_within(offsets, -kLargestOffset) || !all_within(modes, -kLargestOffset) ||
                 !all_within(own, kLeastSigma))) {
    fields.complain("offsets", "has numbers that no board has");
  }
  if (error) return tl::unexpected<Error>(*std::move(error));
  BoardMeasurement measured;
  measured.board = board;
  measured.offsets.resize(points);
  CompactCovariance compacted;
  compacted.own.resize(3 * static_cast<Eigen::Index>(points));
  compacted.modes.resize(compacted.own.size(), static_cast<Eigen::Index>(modes.size()));
  for (std::size_t i = 0; i < points; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      measured.offsets[i][static_cast<Eigen::Index>(k)] = offsets[i][k];
      compacted.own[static_cast<Eigen::Index>(3 * i + k)] = own[i][k] * own[i][k];
    }
  }
  for (std::size_t m = 0; m < modes.size(); ++m) {
    compacted.modes.col(static_cast<Eigen::Index>(m)) =
        Eigen::Map<const Eigen::VectorXd>(modes[m].data(), compacted.modes.rows());
  }
  measured.covariance = compacted.full();
  for (const auto& view : views) measured.views.push_back({{view[0], view[1]}, {view[2], view[3]}});
  return measured;
}

}  // namespace calvin::io
