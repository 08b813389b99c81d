// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The table of the lenses' traits, made from the list of lenses in camera/meson.build.

#include "calvin/camera/lens_table.hpp"

#include <algorithm>

#include "calvin/camera/models.hpp"

namespace calvin {

namespace {

template <typename Lens>
LensTraits traits_of() {
  LensTraits traits;
  traits.model = Lens::kName;
  traits.coefficients = {Lens::kNames.begin(), Lens::kNames.end()};
  traits.perspective = Lens::kPerspective;
  traits.candidate = Lens::kCandidate;
  traits.opencv = Lens::kOpenCv;
  for (const auto& start : Lens::kStarts) traits.starts.emplace_back(start.begin(), start.end());
  if constexpr (requires { Lens::kNeutral; }) {
    traits.neutral = {Lens::kNeutral.begin(), Lens::kNeutral.end()};
  } else {
    traits.neutral.resize(traits.coefficients.size());
  }
  if constexpr (requires { Lens::kOrders; }) {
    traits.orders = {Lens::kOrders.begin(), Lens::kOrders.end()};
  } else {
    traits.orders.resize(traits.coefficients.size());
  }
  traits.typical = {Lens::kTypical.begin(), Lens::kTypical.end()};
  traits.glsl = Lens::glsl();
  return traits;
}

}  // namespace

// Never freed: while a program ends, its other threads may still be at work.
const std::vector<LensTraits>& all_lenses() {
  static const auto& kLenses = []<typename... Lens>(std::tuple<Lens...>*) -> auto& {
    return *new std::vector<LensTraits>{traits_of<Lens>()...};
  }
  (static_cast<AllLenses*>(nullptr));
  return kLenses;
}

const LensTraits* find_lens(std::string_view model) {
  const auto& lenses = all_lenses();
  const auto it = std::find_if(lenses.begin(), lenses.end(),
                               [model](const LensTraits& lens) { return lens.model == model; });
  return it == lenses.end() ? nullptr : &*it;
}

std::vector<const LensTraits*> lenses_where(const std::function<bool(const LensTraits&)>& wanted) {
  std::vector<const LensTraits*> lenses;
  for (const LensTraits& lens : all_lenses()) {
    if (wanted(lens)) lenses.push_back(&lens);
  }
  std::stable_sort(lenses.begin(), lenses.end(), [](const LensTraits* a, const LensTraits* b) {
    return a->coefficients.size() < b->coefficients.size();
  });
  return lenses;
}

bool share_coefficients(const LensTraits& a, const LensTraits& b) {
  const bool both_brown = a.opencv == OpenCvForm::kBrown && b.opencv == OpenCvForm::kBrown;
  return both_brown || a.model == b.model;
}

}  // namespace calvin
