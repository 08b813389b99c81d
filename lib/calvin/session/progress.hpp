// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How far a calibration is: what a session tells, messages and metas carry, and the overlay shows.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calvin/core/calibration.hpp"

namespace calvin {

// The picture in cells that are equal, row by row from the top.
struct CoverageMap {
  int columns = 0;
  std::vector<bool> covered;  // whether a board was seen in the middle of each

  [[nodiscard]] int rows() const {
    return columns < 1 ? 0 : static_cast<int>(covered.size()) / columns;
  }
  [[nodiscard]] bool is_covered(int column, int row) const {
    return covered[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                   static_cast<std::size_t>(column)];
  }
};

// Some parameters of a camera that mean one thing to a user, and how well they are known.
struct ParameterGroup {
  std::string name;  // "focal length", "principal point", "distortion"
  double known = 0;  // 0..1: 1 where they are known as well as is wanted
};

// A manual point in the picture.
struct PlacedPoint {
  int id = 0;
  Pixel at;  // parts of the picture, as Progress::ghost
};

struct Progress {
  int views = 0;
  double coverage = 0;  // part of the image that boards covered, 0..1

  // How much of the useful range the kept views span, 0..1: position, size and tilt of the board.
  double x = 0;
  double y = 0;
  double size = 0;
  double tilt = 0;

  // Of the newest calibration, px; absent before the first one.
  std::optional<double> expected_error;           // 1 sigma, where corners covered the picture
  std::optional<double> expected_error_anywhere;  // 1 sigma, all over it
  std::optional<double> rms;

  bool captured = false;       // a view was taken from the frame at hand
  std::string hint;            // what to show next, a sentence: of to_text(), or of another program
  std::optional<Pose> target;  // of the hint, camera_from_board; absent where it has none
  // The outline of the corners of the board at the target, as parts of the picture: 0 .. 1 across
  // and down; empty where there is none.
  std::vector<Pixel> ghost;
  // Of what the view at the target would tell: as much of it as the newest view does, 0..1.
  double ghost_share = 0;
  static constexpr double kEnoughShare = 0.8;  // is taken at once where the board is held still
  CoverageMap coverage_map;  // what boards covered; without columns where it is not known
  std::vector<ParameterGroup> parameters =
      {};                                 // of the newest calibration; empty before the first one
  bool done = false;                      // nothing more is needed
  std::vector<std::string> summary = {};  // then: the calibration, a parameter in each line
  // What expected_error_anywhere is to come to, px; absent where nobody wants anything.
  std::optional<double> wanted_error_anywhere = std::nullopt;
  std::vector<PlacedPoint> points = {};  // manual points, the newest kMostPoints of them
  static constexpr std::size_t kMostPoints = 256;
};

}  // namespace calvin
