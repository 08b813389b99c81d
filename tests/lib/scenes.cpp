// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Random cameras and poses, what is seen of a board, and the error of an estimate in units of its
// predicted standard deviation.

#include "scenes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace calvin::scenes {

bool full_count() {
  const char* text = std::getenv("CALVIN_FULL");
  return text != nullptr && std::string_view(text) == "1";
}

Camera random_camera(std::string_view model, Random& random, ImageSize size) {
  const auto draw = [&random](double low, double high) { return uniform(random, low, high); };
  const LensTraits& lens = *find_lens(model);
  const double fx = size.width * (lens.perspective ? draw(0.8, 1.2) : draw(0.28, 0.36));
  std::vector<double> p = {fx, fx * draw(0.997, 1.003), size.width * draw(0.48, 0.52),
                           size.height * draw(0.48, 0.52)};
  for (const auto& [low, high] : lens.typical) p.push_back(draw(low, high));
  // As many draws for brown4 as for brown5: the poses that follow are the same.
  if (model == "brown4") draw(0, 1);
  // Of a wide lens, 90 degrees from the axis are as far off as through an equidistant one, which it
  // is by itself where its coefficients are about 0.
  const auto about_zero = [](const CoefficientRange& r) { return r.low < 0 && r.high > 0; };
  if (!lens.perspective && !std::ranges::all_of(lens.typical, about_zero)) {
    std::vector<double> unit = {1, 1, 0, 0};
    unit.insert(unit.end(), p.begin() + 4, p.end());
    const double half = Camera::make(model, size, unit)->project({1, 0, 0}).value().u;
    p[0] *= std::numbers::pi / 2 / half;
    p[1] *= std::numbers::pi / 2 / half;
  }
  return Camera::make(model, size, p).value();
}

bool sees_all(const Camera& camera, const Board& board, const SE3& camera_from_board) {
  for (const Eigen::Vector3d& point : board.points()) {
    const auto at = camera.project(camera_from_board * point);
    if (!at || at->u < 0 || at->v < 0 || at->u > camera.image_size().width - 1 ||
        at->v > camera.image_size().height - 1) {
      return false;
    }
  }
  return true;
}

SE3 random_pose(const Camera& camera, const Board& board, Random& random, double tilt) {
  const BoardArea area = board.extent();
  const Eigen::Vector3d center((area.left + area.right) / 2, (area.top + area.bottom) / 2, 0);
  for (;;) {
    const ImageSize size = camera.image_size();
    const auto ray =
        camera.unproject({uniform(random, 0, size.width - 1), uniform(random, 0, size.height - 1)});
    if (!ray) continue;
    const double extent = uniform(random, 0.25, 0.8) * size.width;
    const double distance = camera.fx() * area.width() / extent;
    const double side = uniform(random, 0, 2 * std::numbers::pi);
    const Eigen::Matrix3d facing = rotation_between(Eigen::Vector3d::UnitZ(), *ray);
    const Eigen::Matrix3d rotation = facing *
                                     exp_so3({tilt * std::cos(side), tilt * std::sin(side), 0}) *
                                     exp_so3({0, 0, uniform(random, -0.5, 0.5)});
    SE3 pose = {rotation, *ray * distance - rotation * center};
    if (sees_all(camera, board, pose)) return pose;
  }
}

std::vector<SE3> random_poses(const Camera& camera, const Board& board, Random& random, int count,
                              double max_tilt) {
  std::vector<SE3> poses;
  for (int i = 0; i < count; ++i) {
    poses.push_back(random_pose(camera, board, random, uniform(random, 0, max_tilt)));
  }
  return poses;
}

View observe(const Camera& camera, const Board& board, const SE3& camera_from_board, double sigma,
             Random& random) {
  std::normal_distribution<double> noise(0, 1);
  View view;
  view.board = board;
  view.observation.board = board.text();
  view.observation.image_size = camera.image_size();
  view.observation.ids = board.ids();
  for (const Eigen::Vector3d& point : board.points()) {
    const Pixel at = camera.project(camera_from_board * point).value();
    view.observation.uv.push_back({at.u + sigma * noise(random), at.v + sigma * noise(random)});
    view.observation.sigma.push_back(sigma > 0 ? sigma : 1);
  }
  return view;
}

std::vector<View> observe_all(const Camera& camera, const Board& board,
                              const std::vector<SE3>& poses, double sigma, Random& random) {
  std::vector<View> views;
  for (const SE3& pose : poses) {
    views.push_back(observe(camera, board, pose, sigma, random));
    views.back().observation.timestamp = 1000 * views.size();
  }
  return views;
}

double normalised_error(const Calibration& calibration, const Camera& truth) {
  std::vector<double> error;
  for (std::size_t i = 0; i < truth.parameters().size(); ++i) {
    if (calibration.parameters[i].sigma) {
      error.push_back(calibration.parameters[i].value - truth.parameters()[i]);
    }
  }
  const auto n = static_cast<Eigen::Index>(error.size());
  const Eigen::MatrixXd c = Eigen::Map<const Eigen::MatrixXd>(calibration.covariance.data(), n, n);
  const Eigen::VectorXd e = Eigen::Map<const Eigen::VectorXd>(error.data(), n);
  const Eigen::VectorXd sigma = c.diagonal().cwiseSqrt();
  const Eigen::MatrixXd correlation =
      sigma.cwiseInverse().asDiagonal() * c * sigma.cwiseInverse().asDiagonal();
  const Eigen::VectorXd scaled = e.cwiseQuotient(sigma);
  return scaled.dot(correlation.ldlt().solve(scaled)) / static_cast<double>(n);
}

}  // namespace calvin::scenes
