// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tells the version of the library that runs.

#include "calvin/version.hpp"

#include "calvin_config.h"

namespace calvin {

std::string_view library_version() noexcept { return CALVIN_VERSION; }

}  // namespace calvin
