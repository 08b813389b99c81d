// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibview was set to, and the scene that it shows.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gst/base/gstbasesrc.h>

#include "calvin/core/image.hpp"
#include "calvin/draw/scene/scene_picture.hpp"
#include "common/properties.hpp"
#include "common/shared_settings.hpp"
#include "common/worker.hpp"

namespace calvin::gst {

struct ViewSettings {
  std::string rig;
  double orbit = 12;  // degrees/s
};

class ViewState : public SharedSettings<ViewSettings> {
 public:
  explicit ViewState(GstBaseSrc* element) : element_(element) {}

  // Any thread. GstBaseSrc keeps whether the source is live.
  [[nodiscard]] bool is_live() { return gst_base_src_is_live(element_) != FALSE; }
  void set_live(bool live) { gst_base_src_set_live(element_, live); }

  // Reads the rig. An error for what is no rig; one that is not there yet is waited for, which is
  // said.
  [[nodiscard]] Status start();
  void stop() { reader_.stop(); }

  // Streaming thread: draws the scene as it is seen at a time of the stream, the rig anew where its
  // file was replaced.
  [[nodiscard]] Status draw(GstClockTime time, ImageSize size, std::uint8_t* pixels,
                            std::ptrdiff_t stride);

  // Any thread: the mouse, in parts of the picture's height.
  void drag_by(double right, double down);
  void zoom_by(double steps);

 private:
  // What tells the files of a rig from the next ones under the same name.
  struct FileStamp {
    std::filesystem::path file;
    std::filesystem::file_time_type written;
    std::uintmax_t size = 0;
    friend bool operator==(const FileStamp&, const FileStamp&) = default;
  };
  using Stamp = std::vector<FileStamp>;
  void look_again();
  [[nodiscard]] static std::optional<Stamp> stamp_of(const std::string& path);

  GstBaseSrc* element_;

  // Under lock_.
  std::shared_ptr<const Scene> scene_;
  SceneViewpoint viewpoint_;  // beside what the orbit adds
  std::optional<Stamp> stamp_;

  std::string path_;      // since start()
  gint64 next_look_ = 0;  // us, monotonic; streaming thread
  Worker reader_;
};

extern const Property<ViewState> kViewProperties[3];

}  // namespace calvin::gst
