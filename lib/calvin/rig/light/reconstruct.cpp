// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A pair of cameras to begin with, then one more at a time.

#include "calvin/rig/light/reconstruct.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "calvin/core/text.hpp"
#include "calvin/geometry/cross_matrix.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/rig/light/linear.hpp"

namespace calvin::rig {

namespace {

constexpr double kPlanar = 0.9;  // share of a pair's instants that lie in one plane

// How many points are before both cameras.
std::size_t in_front(const Tracks& tracks, const EpipolarGeometry& pair, const Matrix34& first,
                     const Matrix34& second) {
  std::size_t count = 0;
  for (const std::size_t i : pair.instants) {
    const TrackPoint& a = *tracks[pair.a][i];
    const TrackPoint& b = *tracks[pair.b][i];
    const Ray rays[] = {{pair.a, first, a.at, a.scale}, {pair.b, second, b.at, b.scale}};
    const Eigen::Vector4d point = triangulate(rays);
    const double side = point[3];
    count += first.row(2).dot(point) * side > 0 && second.row(2).dot(point) * side > 0 ? 1 : 0;
  }
  return count;
}

// The motion whose essential matrix is nearest to F: of the four that it allows, the one with most
// points in front.
Matrix34 nearest_motion(const Tracks& tracks, const EpipolarGeometry& pair) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(pair.fundamental,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  Matrix34 best = Matrix34::Zero();
  std::size_t most = 0;
  for (const bool is_back : {false, true}) {
    Eigen::Matrix3d turn = is_back ? quarter.transpose() : quarter;
    turn = svd.matrixU() * turn * svd.matrixV().transpose();
    if (turn.determinant() < 0) turn = -turn;
    for (const double sign : {1.0, -1.0}) {
      Matrix34 motion;
      motion << turn, sign * svd.matrixU().col(2);
      const std::size_t count = in_front(tracks, pair, Matrix34::Identity(), motion);
      if (count >= most) best = motion;
      most = std::max(most, count);
    }
  }
  return best;
}

// The camera that with [I | 0] has exactly the fundamental matrix, and is nearest to a motion: its
// columns are [a [e]x F + e v^T | e] for any a and v, with the epipole e. In a frame that is nearly
// Euclidean, linear equations weigh points as the eye does (ibid.).
Matrix34 near_motion(const Eigen::Matrix3d& fundamental, const Matrix34& motion) {
  const Eigen::Vector3d epipole = motion.col(3).normalized();
  const Eigen::Matrix3d across = -cross_matrix(epipole) * fundamental;
  const Eigen::Matrix3d turn = motion.leftCols<3>();
  const double a = across.cwiseProduct(turn).sum() / across.squaredNorm();
  Matrix34 projection;
  projection << a * across + epipole * (epipole.transpose() * turn), epipole;
  return projection;
}

// [R | t] up to scale.
Matrix34 to_motion(const Matrix34& projection) {
  Matrix34 p = projection;
  if (p.leftCols<3>().determinant() < 0) p = -p;
  const double scale = std::cbrt(p.leftCols<3>().determinant());
  Matrix34 motion;
  motion << closest_rotation(p.leftCols<3>() / scale), p.col(3) / scale;
  return motion;
}

std::vector<EpipolarGeometry> all_pairs(const Tracks& tracks, double limit) {
  std::vector<EpipolarGeometry> pairs;
  for (std::size_t a = 0; a < tracks.size(); ++a) {
    for (std::size_t b = a + 1; b < tracks.size(); ++b) {
      if (auto pair = find_epipolar_geometry(tracks, a, b, limit)) pairs.push_back(*pair);
    }
  }
  return pairs;
}

tl::unexpected<Error> no_pair(const std::vector<std::string>& names) {
  return make_error(
      ErrorCode::kDegenerate,
      fmt::format(
          "No two of the cameras '{}' have seen the light at {} instants that fit together: "
          "move it where their pictures overlap, in the dark, and see that their clocks "
          "agree.",
          join(names, "', '"), kFewestCommon));
}

tl::unexpected<Error> no_overlap(const std::string& name, std::size_t common) {
  return make_error(
      ErrorCode::kDegenerate,
      fmt::format(
          "The camera '{}' has seen the light at {} instants at which the others tell where "
          "it was, and fits them at fewer than {}: move the light where it and two others "
          "see it at a time.",
          name, common, kFewestSeen));
}

class Builder {
 public:
  Builder(const Tracks& tracks, bool is_calibrated, double limit)
      : tracks_(tracks),
        is_calibrated_(is_calibrated),
        limit_(limit),
        projections_(tracks.size()),
        points_(tracks.front().size()) {}

  void begin(const EpipolarGeometry& pair) {
    const Matrix34 motion = nearest_motion(tracks_, pair);
    projections_[pair.a] = Matrix34::Identity();
    projections_[pair.b] = is_calibrated_ ? motion : near_motion(pair.fundamental, motion);
    update_points();
  }

  // The camera that has seen most of the points that are known.
  [[nodiscard]] std::optional<std::size_t> next() const {
    std::optional<std::size_t> best;
    std::size_t most = 0;
    for (std::size_t c = 0; c < tracks_.size(); ++c) {
      if (projections_[c]) continue;
      const std::size_t count = seen(c, false).size();
      if (!best || count > most) best = c;
      most = std::max(most, count);
    }
    return best;
  }

  [[nodiscard]] bool add(std::size_t camera) {
    projections_[camera] = resect(seen(camera, false), limit_);
    if (!projections_[camera]) return false;
    if (is_calibrated_) projections_[camera] = to_motion(*projections_[camera]);
    update_points();
    return true;
  }

  // All cameras by all points, all points by all cameras.
  void sweep() {
    for (std::size_t c = 0; c < tracks_.size(); ++c) {
      const std::vector<SeenPoint> points = seen(c, true);
      if (points.size() < kFewestSeen) continue;
      projections_[c] = resect_all(points);
      if (is_calibrated_) projections_[c] = to_motion(*projections_[c]);
    }
    update_points();
  }

  [[nodiscard]] std::size_t common(std::size_t camera) const { return seen(camera, false).size(); }

  [[nodiscard]] LinearReconstruction take() {
    LinearReconstruction result;
    for (const auto& projection : projections_) result.projections.push_back(*projection);
    return triangulate_all(tracks_, std::move(result.projections), limit_);
  }

 private:
  [[nodiscard]] std::vector<SeenPoint> seen(std::size_t camera, bool agreeing) const {
    std::vector<SeenPoint> points;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!points_[i] || !tracks_[camera][i]) continue;
      if (agreeing && !agrees_[camera][i]) continue;
      points.push_back({*points_[i], *tracks_[camera][i]});
    }
    return points;
  }

  void update_points() {
    Tracks placed = tracks_;
    std::vector<Matrix34> projections(tracks_.size(), Matrix34::Zero());
    for (std::size_t c = 0; c < tracks_.size(); ++c) {
      if (projections_[c]) {
        projections[c] = *projections_[c];
      } else {
        placed[c].assign(placed[c].size(), std::nullopt);
      }
    }
    LinearReconstruction now = triangulate_all(placed, std::move(projections), limit_);
    points_ = std::move(now.points);
    agrees_ = std::move(now.agrees);
  }

  const Tracks& tracks_;
  bool is_calibrated_;
  double limit_;  // px
  std::vector<std::optional<Matrix34>> projections_;
  std::vector<std::optional<Eigen::Vector4d>> points_;
  std::vector<std::vector<bool>> agrees_;
};

}  // namespace

LinearReconstruction triangulate_all(const Tracks& tracks, std::vector<Matrix34> projections,
                                     double limit) {
  LinearReconstruction result;
  const std::size_t instants = tracks.front().size();
  result.projections = std::move(projections);
  result.points.resize(instants);
  result.agrees.assign(tracks.size(), std::vector<bool>(instants, false));
  for (std::size_t i = 0; i < instants; ++i) {
    std::vector<Ray> rays;
    for (std::size_t c = 0; c < tracks.size(); ++c) {
      if (!tracks[c][i]) continue;
      rays.push_back({c, result.projections[c], tracks[c][i]->at, tracks[c][i]->scale});
    }
    const auto point = agreed_point(rays, limit);
    if (!point) continue;
    result.points[i] = point->at;
    for (std::size_t k = 0; k < rays.size(); ++k) {
      result.agrees[rays[k].camera][i] = point->agree[k];
    }
  }
  return result;
}

tl::unexpected<Error> light_in_a_plane() {
  return make_error(ErrorCode::kDegenerate,
                    "The light has stayed in one plane, or the cameras stand at one place, so that "
                    "their geometry is not determined: move it towards the cameras and away from "
                    "them too, all over the room.");
}

Result<std::vector<EpipolarGeometry>> ranked_pairs(const Tracks& tracks,
                                                   const std::vector<std::string>& names,
                                                   double limit) {
  std::vector<EpipolarGeometry> pairs = all_pairs(tracks, limit);
  if (pairs.empty()) return no_pair(names);
  std::ranges::stable_sort(pairs, std::greater(), [](const EpipolarGeometry& pair) {
    return static_cast<double>(pair.instants.size()) * (1 - pair.planar);
  });
  if (pairs.front().planar > kPlanar) return light_in_a_plane();
  return pairs;
}

Result<LinearReconstruction> reconstruct(const Tracks& tracks, const EpipolarGeometry& first,
                                         const std::vector<std::string>& names, bool is_calibrated,
                                         double limit) {
  constexpr int kSweeps = 8;
  Builder builder(tracks, is_calibrated, limit);
  builder.begin(first);
  while (const auto camera = builder.next()) {
    if (!builder.add(*camera)) return no_overlap(names[*camera], builder.common(*camera));
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) builder.sweep();
  return builder.take();
}

}  // namespace calvin::rig
