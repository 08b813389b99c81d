// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The native calibration file (JSON) -> Calibration.

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/io/calibration_formats.hpp"
#include "calvin/io/native_fields.hpp"

namespace calvin::io {

namespace {

constexpr std::string_view kFormat = "calvin-calibration";

using Problem = std::optional<Error>;

std::vector<Parameter> read_parameters(Fields& fields) {
  // No camera model has as many. The names are looked up one by one, so that more would take their
  // time before anybody saw that they are unknown.
  constexpr std::size_t kMost = 64;
  std::vector<Parameter> parameters;
  Fields values = fields.map("parameters");
  if (values.keys().size() > kMost) {
    fields.complain("parameters", fmt::format("has {} names; no camera model has more than {}",
                                              values.keys().size(), kMost));
    return parameters;
  }
  for (const std::string& name : values.keys()) {
    parameters.push_back({name, values.number(name), {}});
  }
  if (fields.find("sigma") == nullptr) return parameters;
  Fields sigmas = fields.map("sigma");
  for (Parameter& p : parameters) {
    p.sigma = sigmas.optional_number(p.name);
    if (p.sigma.value_or(0) < 0) sigmas.complain(p.name, "is negative");
  }
  return parameters;
}

std::vector<ViewRecord> read_views(Fields& fields, Problem& problem) {
  std::vector<ViewRecord> views;
  const auto& list = fields.list("views");
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].kind != Node::Kind::kMap) fields.complain("views", "is not a list of groups");
    Fields one(list[i], fmt::format("views[{}].", i), problem);
    ViewRecord view;
    view.timestamp = one.optional_time("timestamp").value_or(kNoTimestamp);
    view.rms = one.optional_number("rms").value_or(0);
    view.points = one.find("points") != nullptr ? one.integer("points") : 0;
    view.held_out = one.flag("held_out");
    if (one.find("camera_from_board") != nullptr) {
      view.camera_from_board = read_pose(one.map("camera_from_board"));
    }
    views.push_back(view);
  }
  return views;
}

// The file's order may be any; ours is the model's. The covariance follows.
void sort_parameters(Calibration& calibration) {
  const auto names = parameter_names(calibration.model);
  const auto rank = [&](const Parameter& p) {
    return std::find(names.begin(), names.end(), p.name) - names.begin();
  };
  auto& parameters = calibration.parameters;
  std::vector<std::size_t> order(parameters.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return rank(parameters[a]) < rank(parameters[b]);
  });
  std::vector<std::size_t> row_of(parameters.size());
  std::size_t size = 0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].sigma) row_of[i] = size++;
  }
  std::vector<Parameter> sorted;
  std::vector<std::size_t> rows;
  for (const std::size_t i : order) {
    sorted.push_back(parameters[i]);
    if (parameters[i].sigma) rows.push_back(row_of[i]);
  }
  parameters = std::move(sorted);
  if (calibration.covariance.empty()) return;
  std::vector<double> covariance;
  for (const std::size_t r : rows) {
    for (const std::size_t c : rows) covariance.push_back(calibration.covariance[r * size + c]);
  }
  calibration.covariance = std::move(covariance);
}

// Of an error: absent, or not negative.
std::optional<double> read_error(Fields& fields, std::string_view key) {
  const auto value = fields.optional_number(key);
  if (value.value_or(0) < 0) fields.complain(key, "is negative");
  return value;
}

// A file that tells one promise is of a time when that was the one of the whole picture, which the
// one of the covered region does not exceed: it counts as both.
void read_promises(Fields& fields, Calibration& calibration) {
  calibration.expected_error = read_error(fields, "expected_error");
  calibration.expected_error_anywhere = read_error(fields, "expected_error_anywhere");
  if (!calibration.expected_error_anywhere) {
    calibration.expected_error_anywhere = calibration.expected_error;
  }
  if (fields.find("worst_place") == nullptr) return;
  const auto at = fields.numbers("worst_place", 2);
  calibration.worst_place = Pixel{at[0], at[1]};
}

void read_verdict(Fields& fields, Calibration& calibration) {
  calibration.split_half_ratio = fields.optional_number("split_half_ratio");
  calibration.misfit = fields.optional_string("misfit");
  calibration.systematic = fields.optional_number("systematic");
  const double share = calibration.systematic.value_or(0);
  if (share < 0 || share > 1) fields.complain("systematic", "is not a share from 0 to 1");
  for (const Node& remark : fields.list("remarks")) {
    if (remark.kind != Node::Kind::kString) fields.complain("remarks", "is not a list of texts");
    calibration.remarks.push_back(remark.text);
  }
}

// Absent where the file tells nothing of it.
std::optional<CaptureDevice> read_device(Fields& fields) {
  if (fields.find("device") == nullptr) return std::nullopt;
  Fields values = fields.map("device");
  CaptureDevice device;
  device.node = values.optional_string("node");
  device.name = values.optional_string("name");
  device.bus = values.optional_string("bus");
  if (values.find("autofocus") != nullptr) device.autofocus = values.flag("autofocus");
  const bool empty = device.node.empty() && device.name.empty() && device.bus.empty();
  if (empty && !device.autofocus) return std::nullopt;
  return device;
}

void read_quality(Fields& fields, Calibration& calibration) {
  calibration.rms = read_error(fields, "rms");
  calibration.held_out_rms = read_error(fields, "held_out_rms");
  calibration.chi = read_error(fields, "chi");
  read_promises(fields, calibration);
  read_verdict(fields, calibration);
  calibration.readout = fields.optional_number("readout");
  calibration.readout_sigma = read_error(fields, "readout_sigma");
  calibration.device = read_device(fields);
  calibration.focus = fields.optional_number("focus");
  calibration.zoom = fields.optional_number("zoom");
  if (fields.find("warp") != nullptr) {
    Fields warp = fields.map("warp");
    calibration.warp =
        BoardWarp{warp.number("kx"), warp.number("ky"), warp.optional_number("kx_sigma"),
                  warp.optional_number("ky_sigma")};
  }
  if (fields.find("sensor_crop") != nullptr) {
    const auto r = fields.numbers("sensor_crop", 4);
    calibration.sensor_crop = Rectangle{r[0], r[1], r[2], r[3]};
    const ImageSize size = calibration.image_size;
    if (!(r[2] > 0) || !(r[3] > 0)) fields.complain("sensor_crop", "is empty");
    if (r[0] < 0 || r[1] < 0 || r[0] + r[2] > size.width || r[1] + r[3] > size.height) {
      fields.complain("sensor_crop", "is not within the image");
    }
  }
}

}  // namespace

bool is_native(const Node& root) {
  return root.find("format") != nullptr ||
         (root.find("model") != nullptr && root.find("parameters") != nullptr);
}

Result<Calibration> read_native(const Node& root) {
  Problem problem;
  Fields fields(root, "", problem);
  Calibration calibration;
  read_head(fields, kFormat, kNativeVersion, "a camera");
  if (problem) return tl::unexpected(*problem);
  calibration.camera = fields.optional_string("camera");
  const auto size = fields.numbers("image_size", 2);
  for (const double side : size) {
    if (!(side >= 1 && side <= 65536 && side == static_cast<int>(side))) {
      fields.complain("image_size", "is not [width, height] in whole pixels");
    }
  }
  if (problem) return tl::unexpected(*problem);
  calibration.image_size = {static_cast<int>(size[0]), static_cast<int>(size[1])};
  calibration.model = fields.string("model");
  calibration.parameters = read_parameters(fields);
  if (problem) return tl::unexpected(*problem);
  // Before the covariance: what it lacks follows from the parameters.
  if (const auto camera = Camera::make(calibration); !camera) {
    return tl::unexpected(camera.error());
  }
  const auto estimated = std::count_if(calibration.parameters.begin(), calibration.parameters.end(),
                                       [](const Parameter& p) { return p.sigma.has_value(); });
  calibration.covariance =
      read_covariance(fields, static_cast<std::size_t>(estimated), "parameters have a sigma");
  read_quality(fields, calibration);
  for (const auto& uv : fields.rows("covered", 2)) calibration.covered.push_back({uv[0], uv[1]});
  calibration.board = fields.optional_string("board");
  calibration.views = read_views(fields, problem);
  calibration.created = fields.optional_string("created");
  if (problem) return tl::unexpected(*problem);
  sort_parameters(calibration);
  return calibration;
}

}  // namespace calvin::io
