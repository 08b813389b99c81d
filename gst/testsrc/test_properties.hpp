// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The properties of calibtestsrc.
#pragma once

#include <string>

#include "common/field.hpp"
#include "testsrc/test_scene.hpp"

namespace calvin::gst {

inline constexpr double kDefaultNoise = 1;
inline constexpr double kDefaultBlur = 0.7;

struct TestSettings {
  SceneSettings scene;
  RenderOptions render{.noise = kDefaultNoise, .blur = kDefaultBlur};
  std::string ground_truth;
  guint64 readout_time = 0;  // ns
};

// Properties 1..kTestSettings are kept in the settings, the one behind them by GstBaseSrc.
inline constexpr guint kTestSettings = 9;
inline constexpr guint kTestIsLive = kTestSettings + 1;

void install_test_properties(GObjectClass* object_class);

// Where the property of that number is kept; nowhere for kTestIsLive.
[[nodiscard]] Field test_field(TestSettings& settings, guint id);

}  // namespace calvin::gst
