// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rigs in the files of other programs: any rig to be written, and formulas that are none of ours.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/rig.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/rig_io.hpp"
#include "scenes.hpp"

namespace calvin::test {

inline void put(const std::string& path, const std::string& text) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream(path) << text;
}

inline std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// A text in which `from` became `to`, and words of what is said of it.
struct BrokenText {
  const char* from;
  const char* to;
  const char* words;
};

// Each of them, written to `path`, keeps the folder that it is in from being a rig, and is named in
// what is said of that.
inline void expect_broken(const std::string& path, const std::string& text,
                          std::span<const BrokenText> changes, const char* named = "") {
  for (const BrokenText& change : changes) {
    put(path, with(text, change.from, change.to));
    const auto read = read_rig(std::filesystem::path(path).parent_path());
    ASSERT_FALSE(read.has_value()) << change.words;
    EXPECT_NE(read.error().message.find(change.words), std::string::npos) << read.error().message;
    EXPECT_NE(read.error().message.find(named), std::string::npos) << read.error().message;
    // Whatever its numbers are, the caller's arguments are right.
    EXPECT_NE(read.error().code, ErrorCode::kInvalidArgument) << read.error().message;
  }
}

// Cameras of these models in any places, of which none is the frame of the rig.
inline Rig random_rig(const std::vector<const char*>& models, std::uint64_t seed) {
  scenes::Random random(seed);
  Rig rig;
  for (const char* model : models) {
    RigCamera camera;
    camera.calibration = scenes::random_camera(model, random).to_calibration();
    camera.calibration.camera = "the " + std::string(model);
    const auto some = [&] { return scenes::uniform(random, -1, 1); };
    camera.rig_from_camera = to_pose({exp_so3({some(), some(), some()}), {some(), some(), some()}});
    rig.cameras.push_back(camera);
  }
  rig.world = kReferenceWorld;
  return rig;
}

// Points before each camera have the same pixels.
inline void expect_same(const Rig& before, const Rig& after) {
  ASSERT_EQ(after.cameras.size(), before.cameras.size());
  for (std::size_t n = 0; n < before.cameras.size(); ++n) {
    const Camera camera = Camera::make(before.cameras[n].calibration).value();
    const Camera other = Camera::make(after.cameras[n].calibration).value();
    EXPECT_EQ(other.image_size(), camera.image_size());
    EXPECT_EQ(other.model(), camera.model());
    const SE3 rig_from_camera = to_se3(before.cameras[n].rig_from_camera);
    const SE3 other_from_rig = to_se3(after.cameras[n].rig_from_camera).inverse();
    for (const double x : {-0.3, 0.1, 0.35}) {
      for (const double y : {-0.2, 0.25}) {
        const Eigen::Vector3d point(x, y, 1);
        const auto at = camera.project(point);
        const auto then = other.project(other_from_rig * (rig_from_camera * point));
        ASSERT_TRUE(at && then) << camera.model();
        EXPECT_NEAR(then->u, at->u, 1e-9) << camera.model();
        EXPECT_NEAR(then->v, at->v, 1e-9) << camera.model();
      }
    }
  }
}

// The pixel of a ray (x, y, 1) by OpenCV's formulas: fx fy cx cy, and its coefficients.
inline Pixel brown(double x, double y, const std::vector<double>& p) {
  const double r = x * x + y * y;
  const double k3 = p.size() > 8 ? p[8] : 0;
  const double below = p.size() > 8 ? 1 + p[9] * r + p[10] * r * r + p[11] * r * r * r : 1;
  const double radial = (1 + p[4] * r + p[5] * r * r + k3 * r * r * r) / below;
  const double u = x * radial + 2 * p[6] * x * y + p[7] * (r + 2 * x * x);
  const double v = y * radial + 2 * p[7] * x * y + p[6] * (r + 2 * y * y);
  return {p[0] * u + p[2], p[1] * v + p[3]};
}

inline Pixel fisheye(double x, double y, const std::vector<double>& p) {
  const double r = std::hypot(x, y);
  const double t = std::atan(r);
  const double d = t * (1 + p[4] * t * t + p[5] * std::pow(t, 4) + p[6] * std::pow(t, 6) +
                        p[7] * std::pow(t, 8));
  return {p[0] * x * d / r + p[2], p[1] * y * d / r + p[3]};
}

}  // namespace calvin::test
