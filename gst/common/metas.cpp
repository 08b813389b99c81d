// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The custom metas that travel on buffers.

#include "common/metas.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <gst/video/video.h>

#include "calvin/camera/image_transform.hpp"
#include "calvin/core/text.hpp"
#include "common/patch_values.hpp"
#include "common/values.hpp"

namespace calvin::gst {

namespace {

ImageSize size_of(const GstVideoInfo& info) {
  return {GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)};
}

// Moves what every item of the array `list` says of an observation, and leaves the rest of it.
void move_points(GstStructure* structure, const char* list, const ImageTransform& transform) {
  std::vector<GstStructure*> scaled;
  for (const GstStructure* item : get_structures(structure, list)) {
    GstStructure* copy = gst_structure_copy(item);
    Observation seen;
    seen.uv = get_pixels(copy, "uv");
    seen.sigma = get_doubles(copy, "sigma");
    const bool has_blur = gst_structure_get_double(copy, "blur", &seen.blur) != FALSE;
    const Observation moved = transform(seen);
    set_pixels(copy, "uv", moved.uv);
    if (!moved.sigma.empty()) set_doubles(copy, "sigma", moved.sigma);
    if (has_blur) gst_structure_set(copy, "blur", G_TYPE_DOUBLE, moved.blur, nullptr);
    remove_patches(copy);
    scaled.push_back(copy);
  }
  take_structures(structure, list, scaled);
}

GstStructure* writable_meta(GstBuffer* buffer, const char* name) {
  GstCustomMeta* meta = gst_buffer_get_custom_meta(buffer, name);
  if (meta == nullptr) meta = gst_buffer_add_custom_meta(buffer, name);
  return meta == nullptr ? nullptr : gst_custom_meta_get_structure(meta);
}

const GstStructure* readable_meta(GstBuffer* buffer, const char* name) {
  GstCustomMeta* meta = gst_buffer_get_custom_meta(buffer, name);
  return meta == nullptr ? nullptr : gst_custom_meta_get_structure(meta);
}

void set_fields(GstStructure* to, const GstStructure* from) {
  gst_structure_remove_all_fields(to);
  gst_structure_foreach(
      from,
      [](GQuark field, const GValue* value, gpointer data) -> gboolean {
        gst_structure_id_set_value(static_cast<GstStructure*>(data), field, value);
        return TRUE;
      },
      to);
}

gboolean transform_meta(GstBuffer* to, GstCustomMeta* meta, GstBuffer* /*from*/, GQuark type,
                        gpointer data, gpointer list) {
  const char* name = gst_structure_get_name(gst_custom_meta_get_structure(meta));
  const bool scale = GST_VIDEO_META_TRANSFORM_IS_SCALE(type);
  if (!GST_META_TRANSFORM_IS_COPY(type) && !scale) return FALSE;
  GstStructure* structure = writable_meta(to, name);
  if (structure == nullptr) return FALSE;
  set_fields(structure, gst_custom_meta_get_structure(meta));
  if (scale && list != nullptr) {
    const auto* change = static_cast<const GstVideoMetaTransform*>(data);
    const auto transform =
        ImageTransform::scaled(size_of(*change->in_info), size_of(*change->out_info));
    const auto [width, height] = transform.size();
    move_points(structure, static_cast<const char*>(list), transform);
    gst_structure_set(structure, "width", G_TYPE_INT, width, "height", G_TYPE_INT, height, nullptr);
  }
  return TRUE;
}

void register_one(const char* name, const char* points_list) {
  if (gst_meta_get_info(name) != nullptr) return;
  const char* tags[] = {GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_SIZE_STR,
                        GST_META_TAG_VIDEO_ORIENTATION_STR, nullptr};
  gst_meta_register_custom(name, tags, transform_meta, const_cast<char*>(points_list), nullptr);
}

GstStructure* observation_to_structure(const Observation& o) {
  GstStructure* s = gst_structure_new("observation", "board", G_TYPE_STRING, o.board.c_str(),
                                      "found", G_TYPE_BOOLEAN, o.found(), "timestamp",
                                      G_TYPE_UINT64, o.timestamp, nullptr);
  set_ints(s, "ids", o.ids);
  set_pixels(s, "uv", o.uv);
  set_doubles(s, "sigma", o.sigma);
  std::vector<std::string> ambiguous;
  for (const Relabelling& other : o.ambiguous) ambiguous.push_back(to_text(other));
  set_strings(s, "ambiguous", ambiguous);
  if (o.blur > 0) gst_structure_set(s, "blur", G_TYPE_DOUBLE, o.blur, nullptr);
  set_patches(s, o.patches);
  return s;
}

void set_frame(GstStructure* s, const Observation* first) {
  gst_structure_set(s, "camera", G_TYPE_STRING,
                    first != nullptr ? displayed(first->camera).c_str() : "", "width", G_TYPE_INT,
                    first != nullptr ? first->image_size.width : 0, "height", G_TYPE_INT,
                    first != nullptr ? first->image_size.height : 0, nullptr);
}

bool get_boolean(const GstStructure* s, const char* field) {
  gboolean value = FALSE;
  gst_structure_get_boolean(s, field, &value);
  return value != FALSE;
}

std::optional<double> get_double(const GstStructure* s, const char* field) {
  double value = 0;
  if (!gst_structure_get_double(s, field, &value)) return std::nullopt;
  return value;
}

void set_double(GstStructure* s, const char* field, const std::optional<double>& value) {
  if (value) gst_structure_set(s, field, G_TYPE_DOUBLE, *value, nullptr);
}

}  // namespace

void register_metas() {
  register_one(kObservationName, "observations");
  register_one(kGuidanceName, nullptr);
  register_one(kGroundTruthName, "boards");
}

GstStructure* observations_to_structure(std::span<const Observation> observations) {
  GstStructure* s = gst_structure_new_empty(kObservationName);
  set_frame(s, observations.empty() ? nullptr : &observations.front());
  std::vector<GstStructure*> list;
  for (const Observation& o : observations) list.push_back(observation_to_structure(o));
  take_structures(s, "observations", list);
  return s;
}

std::vector<Observation> observations_from_structure(const GstStructure* structure,
                                                     std::optional<Error>* problem) {
  std::vector<Observation> all;
  const auto refuse = [problem](std::string why) {
    if (problem == nullptr || *problem) return;
    *problem = Error{ErrorCode::kMalformed, std::move(why)};
  };
  const GValue* list = gst_structure_get_value(structure, "observations");
  if (list == nullptr || !GST_VALUE_HOLDS_ARRAY(list)) {
    refuse("the field 'observations' is no array of structures");
  }
  ImageSize size;
  gst_structure_get_int(structure, "width", &size.width);
  gst_structure_get_int(structure, "height", &size.height);
  for (const GstStructure* s : get_structures(structure, "observations")) {
    Observation o;
    o.camera = get_string(structure, "camera");
    o.image_size = size;
    o.board = get_string(s, "board");
    gst_structure_get_uint64(s, "timestamp", &o.timestamp);
    o.ids = get_ints(s, "ids");
    o.uv = get_pixels(s, "uv");
    o.sigma = get_doubles(s, "sigma");
    for (const std::string& text : get_strings(s, "ambiguous")) {
      // A text of another program's that means nothing here still says that there is a doubt.
      o.ambiguous.push_back(parse_relabelling(text).value_or(Relabelling{}));
    }
    gst_structure_get_double(s, "blur", &o.blur);
    o.patches = get_patches(s, o.ids.size());
    const std::size_t numbers = get_doubles(s, "uv").size();
    if (numbers != 2 * o.ids.size() || o.sigma.size() != o.ids.size()) {
      refuse(
          fmt::format("it has {} ids, {} sigmas and {} coordinates; each corner needs an id, a "
                      "sigma and two coordinates",
                      o.ids.size(), o.sigma.size(), numbers));
    } else if (std::any_of(o.sigma.begin(), o.sigma.end(),
                           [](double sigma) { return !std::isfinite(sigma) || sigma < 0; })) {
      refuse("a sigma is negative or no number; it must be in px");
    } else {
      all.push_back(std::move(o));
    }
  }
  return all;
}

void attach_observations(GstBuffer* buffer, std::span<const Observation> observations) {
  g_autoptr(GstStructure) s = observations_to_structure(observations);
  if (GstStructure* meta = writable_meta(buffer, kObservationName)) set_fields(meta, s);
}

void attach_hint(GstBuffer* buffer, const DetectorHint& hint) {
  GstStructure* meta = writable_meta(buffer, kObservationName);
  if (meta == nullptr) return;
  if (hint.words.empty()) {
    gst_structure_remove_fields(meta, "hint", "wrong-board", nullptr);
  } else {
    gst_structure_set(meta, "hint", G_TYPE_STRING, hint.words.c_str(), "wrong-board",
                      G_TYPE_BOOLEAN, hint.wrong_board, nullptr);
  }
}

DetectorHint read_hint(GstBuffer* buffer) {
  const GstStructure* s = readable_meta(buffer, kObservationName);
  if (s == nullptr) return {};
  return {get_string(s, "hint"), get_boolean(s, "wrong-board")};
}

std::vector<Observation> read_observations(GstBuffer* buffer, std::optional<Error>* problem) {
  const GstStructure* s = readable_meta(buffer, kObservationName);
  return s == nullptr ? std::vector<Observation>() : observations_from_structure(s, problem);
}

namespace {

constexpr std::size_t kMostCells = 64;  // of a map, each way: anybody may write one

// A word for each row, a digit for each cell: "0110 0010".
std::string to_text(const CoverageMap& map) {
  std::string text;
  for (std::size_t i = 0; i < map.covered.size(); ++i) {
    if (i > 0 && i % static_cast<std::size_t>(map.columns) == 0) text += ' ';
    text += map.covered[i] ? '1' : '0';
  }
  return text;
}

CoverageMap parse_map(const std::string& text) {
  if (text.empty() || text.size() > kMostCells * (kMostCells + 1)) return {};
  const auto rows = split(text, ' ');
  CoverageMap map;
  map.columns = static_cast<int>(rows.front().size());
  if (rows.size() > kMostCells || rows.front().size() > kMostCells) return {};
  for (const std::string_view row : rows) {
    if (row.size() != rows.front().size() || row.empty()) return {};
    for (const char cell : row) map.covered.push_back(cell == '1');
  }
  return map;
}

void set_parameters(GstStructure* s, const std::vector<ParameterGroup>& groups) {
  if (groups.empty()) return;
  std::vector<GstStructure*> list;
  for (const ParameterGroup& group : groups) {
    list.push_back(gst_structure_new("parameters", "name", G_TYPE_STRING, group.name.c_str(),
                                     "known", G_TYPE_DOUBLE, group.known, nullptr));
  }
  take_structures(s, "parameters", list);
}

void set_points(GstStructure* s, const std::vector<PlacedPoint>& points) {
  if (points.empty()) return;
  std::vector<int> ids;
  std::vector<Pixel> places;
  for (const PlacedPoint& point : points) {
    ids.push_back(point.id);
    places.push_back(point.at);
  }
  set_ints(s, "point-ids", ids);
  set_pixels(s, "points", places);
}

std::vector<PlacedPoint> get_points(const GstStructure* s) {
  const std::vector<int> ids = get_ints(s, "point-ids");
  const std::vector<Pixel> places = get_pixels(s, "points");
  std::vector<PlacedPoint> points;
  for (std::size_t i = 0; i < std::min(ids.size(), places.size()); ++i) {
    points.push_back({ids[i], places[i]});
  }
  return points;
}

std::vector<ParameterGroup> get_parameters(const GstStructure* s) {
  std::vector<ParameterGroup> groups;
  for (const GstStructure* group : get_structures(s, "parameters")) {
    groups.push_back({get_string(group, "name"), get_double(group, "known").value_or(0)});
  }
  return groups;
}

}  // namespace

void set_progress(GstStructure* s, const Progress& p) {
  gst_structure_set(s, "views", G_TYPE_INT, p.views, "coverage", G_TYPE_DOUBLE, p.coverage, "x",
                    G_TYPE_DOUBLE, p.x, "y", G_TYPE_DOUBLE, p.y, "size", G_TYPE_DOUBLE, p.size,
                    "tilt", G_TYPE_DOUBLE, p.tilt, "skew", G_TYPE_DOUBLE, p.tilt, "hint",
                    G_TYPE_STRING, displayed(p.hint).c_str(), "ghost-share", G_TYPE_DOUBLE,
                    p.ghost_share, "done", G_TYPE_BOOLEAN, p.done, nullptr);
  if (p.coverage_map.columns > 0) {
    gst_structure_set(s, "coverage-map", G_TYPE_STRING, to_text(p.coverage_map).c_str(), nullptr);
  }
  set_pixels(s, "ghost", p.ghost);
  set_points(s, p.points);
  set_parameters(s, p.parameters);
  if (!p.summary.empty()) set_strings(s, "summary", p.summary);
  set_double(s, "expected-error", p.expected_error);
  set_double(s, "expected-error-anywhere", p.expected_error_anywhere);
  set_double(s, "wanted-error-anywhere", p.wanted_error_anywhere);
  set_double(s, "rms", p.rms);
}

void attach_guidance(GstBuffer* buffer, const Progress& progress) {
  GstStructure* s = writable_meta(buffer, kGuidanceName);
  if (s == nullptr) return;
  gst_structure_remove_all_fields(s);
  set_progress(s, progress);
  gst_structure_set(s, "captured", G_TYPE_BOOLEAN, progress.captured, nullptr);
}

std::optional<Progress> read_guidance(GstBuffer* buffer) {
  const GstStructure* s = readable_meta(buffer, kGuidanceName);
  if (s == nullptr) return std::nullopt;
  Progress p;
  gst_structure_get_int(s, "views", &p.views);
  p.coverage = get_double(s, "coverage").value_or(0);
  p.coverage_map = parse_map(get_string(s, "coverage-map"));
  p.x = get_double(s, "x").value_or(0);
  p.y = get_double(s, "y").value_or(0);
  p.size = get_double(s, "size").value_or(0);
  p.tilt = get_double(s, get_double(s, "tilt") ? "tilt" : "skew").value_or(0);
  p.expected_error = get_double(s, "expected-error");
  p.expected_error_anywhere = get_double(s, "expected-error-anywhere");
  p.wanted_error_anywhere = get_double(s, "wanted-error-anywhere");
  p.rms = get_double(s, "rms");
  p.captured = get_boolean(s, "captured");
  p.hint = get_string(s, "hint");
  p.ghost = get_pixels(s, "ghost");
  p.points = get_points(s);
  p.ghost_share = get_double(s, "ghost-share").value_or(0);
  p.parameters = get_parameters(s);
  p.done = get_boolean(s, "done");
  p.summary = get_strings(s, "summary");
  return p;
}

void attach_ground_truth(GstBuffer* buffer, const GroundTruth& truth) {
  GstStructure* s = writable_meta(buffer, kGroundTruthName);
  if (s == nullptr) return;
  set_frame(s, truth.boards.empty() ? nullptr : &truth.boards.front().observation);
  gst_structure_set(s, "calibration", G_TYPE_STRING, truth.calibration.c_str(), nullptr);
  std::vector<GstStructure*> list;
  for (const TrueBoard& b : truth.boards) {
    GstStructure* item = observation_to_structure(b.observation);
    set_doubles(item, "rotation", b.camera_from_board.rotation);
    set_doubles(item, "translation", b.camera_from_board.translation);
    list.push_back(item);
  }
  take_structures(s, "boards", list);
}

std::optional<GroundTruth> read_ground_truth(GstBuffer* buffer) {
  const GstStructure* s = readable_meta(buffer, kGroundTruthName);
  if (s == nullptr) return std::nullopt;
  GroundTruth truth;
  truth.calibration = get_string(s, "calibration");
  for (const GstStructure* item : get_structures(s, "boards")) {
    TrueBoard board;
    Observation& o = board.observation;
    o.camera = get_string(s, "camera");
    gst_structure_get_int(s, "width", &o.image_size.width);
    gst_structure_get_int(s, "height", &o.image_size.height);
    o.board = get_string(item, "board");
    gst_structure_get_uint64(item, "timestamp", &o.timestamp);
    o.ids = get_ints(item, "ids");
    o.uv = get_pixels(item, "uv");
    o.sigma = get_doubles(item, "sigma");
    const std::vector<double> rotation = get_doubles(item, "rotation");
    const std::vector<double> translation = get_doubles(item, "translation");
    if (rotation.size() != 3 || translation.size() != 3) continue;
    std::copy(rotation.begin(), rotation.end(), board.camera_from_board.rotation.begin());
    std::copy(translation.begin(), translation.end(), board.camera_from_board.translation.begin());
    truth.boards.push_back(std::move(board));
  }
  return truth;
}

}  // namespace calvin::gst
