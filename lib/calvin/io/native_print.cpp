// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Calibration -> the native calibration file (JSON).

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calvin/core/text.hpp"
#include "calvin/io/calibration_formats.hpp"

namespace calvin::io {

namespace {

using Json = nlohmann::ordered_json;

// On one line; numbers are the shortest that read back as the same.
void print_inline(const Json& json, std::string& out) {
  if (json.is_object() || json.is_array()) {
    out += json.is_object() ? '{' : '[';
    for (auto it = json.begin(); it != json.end(); ++it) {
      if (it != json.begin()) out += ", ";
      if (json.is_object()) out += json_string(it.key()) + ": ";
      print_inline(*it, out);
    }
    out += json.is_object() ? '}' : ']';
  } else if (json.is_number_float()) {
    out += format_double(json.get<double>());
  } else {
    out += json.is_string() ? json_string(json.get_ref<const std::string&>()) : json.dump();
  }
}

// A field a line, and an element a line for lists of groups or of lists: a diff shows what changed.
std::string print_lines(const Json& json) {
  std::string out = "{";
  for (auto it = json.begin(); it != json.end(); ++it) {
    out += it == json.begin() ? "\n  " : ",\n  ";
    out += json_string(it.key()) + ": ";
    if (!it->is_array() || it->empty() || !it->front().is_structured()) {
      print_inline(*it, out);
      continue;
    }
    out += "[";
    for (auto element = it->begin(); element != it->end(); ++element) {
      out += element == it->begin() ? "\n    " : ",\n    ";
      print_inline(*element, out);
    }
    out += "\n  ]";
  }
  return out + "\n}\n";
}

// A field that is unknown is left out, and so is what no file may hold.
void put(Json& json, const char* key, const std::optional<double>& value) {
  if (value && std::isfinite(*value)) json[key] = *value;
}

void put(Json& json, const char* key, const std::string& value) {
  if (!value.empty()) json[key] = value;
}

void put_covariance(Json& json, const Calibration& calibration, std::size_t size) {
  const auto& c = calibration.covariance;
  if (c.empty() || c.size() != size * size) return;
  for (std::size_t r = 0; r < size; ++r) {
    Json row = Json::array();
    for (std::size_t i = 0; i < size; ++i) row.push_back(c[r * size + i]);
    json["covariance"].push_back(std::move(row));
  }
}

Json view_of(const ViewRecord& view) {
  Json json = Json::object();
  if (view.timestamp != kNoTimestamp) json["timestamp"] = view.timestamp;
  put(json, "rms", view.rms);
  json["points"] = view.points;
  json["held_out"] = view.held_out;
  json["camera_from_board"] = {{"rotation", view.camera_from_board.rotation},
                               {"translation", view.camera_from_board.translation}};
  return json;
}

void put_quality(Json& json, const Calibration& calibration) {
  put(json, "rms", calibration.rms);
  put(json, "held_out_rms", calibration.held_out_rms);
  put(json, "chi", calibration.chi);
  put(json, "expected_error", calibration.expected_error);
  put(json, "expected_error_anywhere", calibration.expected_error_anywhere);
  if (const auto& worst = calibration.worst_place) json["worst_place"] = {worst->u, worst->v};
  put(json, "split_half_ratio", calibration.split_half_ratio);
  put(json, "misfit", calibration.misfit);
  put(json, "systematic", calibration.systematic);
  if (!calibration.remarks.empty()) json["remarks"] = calibration.remarks;
}

void put_device(Json& json, const Calibration& calibration) {
  if (!calibration.device) return;
  Json device = Json::object();
  put(device, "node", calibration.device->node);
  put(device, "name", calibration.device->name);
  put(device, "bus", calibration.device->bus);
  if (calibration.device->autofocus) device["autofocus"] = *calibration.device->autofocus;
  if (!device.empty()) json["device"] = std::move(device);
}

void put_rest(Json& json, const Calibration& calibration) {
  for (const Pixel& p : calibration.covered) json["covered"].push_back({p.u, p.v});
  put(json, "board", calibration.board);
  if (calibration.warp) {
    Json& warp = json["warp"];
    warp["kx"] = calibration.warp->kx;
    warp["ky"] = calibration.warp->ky;
    if (calibration.warp->kx_sigma) warp["kx_sigma"] = *calibration.warp->kx_sigma;
    if (calibration.warp->ky_sigma) warp["ky_sigma"] = *calibration.warp->ky_sigma;
  }
  put(json, "readout", calibration.readout);
  put(json, "readout_sigma", calibration.readout_sigma);
  for (const ViewRecord& view : calibration.views) json["views"].push_back(view_of(view));
  if (const auto& crop = calibration.sensor_crop) {
    json["sensor_crop"] = {crop->x, crop->y, crop->width, crop->height};
  }
  put_device(json, calibration);
  put(json, "focus", calibration.focus);
  put(json, "zoom", calibration.zoom);
  put(json, "created", calibration.created);
}

bool all_finite(const Json& json) {
  if (json.is_number_float()) return std::isfinite(json.get<double>());
  return !json.is_structured() ||
         std::all_of(json.begin(), json.end(), [](const Json& item) { return all_finite(item); });
}

}  // namespace

Status check_has_size(const Calibration& calibration, std::string_view file) {
  if (calibration.image_size.width >= 1 && calibration.image_size.height >= 1) return {};
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format("The calibration does not say its image size, which a {} must hold.", file));
}

Result<std::string> print_native(const Calibration& calibration) {
  const Status sized = check_has_size(calibration, "calibration file");
  if (!sized) return tl::unexpected(sized.error());
  Json json = {{"format", "calvin-calibration"}, {"version", kNativeVersion}};
  put(json, "camera", calibration.camera);
  json["image_size"] = {calibration.image_size.width, calibration.image_size.height};
  json["model"] = calibration.model;
  Json sigma = Json::object();
  for (const Parameter& p : calibration.parameters) {
    json["parameters"][p.name] = p.value;
    put(sigma, p.name.c_str(), p.sigma);
  }
  if (!sigma.empty()) json["sigma"] = sigma;
  put_covariance(json, calibration, sigma.size());
  put_quality(json, calibration);
  put_rest(json, calibration);
  if (!all_finite(json)) {
    return make_error(ErrorCode::kInvalidArgument,
                      "The calibration holds a number that is not finite and cannot be written.");
  }
  return print_lines(json);
}

}  // namespace calvin::io
