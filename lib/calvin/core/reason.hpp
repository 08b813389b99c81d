// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Why a board, or a view of it, was taken or not: the `reason` of messages and logs.
#pragma once

#include <string_view>

#include "calvin/core/export.hpp"

namespace calvin {

enum class Reason {
  kAccepted,
  kTooSimilar,
  kMoving,
  kBlurred,
  kTooFewPoints,
  kTooSmall,
  kWrongBoard,
  kOffSize,
  kOutlier,
  kNotFound,
};

// "accepted", "too-similar", ...: the words of the `reason` field on the bus.
[[nodiscard]] CALVIN_API std::string_view to_string(Reason reason) noexcept;

}  // namespace calvin
