// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The names and the advice of each cause of a misfit.

#include "calvin/solve/misfit.hpp"

namespace calvin {

std::string_view to_string(Misfit::Cause cause) {
  switch (cause) {
    case Misfit::Cause::kNone:
      return "none";
    case Misfit::Cause::kNoise:
      return "noise";
    case Misfit::Cause::kModel:
      return "model";
    case Misfit::Cause::kBoard:
      return "board";
    case Misfit::Cause::kMotion:
      return "motion";
  }
  return "";
}

std::string advice(Misfit::Cause cause) {
  switch (cause) {
    case Misfit::Cause::kNone:
      return {};
    case Misfit::Cause::kNoise:
      return "Look for blur, low light or compression.";
    case Misfit::Cause::kModel:
      return "Take a richer model, or model=auto.";
    case Misfit::Cause::kBoard:
      return "Fix the board to a stiff plate and measure its squares.";
    case Misfit::Cause::kMotion:
      return "Hold board and camera still in every view, keep the board from bending, or shorten "
             "the exposure.";
  }
  return {};
}

}  // namespace calvin
