// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The properties of calibtestsrc.
#pragma once

#include "common/properties.hpp"
#include "testsrc/test_state.hpp"

namespace calvin::gst {

extern const Properties<TestState> kTestProperties;

}  // namespace calvin::gst
