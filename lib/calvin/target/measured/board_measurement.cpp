// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Measured boards: what is known before, their covariance by few numbers, and marks of views.

#include "calvin/target/measured/board_measurement.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calvin/geometry/dense.hpp"
#include "calvin/geometry/symmetric.hpp"
#include "calvin/target/measured/board_fields.hpp"

namespace calvin {

namespace {

constexpr double kOffset = 0.05;  // of the distance to the next control point
constexpr int kMostPoints = 150;  // equations of three unknowns each, solved whole

}  // namespace

ViewMark mark_of(const Observation& observation) {
  const auto n = static_cast<double>(observation.uv.size());
  ViewMark mark;
  for (const Pixel& p : observation.uv) {
    mark.mean.u += p.u / n;
    mark.mean.v += p.v / n;
  }
  for (const Pixel& p : observation.uv) {
    mark.spread.u += (p.u - mark.mean.u) * (p.u - mark.mean.u) / n;
    mark.spread.v += (p.v - mark.mean.v) * (p.v - mark.mean.v) / n;
  }
  mark.spread = {std::sqrt(mark.spread.u), std::sqrt(mark.spread.v)};
  return mark;
}

bool same_view(const ViewMark& a, const ViewMark& b) {
  constexpr double kSame = 0.02;  // px
  const auto same = [](Pixel p, Pixel q) {
    return std::abs(p.u - q.u) <= kSame && std::abs(p.v - q.v) <= kSame;
  };
  return same(a.mean, b.mean) && same(a.spread, b.spread);
}

Eigen::MatrixXd CompactCovariance::full() const {
  Eigen::MatrixXd covariance = product(modes, modes.transpose());
  covariance.diagonal() += own;
  return covariance;
}

CompactCovariance compact(const Eigen::MatrixXd& covariance, int modes) {
  constexpr int kRounds = 10;
  constexpr double kLeast = 1e-3;  // of its variance is each number's own
  const Eigen::Index n = covariance.rows();
  const Eigen::Index count = std::min<Eigen::Index>(modes, n);
  CompactCovariance result = {Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, count)};
  for (int i = 0; i < kRounds; ++i) {
    Eigen::MatrixXd common = covariance;
    common.diagonal() -= result.own;
    const auto eigen = symmetric_eigen(common);
    if (!eigen) break;
    const Eigen::VectorXd largest = eigen->values.tail(count).cwiseMax(0.0).cwiseSqrt();
    result.modes = eigen->vectors.rightCols(count) * largest.asDiagonal();
    // No number may have less than nothing of its own: its share of the modes gives way.
    for (Eigen::Index k = 0; k < n; ++k) {
      const double all = covariance(k, k);
      const double in_common = result.modes.row(k).squaredNorm();
      const double most = (1 - kLeast) * all;
      if (in_common > most) result.modes.row(k) *= std::sqrt(most / in_common);
      result.own[k] = all - std::min(in_common, most);
    }
  }
  if (result.own.isZero()) result.own = covariance.diagonal();
  return result;
}

Status can_be_measured(const Board& board) {
  if (!has_shape(board) || board.point_count() > kMostPoints) {
    return make_error(ErrorCode::kUnsupported,
                      fmt::format("The shape of {} cannot be measured: it takes 3 rows of 3 points "
                                  "at least, and {} points at most.",
                                  board.text(), kMostPoints));
  }
  return {};
}

Result<BoardMeasurement> unmeasured(const Board& board) {
  if (const Status can = can_be_measured(board); !can) return tl::unexpected<Error>(can.error());
  const auto n = static_cast<Eigen::Index>(board.point_count());
  const Eigen::MatrixXd basis = offset_basis(board);
  const Eigen::MatrixXd curvatures =
      transposed_product(basis, curvature_fields(board)) * wide_curvature(board);
  const double offset = kOffset * board.cell_size(board.ids().front());
  Eigen::MatrixXd covariance = product(curvatures, curvatures.transpose());
  covariance.diagonal().array() += offset * offset;
  return BoardMeasurement{
      board,
      std::vector<Eigen::Vector3d>(static_cast<std::size_t>(n), Eigen::Vector3d::Zero()),
      congruent(covariance, basis.transpose()),
      {}};
}

}  // namespace calvin
