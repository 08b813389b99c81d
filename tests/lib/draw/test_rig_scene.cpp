// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The view of a rig: frusta are as wide as the cameras see, everything is in the picture, what is
// up is up, and nothing is drawn beside the picture.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "calvin/draw/scene/scene_picture.hpp"
#include "calvin_config.h"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

using scenes::Random;

Rig rig_of(const scenes::SimulatedRig& simulated) {
  Rig rig;
  for (std::size_t c = 0; c < simulated.cameras.size(); ++c) {
    RigCamera camera;
    camera.calibration = simulated.cameras[c].to_calibration();
    camera.calibration.camera = "cam" + std::to_string(c);
    camera.rig_from_camera =
        to_pose(simulated.world_from_camera[0].inverse() * simulated.world_from_camera[c]);
    if (c > 0) {
      camera.covariance.assign(36, 0.0);
      for (std::size_t i = 0; i < 6; ++i) camera.covariance[7 * i] = 1e-8;
    }
    rig.cameras.push_back(std::move(camera));
  }
  rig.world = "cam0";
  return rig;
}

bool is_of(const ScenePath& path, const SceneColour& colour) {
  return path.colour.red == colour.red && path.colour.green == colour.green &&
         path.colour.blue == colour.blue;
}

// The outline of each camera's picture leads back to the border of its image.
TEST(Scene, HasFrustaAsWideAsTheLens) {
  Random random(1);
  const auto simulated = scenes::stereo_rig(random);
  const Rig rig = rig_of(simulated);
  const Scene scene = make_scene(rig);
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const auto label =
        std::ranges::find(scene.labels, rig.cameras[c].calibration.camera, &SceneLabel::text);
    ASSERT_NE(label, scene.labels.end());
    const SE3 pose = to_se3(rig.cameras[c].rig_from_camera);
    EXPECT_LT((label->at - pose.translation).norm(), 1e-12);
    const auto outline = std::ranges::find_if(scene.paths, [&](const ScenePath& path) {
      return path.is_closed && !path.is_filled && path.points.size() == 64 &&
             is_of(path, label->colour);
    });
    ASSERT_NE(outline, scene.paths.end());
    const ImageSize size = simulated.cameras[c].image_size();
    for (const Eigen::Vector3d& point : outline->points) {
      const auto at = simulated.cameras[c].project(pose.inverse() * point);
      ASSERT_TRUE(at.has_value());
      const double off =
          std::min({std::abs(at->u), std::abs(at->v), std::abs(at->u - size.width + 1),
                    std::abs(at->v - size.height + 1)});
      EXPECT_LT(off, 1e-4);
    }
  }
}

TEST(Scene, IsWhollyInThePictureFromEverywhere) {
  Random random(2);
  for (const auto& simulated :
       {scenes::stereo_rig(random), scenes::ring_rig(8, random), scenes::chain_rig(5, random)}) {
    const Scene scene = make_scene(rig_of(simulated));
    for (double azimuth = 0; azimuth < 6; azimuth += 0.7) {
      for (const double elevation : {-0.3, 0.45, 1.4}) {
        const ImageSize size = {1280, 720};
        const SceneProjection projection(scene, {azimuth, elevation, 1}, size);
        for (const SceneLabel& label : scene.labels) {
          const auto at = projection.project(label.at);
          ASSERT_TRUE(at.has_value());
          EXPECT_GT(at->u, 0);
          EXPECT_GT(at->v, 0);
          EXPECT_LT(at->u, size.width);
          EXPECT_LT(at->v, size.height);
        }
        // Everything but the ground, and not as a stamp in the middle of it.
        double farthest = 0;
        for (const ScenePath& path : scene.paths) {
          if (path.width == 0.8) continue;
          for (const Eigen::Vector3d& point : path.points) {
            const auto at = projection.project(point);
            ASSERT_TRUE(at.has_value());
            farthest = std::max(
                {farthest, std::abs(at->u - 639.5) / 639.5, std::abs(at->v - 359.5) / 359.5});
          }
        }
        EXPECT_LT(farthest, 1);
        EXPECT_GT(farthest, 0.45);
        const auto middle = projection.project(scene.middle);
        EXPECT_NEAR(middle->u, (size.width - 1) / 2.0, 1e-6);
        EXPECT_NEAR(middle->v, (size.height - 1) / 2.0, 1e-6);
        const auto above = projection.project(scene.middle + 0.3 * scene.radius * scene.up);
        EXPECT_LT(above->v, middle->v);
        EXPECT_NEAR(above->u, middle->u, 1e-6);
      }
    }
  }
}

// A pinhole at 38 degrees across the shorter side, by a formula of its own: spherical coordinates
// around the middle, and tangents.
TEST(Scene, IsProjectedAsItsViewpointSays) {
  Random random(6);
  Scene scene = make_scene(rig_of(scenes::ring_rig(5, random)));
  scene.up = Eigen::Vector3d::UnitZ();
  scene.behind = Eigen::Vector3d::UnitX();
  scene.rims.clear();
  const ImageSize size = {1000, 600};
  const SceneViewpoint viewpoint = {0.7, 0.3, 1.5};
  const SceneProjection projection(scene, viewpoint, size);
  const double half = 19 * std::numbers::pi / 180;
  const double distance = scene.radius / std::sin(half) / viewpoint.zoom;
  for (const SceneLabel& label : scene.labels) {
    const Eigen::Vector3d d = label.at - scene.middle;
    // Turned so that whoever looks is on the first axis, then tilted down to the ground.
    const double x = std::cos(0.7) * d.x() + std::sin(0.7) * d.y();
    const double y = -std::sin(0.7) * d.x() + std::cos(0.7) * d.y();
    const double towards = std::cos(0.3) * x + std::sin(0.3) * d.z();
    const double up = -std::sin(0.3) * x + std::cos(0.3) * d.z();
    const double focal = 300 / std::tan(half);
    const auto at = projection.project(label.at);
    ASSERT_TRUE(at.has_value());
    EXPECT_NEAR(at->u, 499.5 + focal * y / (distance - towards), 1e-6);
    EXPECT_NEAR(at->v, 299.5 - focal * up / (distance - towards), 1e-6);
  }
}

// What is partly behind whoever looks is cut, not lost.
TEST(Scene, IsCutInFrontOfWhoeverLooks) {
  Random random(7);
  const Scene scene = make_scene(rig_of(scenes::ring_rig(5, random)));
  const SceneProjection projection(scene, {0.6, 0.45, 1}, {1000, 600});
  // Behind: as far again as the middle is away.
  const auto from = [&](double depth) {
    Eigen::Vector3d ahead;
    for (int k = 0; k < 3; ++k) {
      ahead(k) = projection.depth(scene.middle + Eigen::Vector3d::Unit(k)) -
                 projection.depth(scene.middle);
    }
    return Eigen::Vector3d(scene.middle + (depth - projection.distance()) * ahead);
  };
  ScenePath line;
  line.points = {from(projection.distance()), from(-projection.distance())};
  EXPECT_EQ(projection.project(line).size(), 2U);
  line.points = {from(-1), from(-2)};
  EXPECT_TRUE(projection.project(line).empty());
  ScenePath shape;
  const Eigen::Vector3d aside = 0.1 * scene.up;
  shape.is_closed = true;
  shape.points = {from(projection.distance()), from(projection.distance()) + aside,
                  from(-1) + aside, from(-1)};
  const auto cut = projection.project(shape);
  EXPECT_EQ(cut.size(), 4U);
  for (const Pixel& at : cut) EXPECT_TRUE(std::isfinite(at.u) && std::isfinite(at.v));
}

// Each ellipsoid is as large as the covariance says, by the factor that is to be read.
TEST(Scene, HasEllipsoidsOfOneSigma) {
  Random random(8);
  Rig rig = rig_of(scenes::stereo_rig(random));
  const double sigmas[] = {1e-4, 2e-4, 4e-4};  // m
  rig.cameras[1].covariance.assign(36, 0.0);
  for (std::size_t k = 0; k < 3; ++k) {
    rig.cameras[1].covariance[7 * (3 + k)] = sigmas[k] * sigmas[k];
  }
  const Scene scene = make_scene(rig);
  double factor = 0;
  for (const std::string& note : scene.notes) {
    const auto x = note.find(" x ");
    if (x != std::string::npos) factor = std::stod(note.substr(x + 3));
  }
  ASSERT_GT(factor, 0);
  const Eigen::Vector3d at = to_se3(rig.cameras[1].rig_from_camera).translation;
  Eigen::Vector3d reach = Eigen::Vector3d::Zero();
  for (const ScenePath& path : scene.paths) {
    if (path.points.size() != 32) continue;
    for (const Eigen::Vector3d& p : path.points) reach = reach.cwiseMax((p - at).cwiseAbs());
  }
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(reach(k), factor * sigmas[k], 1e-9);
}

// A sheet of 11 x 8 squares of 25 mm where the board was, in the order of its corners, and half of
// its squares; texts that are no boards are left out.
TEST(Scene, HasBoardsWhereTheyWere) {
  Random random(10);
  Rig rig = rig_of(scenes::stereo_rig(random));
  const Scene without = make_scene(rig);
  const SE3 pose = {exp_so3({0.2, -0.3, 0.1}), {0.05, -0.02, 0.6}};
  rig.boards = {{"checkerboard:9x6:25mm", to_pose(pose)}, {"no board", to_pose(pose)}};
  const Scene scene = make_scene(rig);
  const Board board = parse_board("checkerboard:9x6:25mm").value();
  const BoardArea sheet = board.outline();
  int rims = 0;
  int squares = 0;
  for (const ScenePath& path : scene.paths) {
    if (path.points.size() != 4) continue;
    const double area =
        (path.points[1] - path.points[0]).norm() * (path.points[3] - path.points[0]).norm();
    const bool is_sheet =
        (path.points[0] - pose * Eigen::Vector3d(sheet.left, sheet.top, 0)).norm() < 1e-12 &&
        (path.points[2] - pose * Eigen::Vector3d(sheet.right, sheet.bottom, 0)).norm() < 1e-12;
    rims += is_sheet ? 1 : 0;
    const Eigen::Vector3d own = pose.inverse() * path.points[0];
    squares += std::abs(area - 0.025 * 0.025) < 1e-9 && std::abs(own.z()) < 1e-12 ? 1 : 0;
  }
  EXPECT_EQ(rims, 2);  // filled, and its line
  EXPECT_EQ(squares, 35);
  EXPECT_EQ(std::ranges::count(scene.labels, "board", &SceneLabel::text), 1);
  EXPECT_EQ(scene.labels.size(), without.labels.size() + 1);
}

// The width of the grid is said in a unit where lengths have one.
TEST(Scene, NamesNoUnitWhereThereIsNone) {
  Random random(9);
  Rig rig = rig_of(scenes::ring_rig(5, random));
  const auto grid_of = [](const Scene& scene) {
    const auto note = std::ranges::find_if(
        scene.notes, [](const std::string& text) { return text.starts_with("grid: "); });
    return note == scene.notes.end() ? "" : *note;
  };
  const std::string metric = grid_of(make_scene(rig));
  EXPECT_TRUE(metric.ends_with(" m") || metric.ends_with(" cm")) << metric;
  rig.is_metric = false;
  const std::string without = grid_of(make_scene(rig));
  EXPECT_TRUE(without.ends_with(", without a unit")) << without;
  const double metres = std::stod(metric.substr(6)) * (metric.ends_with(" cm") ? 0.01 : 1);
  EXPECT_EQ(std::stod(without.substr(6)), metres);
}

// Cameras are upright: up in the scene is up in their pictures.
TEST(Scene, StandsAsItsCamerasDo) {
  Random random(3);
  const Rig rig = rig_of(scenes::ring_rig(6, random));
  const Scene scene = make_scene(rig);
  for (const RigCamera& camera : rig.cameras) {
    EXPECT_GT(-to_se3(camera.rig_from_camera).rotation.col(1).dot(scene.up), 0.7);
  }
  Rig floor = rig;
  floor.world = kBoardWorld;
  EXPECT_EQ(make_scene(floor).up, -Eigen::Vector3d::UnitZ());
}

// Any rig has a finite scene: a single camera, cameras in one place, and one that sees behind
// itself.
TEST(Scene, OfOddRigsIsFinite) {
  Random random(4);
  Rig one = rig_of(scenes::stereo_rig(random));
  one.cameras.resize(1);
  Rig same = rig_of(scenes::stereo_rig(random));
  same.cameras[1].rig_from_camera = same.cameras[0].rig_from_camera;
  Rig wide = rig_of(scenes::stereo_rig(random));
  wide.cameras[0].calibration =
      Camera::make("fisheye", {1000, 1000}, {200, 200, 499.5, 499.5, 0.02, 0, 0, 0})
          .value()
          .to_calibration();
  Rig broken = rig_of(scenes::stereo_rig(random));
  broken.cameras[0].calibration.parameters.clear();
  for (const Rig& rig : {one, same, wide, broken, Rig()}) {
    const Scene scene = make_scene(rig);
    EXPECT_TRUE(std::isfinite(scene.radius) && scene.radius > 0);
    for (const ScenePath& path : scene.paths) {
      for (const Eigen::Vector3d& point : path.points) EXPECT_TRUE(point.allFinite());
    }
  }
}

TEST(ScenePicture, IsDrawnWithinItsRows) {
  Random random(5);
  const Scene scene = make_scene(rig_of(scenes::ring_rig(8, random)));
  for (const ImageSize size : {ImageSize{640, 360}, {1919, 1081}, {16, 16}}) {
    const std::ptrdiff_t stride = 4 * size.width + 64;
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(stride * size.height), 0xAB);
    const Status drawn = draw_scene(scene, {}, size, pixels.data(), stride);
#if CALVIN_HAVE_CAIRO
    ASSERT_TRUE(drawn.has_value());
    int bright = 0;
    for (int row = 0; row < size.height; ++row) {
      const std::uint8_t* begin = pixels.data() + row * stride;
      for (int col = 0; col < size.width; ++col) bright += begin[4 * col + 1] > 100 ? 1 : 0;
      for (int i = 4 * size.width; i < stride; ++i) ASSERT_EQ(begin[i], 0xAB) << row;
    }
    EXPECT_GT(bright, size.width > 100 ? 500 : 0);
#else
    EXPECT_EQ(drawn.error().code, ErrorCode::kUnsupported);
#endif
  }
}

}  // namespace
}  // namespace calvin
