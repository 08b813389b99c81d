// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// From bright pixels to blobs, fitted spots and the light, frame by frame.

#include "calvin/detect/light/light_detector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calvin/detect/light/light_background.hpp"
#include "calvin/detect/light/light_blobs.hpp"
#include "calvin/detect/light/light_choice.hpp"
#include "calvin/detect/light/spot_fit.hpp"
#include "calvin/detect/light/wand_shape.hpp"
#include "calvin/detect/luma.hpp"
#include "calvin/detect/smoothing.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin::detect {

namespace {

constexpr int kFewestPixels = 3;
constexpr int kLeastPeak = 30;          // grey levels above the background
constexpr double kLargest = 1.0 / 8;    // of the shorter side of the image
constexpr int kLargestAtLeast = 16;     // px
constexpr double kThinnest = 0.25;      // px, 1 sigma: a single pixel is no light
constexpr double kRound = 1.4;          // longer over shorter axis, by what lenses stretch
constexpr double kStreak = 8;           // the same of one that moves, at most
constexpr double kUnlike = 0.10;        // of its height, by which a round light is no Gaussian
constexpr double kStreakUnlike = 0.06;  // the same of a streak, as which much else is seen
constexpr std::size_t kMostSpots = 8;   // of one frame: more is no scene for a light
constexpr std::size_t kMostBlobs = 16;  // that may be lights
// What the middle of a streak may be off along it, in its length: light that is not even while the
// shutter is open, and shutters of several cameras that are not open at the same time.
constexpr double kOffMiddle = 0.05;

// What a picture shows that may be the light.
struct Spots {
  std::vector<LightSpotSeen> all;
  double rival = 0;      // flux of the brightest blob that is none
  std::string_view why;  // what was wrong with the best one, for a user
  Reason reason = Reason::kNotFound;
};

class LightDetector final : public Detector {
 public:
  explicit LightDetector(PointLight light)
      : light_(std::move(light)),
        chooser_(light_.is_wand() ? light_.places : std::vector<double>()) {}

  std::vector<Detection> detect_all(const ImageView& image,
                                    std::stop_token stop) noexcept override {
    return guarded(image, stop, [&](const ImageView& plain) { return look_once(plain); });
  }
  std::vector<Detection> follow_all(const ImageView& image, std::uint64_t timestamp,
                                    std::stop_token stop) noexcept override {
    return guarded(image, stop, [&](const ImageView& plain) { return look_on(plain, timestamp); });
  }

 private:
  template <typename Look>
  std::vector<Detection> guarded(const ImageView& image, const std::stop_token& stop,
                                 Look look) noexcept;
  [[nodiscard]] Detection look_once(const ImageView& image);
  [[nodiscard]] Detection look_on(const ImageView& image, std::uint64_t timestamp);
  [[nodiscard]] Spots find_spots(const ImageView& image);
  [[nodiscard]] Detection conclude(const Spots& spots, const LightChoice& choice) const;
  void forget();

  PointLight light_;
  GrayImage copy_;  // of images whose pixels do not lie side by side
  LightBackground background_;
  LightChooser chooser_;
  BlobJoiner joiner_;
  std::vector<BrightRun> runs_;
  std::uint64_t timestamp_ = kNoTimestamp;
};

// ---- One picture
// ---------------------------------------------------------------------------------

int largest_in(ImageSize size) {
  return std::max(kLargestAtLeast, static_cast<int>(kLargest * std::min(size.width, size.height)));
}

bool may_be_light(const LightBlob& blob, int largest) {
  return blob.pixels >= kFewestPixels && blob.peak >= kLeastPeak && blob.longer_side() <= largest;
}

constexpr std::string_view kTooFast =
    "The light moves too fast: a shorter exposure, or move it slowly";

// Too long for a fit to say where its middle is.
bool is_long_streak(const LightBlob& blob) {
  const double length = std::hypot(blob.box.width(), blob.box.height());
  return blob.peak >= kLeastPeak && blob.pixels * kStreak < length * length;
}

// Whether the fit is the blob's: as large as what is seen of it, and much of it is seen.
bool is_of(const LightBlob& blob, const SpotFit& fit, double noise) {
  constexpr double kUncertain = 0.2;  // of the longer axis, by which a place may be uncertain
  constexpr double kLeastBox = 1.5;   // times the longer axis: what is above the threshold is wider
  const double beyond_noise = std::sqrt(std::max(0.0, fit.residual * fit.residual - noise * noise));
  const double unlike = fit.longer > kRound * fit.shorter ? kStreakUnlike : kUnlike;
  return fit.seen >= kLeastPeak / 2.0 && beyond_noise <= unlike * fit.seen &&
         fit.shorter >= kThinnest && fit.sigma_along <= kUncertain * fit.longer &&
         blob.longer_side() >= kLeastBox * fit.longer;
}

// What keeps a fit from being that of a light; empty where it is one.
std::string_view problem_of(const SpotFit& fit, int largest, Reason& reason) {
  if (fit.shorter > largest / 4.0) return "The light is too large: move away, or a smaller one";
  if (fit.longer > kStreak * fit.shorter || fit.longer > largest / 2.0) {
    reason = Reason::kMoving;
    return kTooFast;
  }
  return {};
}

// Grey levels times px^2, what is cut off included, of which the flanks do not say for certain how
// much it is.
double flux_of(const SpotFit& fit) {
  constexpr double kMostHidden = 8;  // times what is seen
  return 2 * std::numbers::pi * std::min(fit.height, kMostHidden * fit.seen) * fit.longer *
         fit.shorter;
}

// px, 1 sigma per coordinate: of a streak that along it, which is the larger one.
double sigma_of(const SpotFit& fit) {
  const double both = std::hypot(fit.sigma_along, fit.sigma_across) / std::sqrt(2.0);
  const double round = kRound * fit.shorter;
  if (fit.longer <= round) return both;
  // The length of a straight streak of even brightness by its variance.
  const double length = std::sqrt(12 * (fit.longer * fit.longer - round * round));
  return std::hypot(std::max(both, fit.sigma_along), kOffMiddle * length);
}

Spots LightDetector::find_spots(const ImageView& image) {
  const int largest = largest_in(image.size());
  const double noise = noise_of(image);
  Spots spots;
  std::vector<LightBlob> blobs;
  for (const LightBlob& blob : joiner_.join(image, background_, runs_)) {
    if (may_be_light(blob, largest)) {
      blobs.push_back(blob);
    } else {
      spots.rival = std::max(spots.rival, blob.flux);
      if (!is_long_streak(blob)) continue;
      spots.reason = Reason::kMoving;
      spots.why = kTooFast;
    }
  }
  std::ranges::sort(blobs, std::greater(), &LightBlob::flux);
  if (blobs.size() > kMostBlobs) {
    spots.why = "Too much moves in the picture: a light alone, before a camera that stands still";
    return spots;
  }
  blobs.resize(std::min(blobs.size(), kMostSpots));
  for (const LightBlob& blob : blobs) {
    const auto fit = fit_spot(image, background_, blob);
    Reason reason = Reason::kNotFound;
    const bool is_its = fit && is_of(blob, *fit, noise);
    if (!is_its && is_long_streak(blob)) reason = Reason::kMoving;
    const std::string_view problem = is_its ? problem_of(*fit, largest, reason)
                                     : reason == Reason::kMoving
                                         ? kTooFast
                                         : "What is bright and moves is no small light";
    if (problem.empty()) {
      spots.all.push_back({*fit, flux_of(*fit), blob.box});
      continue;
    }
    spots.rival = std::max(spots.rival, blob.flux);
    if (spots.why.empty()) {
      spots.why = problem;
      spots.reason = reason;
    }
  }
  return spots;
}

Detection LightDetector::conclude(const Spots& spots, const LightChoice& choice) const {
  Detection result;
  if (choice.spots.empty()) {
    result.reason = spots.all.empty() ? spots.reason : Reason::kNotFound;
    result.obstacle = spots.all.empty() ? spots.why : choice.why;
    return result;
  }
  result.reason = Reason::kAccepted;
  result.observation.ids = light_.ids();
  for (const std::size_t spot : choice.spots) {
    const SpotFit& light = spots.all[spot].fit;
    result.observation.uv.push_back(light.centre);
    result.observation.sigma.push_back(sigma_of(light));
  }
  return result;
}

// The median of some pixels, and the noise about it by the median difference.
struct RoomLevel {
  std::uint8_t level = 0;
  std::uint8_t spread = 0;
};

RoomLevel level_of_room(const ImageView& image) {
  constexpr int kStep = 3;  // px, in both directions
  std::array<int, 256> counts{};
  int samples = 0;
  for (int y = 0; y < image.height; y += kStep) {
    for (int x = 0; x < image.width; x += kStep, ++samples) ++counts[image.at(x, y)];
  }
  const auto quantile = [&](double share) {
    int level = 0;
    for (int below = counts[0]; level < 255 && below <= share * samples;) {
      below += counts[static_cast<std::size_t>(++level)];
    }
    return level;
  };
  const int median = quantile(0.5);
  // Four times the quartile's distance, as the background has it.
  const int spread = std::clamp(4 * (quantile(0.75) - median), 8, 100);
  return {static_cast<std::uint8_t>(median), static_cast<std::uint8_t>(spread)};
}

// A picture alone does not tell lamps from lights: the light, or the wand, has to be the one bright
// thing.
Detection LightDetector::look_once(const ImageView& image) {
  constexpr double kMostBright = 1.0 / 64;  // of the picture
  const RoomLevel room = level_of_room(image);
  background_.start(image.size(), room.level, room.spread);
  const double pixels = static_cast<double>(image.width) * image.height;
  Spots spots;
  if (background_.find_brighter(image, static_cast<std::size_t>(kMostBright * pixels), runs_)) {
    spots = find_spots(image);
  }
  // Any other one may be the light, however weak.
  if (spots.all.size() > light_.places.size()) spots.rival = HUGE_VAL;
  const LightChoice choice = chooser_.choose(spots.all, spots.rival);
  Detection result = conclude(spots, choice);
  forget();
  return result;
}

// ---- A video
// -------------------------------------------------------------------------------------

void LightDetector::forget() {
  background_.forget();
  chooser_.forget();
  timestamp_ = kNoTimestamp;
}

Detection LightDetector::look_on(const ImageView& image, std::uint64_t timestamp) {
  constexpr double kMostBrighter = 0.25;  // of the picture: then it is another one
  const bool known = timestamp != kNoTimestamp && timestamp_ != kNoTimestamp;
  if (known && timestamp < timestamp_) forget();
  timestamp_ = timestamp;
  const double pixels = static_cast<double>(image.width) * image.height;
  if (!background_.has(image.size()) ||
      !background_.find_brighter(image, static_cast<std::size_t>(kMostBrighter * pixels), runs_)) {
    background_.start(image);
    chooser_.forget();
    return {};
  }
  const Spots spots = find_spots(image);
  const LightChoice choice = chooser_.choose(spots.all, 0);
  std::vector<PixelBox> kept;
  for (const LightSpotSeen& spot : spots.all) {
    kept.push_back(spot.box.grown(2 + (spot.box.width() + spot.box.height()) / 4, image.size()));
  }
  background_.learn(image, kept);
  for (const PixelBox& lamp : chooser_.lamps()) {
    background_.take(image, lamp.grown(2 + (lamp.width() + lamp.height()) / 4, image.size()));
  }
  return conclude(spots, choice);
}

template <typename Look>
std::vector<Detection> LightDetector::guarded(const ImageView& image, const std::stop_token& stop,
                                              Look look) noexcept {
  try {
    std::vector<Detection> results(1);
    if (image.data != nullptr && image.width > 0 && image.height > 0 && !stop.stop_requested()) {
      ImageView plain = image;
      if (image.step != 1) {
        take_luma(image, copy_);
        plain = copy_.view();
      }
      results.front() = look(plain);
    }
    results.front().observation.board = light_.text();
    results.front().observation.image_size = image.size();
    return results;
  } catch (const std::exception&) {
    forget();
    return {};  // no memory
  }
}

}  // namespace

Status check_light(const Board& board) {
  const auto* light = board.as<PointLight>();
  return light == nullptr ? Status() : check_shape(*light);
}

bool is_light(const Board& board) { return board.as<PointLight>() != nullptr; }

std::unique_ptr<Detector> make_light_detector(std::span<const Board> boards) {
  return std::make_unique<LightDetector>(*boards.front().as<PointLight>());
}

}  // namespace calvin::detect
