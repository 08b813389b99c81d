// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Puts the shapes of a scene into the buffer of a GLB, and says in JSON where each is (Khronos
// Group, glTF 2.0 Specification, 2021).

#include "calvin/draw/scene/scene_gltf.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "calvin/geometry/se3.hpp"
#include "calvin/io/node_map.hpp"

namespace calvin {

namespace {

using io::integer_node;
using io::list_node;
using io::Node;
using io::NodeMap;
using io::text_node;

// Numbers that the specification gives.
constexpr int kFloat = 5126;
constexpr int kArrayBuffer = 34962;
constexpr int kLineLoop = 2;
constexpr int kLineStrip = 3;
constexpr int kTriangles = 4;

void put_u32(std::string& bytes, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) {
    bytes += static_cast<char>(static_cast<unsigned char>(value >> shift));
  }
}

Node list_of(std::vector<Node> items) { return {Node::Kind::kList, {}, {}, std::move(items)}; }

// Around its first corner: the faces of a scene are convex, or nearly so.
std::vector<Eigen::Vector3d> triangles_of(const std::vector<Eigen::Vector3d>& corners) {
  std::vector<Eigen::Vector3d> all;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    all.insert(all.end(), {corners[0], corners[i - 1], corners[i]});
  }
  return all;
}

class GltfMaker {
 public:
  explicit GltfMaker(const Scene& scene) : scene_(scene) {
    for (const ScenePath& path : scene.paths) add_path(path);
    for (const SceneLabel& label : scene.labels) add_label(label);
  }

  // Both chunks, each filled up to four bytes.
  std::string take() {
    std::string json = io::print_json(document());
    json.resize((json.size() + 3) / 4 * 4, ' ');
    buffer_.resize((buffer_.size() + 3) / 4 * 4, '\0');
    std::string bytes = "glTF";
    put_u32(bytes, 2);
    put_u32(bytes, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer_.size()));
    put_u32(bytes, static_cast<std::uint32_t>(json.size()));
    bytes += "JSON" + json;
    put_u32(bytes, static_cast<std::uint32_t>(buffer_.size()));
    bytes.append("BIN\0", 4);
    return bytes + buffer_;
  }

 private:
  // One colour, as a material and a mesh.
  struct Mesh {
    SceneColour colour;
    std::vector<Node> primitives;
  };

  void add_path(const ScenePath& path) {
    if (path.points.size() < (path.is_filled ? 3U : 2U)) return;
    const int mode = path.is_filled ? kTriangles : (path.is_closed ? kLineLoop : kLineStrip);
    const std::size_t mesh = mesh_of(path.colour);
    const std::size_t accessor =
        add_points(path.is_filled ? triangles_of(path.points) : path.points);
    meshes_[mesh].primitives.push_back(
        NodeMap()
            .put("attributes", NodeMap().put("POSITION", integer_node(accessor)).take())
            .put("material", integer_node(mesh))
            .put("mode", integer_node(mode))
            .take());
  }

  std::size_t mesh_of(const SceneColour& colour) {
    const auto same = [&](const Mesh& mesh) {
      return mesh.colour.red == colour.red && mesh.colour.green == colour.green &&
             mesh.colour.blue == colour.blue && mesh.colour.alpha == colour.alpha;
    };
    const auto known = std::ranges::find_if(meshes_, same);
    if (known != meshes_.end()) return static_cast<std::size_t>(known - meshes_.begin());
    meshes_.push_back({colour, {}});
    return meshes_.size() - 1;
  }

  // The number of the accessor.
  std::size_t add_points(const std::vector<Eigen::Vector3d>& points) {
    Eigen::Vector3f least = Eigen::Vector3f::Constant(std::numeric_limits<float>::max());
    Eigen::Vector3f most = -least;
    const std::size_t offset = buffer_.size();
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3f p = point.cast<float>();
      least = least.cwiseMin(p);
      most = most.cwiseMax(p);
      for (int k = 0; k < 3; ++k) put_u32(buffer_, std::bit_cast<std::uint32_t>(p[k]));
    }
    accessors_.push_back(NodeMap()
                             .put("bufferView", integer_node(0))
                             .put("byteOffset", integer_node(offset))
                             .put("componentType", integer_node(kFloat))
                             .put("count", integer_node(points.size()))
                             .put("type", text_node("VEC3"))
                             .put("min", list_node(std::array{least.x(), least.y(), least.z()}))
                             .put("max", list_node(std::array{most.x(), most.y(), most.z()}))
                             .take());
    return accessors_.size() - 1;
  }

  void add_label(const SceneLabel& label) {
    labels_.push_back(
        NodeMap()
            .put("name", text_node(label.text))
            .put("translation", list_node(std::array{label.at.x(), label.at.y(), label.at.z()}))
            .take());
  }

  static Node material_of(const SceneColour& colour) {
    // Colours of pictures are sRGB, those of materials linear.
    const auto linear = [](double c) {
      return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    };
    return NodeMap()
        .put("pbrMetallicRoughness",
             NodeMap()
                 .put("baseColorFactor",
                      list_node(std::array{linear(colour.red), linear(colour.green),
                                           linear(colour.blue), colour.alpha}))
                 .put("metallicFactor", integer_node(0))
                 .take())
        .put("alphaMode", text_node(colour.alpha < 1 ? "BLEND" : "OPAQUE"))
        .put("doubleSided", {Node::Kind::kPlain, "true", {}, {}})
        .put("extensions", NodeMap().put("KHR_materials_unlit", NodeMap().take()).take())
        .take();
  }

  // The node that has all others, turned so that up is +y.
  Node root(std::size_t children) const {
    const Eigen::Quaterniond q(rotation_between(scene_.up, Eigen::Vector3d::UnitY()));
    std::vector<Node> numbers;
    for (std::size_t i = 1; i <= children; ++i) numbers.push_back(integer_node(i));
    return NodeMap()
        .put("name", text_node("rig"))
        .put("rotation", list_node(std::array{q.x(), q.y(), q.z(), q.w()}))
        .put("children", list_of(std::move(numbers)))
        .take();
  }

  Node document() {
    std::vector<Node> meshes;
    std::vector<Node> materials;
    std::vector<Node> nodes = {root(meshes_.size() + labels_.size())};
    for (std::size_t i = 0; i < meshes_.size(); ++i) {
      materials.push_back(material_of(meshes_[i].colour));
      meshes.push_back(
          NodeMap().put("primitives", list_of(std::move(meshes_[i].primitives))).take());
      nodes.push_back(NodeMap().put("mesh", integer_node(i)).take());
    }
    for (Node& label : labels_) nodes.push_back(std::move(label));
    NodeMap all;
    all.put("asset", NodeMap()
                         .put("version", text_node("2.0"))
                         .put("generator", text_node("gst-calvin"))
                         .take());
    all.put("extensionsUsed", list_of({text_node("KHR_materials_unlit")}));
    all.put("scene", integer_node(0));
    all.put("scenes", list_of({NodeMap().put("nodes", list_of({integer_node(0)})).take()}));
    all.put("nodes", list_of(std::move(nodes)));
    if (meshes.empty()) return all.take();  // an empty list is none in glTF
    all.put("meshes", list_of(std::move(meshes)));
    all.put("materials", list_of(std::move(materials)));
    all.put("accessors", list_of(std::move(accessors_)));
    all.put("bufferViews", list_of({NodeMap()
                                        .put("buffer", integer_node(0))
                                        .put("byteLength", integer_node(buffer_.size()))
                                        .put("target", integer_node(kArrayBuffer))
                                        .take()}));
    all.put("buffers", list_of({NodeMap().put("byteLength", integer_node(buffer_.size())).take()}));
    return all.take();
  }

  const Scene& scene_;
  std::vector<Mesh> meshes_;
  std::vector<Node> accessors_;
  std::vector<Node> labels_;
  std::string buffer_;
};

}  // namespace

std::string print_glb(const Scene& scene) { return GltfMaker(scene).take(); }

}  // namespace calvin
