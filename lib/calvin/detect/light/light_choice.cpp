// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Compares the fluxes and the places of spots with each other and with those of the light before.

#include "calvin/detect/light/light_choice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/detect/light/wand_shape.hpp"
#include "calvin/geometry/pixels.hpp"

namespace calvin::detect {

namespace {

// By what the light outshines its reflections, which mirrors alone do not weaken.
constexpr double kFarBrighter = 3;
// Of its flux: what is so weak all of a sudden is a reflection while the light itself is covered.
constexpr double kWeak = 0.1;
constexpr double kFading = 0.98;      // of the remembered flux, per frame without the light
constexpr int kFollowed = 5;          // frames without the light in which its place is expected
constexpr double kLeastReach = 10;    // px that the light may be off its expected place
constexpr double kReachOfStep = 1.5;  // the same, in steps of the last two frames
constexpr double kStill = 1.5;        // px, of what stands
constexpr int kStands = 15;           // frames

}  // namespace

void LightChooser::forget() { *this = LightChooser(std::move(wand_)); }

bool LightChooser::goes_on(const LightSpotSeen& spot) const {
  if (!last_ || frames_since_ >= kFollowed) return false;
  const int frames = frames_since_ + 1;
  const Pixel expected = {last_->u + frames * step_.u, last_->v + frames * step_.v};
  const double reach = kLeastReach + kReachOfStep * std::hypot(step_.u, step_.v) * frames;
  return distance(expected, spot.fit.centre) < reach;
}

LightChoice LightChooser::pick(const std::vector<LightSpotSeen>& spots, double rival) const {
  if (spots.empty()) return {};
  const auto brightest = std::ranges::max_element(spots, {}, &LightSpotSeen::flux);
  for (const LightSpotSeen& spot : spots) {
    if (&spot != &*brightest) rival = std::max(rival, spot.flux);
  }
  const auto place = [&](const LightSpotSeen& spot) {
    return static_cast<std::size_t>(&spot - spots.data());
  };
  if (brightest->flux >= kFarBrighter * rival) {
    if (brightest->flux < kWeak * flux_ && !goes_on(*brightest)) {
      return {{}, "What is seen is much weaker than the light was: it may be a reflection"};
    }
    return {{place(*brightest)}, {}};
  }
  const auto next = std::ranges::find_if(spots, [&](const auto& s) { return goes_on(s); });
  const bool is_one =
      next != spots.end() &&
      std::none_of(next + 1, spots.end(), [&](const auto& s) { return goes_on(s); });
  if (is_one && kFarBrighter * next->flux >= std::max(rival, brightest->flux)) {
    return {{place(*next)}, {}};
  }
  return {{}, "Several lights are in view: cover the others, and what reflects them"};
}

// Of all sets that lie as the wand does the one that is far brighter than the others.
LightChoice LightChooser::pick_wand(const std::vector<LightSpotSeen>& spots, double rival) const {
  if (spots.size() < wand_.size()) {
    return {{}, spots.empty() ? "" : "Not all lights of the wand are in view"};
  }
  const auto sets = sets_of_wand(spots, wand_);
  if (sets.empty()) {
    return {{}, "What is seen lies otherwise than the lights of the wand: cover other lights"};
  }
  const auto flux = [&](const std::vector<std::size_t>& set) {
    double sum = 0;
    for (const std::size_t i : set) sum += spots[i].flux;
    return sum;
  };
  const auto best = std::ranges::max_element(sets, {}, flux);
  for (const auto& set : sets) {
    if (&set != &*best) rival = std::max(rival, flux(set));
  }
  if (flux(*best) < kFarBrighter * rival) {
    return {{}, "Several lights lie as those of the wand do: cover what reflects them"};
  }
  if (flux(*best) < kWeak * flux_) {
    return {{}, "What is seen is much weaker than the wand was: it may be a reflection"};
  }
  return {*best, {}};
}

void LightChooser::remember_flux(double flux) {
  constexpr double kNewest = 0.2;  // of it
  flux_ = flux_ > 0 ? std::max(flux_ + kNewest * (flux - flux_), flux) : flux;
}

void LightChooser::remember(const LightSpotSeen& light) {
  const Pixel now = light.fit.centre;
  if (last_ && frames_since_ == 0) {
    step_ = {now.u - last_->u, now.v - last_->v};
  } else {
    step_ = {};
  }
  last_ = now;
  frames_since_ = 0;
  remember_flux(light.flux);
}

void LightChooser::note_others(const std::vector<LightSpotSeen>& spots, const LightChoice& choice) {
  std::vector<Standing> now;
  lamps_.clear();
  for (std::size_t i = 0; i < spots.size(); ++i) {
    if (std::ranges::find(choice.spots, i) != choice.spots.end()) continue;
    const Pixel at = spots[i].fit.centre;
    const auto before = std::ranges::find_if(
        standing_, [&](const Standing& s) { return distance(s.at, at) < kStill; });
    // From where it was seen first: what creeps does not stand.
    Standing standing = before == standing_.end() ? Standing{at, 0} : *before;
    if (++standing.frames >= kStands) {
      lamps_.push_back(spots[i].box);
    } else {
      now.push_back(standing);
    }
  }
  standing_ = std::move(now);
}

LightChoice LightChooser::choose(const std::vector<LightSpotSeen>& spots, double rival) {
  const LightChoice choice = wand_.empty() ? pick(spots, rival) : pick_wand(spots, rival);
  note_others(spots, choice);
  if (choice.spots.size() == 1) {
    remember(spots[choice.spots.front()]);
  } else if (!choice.spots.empty()) {
    double flux = 0;
    for (const std::size_t i : choice.spots) flux += spots[i].flux;
    remember_flux(flux);
  } else {
    ++frames_since_;
    flux_ *= kFading;
  }
  return choice;
}

}  // namespace calvin::detect
