// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One element that gets something bad, and what must come of it.
#pragma once

#include <fstream>

#include <sys/stat.h>

#include "undistort_fixture.hpp"

#include <gst/check/gstharness.h>

namespace calvin::check {

// What the failure policy says of an element that was given something bad.
enum class After {
  kRefused,  // ERROR, and it does not start
  kStopped,  // ERROR, and the stream ends there
  kDropped,  // WARNING, and the frame does not come out, but the others do
  kGoesOn,   // WARNING, and the frames come out as they did before
};

// What a build must have been made with to come upon this input.
enum class Needs { kNothing, kFormats, kToml, kDrawing };

class InputFixture;

struct BadInput {
  const char* what;
  const char* element;  // "NAME PROPERTY=VALUE ..."
  void (*give)(InputFixture&, const std::string& input);
  std::string input;   // "@" stands for the folder with the files
  const char* says;    // a part of the message: what is wrong
  const char* advice;  // another one: what to do
  After after;
  Needs needs = Needs::kNothing;
};

// Files as nobody wants them.
inline void make_bad_files(const TemporaryFolder& folder) {
  std::filesystem::create_directory(folder / "directory");
  ::mkfifo((folder / "pipe").c_str(), 0600);
  std::ofstream(folder / "empty").close();
  std::ofstream(folder / "binary")
      .write(
          "\x7f"
          "ELF\0\0\1\2\3",
          9);
  std::filesystem::create_symlink("loop", folder / "loop");
  std::ofstream(folder / "huge").close();
  std::filesystem::resize_file(folder / "huge", std::uintmax_t{1} << 32);
  std::ofstream(folder / "no-names.json") << "[1, 2]";
  std::ofstream(folder / "names.json")
      << R"({"format": "calvin-boards", "version": 1, "boards": {"floor": "names.json#floor"}})";
}

// Gives the input and collects what the element says. `give` uses it in the order of its functions.
class InputFixture {
 public:
  explicit InputFixture(const BadInput& bad)
      : bad_(bad),
        element_(gst_object_ref_sink(make_element(bad.element))),
        bus(GST_ELEMENT(element_)) {
    make_bad_files(folder_);
  }
  ~InputFixture() {
    if (h_ != nullptr) {
      gst_harness_teardown(h_);
    } else {
      gst_element_set_state(element(), GST_STATE_NULL);
    }
    bus.detach();
    gst_object_unref(element_);
  }

  [[nodiscard]] GstElement* element() const { return GST_ELEMENT(element_); }
  [[nodiscard]] bool goes_on() const { return bad_.after >= After::kDropped; }
  [[nodiscard]] bool drops() const { return bad_.after == After::kDropped; }
  [[nodiscard]] const char* what() const { return bad_.what; }
  [[nodiscard]] std::string in_folder(std::string text) const {
    for (auto at = text.find('@'); at != std::string::npos; at = text.find('@', at)) {
      text.replace(at, 2, folder_ / "");
    }
    return text;
  }

  // "PROPERTY=VALUE"
  void set(const std::string& text) {
    const auto equals = text.find('=');
    const std::string name = text.substr(0, equals);
    const std::string value = in_folder(text.substr(equals + 1));
    const GParamSpec* spec =
        g_object_class_find_property(G_OBJECT_GET_CLASS(element_), name.c_str());
    g_assert_nonnull(spec);
    if (spec->value_type == G_TYPE_STRING) {
      g_object_set(element_, name.c_str(), value.c_str(), nullptr);
    } else {
      gst_util_set_object_arg(G_OBJECT(element_), name.c_str(), value.c_str());
    }
  }
  [[nodiscard]] bool starts() {
    return gst_element_set_state(element(), GST_STATE_PAUSED) != GST_STATE_CHANGE_FAILURE;
  }
  // From here on there are pads to push into and to pull from.
  void open() {
    gst_element_set_state(element(), GST_STATE_NULL);
    h_ = gst_harness_new_with_element(element(), "sink", "src");
  }
  void open_with_caps() {
    open();
    gst_harness_set_src_caps(h_, caps_of("GRAY8", kSize));
  }
  // What a harness does only together with good caps.
  void begin() { gst_pad_push_event(h_->srcpad, gst_event_new_stream_start("bad")); }
  void begin_segment() {
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    gst_pad_push_event(h_->srcpad, gst_event_new_segment(&segment));
  }
  [[nodiscard]] GstHarness* harness() const { return h_; }
  [[nodiscard]] GstFlowReturn push(GstBuffer* buffer) { return gst_harness_push(h_, buffer); }
  [[nodiscard]] guint waiting() const { return gst_harness_buffers_in_queue(h_); }
  // The bytes of the frame that comes out for one of noise.
  [[nodiscard]] std::vector<guint8> frame() {
    g_autoptr(GstBuffer) out = gst_harness_push_and_pull(h_, Fixture::noise("GRAY8", kSize, n_++));
    return bytes(out);
  }
  static std::vector<guint8> bytes(GstBuffer* buffer) {
    std::vector<guint8> all(gst_buffer_get_size(buffer));
    if (!all.empty()) gst_buffer_extract(buffer, 0, all.data(), all.size());
    return all;
  }

 private:
  const BadInput& bad_;
  TemporaryFolder folder_;
  gpointer element_;
  GstHarness* h_ = nullptr;
  int n_ = 0;

 public:
  Bus bus;
};

}  // namespace calvin::check
