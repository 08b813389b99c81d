// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort: a coloured edge that is straight in the scene is straight in every component of
// the output, and in the same place, wherever the chroma samples lie.

#include <cmath>

#include "remap_reference.hpp"
#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

// Where chroma lies: on the first luma sample of a group along an axis, or in the middle.
struct Siting {
  bool x_cosited;
  bool y_cosited;
};
static const Siting kJpeg = {false, false};
static const Siting kMpeg2 = {true, false};
static const Siting kCosited = {true, true};

// Pixels of the picture in memory before the frame: a crop.
struct Before {
  int x = 0;
  int y = 0;
};

struct Case {
  const char* format;
  ImageSize size;
  const char* caps;    // what else the caps say
  const char* behind;  // what the element behind wants
  Siting in;
  Siting out;
  Before before = {};
};
static const ImageSize kPal = {720, 576};
static const ImageSize kHd = {1280, 720};
static const char kAny[] = "video/x-raw";
static const Case kCases[] = {
    {"I420", kPal, "", kAny, kJpeg, kJpeg},
    {"I420", kPal, ",colorimetry=bt601", kAny, kJpeg, kJpeg},
    {"I420", kPal, ",chroma-site=jpeg", kAny, kJpeg, kJpeg},
    {"I420", kPal, ",chroma-site=mpeg2", kAny, kMpeg2, kMpeg2},
    {"I420", kPal, ",chroma-site=mpeg2,colorimetry=bt601", kAny, kMpeg2, kMpeg2},
    {"I420", kPal, ",chroma-site=cosited", kAny, kCosited, kCosited},
    {"I420", kPal, ",chroma-site=v-cosited", kAny, {false, true}, {false, true}},
    {"I420", kHd, "", kAny, kMpeg2, kMpeg2},
    {"I420", kHd, ",colorimetry=bt709", kAny, kMpeg2, kMpeg2},
    {"I420", kHd, ",chroma-site=jpeg", kAny, kJpeg, kJpeg},
    {"I420", kHd, ",chroma-site=jpeg,colorimetry=bt709", kAny, kJpeg, kJpeg},
    {"I420", kHd, ",chroma-site=mpeg2", kAny, kMpeg2, kMpeg2},
    {"I420", kHd, ",chroma-site=cosited", kAny, kCosited, kCosited},
    {"NV12", kPal, ",chroma-site=mpeg2", kAny, kMpeg2, kMpeg2},
    {"NV21", kHd, "", kAny, kMpeg2, kMpeg2},
    {"YUY2", kPal, "", kAny, kJpeg, kJpeg},
    {"UYVY", kHd, "", kAny, kMpeg2, kMpeg2},
    {"Y42B", kPal, ",chroma-site=mpeg2", kAny, kMpeg2, kMpeg2},
    {"Y444", kPal, "", kAny, kJpeg, kJpeg},
    {"I420_10LE", kHd, "", kAny, kMpeg2, kMpeg2},
    {"RGB", kPal, "", kAny, kJpeg, kJpeg},
    {"xBGR", kHd, "", kAny, kJpeg, kJpeg},
    // From the one siting to the other, and to a size for which the caps would say another one.
    {"I420", kPal, ",chroma-site=mpeg2", "video/x-raw,chroma-site=jpeg", kMpeg2, kJpeg},
    {"NV12", kHd, ",chroma-site=jpeg", "video/x-raw,chroma-site=cosited", kJpeg, kCosited},
    {"I420", kHd, "", "video/x-raw,width=854,height=480", kMpeg2, kMpeg2},
    {"I420", kPal, "", "video/x-raw,width=1280,height=1024", kJpeg, kJpeg},
    // A part that begins on an odd pixel, and on an even one.
    {"I420", kPal, "", kAny, kJpeg, kJpeg, {1, 1}},
    {"NV12", kHd, "", kAny, kMpeg2, kMpeg2, {1, 1}},
    {"YUY2", kPal, "", kAny, kJpeg, kJpeg, {3, 3}},
    {"I420_10LE", kHd, "", kAny, kMpeg2, kMpeg2, {1, 1}},
    {"NV12", kHd, "", kAny, kMpeg2, kMpeg2, {2, 2}},
    // On an odd column of an even row, and the other way round.
    {"I420", kPal, "", kAny, kJpeg, kJpeg, {1, 0}},
    {"NV12", kHd, ",chroma-site=cosited", kAny, kCosited, kCosited, {4, 3}},
};

static constexpr double kRadial1 = -0.28;
static constexpr double kRadial2 = 0.09;
static constexpr double kRamp = 5;  // px of the source to either side of the edge

// Distorted point on the plane z = 1 -> ideal.
static Pixel ideal(double x, double y) {
  const double target = std::hypot(x, y);
  double r = target;
  for (int i = 0; i < 20; ++i) {
    const double s = r * r;
    const double step = (r * (1 + s * (kRadial1 + s * kRadial2)) - target) /
                        (1 + s * (3 * kRadial1 + s * 5 * kRadial2));
    r -= step;
    if (std::abs(step) < 1e-12) break;
  }
  const double scale = target > 0 ? r / target : 1;
  return {x * scale, y * scale};
}

// The edge: points of the plane z = 1 with nx x + ny y = c.
struct Edge {
  double nx;
  double ny;
  double c;
};
static const Edge kEdges[] = {{1, 0.08, -0.62}, {1, -0.15, 0.7}, {0.06, 1, -0.38}, {-0.1, 1, 0.4}};

static double focal_of(ImageSize size) { return 0.6 * size.width; }

// Each component goes from near one end of its range to near the other, some up and some down.
static double level(guint component, double t, int depth) {
  const double low = component == 1 ? 236 : 20;
  const double high = component == 1 ? 20 : 236;
  return (low + (high - low) * t) * (1 << (depth - 8));
}

struct Axes {
  std::vector<double> xs;
  std::vector<double> ys;
};
// As px of the frame, which begins so many behind the picture.
static Axes axes_of(const GstVideoInfo& info, guint c, Siting site, Before before = {}) {
  const int xs = static_cast<int>(GST_VIDEO_FORMAT_INFO_W_SUB(info.finfo, c));
  const int ys = static_cast<int>(GST_VIDEO_FORMAT_INFO_H_SUB(info.finfo, c));
  return {reference::sites(GST_VIDEO_INFO_WIDTH(&info) - before.x, xs, xs > 0 && site.x_cosited,
                           before.x),
          reference::sites(GST_VIDEO_INFO_HEIGHT(&info) - before.y, ys, ys > 0 && site.y_cosited,
                           before.y)};
}

static guint8* sample(const GstVideoFrame& frame, guint c, std::size_t x, std::size_t y) {
  return static_cast<guint8*>(GST_VIDEO_FRAME_COMP_DATA(&frame, c)) +
         static_cast<std::ptrdiff_t>(y) * GST_VIDEO_FRAME_COMP_STRIDE(&frame, c) +
         static_cast<std::ptrdiff_t>(x) * GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, c);
}

// What the camera sees of the edge, and before the frame.
static GstBuffer* render(const GstVideoInfo& info, const Edge& edge, Siting site, Before before) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_WRITE));
  const ImageSize size = {GST_VIDEO_INFO_WIDTH(&info) - before.x,
                          GST_VIDEO_INFO_HEIGHT(&info) - before.y};
  const double f = focal_of(size);
  for (guint c = 0; c < GST_VIDEO_INFO_N_COMPONENTS(&info); ++c) {
    const int depth = static_cast<int>(GST_VIDEO_INFO_COMP_DEPTH(&info, c));
    const Axes axes = axes_of(info, c, site, before);
    for (std::size_t j = 0; j < axes.ys.size(); ++j) {
      for (std::size_t i = 0; i < axes.xs.size(); ++i) {
        const Pixel at =
            ideal((axes.xs[i] - 0.5 * size.width) / f, (axes.ys[j] - 0.5 * size.height) / f);
        const double distance = f * (edge.nx * at.u + edge.ny * at.v - edge.c);
        const double t = std::clamp(0.5 + distance / (2 * kRamp), 0.0, 1.0);
        const auto value = static_cast<guint16>(std::lround(level(c, t, depth)));
        guint8* to = sample(frame, c, i, j);
        to[0] = static_cast<guint8>(value);
        if (depth > 8) to[1] = static_cast<guint8>(value >> 8);
      }
    }
  }
  gst_video_frame_unmap(&frame);
  GST_BUFFER_PTS(buffer) = 0;
  return buffer;
}

// How far the edge of one component is from where it belongs, at most, px; and in how many rows (or
// columns) it was seen.
struct Registration {
  double worst = 0;
  int seen = 0;
};
static Registration locate(const GstVideoFrame& frame, guint c, const Edge& edge,
                           const Camera& view, Siting site) {
  const int depth = static_cast<int>(GST_VIDEO_INFO_COMP_DEPTH(&frame.info, c));
  const Axes axes = axes_of(frame.info, c, site);
  const bool upright = std::abs(edge.nx) > std::abs(edge.ny);
  const auto& along = upright ? axes.xs : axes.ys;
  const auto& across = upright ? axes.ys : axes.xs;
  const double middle = level(c, 0.5, depth);
  const auto read = [&](std::size_t i, std::size_t j) {
    const guint8* at = upright ? sample(frame, c, i, j) : sample(frame, c, j, i);
    return depth > 8 ? at[0] + 256 * at[1] : at[0];
  };
  Registration found;
  for (std::size_t j = 0; j < across.size(); ++j) {
    double want = 0;
    if (upright) {
      const double y = (across[j] - view.cy()) / view.fy();
      want = view.fx() * (edge.c - edge.ny * y) / edge.nx + view.cx();
    } else {
      const double x = (across[j] - view.cx()) / view.fx();
      want = view.fy() * (edge.c - edge.nx * x) / edge.ny + view.cy();
    }
    if (want < along.front() + 20 || want > along.back() - 20) continue;
    for (std::size_t i = 1; i < along.size(); ++i) {
      const double a = read(i - 1, j) - middle;
      const double b = read(i, j) - middle;
      if ((a < 0) == (b < 0)) continue;
      const double at = along[i - 1] + (along[i] - along[i - 1]) * a / (a - b);
      found.worst = std::max(found.worst, std::abs(at - want));
      ++found.seen;
    }
  }
  return found;
}

// A buffer whose frame is of the format.
static GstBuffer* picture_of(const Case& k, const GstVideoInfo& frame, const Edge& edge) {
  if (k.before.x == 0 && k.before.y == 0) return render(frame, edge, k.in, {});
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_INFO_FORMAT(&frame),
                            static_cast<guint>(k.size.width + k.before.x),
                            static_cast<guint>(k.size.height + k.before.y));
  GstBuffer* buffer = render(info, edge, k.in, k.before);
  add_crop(buffer, info, {{info.width, info.height}, k.before.x, k.before.y, k.size});
  return buffer;
}

static void check_edge(const Case& k, const Edge& edge) {
  Fixture f((std::string("calibundistort ! capsfilter caps=") + k.behind).c_str());
  const double focal = focal_of(k.size);
  const Camera source = Camera::make("brown4", k.size,
                                     {focal, focal, 0.5 * k.size.width, 0.5 * k.size.height,
                                      kRadial1, kRadial2, 0, 0})
                            .value();
  const std::string json = print_calibration(source.to_calibration()).value();
  g_object_set(f.element, "calibration", json.c_str(), nullptr);
  const std::string text = std::string("video/x-raw,framerate=25/1,format=") + k.format +
                           ",width=" + std::to_string(k.size.width) +
                           ",height=" + std::to_string(k.size.height) + k.caps;
  g_autoptr(GstCaps) caps = gst_caps_from_string(text.c_str());
  GstVideoInfo in_info;
  fail_unless(gst_video_info_from_caps(&in_info, caps));
  gst_harness_set_src_caps(f.h, gst_caps_ref(caps));
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, picture_of(k, in_info, edge));
  g_autoptr(GstCaps) out_caps = gst_pad_get_current_caps(f.h->sinkpad);
  GstVideoInfo out_info;
  fail_unless(gst_video_info_from_caps(&out_info, out_caps));
  const Camera view = Camera::make(parse_calibration(output_calibration(f)).value()).value();
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &out_info, out, GST_MAP_READ));
  for (guint c = 0; c < GST_VIDEO_INFO_N_COMPONENTS(&out_info); ++c) {
    const Registration found = locate(frame, c, edge, view, k.out);
    fail_unless(found.seen > 100, "%s: component %u is seen in %d rows", text.c_str(), c,
                found.seen);
    fail_unless(found.worst < 0.1, "%s: component %u, %f px off", text.c_str(), c, found.worst);
  }
  gst_video_frame_unmap(&frame);
}

GST_START_TEST(test_a_straight_edge_is_straight_in_every_component) {
  // One upright, one lying; all four where all is asked for.
  const bool full = std::getenv("CALVIN_FULL") != nullptr;
  for (int i = 0; i < 4; ++i) {
    if (full || i % 2 == __i__ % 2) check_edge(kCases[__i__], kEdges[i]);
  }
}
GST_END_TEST;

static Suite* calibundistort_chroma_suite() {
  Suite* suite = suite_create("calibundistort_chroma");
  TCase* tc = tcase_create("general");
  tcase_add_loop_test(tc, test_a_straight_edge_is_straight_in_every_component, 0,
                      static_cast<int>(std::size(kCases)));
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(calibundistort_chroma)
