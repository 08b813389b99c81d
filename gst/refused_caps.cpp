// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a user reads when the neighbour upstream sends what an element cannot take.

#include "refused_caps.hpp"

#include <array>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <gst/video/video.h>

#include "messages.hpp"

namespace calvin::gst {

namespace {

struct Converter {
  std::string_view of;
  std::string_view insert;
};
constexpr std::array<Converter, 7> kFromMemory = {{{"memory:GLMemory", "gldownload"},
                                                   {"memory:DMABuf", "glupload ! gldownload"},
                                                   {"memory:VAMemory", "vapostproc"},
                                                   {"memory:VASurface", "vaapipostproc"},
                                                   {"memory:CUDAMemory", "cudadownload"},
                                                   {"memory:D3D11Memory", "d3d11download"},
                                                   {"memory:NVMM", "nvvidconv"}}};
constexpr std::array<Converter, 4> kFromMedia = {{{"video/x-raw", "videoconvert"},
                                                  {"video/x-bayer", "bayer2rgb"},
                                                  {"image/jpeg", "jpegdec"},
                                                  {"image/png", "pngdec"}}};

template <std::size_t N>
std::string_view find(const std::array<Converter, N>& table, std::string_view of) {
  for (const Converter& row : table) {
    if (row.of == of) return row.insert;
  }
  return {};
}

struct Refused {
  std::string what;
  std::string insert;  // empty: nothing helps
};

// The first memory of `features` that is not system memory; empty where there is none.
std::string_view foreign_memory(const GstCapsFeatures* features) {
  for (guint i = 0; features != nullptr && i < gst_caps_features_get_size(features); ++i) {
    const std::string_view feature = gst_caps_features_get_nth(features, i);
    if (feature.starts_with("memory:") && feature != GST_CAPS_FEATURE_MEMORY_SYSTEM_MEMORY) {
      return feature;
    }
  }
  return {};
}

Refused refused_raw(const GstStructure* s) {
  const char* format = gst_structure_get_string(s, "format");
  int width = 0;
  int height = 0;
  const bool sized = gst_structure_get_int(s, "width", &width) != FALSE &&
                     gst_structure_get_int(s, "height", &height) != FALSE;
  if (sized && (width < 1 || height < 1)) {
    return {fmt::format("Video of {}x{} px has no pixels and", width, height), ""};
  }
  if (format != nullptr &&
      (!sized || gst_video_format_from_string(format) == GST_VIDEO_FORMAT_UNKNOWN)) {
    return {fmt::format("Video of the unknown format '{}' or without a size", format), ""};
  }
  if (format != nullptr) return {fmt::format("Video of the format {}", format), "videoconvert"};
  return {"Raw video of these formats", "videoconvert"};
}

Refused refused(const GstStructure* s, const GstCapsFeatures* features) {
  const std::string_view media = gst_structure_get_name(s);
  if (const std::string_view memory = foreign_memory(features); !memory.empty()) {
    const std::string_view insert = find(kFromMemory, memory);
    return {
        fmt::format("Video in {}", memory),
        insert.empty() ? fmt::format("an element that downloads {}", memory) : std::string(insert)};
  }
  if (media == "video/x-raw") return refused_raw(s);
  if (const std::string_view insert = find(kFromMedia, media); !insert.empty()) {
    return {std::string(media), std::string(insert)};
  }
  const bool pictures = media.starts_with("video/") || media.starts_with("image/");
  return {std::string(media), pictures ? "decodebin" : ""};
}

// Of fixed caps that fit the pad, whether no memory could hold a frame of them.
std::optional<Error> too_large(const GstCaps* caps) {
  GstVideoInfo info;
  if (!gst_caps_is_fixed(caps) || gst_video_info_from_caps(&info, caps)) return std::nullopt;
  g_autofree char* text = gst_caps_to_string(caps);
  return Error{ErrorCode::kUnsupported,
               fmt::format("No memory can hold a frame of the caps {}: insert videoscale, or ask "
                           "upstream for smaller frames.",
                           text)};
}

// What one pad has said since its stream began: each reason once.
class Watch {
 public:
  void begin() {
    const std::lock_guard guard(lock_);
    said_.clear();
  }
  void look(GstPad* pad, const GstCaps* caps, bool set) {
    g_autoptr(GstCaps) accepted = gst_pad_get_pad_template_caps(pad);
    const auto problem = explain_refusal(caps, accepted, set);
    if (!problem) return;
    {
      const std::lock_guard guard(lock_);
      if (std::exchange(said_, problem->message) == problem->message) return;
    }
    g_autoptr(GstElement) element = gst_pad_get_parent_element(pad);
    if (element != nullptr) post_error(element, *problem);
  }

 private:
  std::mutex lock_;
  std::string said_;
};

GstPadProbeReturn watch_event(GstPad* pad, GstPadProbeInfo* info, gpointer data) {
  GstEvent* event = gst_pad_probe_info_get_event(info);
  auto* watch = static_cast<Watch*>(data);
  if (GST_EVENT_TYPE(event) == GST_EVENT_STREAM_START) watch->begin();
  if (GST_EVENT_TYPE(event) == GST_EVENT_CAPS) {
    GstCaps* caps = nullptr;
    gst_event_parse_caps(event, &caps);
    watch->look(pad, caps, true);
  }
  return GST_PAD_PROBE_OK;
}

// A source that finds nothing in common with what it asks for here says "not-negotiated" and no
// more, so what it has is looked at while it asks.
GstPadProbeReturn watch_query(GstPad* pad, GstPadProbeInfo* info, gpointer data) {
  // Somebody upstream may answer by asking here again.
  thread_local bool asking = false;
  const GstQuery* query = gst_pad_probe_info_get_query(info);
  // While pipelines are put together anything may be asked for, and linking fails by itself; with
  // caps there, something was found.
  if (GST_QUERY_TYPE(query) != GST_QUERY_CAPS || !gst_pad_is_active(pad) ||
      gst_pad_has_current_caps(pad) || asking) {
    return GST_PAD_PROBE_OK;
  }
  asking = true;
  g_autoptr(GstCaps) offered = gst_pad_peer_query_caps(pad, nullptr);
  asking = false;
  if (offered != nullptr) static_cast<Watch*>(data)->look(pad, offered, false);
  return GST_PAD_PROBE_OK;
}

}  // namespace

std::optional<Error> explain_refusal(const GstCaps* caps, const GstCaps* accepted, bool set) {
  if (gst_caps_is_any(caps) || gst_caps_is_empty(caps)) return std::nullopt;
  // Caps that are set say everything; those that may be set yet can lack the size, say.
  const bool fits =
      set ? gst_caps_is_subset(caps, accepted) : gst_caps_can_intersect(caps, accepted);
  if (fits) return set ? too_large(caps) : std::nullopt;
  const Refused first = refused(gst_caps_get_structure(caps, 0), gst_caps_get_features(caps, 0));
  return Error{ErrorCode::kUnsupported,
               first.insert.empty()
                   ? fmt::format("{} cannot be used here: send video/x-raw in system memory, in a "
                                 "format of this element's sink pad and with at least one pixel.",
                                 first.what)
                   : fmt::format("{} cannot be used here: insert {} before this element.",
                                 first.what, first.insert)};
}

void explain_refused_caps(GstElement* element) {
  g_autoptr(GstPad) sink = gst_element_get_static_pad(element, "sink");
  auto* watch = new Watch;
  // The event probe owns the watch; a pad drops both probes at the same time.
  gst_pad_add_probe(sink, GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, watch_event, watch,
                    [](gpointer data) { delete static_cast<Watch*>(data); });
  // A bin refuses caps for its children, but asks them what they take.
  if (GST_IS_BIN(element)) return;
  gst_pad_add_probe(
      sink,
      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_QUERY_DOWNSTREAM | GST_PAD_PROBE_TYPE_PUSH),
      watch_query, watch, nullptr);
}

}  // namespace calvin::gst
