// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a user reads when the neighbour upstream sends what an element cannot take.

#include "common/frames/refused_caps.hpp"

#include <array>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "common/frames/dma_caps.hpp"
#include "common/messages.hpp"

namespace calvin::gst {

namespace {

struct Converter {
  std::string_view of;
  std::string_view insert;
};
constexpr std::array<Converter, 7> kFromMemory = {
    {{"memory:GLMemory", "gldownload"},
     {"memory:DMABuf", "glupload ! gldownload or vapostproc"},
     {"memory:VAMemory", "vapostproc"},
     {"memory:VASurface", "vaapipostproc"},
     {"memory:CUDAMemory", "cudadownload"},
     {"memory:D3D11Memory", "d3d11download"},
     {"memory:NVMM", "nvvidconv"}}};
constexpr std::array<Converter, 4> kFromMedia = {{{"video/x-raw", "videoconvert"},
                                                  {"video/x-bayer", "bayer2rgb"},
                                                  {"image/jpeg", "jpegdec"},
                                                  {"image/png", "pngdec"}}};

constexpr char kGood[] =
    "send video/x-raw in system memory, in a format of this element's sink pad and with at least "
    "one pixel";

template <std::size_t N>
std::string_view find(const std::array<Converter, N>& table, std::string_view of) {
  for (const Converter& row : table) {
    if (row.of == of) return row.insert;
  }
  return {};
}

struct Refused {
  std::string what;
  std::string advice;
};

std::string insertion(std::string_view element) {
  return fmt::format("insert {} before this element", element);
}

// The first feature of `features` that is not plain system memory; empty where there is none.
std::string_view foreign_feature(const GstCapsFeatures* features) {
  for (guint i = 0; features != nullptr && i < gst_caps_features_get_size(features); ++i) {
    const std::string_view feature = gst_caps_features_get_nth(features, i);
    if (feature != GST_CAPS_FEATURE_MEMORY_SYSTEM_MEMORY &&
        feature != GST_CAPS_FEATURE_META_GST_VIDEO_OVERLAY_COMPOSITION) {
      return feature;
    }
  }
  return {};
}

// Which frames in DMA memory they are, where that is said: those with a modifier are tiled.
std::string dma_format(const GstStructure* s) {
  const char* format = gst_structure_get_string(s, "drm-format");
  if (format == nullptr) return {};
  const bool tiled = std::string_view(format).find(':') != std::string_view::npos;
  return fmt::format(" of the {}format {}", tiled ? "tiled " : "", format);
}

Refused refused_feature(std::string_view feature, const GstStructure* s) {
  if (!feature.starts_with("memory:")) {
    return {fmt::format("Video with the caps feature {}", feature),
            fmt::format("send plain video/x-raw, or insert an element that takes it without {}",
                        feature)};
  }
  const std::string_view insert = find(kFromMemory, feature);
  return {fmt::format("Video in {}{}", feature, dma_format(s)),
          insertion(insert.empty() ? fmt::format("an element that downloads {}", feature)
                                   : std::string(insert))};
}

// What is missing in the caps of frames that will come: GStreamer refuses those, and gives no
// reason. It does without a framerate.
std::optional<Refused> incomplete(const GstStructure* s) {
  struct Needed {
    const char* field;
    GType type;
    std::string_view example;
  };
  static const std::array<Needed, 3> kAll = {{{"format", G_TYPE_STRING, "format=NV12"},
                                              {"width", G_TYPE_INT, "width=640"},
                                              {"height", G_TYPE_INT, "height=480"}}};
  std::string missing;
  std::string examples;
  for (const Needed& needed : kAll) {
    if (gst_structure_has_field_typed(s, needed.field, needed.type) != FALSE) continue;
    missing += fmt::format("{}no {}", missing.empty() ? "" : " and ", needed.field);
    examples += fmt::format("{}{}", examples.empty() ? "" : ",", needed.example);
  }
  if (missing.empty()) return std::nullopt;
  return Refused{fmt::format("Video whose caps name {}", missing),
                 fmt::format("complete the caps of the element upstream, those of an appsrc for "
                             "example, as in video/x-raw,{}",
                             examples)};
}

Refused refused_raw(const GstStructure* s) {
  const char* format = gst_structure_get_string(s, "format");
  int width = 0;
  int height = 0;
  const bool sized = gst_structure_get_int(s, "width", &width) != FALSE &&
                     gst_structure_get_int(s, "height", &height) != FALSE;
  if (sized && (width < 1 || height < 1)) {
    return {fmt::format("Video of {}x{} px has no pixels and", width, height), kGood};
  }
  if (format != nullptr && gst_video_format_from_string(format) == GST_VIDEO_FORMAT_UNKNOWN) {
    return {fmt::format("Video of the unknown format '{}'", format), kGood};
  }
  return {format != nullptr ? fmt::format("Video of the format {}", format)
                            : "Raw video of these formats",
          insertion("videoconvert")};
}

Refused refused(const GstStructure* s, const GstCapsFeatures* features) {
  const std::string_view media = gst_structure_get_name(s);
  const std::string_view feature = foreign_feature(features);
  if (!feature.empty()) return refused_feature(feature, s);
  if (media == "video/x-raw") return refused_raw(s);
  if (const std::string_view insert = find(kFromMedia, media); !insert.empty()) {
    return {std::string(media), insertion(insert)};
  }
  const bool pictures = media.starts_with("video/") || media.starts_with("image/");
  return {std::string(media), pictures ? insertion("decodebin") : kGood};
}

Error error_of(const Refused& refused) {
  return {ErrorCode::kUnsupported,
          fmt::format("{} cannot be used here: {}.", refused.what, refused.advice)};
}

// Of caps that fit the pad and are set, whether they make no frames all the same.
std::optional<Error> useless(const GstCaps* caps) {
  if (const auto lacks = incomplete(gst_caps_get_structure(caps, 0))) return error_of(*lacks);
  GstVideoInfo info;
  if (!gst_caps_is_fixed(caps) || video_info_of(info, caps)) return std::nullopt;
  const char* interlacing =
      gst_structure_get_string(gst_caps_get_structure(caps, 0), "interlace-mode");
  if (g_strcmp0(interlacing, "alternate") == 0) {
    return Error{ErrorCode::kUnsupported,
                 "Caps with interlace-mode=alternate, one field in each buffer, need the caps "
                 "feature format:Interlaced. Where the buffers are whole frames, correct the caps "
                 "of the element upstream to interlace-mode=progressive; where they are fields, "
                 "insert deinterlace behind the element that sends them with that feature."};
  }
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
  if (gst_caps_can_intersect(caps, accepted)) return set ? useless(caps) : std::nullopt;
  return error_of(refused(gst_caps_get_structure(caps, 0), gst_caps_get_features(caps, 0)));
}

std::optional<Error> explain_fields(const GstVideoInfo& info) {
  const GstVideoInterlaceMode mode = GST_VIDEO_INFO_INTERLACE_MODE(&info);
  if (mode == GST_VIDEO_INTERLACE_MODE_PROGRESSIVE || mode == GST_VIDEO_INTERLACE_MODE_MIXED) {
    return std::nullopt;
  }
  return Error{ErrorCode::kUnsupported,
               "The video is interlaced, its fields show different moments: corners of a board "
               "that moves are wrong. Insert deinterlace before this element."};
}

void explain_refused_caps(GstElement* element) {
  g_autoptr(GstPad) sink = gst_element_get_static_pad(element, "sink");
  auto* watch = new Watch;
  // The event probe owns the watch; a pad drops both probes at the same time.
  gst_pad_add_probe(sink, GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, watch_event, watch,
                    [](gpointer data) { delete static_cast<Watch*>(data); });
  // As every filter does: what caps leave open, such as the framerate, is no reason to refuse them.
  GST_PAD_SET_ACCEPT_INTERSECT(sink);
  // A bin refuses caps for its children, but asks them what they take.
  if (GST_IS_BIN(element)) return;
  gst_pad_add_probe(
      sink,
      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_QUERY_DOWNSTREAM | GST_PAD_PROBE_TYPE_PUSH),
      watch_query, watch, nullptr);
}

}  // namespace calvin::gst
