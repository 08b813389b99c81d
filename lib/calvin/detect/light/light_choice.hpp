// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which of several bright spots is the light: the one that is far brighter than all others, or that
// goes on where the light was; of a wand, those that lie as its lights do. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/light/light_background.hpp"
#include "calvin/detect/light/spot_fit.hpp"

namespace calvin::detect {

// A spot that may be the light.
struct LightSpotSeen {
  SpotFit fit;
  double flux = 0;  // grey levels times px^2, above the background, as if nothing were cut off
  PixelBox box;     // around its bright pixels
};

struct LightChoice {
  // Of each light, in their order: which spot it is. Empty where that is not certain.
  std::vector<std::size_t> spots;
  std::string_view why;  // in words for a user, where there was one to choose
};

// Remembers the light from frame to frame.
class LightChooser {
 public:
  // Of a wand the places of its lights along it; of one light nothing.
  explicit LightChooser(std::vector<double> wand = {}) : wand_(std::move(wand)) {}

  void forget();

  // To be called once for each frame, with all spots of it. `rival` is the flux of the brightest
  // thing beside them that might be the light.
  [[nodiscard]] LightChoice choose(const std::vector<LightSpotSeen>& spots, double rival);

  // Of the spots of the last choice those that were not chosen and have stood still for a while:
  // lamps that were switched on.
  [[nodiscard]] const std::vector<PixelBox>& lamps() const noexcept { return lamps_; }

 private:
  // A spot that was not chosen, and for how many frames it has been where it is.
  struct Standing {
    Pixel at;
    int frames = 0;
  };

  [[nodiscard]] LightChoice pick(const std::vector<LightSpotSeen>& spots, double rival) const;
  [[nodiscard]] LightChoice pick_wand(const std::vector<LightSpotSeen>& spots, double rival) const;
  [[nodiscard]] bool goes_on(const LightSpotSeen& spot) const;
  void remember(const LightSpotSeen& light);
  void remember_flux(double flux);
  void note_others(const std::vector<LightSpotSeen>& spots, const LightChoice& choice);

  std::vector<double> wand_;
  std::optional<Pixel> last_;  // where the light was when it was found last
  Pixel step_;                 // px per frame
  int frames_since_ = 0;
  double flux_ = 0;  // of the light, fading while it is not found
  std::vector<Standing> standing_;
  std::vector<PixelBox> lamps_;
};

}  // namespace calvin::detect
