// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The structures of calibrig.

#include "rig/rig_messages.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include "calvin/core/text.hpp"
#include "common/values.hpp"

namespace calvin::gst {

namespace {

void set_optional(GstStructure* s, const char* field, const std::optional<double>& value) {
  if (value) gst_structure_set(s, field, G_TYPE_DOUBLE, *value, nullptr);
}

GstStructure* link_structure(const RigLink& link, const Rig& rig) {
  GstStructure* s = gst_structure_new(
      "link", "a", G_TYPE_STRING, displayed(rig.cameras[link.a].calibration.camera).c_str(), "b",
      G_TYPE_STRING, displayed(rig.cameras[link.b].calibration.camera).c_str(), "views", G_TYPE_INT,
      static_cast<int>(link.views), "agree", G_TYPE_INT, static_cast<int>(link.agree), "distance",
      G_TYPE_DOUBLE, link.distance, "distance-sigma", G_TYPE_DOUBLE, link.distance_sigma, "angle",
      G_TYPE_DOUBLE, link.angle, nullptr);
  set_optional(s, "bias", link.bias);
  set_optional(s, "spread", link.spread);
  set_optional(s, "epipolar-error", link.epipolar_error);
  return s;
}

// Of the cameras whose clocks do not agree with that of the first one.
std::vector<GstStructure*> time_offsets_of(const Rig& rig) {
  constexpr double kSecond = 1e9;  // ns
  std::vector<GstStructure*> offsets;
  for (const RigCamera& camera : rig.cameras) {
    if (!camera.time_offset) continue;
    offsets.push_back(gst_structure_new(
        "time-offset", "camera", G_TYPE_STRING, displayed(camera.calibration.camera).c_str(),
        "offset", G_TYPE_INT64,
        static_cast<gint64>(std::llround(kSecond * camera.time_offset->seconds)), "sigma",
        G_TYPE_INT64, static_cast<gint64>(std::llround(kSecond * camera.time_offset->sigma)),
        nullptr));
  }
  return offsets;
}

}  // namespace

GstStructure* rig_progress_message(const FrameTimes& times, const RigProgress& progress) {
  GstStructure* s = new_message("calib-rig-progress", times, "");
  gst_structure_set(s, "cameras", G_TYPE_INT, static_cast<int>(progress.cameras.size()), "instants",
                    G_TYPE_INT, progress.instants, "weakest", G_TYPE_STRING,
                    displayed(progress.weakest).c_str(), nullptr);
  std::vector<GstStructure*> links;
  for (const RigProgress::Link& link : progress.links) {
    links.push_back(gst_structure_new("link", "a", G_TYPE_STRING, displayed(link.a).c_str(), "b",
                                      G_TYPE_STRING, displayed(link.b).c_str(), "views", G_TYPE_INT,
                                      link.views, nullptr));
  }
  take_structures(s, "links", links);
  return s;
}

GstStructure* rig_result_message(const FrameTimes& times, const RigSolution& solution,
                                 const std::string& location, const char* json) {
  const Rig& rig = solution.rig;
  GstStructure* s = new_message("calib-rig-result", times, "");
  gst_structure_set(s, "state", G_TYPE_STRING, json != nullptr ? "final" : "intermediate",
                    "cameras", G_TYPE_INT, static_cast<int>(rig.cameras.size()), "world",
                    G_TYPE_STRING, displayed(rig.world).c_str(), "unit", G_TYPE_STRING,
                    rig.is_metric ? "m" : "none", "pairing", G_TYPE_UINT64,
                    static_cast<guint64>(solution.farthest), "rejected", G_TYPE_INT,
                    static_cast<int>(solution.rejected.size()), nullptr);
  set_optional(s, "rms", rig.rms);
  std::vector<GstStructure*> links;
  for (const RigLink& link : solution.links) links.push_back(link_structure(link, rig));
  take_structures(s, "links", links);
  if (solution.weakest) {
    const RigLink& weakest = solution.links[*solution.weakest];
    gst_structure_set(s, "weakest", G_TYPE_STRING,
                      displayed(rig.cameras[weakest.a].calibration.camera + " " +
                                rig.cameras[weakest.b].calibration.camera)
                          .c_str(),
                      nullptr);
  }
  std::vector<GstStructure*> missing;
  for (const LeftOutCamera& camera : solution.left_out) {
    missing.push_back(gst_structure_new("missing", "camera", G_TYPE_STRING,
                                        displayed(camera.camera).c_str(), "reason", G_TYPE_STRING,
                                        displayed(camera.reason).c_str(), nullptr));
  }
  take_structures(s, "missing", missing);
  take_structures(s, "time-offsets", time_offsets_of(rig));
  if (solution.board_scale) {
    gst_structure_set(s, "board-scale", G_TYPE_DOUBLE, solution.board_scale->scale,
                      "board-scale-sigma", G_TYPE_DOUBLE, solution.board_scale->sigma, nullptr);
  }
  if (!solution.remarks.empty()) {
    gst_structure_set(s, "remarks", G_TYPE_STRING, displayed(join(solution.remarks, " ")).c_str(),
                      nullptr);
  }
  if (!location.empty()) {
    gst_structure_set(s, "location", G_TYPE_STRING, displayed(location).c_str(), nullptr);
  }
  if (json != nullptr) gst_structure_set(s, "json", G_TYPE_STRING, json, nullptr);
  return s;
}

GstStructure* rig_moved_message(const FrameTimes& times, const MovedCamera& moved) {
  // Where it is one of two, the message is of no camera of its own.
  const std::string camera = moved.cameras.size() == 1 ? moved.cameras.front() : "";
  GstStructure* s = new_message("calib-rig-moved", times, camera);
  gst_structure_set(s, "cameras", G_TYPE_STRING, displayed(join(moved.cameras, " ")).c_str(),
                    "since", G_TYPE_UINT64, static_cast<guint64>(moved.since), "distance",
                    G_TYPE_DOUBLE, moved.place, "angle", G_TYPE_DOUBLE, moved.turn, nullptr);
  return s;
}

}  // namespace calvin::gst
