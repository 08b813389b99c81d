// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibundistort: the pixels of every format, size and stride against a reference in double
// precision. Samples are read with GStreamer's own unpackers, which know nothing of planes here.

#include <cmath>
#include <map>
#include <span>

#include "remap_reference.hpp"
#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;
using namespace calvin::check;

// With a siting each, and with another part of black in the picture.
struct Frames {
  ImageSize size;
  const char* site;
  bool x_cosited;
  bool y_cosited;
  double alpha;
};
static const Frames kFrames[] = {{{640, 480}, nullptr, false, false, 0},
                                 {{641, 479}, "mpeg2", true, false, 1},
                                 {{322, 242}, "cosited", true, true, 0.6}};

static const reference::Lens kLens = {"barrel", "brown4", {-0.28, 0.09, 5e-4, -7e-4}};

// Every row where all is asked for; one of seven tells as much.
static int row_step() { return std::getenv("CALVIN_FULL") != nullptr ? 1 : 7; }

// The components of a frame, each as large as the picture: alpha, then Y U V or R G B.
struct Picture {
  Picture(const GstVideoInfo& info, GstBuffer* buffer) : width(GST_VIDEO_INFO_WIDTH(&info)) {
    GstVideoFrame frame;
    fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_READ));
    fail_unless_equals_int(GST_VIDEO_FRAME_WIDTH(&frame), GST_VIDEO_INFO_WIDTH(&info));
    fail_unless_equals_int(GST_VIDEO_FRAME_HEIGHT(&frame), GST_VIDEO_INFO_HEIGHT(&info));
    const GstVideoFormatInfo* f = info.finfo;
    const auto unpacked = f->unpack_format;
    const bool wide = unpacked == GST_VIDEO_FORMAT_AYUV64 || unpacked == GST_VIDEO_FORMAT_ARGB64;
    const auto count = static_cast<std::size_t>(4 * width);
    std::vector<guint16> line(count);
    std::vector<guint8> bytes(count);
    for (int y = 0; y < GST_VIDEO_INFO_HEIGHT(&info); ++y) {
      f->unpack_func(f, GST_VIDEO_PACK_FLAG_TRUNCATE_RANGE,
                     wide ? static_cast<gpointer>(line.data()) : bytes.data(), frame.data,
                     frame.info.stride, 0, y, width);
      if (!wide) std::copy(bytes.begin(), bytes.end(), line.begin());
      // GStreamer 1.22 takes U for V in the last column of an odd width.
      if (GST_VIDEO_INFO_FORMAT(&info) == GST_VIDEO_FORMAT_VYUY && width % 2 == 1) {
        std::swap(line[count - 2], line[count - 1]);
      }
      values.insert(values.end(), line.begin(), line.end());
    }
    for (guint c = 0; c < GST_VIDEO_FORMAT_INFO_N_COMPONENTS(f); ++c) {
      shift[c == GST_VIDEO_COMP_A ? 0 : c + 1] =
          (wide ? 16 : 8) - static_cast<int>(GST_VIDEO_FORMAT_INFO_DEPTH(f, c));
    }
    gst_video_frame_unmap(&frame);
  }
  [[nodiscard]] int at(int component, int x, int y) const {
    return values[static_cast<std::size_t>(4 * (y * width + x) + component)] >> shift[component];
  }
  int width;
  int shift[4] = {};  // of each component
  std::vector<guint16> values;
};

// Noise in every byte, and then in every sample by GStreamer's own packers, for some formats have
// bits that mean nothing: no sample is like its neighbour, and none may be touched in vain.
static void fill_with_noise(const GstVideoInfo& info, GstBuffer* buffer) {
  std::mt19937 random(1);
  // Packers want aligned memory.
  g_autoptr(GstBuffer) plain = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  for (GstBuffer* each : {plain, buffer}) {
    GstMapInfo map;
    gst_buffer_map(each, &map, GST_MAP_WRITE);
    for (gsize i = 0; i < map.size; ++i) map.data[i] = static_cast<guint8>(random());
    gst_buffer_unmap(each, &map);
  }
  const GstVideoFormatInfo* f = info.finfo;
  GstVideoFrame from;
  GstVideoFrame to;
  fail_unless(gst_video_frame_map(&from, &info, plain, GST_MAP_READWRITE));
  fail_unless(gst_video_frame_map(&to, &info, buffer, GST_MAP_WRITE));
  std::vector<guint16> line(static_cast<std::size_t>(4 * (GST_VIDEO_INFO_WIDTH(&info) + 64)));
  for (int y = 0; y < GST_VIDEO_INFO_HEIGHT(&info); ++y) {
    for (guint16& value : line) value = static_cast<guint16>(random());
    f->pack_func(f, GST_VIDEO_PACK_FLAG_TRUNCATE_RANGE, line.data(), 0, from.data, from.info.stride,
                 GST_VIDEO_CHROMA_SITE_UNKNOWN, y, GST_VIDEO_INFO_WIDTH(&info));
  }
  fail_unless(gst_video_frame_copy(&to, &from));
  gst_video_frame_unmap(&to);
  gst_video_frame_unmap(&from);
}

// A buffer whose planes begin anywhere and whose rows have something behind them.
static GstBuffer* new_buffer(const GstVideoInfo& info, bool padded) {
  const gsize step = GST_VIDEO_INFO_COMP_DEPTH(&info, 0) == 8 ? 1 : 2;
  gsize offset[GST_VIDEO_MAX_PLANES] = {};
  gint stride[GST_VIDEO_MAX_PLANES] = {};
  gsize size = padded ? 11 * step : 0;
  for (guint p = 0; p < GST_VIDEO_INFO_N_PLANES(&info); ++p) {
    const auto rows = static_cast<gsize>(GST_VIDEO_INFO_HEIGHT(&info));
    offset[p] = size;
    stride[p] = GST_VIDEO_INFO_PLANE_STRIDE(&info, p) + static_cast<gint>((13 + 2 * p) * step);
    size += static_cast<gsize>(stride[p]) * rows + 7 * step;
  }
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, padded ? size : info.size, nullptr);
  if (padded) {
    gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_INFO_FORMAT(&info),
                                   static_cast<guint>(GST_VIDEO_INFO_WIDTH(&info)),
                                   static_cast<guint>(GST_VIDEO_INFO_HEIGHT(&info)),
                                   GST_VIDEO_INFO_N_PLANES(&info), offset, stride);
  }
  GST_BUFFER_PTS(buffer) = 0;
  return buffer;
}

// Answers the ALLOCATION query with a pool of padded frames.
static GstPadProbeReturn offer_padded_pool(GstPad* /*pad*/, GstPadProbeInfo* probe, gpointer) {
  auto* query = GST_PAD_PROBE_INFO_QUERY(probe);
  if (GST_QUERY_TYPE(query) != GST_QUERY_ALLOCATION) return GST_PAD_PROBE_OK;
  GstCaps* caps = nullptr;
  gst_query_parse_allocation(query, &caps, nullptr);
  GstVideoInfo info;
  gst_video_info_from_caps(&info, caps);
  GstBufferPool* pool = gst_video_buffer_pool_new();
  GstStructure* config = gst_buffer_pool_get_config(pool);
  gst_buffer_pool_config_set_params(config, caps, static_cast<guint>(info.size), 0, 0);
  gst_buffer_pool_config_add_option(config, GST_BUFFER_POOL_OPTION_VIDEO_META);
  gst_buffer_pool_config_add_option(config, GST_BUFFER_POOL_OPTION_VIDEO_ALIGNMENT);
  GstVideoAlignment align;
  gst_video_alignment_reset(&align);
  align.padding_left = 6;
  align.padding_right = 7;
  align.padding_top = 2;
  align.padding_bottom = 5;
  gst_buffer_pool_config_set_video_alignment(config, &align);
  fail_unless(gst_buffer_pool_set_config(pool, config));
  gst_query_add_allocation_pool(query, pool, static_cast<guint>(info.size), 0, 0);
  gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
  gst_object_unref(pool);
  return GST_PAD_PROBE_HANDLED;
}

// Where the samples of one plane come from; of the rows that are looked at.
struct Place {
  bool certain;  // far enough from the border of the source
  bool valid;
  double x, y;  // samples
};
static std::vector<Place> places_of(const Camera& source, const Camera& view, int x_shift,
                                    int y_shift, const Frames& frames) {
  const auto xs = reference::sites(frames.size.width, x_shift, x_shift > 0 && frames.x_cosited);
  const auto ys = reference::sites(frames.size.height, y_shift, y_shift > 0 && frames.y_cosited);
  const double fold = reference::fold(kLens);
  std::vector<Place> places(xs.size() * ys.size());
  for (std::size_t j = 0; j < ys.size(); j += static_cast<std::size_t>(row_step())) {
    for (std::size_t i = 0; i < xs.size(); ++i) {
      const double u = xs[i];
      const double v = ys[j];
      const auto [at, radius] = reference::source_place(kLens, source, view, u, v);
      const double inside =
          radius > fold
              ? -1
              : std::min({at.u, at.v, frames.size.width - 1 - at.u, frames.size.height - 1 - at.v});
      places[j * xs.size() + i] = {std::abs(inside) > 4e-3 && std::abs(radius - fold) > 2e-3,
                                   inside > 0, reference::sample_at(xs, at.u),
                                   reference::sample_at(ys, at.v)};
    }
  }
  return places;
}

// What has no source: black, chroma without colour, alpha opaque.
static int expected_fill(const GstVideoFormatInfo* f, int component) {
  const int depth = static_cast<int>(
      GST_VIDEO_FORMAT_INFO_DEPTH(f, component == 0 ? GST_VIDEO_COMP_A : component - 1));
  if (component == 0) return (1 << depth) - 1;
  if (!GST_VIDEO_FORMAT_INFO_IS_YUV(f)) return 0;
  return component == 1 ? 16 << (depth - 8) : 1 << (depth - 1);
}

static void compare(const GstVideoInfo& info, const Picture& in, const Picture& out,
                    const Camera& source, const Camera& view, const Frames& frames) {
  const GstVideoFormatInfo* f = info.finfo;
  std::map<std::pair<int, int>, std::vector<Place>> known;
  int valid = 0;
  int filled = 0;
  const int count = static_cast<int>(GST_VIDEO_FORMAT_INFO_N_COMPONENTS(f));
  for (int c = 0; c < count; ++c) {
    const auto index = static_cast<guint>(c);
    const int xs = static_cast<int>(GST_VIDEO_FORMAT_INFO_W_SUB(f, index));
    const int ys = static_cast<int>(GST_VIDEO_FORMAT_INFO_H_SUB(f, index));
    const int top = (1 << GST_VIDEO_FORMAT_INFO_DEPTH(f, index)) - 1;
    // Half a level of rounding; places are 1/250 px wrong each way, or 1/500 px, and for 8 bit
    // weights are multiples of 1/128. That many levels only where neighbours are black and white.
    const double bound = 0.5 + (top == 255 ? 1 + 2 * top / 250.0 : 2 * top / 500.0);
    const int unpacked = c == GST_VIDEO_COMP_A ? 0 : c + 1;
    auto& places = known[{xs, ys}];
    if (places.empty()) places = places_of(source, view, xs, ys, frames);
    const int width = (frames.size.width + (1 << xs) - 1) >> xs;
    const int height = (frames.size.height + (1 << ys) - 1) >> ys;
    fail_unless_equals_int(places.size(), width * height);
    for (int j = 0; j < height; j += row_step()) {
      for (int i = 0; i < width; ++i) {
        const Place& p = places[static_cast<std::size_t>(j * width + i)];
        if (!p.certain) continue;
        const int got = out.at(unpacked, i << xs, j << ys);
        const double want =
            p.valid ? reference::bilinear(
                          [&](int x, int y) { return in.at(unpacked, x << xs, y << ys); }, width,
                          height, p.x, p.y)
                    : expected_fill(f, unpacked);
        ++(p.valid ? valid : filled);
        if (std::abs(got - want) <= (p.valid ? bound : 0)) continue;
        fail_unless(false, "%s %dx%d: %d instead of %f, component %d, sample %d, %d",
                    GST_VIDEO_INFO_NAME(&info), frames.size.width, frames.size.height, got, want, c,
                    i, j);
      }
    }
  }
  fail_unless(valid > frames.size.width * frames.size.height / row_step() / 2);
  fail_unless((filled > 0) == (frames.alpha > 0));
}

static void check_frames(const char* format, const Frames& frames, bool padded) {
  const Camera source = reference::camera(kLens, frames.size, 0.75 * frames.size.width,
                                          0.51 * frames.size.width, 0.485 * frames.size.height);
  Fixture f("calibundistort");
  if (padded) {
    gst_pad_add_probe(f.h->sinkpad, GST_PAD_PROBE_TYPE_QUERY_DOWNSTREAM, offer_padded_pool, nullptr,
                      nullptr);
  }
  const std::string json = print_calibration(source.to_calibration()).value();
  g_object_set(f.element, "calibration", json.c_str(), "alpha", frames.alpha, nullptr);
  g_autoptr(GstCaps) caps = caps_of(format, frames.size);
  if (frames.site != nullptr) {
    gst_caps_set_simple(caps, "chroma-site", G_TYPE_STRING, frames.site, nullptr);
  }
  gst_harness_set_src_caps(f.h, gst_caps_copy(caps));
  GstVideoInfo info;
  fail_unless(gst_video_info_from_caps(&info, caps));
  g_autoptr(GstBuffer) in = new_buffer(info, padded);
  fill_with_noise(info, in);
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(f.h, gst_buffer_ref(in));
  const GstVideoMeta* meta = gst_buffer_get_video_meta(out);
  const bool longer = meta != nullptr && meta->stride[0] > info.stride[0];
  // The rows of v210 and its like have room for some pixels more.
  fail_unless(longer == padded || (padded && GST_VIDEO_FORMAT_INFO_IS_COMPLEX(info.finfo)));
  const Camera view = Camera::make(parse_calibration(output_calibration(f)).value()).value();
  compare(info, Picture(info, in), Picture(info, out), source, view, frames);
}

GST_START_TEST(test_every_format_equals_the_reference) {
  const std::string name = formats_without_palette()[static_cast<std::size_t>(__i__)];
  const char* format = name.c_str();
  const auto f = gst_video_format_get_info(gst_video_format_from_string(format));
  // Of tiles there is a whole number in memory, whatever is wanted behind the rows.
  const bool pads = !GST_VIDEO_FORMAT_INFO_IS_TILED(f);
  check_frames(format, kFrames[0], false);
  if (pads) check_frames(format, kFrames[0], true);
  for (const Frames& frames : std::span(kFrames).subspan(1)) check_frames(format, frames, pads);
}
GST_END_TEST;

static Suite* calibundistort_formats_suite() {
  Suite* suite = suite_create("calibundistort_formats");
  TCase* tc = tcase_create("general");
  tcase_add_loop_test(tc, test_every_format_equals_the_reference, 0,
                      static_cast<int>(formats_without_palette().size()));
  suite_add_tcase(suite, tc);
  return suite;
}

GST_CHECK_MAIN(calibundistort_formats)
