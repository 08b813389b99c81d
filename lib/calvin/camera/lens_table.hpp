// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The lenses that this version has.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "calvin/camera/lens_traits.hpp"

namespace calvin {

// All lenses of this version, in the order of model_names().
[[nodiscard]] const std::vector<LensTraits>& all_lenses();

// The lens of a model; nullptr for an unknown one.
[[nodiscard]] const LensTraits* find_lens(std::string_view model);

// The lenses for which `wanted` is true, those with fewer coefficients first.
[[nodiscard]] std::vector<const LensTraits*> lenses_where(
    const std::function<bool(const LensTraits&)>& wanted);

// Whether a coefficient that two lenses call by one name means the same in both.
[[nodiscard]] bool share_coefficients(const LensTraits& a, const LensTraits& b);

}  // namespace calvin
