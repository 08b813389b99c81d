// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The text of a length; parse_length() in target/board.hpp reads it. Internal.
#pragma once

#include <string>

namespace calvin {

// m -> "25mm", to a nanometre.
[[nodiscard]] std::string length_text(double metres);

}  // namespace calvin
