// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads the rig, at the start and whenever its file is another one.

#include "view/view_state.hpp"

#include <numbers>
#include <system_error>
#include <utility>

#include "calvin/io/rig_io.hpp"
#include "common/messages.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibview_debug);
#define GST_CAT_DEFAULT calibview_debug

namespace calvin::gst {

namespace {

constexpr double kDegree = std::numbers::pi / 180;

Result<Rig> read_setting(const std::string& text) {
  if (text.empty()) {
    return make_error(ErrorCode::kInvalidArgument,
                      "There is no rig to show: set rig=FILE, as calibrig location=FILE or "
                      "calvin-rig has written it.");
  }
  return text.starts_with('{') ? parse_rig(text) : read_rig(text);
}

}  // namespace

const Property<ViewState> kViewProperties[4] = {
    {"rig",
     "Rig",
     "The rig to show: its file or folder, read again when a file is replaced, or its JSON (unset: "
     "that of the calibrig upstream)",
     kept_in<&ViewSettings::rig>,
     {.flags = kMutableReady}},
    {"orbit",
     "Orbit",
     "How fast whoever looks goes around the rig (degrees per second; 0 = not at all)",
     kept_in<&ViewSettings::orbit>,
     {.range = Range{-360, 360}}},
    {"is-live",
     "Is Live",
     "Make each frame at its time, as a camera does; a filter has the frames of its input",
     kept_in<&ViewSettings::is_live>,
     {.flags = kMutableReady}},
    {"num-buffers",
     "Number of Buffers",
     "Number of frames to make before EOS (-1 = no end)",
     kept_in<&ViewSettings::num_buffers>,
     {.range = Range{-1, G_MAXINT}, .flags = kMutableReady}},
};

std::optional<ViewState::Stamp> ViewState::stamp_of(const std::string& path) {
  Stamp stamp;
  for (std::filesystem::path& file : files_of_rig(path)) {
    std::error_code error;
    const auto written = std::filesystem::last_write_time(file, error);
    if (error) return std::nullopt;
    const auto size = std::filesystem::file_size(file, error);
    if (error) return std::nullopt;
    stamp.push_back({std::move(file), written, size});
  }
  if (stamp.empty()) return std::nullopt;
  return stamp;
}

Status ViewState::start(GstElement* element, bool may_come) {
  path_ = settings().rig;
  const bool is_awaited = path_.empty() && may_come;
  const auto stamp = stamp_of(path_);
  const auto rig = read_setting(path_);
  const bool is_there_later = !rig && (path_.empty() || rig.error().code == ErrorCode::kNotFound);
  if (!rig && !is_there_later) return tl::unexpected<Error>(rig.error());
  if (is_there_later && !is_awaited) post_warning(element, rig.error());
  auto scene = std::make_shared<Scene>();
  if (rig) {
    *scene = make_scene(*rig);
  } else {
    scene->notes = {"no rig yet"};
  }
  {
    const std::lock_guard guard(lock_);
    scene_ = std::move(scene);
    viewpoint_ = {};
    stamp_ = rig ? stamp : std::nullopt;
    held_.reset();
  }
  next_look_ = 0;
  return reader_.start();
}

Status ViewState::show(const std::string& json) {
  if (!path_.empty()) return {};
  const auto rig = parse_rig(json);
  if (!rig) return tl::unexpected<Error>(rig.error());
  auto scene = std::make_shared<const Scene>(make_scene(*rig));
  const std::lock_guard guard(lock_);
  scene_ = std::move(scene);
  return {};
}

// What cannot be read may be half written: the old rig stays until there is another one.
void ViewState::look_again() {
  constexpr gint64 kEvery = 500'000;  // us
  const gint64 now = g_get_monotonic_time();
  if (now < next_look_ || path_.empty() || path_.starts_with('{')) return;
  next_look_ = now + kEvery;
  reader_.offer([this, path = path_](const std::stop_token& stop) {
    const auto stamp = stamp_of(path);
    {
      const std::lock_guard guard(lock_);
      if (!stamp || stamp == stamp_) return;
    }
    const auto rig = read_rig(path);
    if (!rig) return;
    GST_INFO("the rig in '%s' was replaced", path.c_str());
    auto scene = std::make_shared<const Scene>(make_scene(*rig));
    const std::lock_guard guard(lock_);
    if (stop.stop_requested()) return;
    scene_ = std::move(scene);
    stamp_ = stamp;
  });
}

Status ViewState::draw(GstClockTime time, ImageSize size, std::uint8_t* pixels,
                       std::ptrdiff_t stride) {
  look_again();
  std::shared_ptr<const Scene> scene;
  SceneViewpoint viewpoint;
  {
    const std::lock_guard guard(lock_);
    scene = scene_;
    viewpoint = viewpoint_;
    viewpoint.azimuth +=
        kDegree * settings_.orbit * static_cast<double>(time) / static_cast<double>(GST_SECOND);
  }
  return draw_scene(*scene, viewpoint, size, pixels, stride);
}

}  // namespace calvin::gst
