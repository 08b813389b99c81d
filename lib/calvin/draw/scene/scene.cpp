// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Makes the shapes of a scene out of the poses and lenses of a rig.

#include "calvin/draw/scene/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "calvin/camera/camera.hpp"
#include "calvin/draw/scene/scene_boards.hpp"
#include "calvin/geometry/se3.hpp"

namespace calvin {

namespace {

constexpr std::array<SceneColour, 8> kColours = {{{0.36, 0.72, 1.00},
                                                  {1.00, 0.66, 0.30},
                                                  {0.48, 0.86, 0.52},
                                                  {0.96, 0.48, 0.56},
                                                  {0.76, 0.62, 1.00},
                                                  {0.98, 0.86, 0.40},
                                                  {0.42, 0.86, 0.84},
                                                  {0.92, 0.60, 0.86}}};
constexpr SceneColour kGridColour = {0.62, 0.68, 0.76, 0.28};
constexpr SceneColour kAxisColours[] = {{0.95, 0.32, 0.30}, {0.42, 0.82, 0.36}, {0.36, 0.54, 1.0}};
constexpr SceneColour kWhite = {0.93, 0.95, 0.97};

constexpr double kLeastRadius = 0.02;   // m
constexpr double kFrustum = 0.30;       // of the size of marks
constexpr double kAxis = 0.30;          // likewise
constexpr double kLargestError = 0.08;  // likewise, of an ellipsoid

SceneColour with_alpha(SceneColour colour, double alpha) {
  colour.alpha = alpha;
  return colour;
}

bool is_of_board(const Rig& rig) { return rig.world == kBoardWorld; }

// The largest of 1, 2 and 5 times a power of ten that is not above a number.
double round_below(double number) {
  const double power = std::pow(10.0, std::floor(std::log10(number)));
  const double digit = number / power;
  return power * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}

std::string text_of(double length, bool is_metric) {
  if (!is_metric) return fmt::format("{:g}, without a unit", length);
  if (length >= 1) return fmt::format("{:g} m", length);
  return length >= 0.01 ? fmt::format("{:g} cm", 100 * length)
                        : fmt::format("{:g} mm", 1000 * length);
}

// Away from the board, to where the cameras are that have seen it. Of a board that is -z, and where
// its axes were turned the one with all of them.
Eigen::Vector3d up_of_board(const Rig& rig) {
  constexpr double kSides[] = {-1, 1};
  for (const int axis : {2, 1, 0}) {
    for (const double side : kSides) {
      const bool has_all = std::ranges::all_of(rig.cameras, [&](const RigCamera& camera) {
        return side * camera.rig_from_camera.translation[static_cast<std::size_t>(axis)] > 0;
      });
      if (has_all) return side * Eigen::Vector3d::Unit(axis);
    }
  }
  return -Eigen::Vector3d::UnitZ();
}

// Against the mean of where the cameras' pictures have their lower sides, or away from the board.
Eigen::Vector3d up_of(const Rig& rig) {
  if (is_of_board(rig)) return up_of_board(rig);
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const RigCamera& camera : rig.cameras) up -= to_se3(camera.rig_from_camera).rotation.col(1);
  return up.norm() > 1e-3 ? Eigen::Vector3d(up.normalized()) : -Eigen::Vector3d::UnitY();
}

// The part of a direction that lies in the ground, of unit length; any one where there is none.
Eigen::Vector3d level(const Eigen::Vector3d& direction, const Eigen::Vector3d& up) {
  const Eigen::Vector3d flat = direction - direction.dot(up) * up;
  if (flat.norm() > 0.3) return flat.normalized();
  const Eigen::Vector3d any =
      std::abs(up.x()) < 0.8 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  return (any - any.dot(up) * up).normalized();
}

// Against where the cameras look on average.
Eigen::Vector3d behind(const Rig& rig, const Eigen::Vector3d& up) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const RigCamera& camera : rig.cameras) sum -= to_se3(camera.rig_from_camera).rotation.col(2);
  return level(sum / std::max<double>(1, static_cast<double>(rig.cameras.size())), up);
}

// The ray of a pixel, or of the farthest one on the way to it from the centre that has one.
std::optional<Eigen::Vector3d> ray_towards(const Camera& camera, Pixel at) {
  constexpr int kHalvings = 12;  // to a fraction of a pixel
  const Pixel centre = image_center(camera.image_size());
  const auto ray_at = [&](double t) {
    return camera.unproject({std::lerp(centre.u, at.u, t), std::lerp(centre.v, at.v, t)});
  };
  if (const auto whole = ray_at(1)) return whole;
  double has = 0;
  double lacks = 1;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (has + lacks);
    (ray_at(middle) ? has : lacks) = middle;
  }
  return ray_at(has);
}

// The rays through the border of a picture, clockwise from the upper left, camera frame.
std::vector<Eigen::Vector3d> border_rays(const Camera& camera) {
  constexpr int kSteps = 16;  // of each side
  const ImageSize size = camera.image_size();
  const double right = size.width - 1;
  const double bottom = size.height - 1;
  const std::array<Pixel, 5> corners = {{{0, 0}, {right, 0}, {right, bottom}, {0, bottom}, {0, 0}}};
  std::vector<Eigen::Vector3d> rays;
  for (std::size_t side = 0; side < 4; ++side) {
    for (int i = 0; i < kSteps; ++i) {
      const double t = i / static_cast<double>(kSteps);
      const auto ray = ray_towards(camera, {std::lerp(corners[side].u, corners[side + 1].u, t),
                                            std::lerp(corners[side].v, corners[side + 1].v, t)});
      if (ray) rays.push_back(*ray);
    }
  }
  return rays;
}

// Rays as long as to a plane in front of the camera; all of one length where some are so far aside
// that the plane would be endless.
void cut(std::vector<Eigen::Vector3d>& rays, double depth) {
  constexpr double kWide = 0.45;     // cosine, from the axis
  constexpr double kShorter = 0.65;  // so that it hides no more than others
  const bool is_wide =
      std::ranges::any_of(rays, [](const Eigen::Vector3d& ray) { return ray.z() < kWide; });
  for (Eigen::Vector3d& ray : rays) ray *= is_wide ? kShorter * depth : depth / ray.z();
}

// Of a file that does not say the size of its pictures they are drawn about the principal point.
Result<Camera> drawn_camera(Calibration calibration) {
  if (calibration.image_size == ImageSize{}) {
    const Parameter* cx = calibration.find("cx");
    const Parameter* cy = calibration.find("cy");
    const auto length = [](const Parameter* centre) {
      constexpr double kMost = 1e5;  // px
      return static_cast<int>(
          std::clamp(centre == nullptr ? 0 : 2 * centre->value + 1, 2.0, kMost));
    };
    calibration.image_size = {length(cx), length(cy)};
  }
  return Camera::make(calibration);
}

class SceneMaker {
 public:
  explicit SceneMaker(const Rig& rig) : rig_(rig) {
    scene_.up = up_of(rig);
    scene_.behind = behind(rig, scene_.up);
    for (const RigCamera& camera : rig.cameras) {
      places_.push_back(to_se3(camera.rig_from_camera).translation);
    }
    if (is_of_board(rig) || places_.empty()) places_.emplace_back(Eigen::Vector3d::Zero());
    size_ = size_of_marks();
  }

  Scene make() {
    for (std::size_t c = 0; c < rig_.cameras.size(); ++c) add_camera(c);
    add_boards(rig_, scene_);
    add_ellipsoids();
    add_axes();
    find_radius();
    add_ground();
    add_notes();
    return std::move(scene_);
  }

 private:
  void add_path(std::vector<Eigen::Vector3d> points, SceneColour colour, double width,
                bool is_closed, bool is_filled) {
    scene_.paths.push_back({std::move(points), colour, width, is_closed, is_filled});
  }

  [[nodiscard]] static double radius_of(const std::vector<Eigen::Vector3d>& points) {
    const Eigen::Vector3d middle = mean_of(points);
    double radius = kLeastRadius;
    for (const Eigen::Vector3d& p : points) radius = std::max(radius, (p - middle).norm());
    return radius;
  }

  [[nodiscard]] static Eigen::Vector3d mean_of(const std::vector<Eigen::Vector3d>& points) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : points) sum += p;
    return sum / static_cast<double>(points.size());
  }

  // As large as the place of the cameras; where they are close together and boards far away, as
  // large as can be seen beside these without hiding the next camera.
  [[nodiscard]] double size_of_marks() const {
    constexpr double kLargestMark = 0.22;  // of the whole scene
    constexpr double kApart = 0.75;        // of the distance to the nearest camera
    std::vector<Eigen::Vector3d> all = places_;
    for (const RigBoard& board : rig_.boards) {
      all.push_back(to_se3(board.rig_from_board).translation);
    }
    double nearest = radius_of(all);
    for (std::size_t i = 0; i < rig_.cameras.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        nearest = std::min(nearest, (places_[i] - places_[j]).norm());
      }
    }
    return std::max(radius_of(places_),
                    std::min(kLargestMark * radius_of(all), kApart * nearest) / kFrustum);
  }

  // Where the camera looks: as far as to what it looks at.
  void add_axis(const SE3& pose, SceneColour colour) {
    std::vector<Eigen::Vector3d> boards;
    for (const RigBoard& board : rig_.boards) {
      boards.push_back(to_se3(board.rig_from_board).translation);
    }
    const Eigen::Vector3d looked_at = mean_of(boards.empty() ? places_ : boards);
    const Eigen::Vector3d ahead = pose.rotation.col(2);
    const double far = std::max(ahead.dot(looked_at - pose.translation), 1.6 * kFrustum * size_);
    add_path({pose.translation, pose.translation + far * ahead}, with_alpha(colour, 0.35), 1, false,
             false);
  }

  void add_camera(std::size_t number) {
    const RigCamera& camera = rig_.cameras[number];
    const SceneColour colour = kColours[number % kColours.size()];
    const SE3 pose = to_se3(camera.rig_from_camera);
    scene_.labels.push_back({pose.translation, camera.calibration.camera, colour});
    const auto lens = drawn_camera(camera.calibration);
    if (!lens) return;
    add_axis(pose, colour);
    auto border = border_rays(*lens);
    if (border.size() < 4) return;
    cut(border, kFrustum * size_);
    for (Eigen::Vector3d& point : border) point = pose * point;
    add_path(border, with_alpha(colour, 0.16), 1, true, true);
    add_path(border, with_alpha(colour, 0.95), 1.6, true, false);
    const std::size_t side = border.size() / 4;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const Eigen::Vector3d& a = border[corner * side];
      const Eigen::Vector3d& b = border[(corner + 1) * side % border.size()];
      add_path({pose.translation, a, b}, with_alpha(colour, 0.07), 1, true, true);
      add_path({pose.translation, a}, with_alpha(colour, 0.9), 1.3, false, false);
    }
    // The upper side of the picture has a gable, as the finder of a camera.
    const Eigen::Vector3d upper = 0.5 * (border.front() + border[side]);
    const Eigen::Vector3d gable = upper - 0.25 * kFrustum * size_ * pose.rotation.col(1);
    const Eigen::Vector3d aside = 0.22 * (border[side] - border.front());
    add_path({upper - aside, gable, upper + aside}, with_alpha(colour, 0.55), 1, true, true);
  }

  // 1 sigma of the place of a camera, by its axes; absent where it is not known.
  [[nodiscard]] std::optional<Eigen::Matrix3d> error_of(const RigCamera& camera) const {
    if (camera.covariance.size() != 36) return std::nullopt;
    const Eigen::Map<const Eigen::Matrix<double, 6, 6>> all(camera.covariance.data());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(all.bottomRightCorner<3, 3>());
    if (axes.info() != Eigen::Success) return std::nullopt;
    return axes.eigenvectors() * axes.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  }

  // All by one round factor, so that the largest can be seen and hides nothing.
  void add_ellipsoids() {
    double largest = 0;
    for (const RigCamera& camera : rig_.cameras) {
      if (const auto error = error_of(camera)) {
        largest = std::max(largest, error->colwise().norm().maxCoeff());
      }
    }
    if (!(largest > 0)) return;
    const double most = kLargestError * size_ / largest;
    const double factor = std::max(1.0, round_below(most));
    for (std::size_t c = 0; c < rig_.cameras.size(); ++c) {
      const auto error = error_of(rig_.cameras[c]);
      if (!error) continue;
      const Eigen::Vector3d at = to_se3(rig_.cameras[c].rig_from_camera).translation;
      for (int axis = 0; axis < 3; ++axis) {
        constexpr int kSteps = 32;
        std::vector<Eigen::Vector3d> ellipse;
        for (int i = 0; i < kSteps; ++i) {
          const double angle = 2 * std::numbers::pi * i / kSteps;
          ellipse.emplace_back(at + factor * (std::cos(angle) * error->col(axis) +
                                              std::sin(angle) * error->col((axis + 1) % 3)));
        }
        add_path(ellipse, with_alpha(kColours[c % kColours.size()], 0.25), 1, true, true);
        add_path(std::move(ellipse), with_alpha(kWhite, 0.8), 1, true, false);
      }
    }
    scene_.notes.push_back(factor > 1
                               ? fmt::format("ellipsoids: 1 sigma of the place, x {:.0f}", factor)
                               : "ellipsoids: 1 sigma of the place");
  }

  void add_axes() {
    constexpr const char* kNames[] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d end = kAxis * size_ * Eigen::Vector3d::Unit(axis);
      add_path({Eigen::Vector3d::Zero(), end}, kAxisColours[axis], 2.2, false, false);
      scene_.labels.push_back({end, kNames[axis], kAxisColours[axis]});
    }
    if (is_of_board(rig_) && rig_.boards.empty()) {
      scene_.labels.push_back({Eigen::Vector3d::Zero(), "board", kWhite});
    }
  }

  // Around the box that has everything but the ground.
  void find_radius() {
    Eigen::Vector3d least = Eigen::Vector3d::Constant(1e300);
    Eigen::Vector3d most = -least;
    for (const ScenePath& path : scene_.paths) {
      for (const Eigen::Vector3d& p : path.points) {
        least = least.cwiseMin(p);
        most = most.cwiseMax(p);
      }
    }
    scene_.middle = 0.5 * (least + most);
    scene_.radius = 0;
    for (const ScenePath& path : scene_.paths) {
      for (const Eigen::Vector3d& p : path.points) {
        const Eigen::Vector3d from_middle = p - scene_.middle;
        const double height = from_middle.dot(scene_.up);
        scene_.radius = std::max(scene_.radius, from_middle.norm());
        scene_.rims.emplace_back((from_middle - height * scene_.up).norm(), height);
      }
    }
  }

  // Below everything, or the plane of the board.
  void add_ground() {
    double lowest = is_of_board(rig_) ? 0 : 1e300;
    for (const ScenePath& path : scene_.paths) {
      for (const Eigen::Vector3d& p : path.points) {
        if (!is_of_board(rig_)) lowest = std::min(lowest, p.dot(scene_.up));
      }
    }
    const double step = round_below(scene_.radius / 5);
    const Eigen::Vector3d& x = scene_.behind;
    const Eigen::Vector3d y = scene_.up.cross(x);
    const Eigen::Vector3d middle =
        scene_.middle + (lowest - scene_.middle.dot(scene_.up)) * scene_.up;
    const int lines = static_cast<int>(std::ceil(scene_.radius / step));
    const double reach = lines * step;
    for (int i = -lines; i <= lines; ++i) {
      const double at = i * step;
      add_path({middle + at * x - reach * y, middle + at * x + reach * y}, kGridColour, 0.8, false,
               false);
      add_path({middle + at * y - reach * x, middle + at * y + reach * x}, kGridColour, 0.8, false,
               false);
    }
    scene_.notes.push_back("grid: " + text_of(step, rig_.is_metric));
  }

  void add_notes() {
    std::string head = fmt::format("{} cameras", rig_.cameras.size());
    if (rig_.rms) head += fmt::format(", rms {:.2f} px", *rig_.rms);
    scene_.notes.insert(scene_.notes.begin(), std::move(head));
  }

  const Rig& rig_;
  Scene scene_;
  std::vector<Eigen::Vector3d> places_;
  double size_ = 1;  // m, of marks: about the radius of the cameras' places
};

}  // namespace

Scene make_scene(const Rig& rig) { return SceneMaker(rig).make(); }

}  // namespace calvin
