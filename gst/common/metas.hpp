// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The custom metas that travel on buffers, and their structures.
//
// calvin-observation   camera, width, height, observations: array of {board, found, timestamp,
//                      ids, uv, sigma, ambiguous}. The same structure, as a serialized event,
//                      carries a result that no buffer can take any more.
// calvin-guidance      hint, coverage, x, y, size, tilt and the same as skew, expected-error,
//                      expected-error-anywhere, rms, views, captured, ghost-share, ghost: array of
//                      x and y as parts of the picture, points likewise, point-ids
// calvin-ground-truth  camera, width, height, calibration (JSON), boards: array of {board, ids,
//                      uv, rotation, translation}: what calibtestsrc rendered
//
// All are tagged video, size and orientation and have a transform: an element then either scales
// them correctly or drops them, and nothing keeps stale coordinates.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <gst/gst.h>

#include "calvin/core/calibration.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/session/progress.hpp"

namespace calvin::gst {

// An event upstream: whoever solves wants CornerPatches in the observations from here on.
inline constexpr char kWantPatchesName[] = "calvin-want-patches";

inline constexpr char kObservationName[] = "calvin-observation";
inline constexpr char kGuidanceName[] = "calvin-guidance";
inline constexpr char kGroundTruthName[] = "calvin-ground-truth";

// Makes the metas known; idempotent. Called when the plugin is loaded.
void register_metas();

// One observation per board of one frame; boards that were not found are listed too.
[[nodiscard]] GstStructure* observations_to_structure(std::span<const Observation> observations);
// Anybody may write such a structure: what is no observation is left out, and `problem` tells the
// first reason.
[[nodiscard]] std::vector<Observation> observations_from_structure(
    const GstStructure* structure, std::optional<Error>* problem = nullptr);

// `buffer` must be writable. A meta that is there already is replaced.
void attach_observations(GstBuffer* buffer, std::span<const Observation> observations);

// What a user should be told of a frame that shows another board than is looked for, beside its
// observations: the fields `hint` and `wrong-board`. Without words: nothing.
struct DetectorHint {
  std::string words;         // what keeps a board from being found
  bool wrong_board = false;  // it is another board; else the dark
};
void attach_hint(GstBuffer* buffer, const DetectorHint& hint);
[[nodiscard]] DetectorHint read_hint(GstBuffer* buffer);
[[nodiscard]] std::vector<Observation> read_observations(GstBuffer* buffer,
                                                         std::optional<Error>* problem = nullptr);

// The fields of the meta calvin-guidance but `captured`, which is of a frame; those of the message
// calib-progress too. `tilt` goes as `skew` too, its name in ROS.
void set_progress(GstStructure* structure, const Progress& progress);

void attach_guidance(GstBuffer* buffer, const Progress& progress);
// A meta of another program may have `skew` alone.
[[nodiscard]] std::optional<Progress> read_guidance(GstBuffer* buffer);

struct TrueBoard {
  Observation observation;
  Pose camera_from_board;
};

struct GroundTruth {
  std::string calibration;  // native JSON of the camera
  std::vector<TrueBoard> boards;
};

void attach_ground_truth(GstBuffer* buffer, const GroundTruth& truth);
[[nodiscard]] std::optional<GroundTruth> read_ground_truth(GstBuffer* buffer);

}  // namespace calvin::gst
