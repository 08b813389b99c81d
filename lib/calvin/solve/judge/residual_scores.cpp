// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where each residual is counted, and what the sums tell.

#include "calvin/solve/judge/residual_scores.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calvin/camera/image_transform.hpp"

namespace calvin {

namespace {

constexpr std::size_t kPlaneAxes = 2;  // of a board, in its plane

// The image in parts of about as many corners, along a side of `extent` of an image whose sides are
// as `aspect`.
int parts_along(double residuals, double aspect) {
  constexpr double kCornersPerPart = 40;
  const double parts = std::clamp(residuals / 2 / kCornersPerPart, 1.0, 400.0);
  return std::max(1, static_cast<int>(std::lround(std::sqrt(parts * aspect))));
}

double aspect_of(ImageSize size) { return static_cast<double>(size.width) / size.height; }

std::vector<std::size_t> first_corners(const Fit& fit) {
  std::vector<std::size_t> counts;
  for (std::size_t v = 0; v < fit.views.size(); ++v) {
    if (!fit.used[v]) continue;
    const PointSet& view = fit.views[v];
    if (counts.size() <= view.board) counts.resize(view.board + 1);
    std::size_t& corners = counts[view.board];
    for (const int id : view.ids) corners = std::max(corners, static_cast<std::size_t>(id) + 1);
  }
  counts.push_back(0);
  std::exclusive_scan(counts.begin(), counts.end(), counts.begin(), std::size_t{0});
  return counts;
}

}  // namespace

void Scores::add(const Agreement& groups) {
  for (std::size_t part = 0; part < groups.parts(); ++part) {
    const auto [sum, information] = groups.total(part);
    scores_.push_back({sum, information});
  }
}

ChiSquare Scores::chi_square(double variance, double kept, double absorbed) const {
  ChiSquare result;
  double largest = 0;
  for (const Score& score : scores_) largest = std::max(largest, score.information);
  for (const Score& score : scores_) {
    if (!(score.information > 0) || score.information < 1e-3 * largest) continue;
    result.sum += score.sum * score.sum / (score.information * variance * kept);
    result.degrees += 1;
  }
  result.degrees = std::max(0.0, result.degrees - absorbed);
  return result;
}

ResidualScores::ResidualScores(const Fit& fit, ImageSize size, double residuals)
    : size_(size),
      across_(parts_along(residuals, aspect_of(size))),
      down_(parts_along(residuals, 1 / aspect_of(size))),
      first_(first_corners(fit)),
      picture_shared_(2 * static_cast<std::size_t>(across_ * down_)),
      board_shared_(kPlaneAxes * corners()),
      board_bent_(corners()) {}

Scores ResidualScores::picture() const {
  Scores scores;
  scores.add(picture_shared_);
  return scores;
}

Scores ResidualScores::board() const {
  Scores scores;
  scores.add(board_shared_);
  scores.add(board_bent_);
  return scores;
}

std::size_t ResidualScores::corners() const { return first_.back(); }

std::size_t ResidualScores::boards() const {
  std::size_t seen = 0;
  for (std::size_t b = 0; b + 1 < first_.size(); ++b) seen += first_[b + 1] > first_[b] ? 1 : 0;
  return seen;
}

std::vector<SeenOffset> ResidualScores::offsets(const Grid& grid) const {
  std::vector<SeenOffset> offsets;
  for (std::size_t corner = 0; corner < corners(); ++corner) {
    SeenOffset c;
    c.place = grid.place(static_cast<int>(corner));
    for (std::size_t k = 0; k < kPlaneAxes; ++k) {
      const auto [score, information] = board_shared_.total(kPlaneAxes * corner + k);
      const auto axis = static_cast<Eigen::Index>(k);
      c.offset[axis] = information > 0 ? -score / information : 0;
      c.information[axis] = information;
    }
    if (c.information.minCoeff() > 0) offsets.push_back(c);
  }
  return offsets;
}

std::size_t ResidualScores::part_of(Pixel at) const {
  const auto part = [](double x, int extent, int parts) {
    return std::clamp(static_cast<int>(share_before(x, extent) * parts), 0, parts - 1);
  };
  return static_cast<std::size_t>(part(at.v, size_.height, down_) * across_ +
                                  part(at.u, size_.width, across_));
}

void ResidualScores::add(const PointSet& view, const Eigen::Matrix3d& rotation, ViewRows& rows) {
  constexpr int kFirstOfTranslation = 3;  // the first column of a pose's translation
  const std::size_t group = views_++;
  // A column is the u of all corners, then the v.
  const double* residual = rows.u(RowLayout::kResidual);
  const double* by[3] = {rows.u(kFirstOfTranslation), rows.u(kFirstOfTranslation + 1),
                         rows.u(kFirstOfTranslation + 2)};
  std::size_t at = 0;
  for (std::size_t i = 0; i < view.size(); ++i) {
    const double w = view.weight[i];
    if (!(w > 0)) continue;
    const std::size_t part = 2 * part_of(view.uv[i]);
    Eigen::Vector3d score = Eigen::Vector3d::Zero();
    Eigen::Vector3d information = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 2; ++k) {
      const std::size_t place = k * rows.padded() + at;
      const double r = residual[place];
      picture_shared_.add(group, part + k, w * r, w * w);
      const Eigen::Vector3d along =
          rotation.transpose() * Eigen::Vector3d(by[0][place], by[1][place], by[2][place]);
      score += r * along;
      information += along.cwiseAbs2();
    }
    const std::size_t corner = first_[view.board] + static_cast<std::size_t>(view.ids[i]);
    for (std::size_t k = 0; k < kPlaneAxes; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      board_shared_.add(group, kPlaneAxes * corner + k, score[axis], information[axis]);
    }
    board_bent_.add(group, corner, score[2], information[2]);
    ++at;
  }
}

}  // namespace calvin
