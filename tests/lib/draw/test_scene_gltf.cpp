// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The scene of a rig as binary glTF: read here by the words of the specification.
#include <bit>
#include <cstdint>
#include <cstring>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "calvin/core/text.hpp"
#include "calvin/draw/scene/scene_gltf.hpp"
#include "calvin/io/document.hpp"
#include "rectified_pair.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

using io::Node;

std::uint32_t u32(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= std::uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
  }
  return value;
}

struct Glb {
  Node json;
  std::string buffer;
};

Glb open_glb(const std::string& bytes) {
  Glb glb;
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(u32(bytes, 4), 2U);
  EXPECT_EQ(u32(bytes, 8), bytes.size());
  const std::size_t json = u32(bytes, 12);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  EXPECT_EQ(json % 4, 0U);
  const std::size_t buffer = u32(bytes, 20 + json);
  EXPECT_EQ(bytes.substr(24 + json, 4), std::string("BIN\0", 4));
  EXPECT_EQ(28 + json + buffer, bytes.size());
  auto parsed = io::parse_json(bytes.substr(20, json));
  EXPECT_TRUE(parsed.has_value()) << parsed.error().message;
  if (parsed) glb.json = *std::move(parsed);
  glb.buffer = bytes.substr(28 + json);
  return glb;
}

double number(const Node* node) { return parse_double(node->text).value(); }

std::size_t whole(const Node& of, const char* key) {
  return static_cast<std::size_t>(number(of.find(key)));
}

Scene stereo_scene() {
  scenes::Random random(4);
  const Camera camera = scenes::random_camera("brown5", random);
  Rig rig = scenes::rig_of(camera, scenes::random_camera("fisheye", random),
                           {exp_so3({0.1, 0.2, 0.3}), {0.2, 0.05, -0.1}});
  rig.cameras[1].covariance.assign(36, 0.0);
  for (std::size_t i = 0; i < 6; ++i) rig.cameras[1].covariance[7 * i] = 1e-8;
  return make_scene(rig);
}

TEST(Gltf, HasEveryPathOfTheSceneWhereItIs) {
  const Scene scene = stereo_scene();
  const Glb glb = open_glb(print_glb(scene));
  const Node& accessors = *glb.json.find("accessors");
  std::size_t primitives = 0;
  std::multiset<std::size_t> counts;
  for (const Node& mesh : glb.json.find("meshes")->items) {
    for (const Node& primitive : mesh.find("primitives")->items) {
      ++primitives;
      EXPECT_LT(whole(primitive, "material"), glb.json.find("materials")->items.size());
      const Node& accessor = accessors.items.at(whole(*primitive.find("attributes"), "POSITION"));
      const std::size_t count = whole(accessor, "count");
      const std::size_t offset = whole(accessor, "byteOffset");
      ASSERT_LE(offset + 12 * count, glb.buffer.size());
      EXPECT_EQ(offset % 4, 0U);
      for (std::size_t i = 0; i < 3 * count; ++i) {
        const auto value = std::bit_cast<float>(u32(glb.buffer, offset + 4 * i));
        EXPECT_GE(value, static_cast<float>(number(&accessor.find("min")->items[i % 3])));
        EXPECT_LE(value, static_cast<float>(number(&accessor.find("max")->items[i % 3])));
      }
      counts.insert(count);
    }
  }
  EXPECT_EQ(primitives, scene.paths.size());
  for (const ScenePath& path : scene.paths) {
    const std::size_t count = path.is_filled ? 3 * (path.points.size() - 2) : path.points.size();
    const auto found = counts.find(count);
    ASSERT_NE(found, counts.end());
    counts.erase(found);
  }
}

TEST(Gltf, StandsUprightWithItsNames) {
  const Scene scene = stereo_scene();
  const Glb glb = open_glb(print_glb(scene));
  const Node& nodes = *glb.json.find("nodes");
  const Node& root = nodes.items.at(0);
  const auto& q = root.find("rotation")->items;
  const Eigen::Quaterniond turn(number(&q[3]), number(&q[0]), number(&q[1]), number(&q[2]));
  EXPECT_LT((turn * scene.up - Eigen::Vector3d::UnitY()).norm(), 1e-9);
  EXPECT_EQ(root.find("children")->items.size() + 1, nodes.items.size());
  for (const SceneLabel& label : scene.labels) {
    bool is_there = false;
    for (const Node& node : nodes.items) {
      const Node* name = node.find("name");
      if (name == nullptr || name->text != label.text) continue;
      const auto& at = node.find("translation")->items;
      const Eigen::Vector3d place(number(&at[0]), number(&at[1]), number(&at[2]));
      is_there = (place - label.at).norm() < 1e-12;
    }
    EXPECT_TRUE(is_there) << label.text;
  }
}

TEST(Gltf, OfNothingIsAFileWithoutMeshes) {
  const Glb glb = open_glb(print_glb(Scene()));
  EXPECT_EQ(glb.json.find("meshes"), nullptr);
  EXPECT_EQ(glb.json.find("asset")->find("version")->text, "2.0");
}

}  // namespace
}  // namespace calvin
