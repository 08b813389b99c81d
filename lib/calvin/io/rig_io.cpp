// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rig <-> JSON, around the native form of each camera's calibration.

#include "calvin/io/rig_io.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/calibration_formats.hpp"
#include "calvin/io/native_fields.hpp"
#include "calvin/io/text_document.hpp"

namespace calvin {

namespace {

using io::Fields;
using io::Node;

constexpr std::string_view kFormat = "calvin-rig";
constexpr int kVersion = 1;
constexpr std::size_t kPose = 6;

// ---- Reading ------------------------------------------------------------------------------------

// What no rig has: so that whatever is computed of it stays finite.
void check_range(Fields& fields, const RigCamera& camera) {
  constexpr double kFarthest = 1e6;  // m; of a turn, rad
  const auto is_far = [](double x) { return !(std::abs(x) <= kFarthest); };
  if (std::ranges::any_of(camera.rig_from_camera.translation, is_far) ||
      std::ranges::any_of(camera.rig_from_camera.rotation, is_far)) {
    fields.complain("rig_from_camera", "is out of range (1e6 m, 1e6 rad)");
  }
  if (std::ranges::any_of(camera.covariance, [](double x) { return !(std::abs(x) <= 1e12); })) {
    fields.complain("covariance", "is out of range (1e12)");
  }
}

Result<Calibration> read_camera_calibration(const Node& node) {
  auto calibration = io::read_native(node);
  if (!calibration) return calibration;
  if (const auto camera = Camera::make(*calibration); !camera) {
    return tl::unexpected(camera.error());
  }
  return calibration;
}

RigCamera read_rig_camera(Fields fields) {
  RigCamera camera;
  const std::string name = fields.string("camera");
  const Node* node = fields.find("calibration");
  if (node == nullptr || node->kind != Node::Kind::kMap) {
    fields.complain("calibration", "is missing");
    return camera;
  }
  auto calibration = read_camera_calibration(*node);
  if (!calibration) {
    fields.complain("calibration", fmt::format("is wrong: {}", calibration.error().message),
                    calibration.error().code);
    return camera;
  }
  camera.calibration = *std::move(calibration);
  camera.calibration.camera = name;
  camera.rig_from_camera = io::read_pose(fields.map("rig_from_camera"));
  if (const Node* rows = fields.find("covariance"); rows != nullptr && !rows->items.empty()) {
    camera.covariance = io::read_covariance(fields, kPose, "numbers say where a camera is");
  }
  camera.rms = fields.optional_number("rms");
  check_range(fields, camera);
  return camera;
}

void read_cameras(Fields& fields, std::optional<Error>& problem, Rig& rig) {
  constexpr std::size_t kMost = 4096;
  const auto& list = fields.list("cameras");
  if (list.empty()) fields.complain("cameras", "has none");
  if (list.size() > kMost) {
    fields.complain("cameras", fmt::format("has {}; no rig has more than {}", list.size(), kMost));
  }
  for (std::size_t i = 0; i < list.size() && !fields.failed(); ++i) {
    if (list[i].kind != Node::Kind::kMap) {
      fields.complain("cameras", "is not a list of groups");
      return;
    }
    RigCamera camera = read_rig_camera(Fields(list[i], fmt::format("cameras[{}].", i), problem));
    const auto same = [&](const RigCamera& other) {
      return other.calibration.camera == camera.calibration.camera;
    };
    if (std::ranges::any_of(rig.cameras, same)) {
      fields.complain("cameras",
                      fmt::format("has '{}' twice", shortened(camera.calibration.camera, 64)));
    }
    rig.cameras.push_back(std::move(camera));
  }
}

Result<Rig> parse_text(std::string_view content) {
  if (content.size() > kMaxRigBytes) {
    return make_error(
        ErrorCode::kMalformed,
        fmt::format("it is larger than the {} MiB that a rig may have", kMaxRigBytes >> 20));
  }
  const auto root = io::parse_text_document(content);
  if (!root) return tl::unexpected(root.error());
  if (root->kind != Node::Kind::kMap) {
    return make_error(ErrorCode::kMalformed, "it has none of the fields of a rig");
  }
  std::optional<Error> problem;
  Fields fields(*root, "", problem);
  io::read_head(fields, kFormat, kVersion, "a rig");
  Rig rig;
  if (!problem) read_cameras(fields, problem, rig);
  rig.world = fields.optional_string("world");
  rig.rms = fields.optional_number("rms");
  rig.pairing_tolerance = fields.optional_time("pairing_tolerance_ns").value_or(0);
  if (problem) return tl::unexpected(*problem);
  return rig;
}

std::string explain(std::string_view name, std::string_view why) {
  const std::string reason = shortened(why, 400);
  const std::string file =
      name.empty() ? std::string("The text of a rig") : fmt::format("'{}'", shortened(name, 400));
  return fmt::format("{} cannot be used as a rig: {}{} Give a file that calvin-rig has written.",
                     file, reason, reason.ends_with('.') ? "" : ".");
}

// ---- Writing ------------------------------------------------------------------------------------

Node number(double x) { return {Node::Kind::kPlain, format_double(x), {}, {}}; }
Node text(std::string x) { return {Node::Kind::kString, std::move(x), {}, {}}; }

template <typename Numbers>
Node numbers(const Numbers& values) {
  Node list = {Node::Kind::kList, {}, {}, {}};
  for (const double x : values) list.items.push_back(number(x));
  return list;
}

class Map {
 public:
  Map& put(const char* key, Node value) {
    node_.keys.emplace_back(key);
    node_.items.push_back(std::move(value));
    return *this;
  }
  Map& put(const char* key, const std::optional<double>& value) {
    return value && std::isfinite(*value) ? put(key, number(*value)) : *this;
  }
  [[nodiscard]] Node take() { return std::move(node_); }

 private:
  Node node_{Node::Kind::kMap, {}, {}, {}};
};

Result<Node> camera_node(const RigCamera& camera) {
  const auto printed = io::print_native(camera.calibration);
  if (!printed) return tl::unexpected(printed.error());
  auto calibration = io::parse_json(*printed);
  if (!calibration) return calibration;
  Map map;
  map.put("camera", text(camera.calibration.camera));
  map.put("rig_from_camera", Map()
                                 .put("rotation", numbers(camera.rig_from_camera.rotation))
                                 .put("translation", numbers(camera.rig_from_camera.translation))
                                 .take());
  if (camera.covariance.size() == kPose * kPose) {
    Node rows = {Node::Kind::kList, {}, {}, {}};
    for (std::size_t r = 0; r < kPose; ++r) {
      const auto from = camera.covariance.begin() + static_cast<std::ptrdiff_t>(r * kPose);
      rows.items.push_back(numbers(std::vector<double>(from, from + kPose)));
    }
    map.put("covariance", std::move(rows));
  }
  map.put("rms", camera.rms);
  map.put("calibration", *std::move(calibration));
  return map.take();
}

}  // namespace

Result<Rig> parse_rig(std::string_view content, std::string_view name) {
  Result<Rig> result;
  try {
    result = parse_text(content);
  } catch (const std::exception& exception) {  // out of memory, or a parser's own surprise
    result = make_error(ErrorCode::kMalformed, exception.what());
  }
  if (!result) result.error().message = explain(name, result.error().message);
  return result;
}

bool is_rig(std::string_view content) noexcept {
  // Most files need not be parsed for this.
  if (content.size() > kMaxRigBytes || content.find(kFormat) == std::string_view::npos) {
    return false;
  }
  try {
    const auto root = io::parse_text_document(content);
    const Node* format = root ? root->find("format") : nullptr;
    return format != nullptr && format->text == kFormat;
  } catch (const std::exception&) {
    return false;
  }
}

Result<Rig> read_rig(const std::filesystem::path& path) {
  const auto content = read_file(path.string(), kMaxRigBytes);
  if (!content) return tl::unexpected(content.error());
  return parse_rig(*content, path.string());
}

Result<std::string> print_rig(const Rig& rig) {
  try {
    Node cameras = {Node::Kind::kList, {}, {}, {}};
    for (const RigCamera& camera : rig.cameras) {
      if (const auto good = Camera::make(camera.calibration); !good) {
        return tl::unexpected(good.error());
      }
      auto node = camera_node(camera);
      if (!node) return tl::unexpected(node.error());
      cameras.items.push_back(*std::move(node));
    }
    Map map;
    map.put("format", text(std::string(kFormat)));
    map.put("version", {Node::Kind::kPlain, fmt::format("{}", kVersion), {}, {}});
    map.put("world", text(rig.world));
    map.put("rms", rig.rms);
    map.put("pairing_tolerance_ns",
            {Node::Kind::kPlain, fmt::format("{}", rig.pairing_tolerance), {}, {}});
    map.put("cameras", std::move(cameras));
    return io::print_json(map.take());
  } catch (const std::exception& exception) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The rig cannot be written: {}.", exception.what()));
  }
}

Status write_rig(const std::filesystem::path& path, const Rig& rig) {
  const auto printed = print_rig(rig);
  if (!printed) return tl::unexpected(printed.error());
  return write_file(path.string(), *printed);
}

}  // namespace calvin
