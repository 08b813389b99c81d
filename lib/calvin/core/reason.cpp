// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The words that messages and logs use for each Reason.

#include "calvin/core/reason.hpp"

namespace calvin {

std::string_view to_string(Reason reason) noexcept {
  switch (reason) {
    case Reason::kAccepted:
      return "accepted";
    case Reason::kTooSimilar:
      return "too-similar";
    case Reason::kMoving:
      return "moving";
    case Reason::kBlurred:
      return "blurred";
    case Reason::kTooFewPoints:
      return "too-few-points";
    case Reason::kTooSmall:
      return "too-small";
    case Reason::kWrongBoard:
      return "wrong-board";
    case Reason::kOffSize:
      return "off-size";
    case Reason::kOutlier:
      return "outlier";
    case Reason::kNotFound:
      return "not-found";
  }
  return "not-found";
}

}  // namespace calvin
