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

#include <gst/gst.h>

#include "calvin/core/image.hpp"
#include "calvin/draw/scene/scene_picture.hpp"
#include "common/properties.hpp"
#include "common/shared_settings.hpp"
#include "common/worker.hpp"

namespace calvin::gst {

struct ViewSettings {
  std::string rig;
  double orbit = 12;  // degrees/s
  bool is_live = false;
  int num_buffers = -1;
};

// Shared by the bin and its child, the source or the filter.
class ViewState : public SharedSettings<ViewSettings> {
 public:
  // Reads the rig. An error for what is no rig; one that is not there yet is waited for, which is
  // said in the name of the element: not where `may_come`, as one may by an event.
  [[nodiscard]] Status start(GstElement* element, bool may_come);
  void stop() { reader_.stop(); }

  // Streaming thread: the rig of upstream, where none was set.
  [[nodiscard]] Status show(const std::string& json);

  // Streaming thread: draws the scene as it is seen at a time of the stream, the rig anew where its
  // file was replaced.
  [[nodiscard]] Status draw(GstClockTime time, ImageSize size, std::uint8_t* pixels,
                            std::ptrdiff_t stride);

  // Any thread: what a mouse does in a picture of that height, px.
  void navigate(GstEvent* event, int height);

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

  void press(int button, double x, double y);
  void release(int button);
  void move_to(double x, double y, int height);
  void zoom_by(double steps);

  // Under lock_.
  std::shared_ptr<const Scene> scene_;
  SceneViewpoint viewpoint_;  // beside what the orbit adds
  std::optional<Stamp> stamp_;
  std::optional<Pixel> held_;  // where a button is held

  std::string path_;      // since start()
  gint64 next_look_ = 0;  // us, monotonic; streaming thread
  Worker reader_;
};

extern const Property<ViewState> kViewProperties[4];

}  // namespace calvin::gst
