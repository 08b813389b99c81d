// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Zoom table <-> JSON, around the native form of each setting's calibration.

#include "calvin/io/zoom_io.hpp"

#include <algorithm>
#include <exception>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/io/file_text.hpp"
#include "calvin/io/native_fields.hpp"
#include "calvin/io/node_map.hpp"

namespace calvin {

namespace {

using io::Fields;
using io::Node;
using io::NodeMap;

constexpr std::string_view kZoomFormat = "calvin-zoom";
constexpr int kZoomVersion = 1;

// ---- Reading ------------------------------------------------------------------------------------

ZoomSetting read_setting(Fields fields) {
  ZoomSetting setting;
  setting.calibration = io::read_camera(fields);
  if (fields.failed()) return setting;
  setting.calibration.zoom = fields.number("zoom");
  setting.calibration.focus = fields.optional_number("focus");
  setting.left_out = fields.optional_number("left_out");
  if (setting.left_out.value_or(0) < 0) fields.complain("left_out", "is negative");
  return setting;
}

std::vector<ZoomSetting> read_settings(Fields& fields, std::optional<Error>& problem) {
  constexpr std::size_t kMost = 4096;
  std::vector<ZoomSetting> settings;
  const auto& list = fields.list("settings");
  if (list.size() > kMost) {
    fields.complain("settings",
                    fmt::format("has {}; no zoom table has more than {}", list.size(), kMost));
  }
  for (std::size_t i = 0; i < list.size() && !fields.failed(); ++i) {
    if (list[i].kind != Node::Kind::kMap) {
      fields.complain("settings", "is not a list of groups");
      break;
    }
    settings.push_back(read_setting(Fields(list[i], fmt::format("settings[{}].", i), problem)));
  }
  return settings;
}

Result<ZoomTable> read_table(const Node& root) {
  std::optional<Error> problem;
  Fields fields(root, "", problem);
  io::read_head(fields, kZoomFormat, kZoomVersion, "a zoom table");
  const std::string camera = fields.optional_string("camera");
  std::vector<ZoomSetting> settings;
  if (!problem) settings = read_settings(fields, problem);
  if (problem) return tl::unexpected(*problem);
  std::vector<Calibration> calibrations;
  for (const ZoomSetting& setting : settings) {
    calibrations.push_back(setting.calibration);
    if (!camera.empty()) calibrations.back().camera = camera;
  }
  auto table = make_zoom_table(std::move(calibrations));
  if (!table) return make_error(ErrorCode::kMalformed, table.error().message);
  // What belongs to a setting has found its place with it.
  for (ZoomSetting& setting : table->settings) {
    const auto same = [&](const ZoomSetting& other) {
      return other.calibration.zoom == setting.calibration.zoom &&
             other.calibration.focus == setting.calibration.focus;
    };
    const auto of_file = std::ranges::find_if(settings, same);
    if (of_file != settings.end()) setting.left_out = of_file->left_out;
  }
  return table;
}

Result<ZoomTable> zoom_table_of(std::string_view content) {
  if (content.size() > kMaxZoomBytes) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("it is larger than the {} MiB that a zoom table may have",
                                  kMaxZoomBytes >> 20));
  }
  const auto root = io::parse_json(content);
  if (!root) return tl::unexpected(root.error());
  if (root->kind != Node::Kind::kMap) {
    return make_error(ErrorCode::kMalformed, "it has none of the fields of a zoom table");
  }
  return read_table(*root);
}

constexpr io::FileKind kZoomFile = {"The text of a zoom table", "a zoom table",
                                    "Give a file that calvin-zoom has written."};

// ---- Writing ------------------------------------------------------------------------------------

Result<Node> setting_node(const ZoomSetting& setting) {
  // Where the lens stood is said once, beside the calibration.
  Calibration bare = setting.calibration;
  bare.zoom.reset();
  bare.focus.reset();
  auto calibration = io::camera_node(bare);
  if (!calibration) return calibration;
  NodeMap map;
  map.put("zoom", setting.calibration.zoom);
  map.put("focus", setting.calibration.focus);
  map.put("left_out", setting.left_out);
  map.put("calibration", *std::move(calibration));
  return map.take();
}

Result<std::string> print(const ZoomTable& table) {
  Node settings = {Node::Kind::kList, {}, {}, {}};
  for (const ZoomSetting& setting : table.settings) {
    auto node = setting_node(setting);
    if (!node) return tl::unexpected(node.error());
    settings.items.push_back(*std::move(node));
  }
  NodeMap map;
  map.put("format", io::text_node(kZoomFormat));
  map.put("version", io::integer_node(kZoomVersion));
  if (!table.camera.empty()) map.put("camera", io::text_node(table.camera));
  map.put("settings", std::move(settings));
  return io::print_json(map.take());
}

}  // namespace

Result<ZoomTable> parse_zoom_table(std::string_view content, std::string_view name) {
  return io::parse_as<ZoomTable>(kZoomFile, name, zoom_table_of, content);
}

bool is_zoom_table(std::string_view content) noexcept {
  // Most files need not be parsed for this.
  if (content.size() > kMaxZoomBytes || content.find(kZoomFormat) == std::string_view::npos) {
    return false;
  }
  try {
    const auto root = io::parse_json(content);
    const Node* format = root ? root->find("format") : nullptr;
    return format != nullptr && format->text == kZoomFormat;
  } catch (const std::exception&) {
    return false;
  }
}

Result<ZoomTable> read_zoom_table(const std::filesystem::path& path) {
  const auto content = read_file(path.string(), kMaxZoomBytes);
  if (!content) return tl::unexpected(content.error());
  return parse_zoom_table(*content, path.string());
}

Result<std::string> print_zoom_table(const ZoomTable& table) {
  try {
    return print(table);
  } catch (const std::exception& exception) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The zoom table cannot be written: {}.", exception.what()));
  }
}

Status write_zoom_table(const std::filesystem::path& path, const ZoomTable& table) {
  const auto printed = print_zoom_table(table);
  if (!printed) return tl::unexpected(printed.error());
  return write_file(path.string(), *printed);
}

}  // namespace calvin
