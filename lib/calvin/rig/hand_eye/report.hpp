// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is said of a hand-eye calibration: what is left of its loops, and sentences for the user.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "calvin/core/hand_eye.hpp"
#include "calvin/rig/hand_eye/fit.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// What is left of a loop: from where the robot said that its hand was to where the board, by the
// corners of this view alone, puts it.
struct LoopError {
  std::size_t view = 0;           // of the camera's list
  bool used = true;               // false where the view contradicts the others
  std::array<double, 3> turn{};   // rad, about the axes of the base
  std::array<double, 3> place{};  // m
};

namespace rig {

// Of each loop. `camera_from_board` are its poses by the corners of the first view of each alone.
[[nodiscard]] std::vector<LoopError> loop_errors(const std::vector<LoopView>& loops,
                                                 const HandEyeFit& fit, EyeSetup setup,
                                                 const std::vector<SE3>& camera_from_board);

// Places, covariances, noise, loops and misfit; `weight_sigma` is that of a corner of the weight 1
// by its detector, px.
void set_found(const HandEyeFit& fit, const std::vector<LoopError>& loops, double weight_sigma,
               HandEye& to);

// Sentences: that lengths of board and robot differ, which way the camera's place is poorly known,
// that the robot is noisier than was given, and that views were left out.
void add_hand_eye_remarks(const HandEyeFit& fit, const std::vector<LoopError>& loops,
                          const Board& board, const HandEyeTask& task, HandEye& to);

// The ratio of lengths where that was free and is known at all: a hand that stayed in its place
// says nothing of it.
[[nodiscard]] std::optional<LengthRatio> scale_of(const HandEyeFit& fit);

}  // namespace rig
}  // namespace calvin
