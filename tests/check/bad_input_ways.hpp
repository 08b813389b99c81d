// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The ways in which an element gets something bad. Each sees to it that the frames are as the
// failure policy says: none, or those that came before.
#pragma once

#include "bad_input.hpp"
#include "guarded_memory.hpp"

#include <gst/check/gstcheck.h>

namespace calvin::check {

// A property before the start; or none, where the element's own text is bad.
inline void at_start(InputFixture& fixture, const std::string& input) {
  if (!input.empty()) fixture.set(input);
  const bool started = fixture.starts();
  fail_unless(started == fixture.goes_on(), "%s: %s", fixture.what(),
              started ? "starts" : "does not start");
  if (!started) return;
  fixture.open_with_caps();
  g_autoptr(GstBuffer) same = Fixture::noise("GRAY8", kSize, 0);
  fail_unless(fixture.frame() == InputFixture::bytes(same), "%s changes the frames",
              fixture.what());
}

// The content of the file that the property `calibration` names.
inline void in_file(InputFixture& fixture, const std::string& input) {
  std::ofstream(fixture.in_folder("@/camera.txt")) << input;
  at_start(fixture, "calibration=@/camera.txt");
}

template <typename Give>
void between_frames(InputFixture& fixture, Give give) {
  fixture.open_with_caps();
  const auto before = fixture.frame();
  give();
  const auto after = fixture.frame();
  fail_unless(before == after, "%s changes the frames", fixture.what());
}

inline void while_running(InputFixture& fixture, const std::string& input) {
  between_frames(fixture, [&] { fixture.set(input); });
}

// Likewise, of what a disk has to answer for: heard of a few frames later.
inline void while_running_beside(InputFixture& fixture, const std::string& input) {
  while_running(fixture, input);
  for (int i = 0; i < 3000 && fixture.bus.texts(GST_MESSAGE_WARNING).empty(); ++i) {
    g_usleep(10000);
    static_cast<void>(fixture.frame());
  }
}

inline void signal(InputFixture& fixture, const std::string& input) {
  between_frames(fixture, [&] { g_signal_emit_by_name(fixture.element(), input.c_str()); });
}

inline void eos(InputFixture& fixture, const std::string& input) {
  fixture.set(input);
  fixture.open_with_caps();
  gst_harness_push_event(fixture.harness(), gst_event_new_eos());
}

inline GstStructure* structure_of(const std::string& text) {
  GstStructure* s = gst_structure_from_string(text.c_str(), nullptr);
  g_assert_nonnull(s);
  return s;
}

inline void sticky_event(InputFixture& fixture, const std::string& input) {
  between_frames(fixture, [&] {
    gst_harness_push_event(
        fixture.harness(),
        gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM_STICKY, structure_of(input)));
  });
}

inline void event(InputFixture& fixture, const std::string& input) {
  between_frames(fixture, [&] {
    gst_harness_push_event(fixture.harness(),
                           gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM, structure_of(input)));
  });
}

inline void peers_event(InputFixture& fixture, const std::string& input) {
  between_frames(fixture, [&] {
    gst_harness_push_event(fixture.harness(),
                           gst_event_new_custom(GST_EVENT_CUSTOM_BOTH, structure_of(input)));
  });
}

inline void peers_event_from_behind(InputFixture& fixture, const std::string& input) {
  between_frames(fixture, [&] {
    gst_harness_push_upstream_event(
        fixture.harness(), gst_event_new_custom(GST_EVENT_CUSTOM_BOTH, structure_of(input)));
  });
}

// The structure of an observation meta.
inline void meta(InputFixture& fixture, const std::string& input) {
  between_frames(fixture, [&] {
    GstBuffer* buffer = Fixture::noise("GRAY8", kSize, 0);
    g_autoptr(GstStructure) wanted = structure_of(input);
    GstStructure* s =
        gst_custom_meta_get_structure(gst_buffer_add_custom_meta(buffer, gst::kObservationName));
    gst_structure_foreach(
        wanted,
        [](GQuark field, const GValue* value, gpointer to) -> gboolean {
          gst_structure_id_set_value(static_cast<GstStructure*>(to), field, value);
          return TRUE;
        },
        s);
    gst_buffer_unref(gst_harness_push_and_pull(fixture.harness(), buffer));
  });
}

// Caps that are set, and a frame.
inline void caps(InputFixture& fixture, const std::string& input) {
  fixture.open();
  g_autoptr(GstCaps) wanted = gst_caps_from_string(input.c_str());
  g_assert_nonnull(wanted);
  fixture.begin();
  gst_pad_push_event(fixture.harness()->srcpad, gst_event_new_caps(wanted));
  GstVideoInfo info;
  const gsize size =
      fixture.goes_on() && gst_video_info_from_caps(&info, wanted) ? GST_VIDEO_INFO_SIZE(&info) : 1;
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, size, nullptr);
  gst_buffer_memset(buffer, 0, 77, size);
  const auto before = InputFixture::bytes(buffer);
  fixture.begin_segment();
  const GstFlowReturn flow = gst_pad_push(fixture.harness()->srcpad, buffer);
  fail_unless(flow == (fixture.goes_on() ? GST_FLOW_OK : GST_FLOW_NOT_NEGOTIATED), "%s: %s",
              fixture.what(), gst_flow_get_name(flow));
  if (!fixture.goes_on()) return;
  g_autoptr(GstBuffer) out = gst_harness_pull(fixture.harness());
  fail_unless(InputFixture::bytes(out) == before, "%s changes the frames", fixture.what());
}

// The same, where what follows takes frames of 640x480 px only.
inline void caps_for_vga(InputFixture& fixture, const std::string& input) {
  fixture.open();
  gst_harness_set_sink_caps_str(fixture.harness(), "video/x-raw,width=640,height=480");
  fixture.begin();
  g_autoptr(GstCaps) wanted = gst_caps_from_string(input.c_str());
  gst_pad_push_event(fixture.harness()->srcpad, gst_event_new_caps(wanted));
  fixture.begin_segment();
  fail_unless_equals_int(
      gst_pad_push(fixture.harness()->srcpad, gst_buffer_new_allocate(nullptr, 4, nullptr)),
      GST_FLOW_NOT_NEGOTIATED);
}

// A source that has nothing but these caps, and asks what is wanted of them.
inline void offer(InputFixture& fixture, const std::string& input) {
  fail_unless(fixture.starts());
  g_autoptr(GstCaps) all = gst_caps_from_string(input.c_str());
  GstPadTemplate* only = gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, all);
  gst_object_ref_sink(only);
  GstPad* source = gst_pad_new_from_template(only, "src");
  gst_object_ref_sink(source);
  gst_object_unref(only);
  gst_pad_set_active(source, TRUE);
  g_autoptr(GstPad) sink = gst_element_get_static_pad(fixture.element(), "sink");
  fail_unless_equals_int(gst_pad_link_full(source, sink, GST_PAD_LINK_CHECK_NOTHING),
                         GST_PAD_LINK_OK);
  g_autoptr(GstCaps) wanted = gst_pad_peer_query_caps(source, nullptr);
  fail_if(gst_caps_can_intersect(wanted, all));
  gst_pad_unlink(source, sink);
  gst_object_unref(source);
}

// A frame that is not what the caps say. Where frames go on, so does this one, untouched, or it is
// left out.
inline void push_bad(InputFixture& fixture, GstBuffer* buffer) {
  fixture.open_with_caps();
  gst::attach_guidance(
      buffer,
      {3, 0.5, 0.5, 0.5, 0.5, 0.5, {}, {}, {}, false, "tilt", {}, {}, 0, {}});  // to be drawn
  const auto before = InputFixture::bytes(buffer);
  const GstFlowReturn flow = fixture.push(buffer);
  fail_unless((flow == GST_FLOW_OK) == fixture.goes_on(), "%s: %s", fixture.what(),
              gst_flow_get_name(flow));
  const bool comes_out = fixture.goes_on() && !fixture.drops();
  fail_unless_equals_int(fixture.waiting(), comes_out ? 1 : 0);
  if (!fixture.goes_on()) return;
  if (comes_out) {
    g_autoptr(GstBuffer) out = gst_harness_pull(fixture.harness());
    fail_unless(InputFixture::bytes(out) == before, "%s changes the frame", fixture.what());
  }
  fail_unless(fixture.frame().size() == 640 * 480);
}

inline void small_frame(InputFixture& fixture, const std::string& input) {
  push_bad(fixture, gst_buffer_new_allocate(nullptr, std::stoul(input), nullptr));
}

inline void frame_of_other_size(InputFixture& fixture, const std::string& /*input*/) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
  gst_buffer_add_video_meta(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_GRAY8, 320, 240);
  push_bad(fixture, buffer);
}

// Which GStreamer has no name for.
inline void frame_of_no_format(InputFixture& fixture, const std::string& input) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
  gst_buffer_add_video_meta(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_GRAY8, 640, 480)
      ->format = static_cast<GstVideoFormat>(std::stoi(input));
  push_bad(fixture, buffer);
}

// Of no plane at all, which GStreamer itself takes for a mistake of the program.
inline void frame_without_planes(InputFixture& fixture, const std::string& /*input*/) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
  gst_buffer_add_video_meta(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_GRAY8, 640, 480)
      ->n_planes = 0;
  push_bad(fixture, buffer);
}

// As one that was added by gst_buffer_add_meta() and filled in by hand.
inline void frame_without_map(InputFixture& fixture, const std::string& /*input*/) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
  GstVideoMeta* meta = gst_buffer_add_video_meta(buffer, GST_VIDEO_FRAME_FLAG_NONE,
                                                 GST_VIDEO_FORMAT_GRAY8, 640, 480);
  meta->map = nullptr;
  push_bad(fixture, buffer);
}

inline void frame_without_unmap(InputFixture& fixture, const std::string& /*input*/) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
  GstVideoMeta* meta = gst_buffer_add_video_meta(buffer, GST_VIDEO_FRAME_FLAG_NONE,
                                                 GST_VIDEO_FORMAT_GRAY8, 640, 480);
  meta->unmap = nullptr;
  push_bad(fixture, buffer);
}

// An allocator whose memory nobody can look into, as that of some decoders.
struct BlindAllocator {
  GstAllocator parent;
};
struct BlindAllocatorClass {
  GstAllocatorClass parent_class;
};
G_DEFINE_TYPE(BlindAllocator, blind_allocator, GST_TYPE_ALLOCATOR)
inline void blind_allocator_class_init(BlindAllocatorClass* klass) {
  klass->parent_class.alloc = [](GstAllocator* self, gsize size, GstAllocationParams*) {
    auto* memory = g_new0(GstMemory, 1);
    gst_memory_init(memory, static_cast<GstMemoryFlags>(0), self, nullptr, size, 0, 0, size);
    return memory;
  };
  klass->parent_class.free = [](GstAllocator*, GstMemory* memory) { g_free(memory); };
}
inline void blind_allocator_init(BlindAllocator* self) {
  self->parent.mem_type = "Blind";
  self->parent.mem_map = [](GstMemory*, gsize, GstMapFlags) -> gpointer { return nullptr; };
  self->parent.mem_unmap = [](GstMemory*) {};
}

inline void frame_without_access(InputFixture& fixture, const std::string& /*input*/) {
  auto* allocator =
      GST_ALLOCATOR(gst_object_ref_sink(g_object_new(blind_allocator_get_type(), nullptr)));
  GstBuffer* buffer = gst_buffer_new_allocate(allocator, 640 * 480, nullptr);
  gst_object_unref(allocator);
  fixture.open_with_caps();
  fail_unless_equals_int(fixture.push(buffer), GST_FLOW_OK);
  fail_unless_equals_int(fixture.waiting(), fixture.drops() ? 0 : 1);
  if (!fixture.drops()) gst_buffer_unref(gst_harness_pull(fixture.harness()));
  fail_unless(fixture.frame().size() == 640 * 480);
}

// A frame is taken whole where its memory can be mapped, and left out or passed where not.
inline void frames_of_fickle_memory(InputFixture& fixture, const std::string& /*input*/) {
  g_autoptr(GstAllocator) fickle = new_fickle_allocator();
  fixture.open_with_caps();
  guint out = 0;
  for (int n = 0; n < 6; ++n) {
    GstBuffer* in = gst_buffer_new_allocate(fickle, 640 * 480, nullptr);  // of bytes 0x55
    gst::attach_guidance(in,
                         {3, 0.5, 0.5, 0.5, 0.5, 0.5, {}, {}, {}, false, "tilt", {}, {}, 0, {}});
    fail_unless_equals_int(fixture.push(in), GST_FLOW_OK);
    out += fixture.waiting();
    if (fixture.waiting() == 0) continue;
    g_autoptr(GstBuffer) moved = gst_harness_pull(fixture.harness());
    const std::vector<guint8> bytes =
        fixture.drops() ? InputFixture::bytes(moved) : std::vector<guint8>();
    fail_unless(std::all_of(bytes.begin(), bytes.end(), [](guint8 byte) { return byte == 0x55; }),
                "%s: a frame comes out unwritten", fixture.what());
  }
  fail_unless_equals_int(out, fixture.drops() ? 3 : 6);
  for (const std::string& text : fixture.bus.texts(GST_MESSAGE_WARNING)) {
    fail_unless(text.find("Internal") == std::string::npos, "%s: %s", fixture.what(), text.c_str());
  }
}

// Downstream gives such memory to write into.
inline void room_in_fickle_memory(InputFixture& fixture, const std::string& /*input*/) {
  g_autoptr(GstAllocator) fickle = new_fickle_allocator();
  fixture.open();
  gst_harness_set_propose_allocator(fixture.harness(), GST_ALLOCATOR(gst_object_ref(fickle)),
                                    nullptr);
  gst_harness_set_src_caps(fixture.harness(), caps_of("GRAY8", kSize));
  fail_unless_equals_int(fixture.push(Fixture::noise("GRAY8", kSize, 0)), GST_FLOW_ERROR);
  fail_unless_equals_int(fixture.waiting(), 0);
}

// The rows are said to lie further apart than the memory is long.
inline void frame_beyond_memory(InputFixture& fixture, const std::string& /*input*/) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
  gsize offset[GST_VIDEO_MAX_PLANES] = {0};
  gint stride[GST_VIDEO_MAX_PLANES] = {100000};
  gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_GRAY8, 640,
                                 480, 1, offset, stride);
  push_bad(fixture, buffer);
}

inline void frame_before_caps(InputFixture& fixture, const std::string& /*input*/) {
  fixture.open();
  fixture.begin();
  fixture.begin_segment();
  fail_if(gst_pad_push(fixture.harness()->srcpad, Fixture::noise("GRAY8", kSize, 0)) ==
          GST_FLOW_OK);
  fail_unless_equals_int(fixture.waiting(), 0);
}

// A source: the caps that are asked of it.
inline void asked_for(InputFixture& fixture, const std::string& input) {
  GstHarness* h = gst_harness_new_with_element(fixture.element(), nullptr, "src");
  if (!input.empty()) gst_harness_set_sink_caps_str(h, input.c_str());
  gst_element_set_state(fixture.element(), GST_STATE_PLAYING);
  for (int i = 0; i < 500 && fixture.bus.texts(GST_MESSAGE_ERROR).empty(); ++i) g_usleep(10000);
  fail_unless_equals_int(gst_harness_buffers_in_queue(h), 0);
  gst_harness_teardown(h);
}

inline void asked_for_while_running(InputFixture& fixture, const std::string& input) {
  GstHarness* h = gst_harness_new_with_element(fixture.element(), nullptr, "src");
  gst_harness_play(h);
  gst_buffer_unref(gst_harness_pull(h));
  fixture.set(input);
  gst_buffer_unref(gst_harness_pull(h));
  gst_harness_teardown(h);
}

}  // namespace calvin::check
