// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibsolve says on the bus.

#include "solve/solve_messages.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "common/metas.hpp"
#include "common/values.hpp"

namespace calvin::gst {

namespace {

void set_optional(GstStructure* s, const char* field, const std::optional<double>& value) {
  if (value) gst_structure_set(s, field, G_TYPE_DOUBLE, *value, nullptr);
}

}  // namespace

GstStructure* view_message(const FrameTimes& times, const std::string& camera, Reason reason,
                           const Progress& progress) {
  GstStructure* s = new_message("calib-view", times, camera);
  gst_structure_set(s, "accepted", G_TYPE_BOOLEAN, reason == Reason::kAccepted, "reason",
                    G_TYPE_STRING, std::string(to_string(reason)).c_str(), "views", G_TYPE_INT,
                    progress.views, "hint", G_TYPE_STRING, displayed(progress.hint).c_str(),
                    nullptr);
  return s;
}

GstStructure* progress_message(const FrameTimes& times, const std::string& camera,
                               const Progress& progress) {
  GstStructure* s = new_message("calib-progress", times, camera);
  set_progress(s, progress);
  return s;
}

GstStructure* result_message(const FrameTimes& times, const Solution& solution,
                             const std::string& location, const char* json) {
  const Calibration& c = solution.calibration;
  GstStructure* s = new_message("calib-result", times, c.camera);
  gst_structure_set(s, "state", G_TYPE_STRING, json != nullptr ? "final" : "intermediate", "model",
                    G_TYPE_STRING, c.model.c_str(), "width", G_TYPE_INT, c.image_size.width,
                    "height", G_TYPE_INT, c.image_size.height, nullptr);
  g_autoptr(GstStructure) sigma = gst_structure_new_empty("sigma");
  for (const Parameter& p : c.parameters) {
    gst_structure_set(s, p.name.c_str(), G_TYPE_DOUBLE, p.value, nullptr);
    set_optional(sigma, p.name.c_str(), p.sigma);
  }
  set_optional(s, "readout", c.readout);
  set_optional(sigma, "readout", c.readout_sigma);
  const auto used = std::count_if(c.views.begin(), c.views.end(),
                                  [](const ViewRecord& view) { return !view.held_out; });
  gst_structure_set(s, "sigma", GST_TYPE_STRUCTURE, sigma, "views", G_TYPE_INT,
                    static_cast<int>(used), nullptr);
  set_optional(s, "rms", c.rms);
  set_optional(s, "held-out-rms", c.held_out_rms);
  set_optional(s, "chi", c.chi);
  for (const char* name : {"split-half-ratio", "halves"}) set_optional(s, name, c.split_half_ratio);
  if (solution.misfit.found()) {
    const std::string cause(to_string(solution.misfit.cause));
    gst_structure_set(s, "misfit", G_TYPE_STRING, cause.c_str(), nullptr);
  }
  if (!c.remarks.empty()) {
    gst_structure_set(s, "remarks", G_TYPE_STRING, join(c.remarks, " ").c_str(), nullptr);
  }
  set_optional(s, "expected-error", c.expected_error);
  set_optional(s, "expected-error-anywhere", c.expected_error_anywhere);
  set_optional(s, "systematic", c.systematic);
  if (!location.empty()) {
    gst_structure_set(s, "location", G_TYPE_STRING, displayed(location).c_str(), nullptr);
  }
  if (json != nullptr) gst_structure_set(s, "json", G_TYPE_STRING, json, nullptr);
  return s;
}

GstStructure* check_message(const SolveJob& job, const EarlierVerdict& verdict) {
  const RecheckReport& report = verdict.report;
  const Calibration& earlier = job.earlier->calibration;
  GstStructure* s = new_message("calib-check", job.times, job.options.camera);
  gst_structure_set(s, "views", G_TYPE_INT, static_cast<int>(job.views.size()), "moved",
                    G_TYPE_DOUBLE, report.displacement, "moved-sigma", G_TYPE_DOUBLE,
                    report.displacement_sigma, "hint", G_TYPE_STRING,
                    displayed(verdict.words).c_str(), nullptr);
  set_optional(s, "expected-error", earlier.expected_error);
  set_optional(s, "expected-error-anywhere", earlier.expected_error_anywhere);
  return s;
}

Error broken_observation(const Error& why) {
  return {why.code,
          fmt::format("An observation from upstream cannot be used, and further ones "
                      "like it are dropped silently: {}{} Check what writes the meta {}.",
                      why.message, why.message.ends_with('.') ? "" : ".", kObservationName)};
}

}  // namespace calvin::gst
