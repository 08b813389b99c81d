// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/remap/map.hpp"

#include <cmath>
#include <new>
#include <stdexcept>

namespace calvin {

namespace {

// Rays through the pixels of a pinhole; any other output model goes through unproject().
class RayCaster {
 public:
  explicit RayCaster(const Camera& camera)
      : camera_(camera), pinhole_(camera.model() == "pinhole" && camera.skew() == 0) {}

  [[nodiscard]] std::optional<Eigen::Vector3d> ray(double x, double y) const noexcept {
    if (!pinhole_) return camera_.unproject({x, y});
    return Eigen::Vector3d((x - camera_.cx()) / camera_.fx(), (y - camera_.cy()) / camera_.fy(), 1);
  }

 private:
  const Camera& camera_;
  bool pinhole_;
};

// The place in the source frame, clamped onto it where it misses by rounding only.
std::optional<Pixel> look_up(const Camera& source, const RayCaster& output, double x,
                             double y) noexcept {
  const auto ray = output.ray(x, y);
  if (!ray) return std::nullopt;
  const auto pixel = source.project(*ray);
  if (!pixel) return std::nullopt;
  constexpr double kSlack = 0.5 / RemapMap::kOne;
  const double right = source.image_size().width - 1;
  const double bottom = source.image_size().height - 1;
  if (!(pixel->u >= -kSlack && pixel->u <= right + kSlack && pixel->v >= -kSlack &&
        pixel->v <= bottom + kSlack)) {
    return std::nullopt;
  }
  return pixel;
}

std::int32_t to_fixed(double sample) {
  return static_cast<std::int32_t>(std::lrint(sample * RemapMap::kOne));
}

}  // namespace

bool is_inside(const Camera& source, const Camera& output, double x, double y) noexcept {
  return look_up(source, RayCaster(output), x, y).has_value();
}

Result<RemapMap> RemapMap::build(const Camera& source, const Camera& output,
                                 const PlaneSites& sites, const std::stop_token& stop) {
  const auto axes = [](ImageSize size, const Subsampling& s) {
    return std::pair(SampleAxis(size.width, s.x_shift, s.x_cosited),
                     SampleAxis(size.height, s.y_shift, s.y_cosited));
  };
  const auto [out_x, out_y] = axes(output.image_size(), sites.output);
  const auto [in_x, in_y] = axes(source.image_size(), sites.source);
  const RayCaster caster(output);
  RemapMap map;
  map.size_ = {out_x.count(), out_y.count()};
  try {
    map.entries_.resize(static_cast<std::size_t>(map.size_.width) *
                        static_cast<std::size_t>(map.size_.height));
  } catch (const std::bad_alloc&) {
    return make_error(ErrorCode::kInvalidArgument,
                      "There is not enough memory for a map of that size.");
  }
  MapEntry* entry = map.entries_.data();
  for (int y = 0; y < map.size_.height; ++y) {
    if (stop.stop_requested()) return make_error(ErrorCode::kCancelled, "The work was cancelled.");
    const double site_y = out_y.site(y);
    for (int x = 0; x < map.size_.width; ++x, ++entry) {
      const auto place = look_up(source, caster, out_x.site(x), site_y);
      if (place) *entry = {to_fixed(in_x.sample(place->u)), to_fixed(in_y.sample(place->v))};
    }
  }
  return map;
}

}  // namespace calvin
