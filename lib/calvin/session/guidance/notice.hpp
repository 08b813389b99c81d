// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a user should hear while a session goes on.
#pragma once

#include "calvin/core/result.hpp"

namespace calvin {

struct Notice {
  enum class Kind { kInfo, kWarning };
  Kind kind = Kind::kWarning;
  Error error;  // for kInfo its message alone counts
};

}  // namespace calvin
