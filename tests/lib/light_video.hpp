// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A video of lights before a room that a detector follows, with what is true of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "calvin/detect/detector.hpp"
#include "calvin/synth/filter.hpp"
#include "calvin/synth/light_spot.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"
#include "scenes.hpp"

namespace calvin::scenes {

class LightVideo {
 public:
  LightVideo(ImageSize size, const RenderOptions& options, const Board& board = light())
      : camera_(default_camera(size)),
        options_(options),
        detector_(make_detector(board).value()),
        room_(render_board(camera_, light(), {Eigen::Matrix3d::Identity(), {0, 0, -1}},
                           {.blur = options.blur,
                            .dark = options.dark,
                            .glow = options.glow,
                            .lamps = options.lamps})) {}

  static Board light() { return PointLight{}; }
  [[nodiscard]] const Camera& camera() const { return camera_; }
  [[nodiscard]] RenderOptions& options() { return options_; }
  [[nodiscard]] Detector& detector() { return *detector_; }

  // Whether a lamp is within some px of a place.
  [[nodiscard]] bool is_before_a_lamp(Pixel at) const {
    constexpr int kNear = 8;
    for (int y = static_cast<int>(at.v) - kNear; y <= static_cast<int>(at.v) + kNear; ++y) {
      for (int x = static_cast<int>(at.u) - kNear; x <= static_cast<int>(at.u) + kNear; ++x) {
        const int u = std::clamp(x, 0, room_.width - 1);
        const int v = std::clamp(y, 0, room_.height - 1);
        if (room_.view().at(u, v) > options_.dark + 8) return true;
      }
    }
    return false;
  }

  // A picture of the room with lights at these places, m, each as bright as a share of the glow.
  [[nodiscard]] GrayImage picture(const std::vector<Eigen::Vector3d>& lights,
                                  const std::vector<double>& shares = {}) {
    synth::FloatImage image = room();
    for (std::size_t i = 0; i < lights.size(); ++i) {
      const double share = i < shares.size() ? shares[i] : 1;
      add(image, camera_.project(lights[i]).value(), lights[i].norm(), share);
    }
    return finished(image);
  }

  // The next frame, with lights or none.
  Detection look(const std::vector<Eigen::Vector3d>& lights,
                 const std::vector<double>& shares = {}) {
    return follow(picture(lights, shares));
  }
  Detection look(const Eigen::Vector3d& light) { return look(std::vector{light}); }
  void look_at_the_room(int frames) {
    for (int i = 0; i < frames; ++i) (void)look(std::vector<Eigen::Vector3d>{});
  }
  // A light that moves by `way` px while the shutter is open, 1.5 m away.
  Detection look_at_streak(Pixel middle, Pixel way) {
    synth::FloatImage image = room();
    const int parts = 4 * static_cast<int>(std::ceil(std::hypot(way.u, way.v))) + 1;
    for (int i = 0; i < parts; ++i) {
      const double t = (i + 0.5) / parts - 0.5;
      add(image, {middle.u + t * way.u, middle.v + t * way.v}, 1.5, 1.0 / parts);
    }
    return follow(finished(image));
  }
  // A disc of even brightness around a place, as of an LED in a diffuse cap, m.
  Detection look_at_disc(const Eigen::Vector3d& at, double diameter) {
    synth::FloatImage image = room();
    const Pixel middle = camera_.project(at).value();
    const double radius = diameter / 2 * camera_.fx() / at.z();  // px, nearly round
    constexpr double kStep = 0.25;                               // px, much less than the blur
    const int reach = static_cast<int>(radius / kStep) + 1;
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        if (std::hypot(i * kStep, j * kStep) > radius) continue;
        const synth::LightSpot part = {
            {middle.u + i * kStep, middle.v + j * kStep},
            options_.blur * options_.blur,
            0,
            options_.blur * options_.blur,
            options_.glow * kStep * kStep / (2 * std::numbers::pi * options_.blur * options_.blur)};
        synth::add_light(image, [&](double /*v*/) { return std::optional(part); });
      }
    }
    return follow(finished(image));
  }
  Detection follow(const GrayImage& image) {
    const std::uint64_t time = 33'333'333 * frame_++;
    return detector_->follow(image.view(), time);
  }

 private:
  [[nodiscard]] synth::FloatImage room() const {
    synth::FloatImage image(camera_.image_size());
    const double more = options_.dark - room_level_;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      image.pixels[i] = static_cast<float>(room_.pixels[i] + more);
    }
    return image;
  }
  void add(synth::FloatImage& image, Pixel at, double distance, double share) const {
    auto spot = synth::light_spot(camera_, distance * camera_.unproject(at).value(),
                                  PointLight::kDiameter, share * options_.glow, options_.blur);
    synth::add_light(image, [&](double /*v*/) { return spot; });
  }
  [[nodiscard]] GrayImage finished(const synth::FloatImage& image) {
    return synth::quantise(image, options_.noise, noise_seed(options_.seed, noise_++));
  }

  Camera camera_;
  RenderOptions options_;
  std::unique_ptr<Detector> detector_;
  GrayImage room_;
  double room_level_ = options_.dark;  // of the room when it was rendered
  std::uint64_t frame_ = 0;
  std::uint64_t noise_ = 0;
};

}  // namespace calvin::scenes
