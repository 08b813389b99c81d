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
inline void at_start(Rig& rig, const std::string& input) {
  if (!input.empty()) rig.set(input);
  const bool started = rig.starts();
  fail_unless(started == rig.goes_on(), "%s: %s", rig.what(),
              started ? "starts" : "does not start");
  if (!started) return;
  rig.open_with_caps();
  g_autoptr(GstBuffer) same = Fixture::noise("GRAY8", kSize, 0);
  fail_unless(rig.frame() == Rig::bytes(same), "%s changes the frames", rig.what());
}

// The content of the file that the property `calibration` names.
inline void in_file(Rig& rig, const std::string& input) {
  std::ofstream(rig.in_folder("@/camera.txt")) << input;
  at_start(rig, "calibration=@/camera.txt");
}

template <typename Give>
void between_frames(Rig& rig, Give give) {
  rig.open_with_caps();
  const auto before = rig.frame();
  give();
  const auto after = rig.frame();
  fail_unless(before == after, "%s changes the frames", rig.what());
}

inline void while_running(Rig& rig, const std::string& input) {
  between_frames(rig, [&] { rig.set(input); });
}

// Likewise, of what a disk has to answer for: heard of a few frames later.
inline void while_running_beside(Rig& rig, const std::string& input) {
  while_running(rig, input);
  for (int i = 0; i < 3000 && rig.bus.texts(GST_MESSAGE_WARNING).empty(); ++i) {
    g_usleep(10000);
    static_cast<void>(rig.frame());
  }
}

inline void signal(Rig& rig, const std::string& input) {
  between_frames(rig, [&] { g_signal_emit_by_name(rig.element(), input.c_str()); });
}

inline void eos(Rig& rig, const std::string& input) {
  rig.set(input);
  rig.open_with_caps();
  gst_harness_push_event(rig.harness(), gst_event_new_eos());
}

inline GstStructure* structure_of(const std::string& text) {
  GstStructure* s = gst_structure_from_string(text.c_str(), nullptr);
  g_assert_nonnull(s);
  return s;
}

inline void sticky_event(Rig& rig, const std::string& input) {
  between_frames(rig, [&] {
    gst_harness_push_event(rig.harness(), gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM_STICKY,
                                                               structure_of(input)));
  });
}

inline void event(Rig& rig, const std::string& input) {
  between_frames(rig, [&] {
    gst_harness_push_event(rig.harness(),
                           gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM, structure_of(input)));
  });
}

inline void peers_event(Rig& rig, const std::string& input) {
  between_frames(rig, [&] {
    gst_harness_push_event(rig.harness(),
                           gst_event_new_custom(GST_EVENT_CUSTOM_BOTH, structure_of(input)));
  });
}

inline void peers_event_from_behind(Rig& rig, const std::string& input) {
  between_frames(rig, [&] {
    gst_harness_push_upstream_event(
        rig.harness(), gst_event_new_custom(GST_EVENT_CUSTOM_BOTH, structure_of(input)));
  });
}

// The structure of an observation meta.
inline void meta(Rig& rig, const std::string& input) {
  between_frames(rig, [&] {
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
    gst_buffer_unref(gst_harness_push_and_pull(rig.harness(), buffer));
  });
}

// Caps that are set, and a frame.
inline void caps(Rig& rig, const std::string& input) {
  rig.open();
  g_autoptr(GstCaps) wanted = gst_caps_from_string(input.c_str());
  g_assert_nonnull(wanted);
  rig.begin();
  gst_pad_push_event(rig.harness()->srcpad, gst_event_new_caps(wanted));
  GstVideoInfo info;
  const gsize size =
      rig.goes_on() && gst_video_info_from_caps(&info, wanted) ? GST_VIDEO_INFO_SIZE(&info) : 1;
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, size, nullptr);
  gst_buffer_memset(buffer, 0, 77, size);
  const auto before = Rig::bytes(buffer);
  rig.begin_segment();
  const GstFlowReturn flow = gst_pad_push(rig.harness()->srcpad, buffer);
  fail_unless(flow == (rig.goes_on() ? GST_FLOW_OK : GST_FLOW_NOT_NEGOTIATED), "%s: %s", rig.what(),
              gst_flow_get_name(flow));
  if (!rig.goes_on()) return;
  g_autoptr(GstBuffer) out = gst_harness_pull(rig.harness());
  fail_unless(Rig::bytes(out) == before, "%s changes the frames", rig.what());
}

// The same, where what follows takes frames of 640x480 px only.
inline void caps_for_vga(Rig& rig, const std::string& input) {
  rig.open();
  gst_harness_set_sink_caps_str(rig.harness(), "video/x-raw,width=640,height=480");
  rig.begin();
  g_autoptr(GstCaps) wanted = gst_caps_from_string(input.c_str());
  gst_pad_push_event(rig.harness()->srcpad, gst_event_new_caps(wanted));
  rig.begin_segment();
  fail_unless_equals_int(
      gst_pad_push(rig.harness()->srcpad, gst_buffer_new_allocate(nullptr, 4, nullptr)),
      GST_FLOW_NOT_NEGOTIATED);
}

// A source that has nothing but these caps, and asks what is wanted of them.
inline void offer(Rig& rig, const std::string& input) {
  fail_unless(rig.starts());
  g_autoptr(GstCaps) all = gst_caps_from_string(input.c_str());
  GstPadTemplate* only = gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, all);
  gst_object_ref_sink(only);
  GstPad* source = gst_pad_new_from_template(only, "src");
  gst_object_ref_sink(source);
  gst_object_unref(only);
  gst_pad_set_active(source, TRUE);
  g_autoptr(GstPad) sink = gst_element_get_static_pad(rig.element(), "sink");
  fail_unless_equals_int(gst_pad_link_full(source, sink, GST_PAD_LINK_CHECK_NOTHING),
                         GST_PAD_LINK_OK);
  g_autoptr(GstCaps) wanted = gst_pad_peer_query_caps(source, nullptr);
  fail_if(gst_caps_can_intersect(wanted, all));
  gst_pad_unlink(source, sink);
  gst_object_unref(source);
}

// A frame that is not what the caps say. Where frames go on, so does this one, untouched, or it is
// left out.
inline void push_bad(Rig& rig, GstBuffer* buffer) {
  rig.open_with_caps();
  gst::attach_guidance(
      buffer,
      {3, 0.5, 0.5, 0.5, 0.5, 0.5, {}, {}, {}, false, "tilt", {}, {}, 0, {}});  // to be drawn
  const auto before = Rig::bytes(buffer);
  const GstFlowReturn flow = rig.push(buffer);
  fail_unless((flow == GST_FLOW_OK) == rig.goes_on(), "%s: %s", rig.what(),
              gst_flow_get_name(flow));
  const bool comes_out = rig.goes_on() && !rig.drops();
  fail_unless_equals_int(rig.waiting(), comes_out ? 1 : 0);
  if (!rig.goes_on()) return;
  if (comes_out) {
    g_autoptr(GstBuffer) out = gst_harness_pull(rig.harness());
    fail_unless(Rig::bytes(out) == before, "%s changes the frame", rig.what());
  }
  fail_unless(rig.frame().size() == 640 * 480);
}

inline void small_frame(Rig& rig, const std::string& input) {
  push_bad(rig, gst_buffer_new_allocate(nullptr, std::stoul(input), nullptr));
}

inline void frame_of_other_size(Rig& rig, const std::string& /*input*/) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
  gst_buffer_add_video_meta(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_GRAY8, 320, 240);
  push_bad(rig, buffer);
}

// Which GStreamer has no name for.
inline void frame_of_no_format(Rig& rig, const std::string& input) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
  gst_buffer_add_video_meta(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_GRAY8, 640, 480)
      ->format = static_cast<GstVideoFormat>(std::stoi(input));
  push_bad(rig, buffer);
}

// Of no plane at all, which GStreamer itself takes for a mistake of the program.
inline void frame_without_planes(Rig& rig, const std::string& /*input*/) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
  gst_buffer_add_video_meta(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_GRAY8, 640, 480)
      ->n_planes = 0;
  push_bad(rig, buffer);
}

// As one that was added by gst_buffer_add_meta() and filled in by hand.
inline void frame_without_map(Rig& rig, const std::string& /*input*/) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
  GstVideoMeta* meta = gst_buffer_add_video_meta(buffer, GST_VIDEO_FRAME_FLAG_NONE,
                                                 GST_VIDEO_FORMAT_GRAY8, 640, 480);
  meta->map = nullptr;
  push_bad(rig, buffer);
}

inline void frame_without_unmap(Rig& rig, const std::string& /*input*/) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
  GstVideoMeta* meta = gst_buffer_add_video_meta(buffer, GST_VIDEO_FRAME_FLAG_NONE,
                                                 GST_VIDEO_FORMAT_GRAY8, 640, 480);
  meta->unmap = nullptr;
  push_bad(rig, buffer);
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

inline void frame_without_access(Rig& rig, const std::string& /*input*/) {
  auto* allocator =
      GST_ALLOCATOR(gst_object_ref_sink(g_object_new(blind_allocator_get_type(), nullptr)));
  GstBuffer* buffer = gst_buffer_new_allocate(allocator, 640 * 480, nullptr);
  gst_object_unref(allocator);
  rig.open_with_caps();
  fail_unless_equals_int(rig.push(buffer), GST_FLOW_OK);
  fail_unless_equals_int(rig.waiting(), rig.drops() ? 0 : 1);
  if (!rig.drops()) gst_buffer_unref(gst_harness_pull(rig.harness()));
  fail_unless(rig.frame().size() == 640 * 480);
}

// A frame is taken whole where its memory can be mapped, and left out or passed where not.
inline void frames_of_fickle_memory(Rig& rig, const std::string& /*input*/) {
  g_autoptr(GstAllocator) fickle = new_fickle_allocator();
  rig.open_with_caps();
  guint out = 0;
  for (int n = 0; n < 6; ++n) {
    GstBuffer* in = gst_buffer_new_allocate(fickle, 640 * 480, nullptr);  // of bytes 0x55
    gst::attach_guidance(in,
                         {3, 0.5, 0.5, 0.5, 0.5, 0.5, {}, {}, {}, false, "tilt", {}, {}, 0, {}});
    fail_unless_equals_int(rig.push(in), GST_FLOW_OK);
    out += rig.waiting();
    if (rig.waiting() == 0) continue;
    g_autoptr(GstBuffer) moved = gst_harness_pull(rig.harness());
    const std::vector<guint8> bytes = rig.drops() ? Rig::bytes(moved) : std::vector<guint8>();
    fail_unless(std::all_of(bytes.begin(), bytes.end(), [](guint8 byte) { return byte == 0x55; }),
                "%s: a frame comes out unwritten", rig.what());
  }
  fail_unless_equals_int(out, rig.drops() ? 3 : 6);
  for (const std::string& text : rig.bus.texts(GST_MESSAGE_WARNING)) {
    fail_unless(text.find("Internal") == std::string::npos, "%s: %s", rig.what(), text.c_str());
  }
}

// Downstream gives such memory to write into.
inline void room_in_fickle_memory(Rig& rig, const std::string& /*input*/) {
  g_autoptr(GstAllocator) fickle = new_fickle_allocator();
  rig.open();
  gst_harness_set_propose_allocator(rig.harness(), GST_ALLOCATOR(gst_object_ref(fickle)), nullptr);
  gst_harness_set_src_caps(rig.harness(), caps_of("GRAY8", kSize));
  fail_unless_equals_int(rig.push(Fixture::noise("GRAY8", kSize, 0)), GST_FLOW_ERROR);
  fail_unless_equals_int(rig.waiting(), 0);
}

// The rows are said to lie further apart than the memory is long.
inline void frame_beyond_memory(Rig& rig, const std::string& /*input*/) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, 640 * 480, nullptr);
  gsize offset[GST_VIDEO_MAX_PLANES] = {0};
  gint stride[GST_VIDEO_MAX_PLANES] = {100000};
  gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_GRAY8, 640,
                                 480, 1, offset, stride);
  push_bad(rig, buffer);
}

inline void frame_before_caps(Rig& rig, const std::string& /*input*/) {
  rig.open();
  rig.begin();
  rig.begin_segment();
  fail_if(gst_pad_push(rig.harness()->srcpad, Fixture::noise("GRAY8", kSize, 0)) == GST_FLOW_OK);
  fail_unless_equals_int(rig.waiting(), 0);
}

// A source: the caps that are asked of it.
inline void asked_for(Rig& rig, const std::string& input) {
  GstHarness* h = gst_harness_new_with_element(rig.element(), nullptr, "src");
  if (!input.empty()) gst_harness_set_sink_caps_str(h, input.c_str());
  gst_element_set_state(rig.element(), GST_STATE_PLAYING);
  for (int i = 0; i < 500 && rig.bus.texts(GST_MESSAGE_ERROR).empty(); ++i) g_usleep(10000);
  fail_unless_equals_int(gst_harness_buffers_in_queue(h), 0);
  gst_harness_teardown(h);
}

inline void asked_for_while_running(Rig& rig, const std::string& input) {
  GstHarness* h = gst_harness_new_with_element(rig.element(), nullptr, "src");
  gst_harness_play(h);
  gst_buffer_unref(gst_harness_pull(h));
  rig.set(input);
  gst_buffer_unref(gst_harness_pull(h));
  gst_harness_teardown(h);
}

}  // namespace calvin::check
