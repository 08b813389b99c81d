// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pixels of an undistorted picture against a reference in double precision.
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "calvin/remap/undistorter.hpp"
#include "remap_reference.hpp"

namespace calvin {
namespace {

using reference::Lens;

const std::vector<Lens> kLenses = {
    {"pinhole", "pinhole", {}},
    {"brown4 barrel", "brown4", {-0.28, 0.09, 5e-4, -7e-4}},
    {"brown4 pincushion", "brown4", {0.12, -0.02, -1e-3, 1e-3}},
    {"brown5", "brown5", {-0.3, 0.12, 1e-3, -5e-4, -0.02}},
    {"fisheye", "fisheye", {-0.02, 0.005, -0.003, 0.0005}},
};

struct NamedLayout {
  const char* name;
  PlaneLayout layout;
  int max = 255;  // the largest value of a sample
};
constexpr auto kLittle = SampleType::kU16Little;
constexpr auto kBig = SampleType::kU16Big;
const std::vector<NamedLayout> kLayouts = {
    {"GRAY8", {{}, 1, 1, 1, {16}}},
    {"I420 chroma, MPEG-2 siting", {{1, 1, true, false}, 1, 1, 1, {128}}},
    {"I420 chroma, JPEG siting", {{1, 1, false, false}, 1, 1, 1, {128}}},
    {"NV12 chroma", {{1, 1, true, false}, 2, 2, 1, {128, 127}}},
    {"YUY2 luma", {{}, 1, 2, 1, {16}}},
    {"YUY2 chroma", {{1, 0, true, false}, 2, 4, 2, {128, 126}}},
    {"RGB", {{}, 3, 3, 1, {1, 2, 3}}},
    {"BGRx", {{}, 4, 4, 1, {10, 20, 30, 255}}},
    {"GRAY16_LE", {{}, 1, 2, 2, {4099}, kLittle}, 65535},
    {"GRAY16_BE", {{}, 1, 2, 2, {4099}, kBig}, 65535},
    {"I420_10LE chroma", {{1, 1, true, false}, 1, 2, 2, {512}, kLittle, 0, std::nullopt, 10}, 1023},
    {"P010 chroma", {{1, 1, true, false}, 2, 4, 2, {512, 511}, kLittle, 6}, 1023},
    {"ARGB64_BE", {{}, 4, 8, 2, {65535, 1, 2, 3}, kBig}, 65535},
    {"I420 chroma, JPEG to MPEG-2 siting",
     {{1, 1, false, false}, 1, 1, 1, {128}, SampleType::kU8, 0, Subsampling{1, 1, true, false}}},
};

int bytes_of(const PlaneLayout& layout) { return layout.sample == SampleType::kU8 ? 1 : 2; }

// A sample as whoever reads the format takes it.
int read_sample(const std::uint8_t* at, const PlaneLayout& layout) {
  if (layout.sample == SampleType::kU8) return at[0];
  const int word = layout.sample == kLittle ? at[0] + 256 * at[1] : 256 * at[0] + at[1];
  return word / (1 << layout.shift);
}

// A plane with padding between the rows; every byte holds something to lose.
struct Plane {
  Plane(ImageSize samples, const PlaneLayout& layout)
      : stride(samples.width * layout.pixel_step + 13),
        bytes(static_cast<std::size_t>(stride * samples.height), 0xA5) {}

  std::ptrdiff_t stride;
  std::vector<std::uint8_t> bytes;
};

// Half smooth like a photograph, half as sharp as a picture can be; 0..1.
double scene(int x, int y, int c, int width, std::mt19937& random) {
  if (x > width / 2) return (random() & 1) != 0 ? 1 : 0;
  return 0.5 + 0.24 * std::sin(0.11 * x + c) + 0.24 * std::cos(0.07 * y - 0.02 * x + c);
}

ImageSize plane_size(ImageSize frame, const Subsampling& s) {
  return {(frame.width + (1 << s.x_shift) - 1) >> s.x_shift,
          (frame.height + (1 << s.y_shift) - 1) >> s.y_shift};
}

Plane make_scene(ImageSize samples, const NamedLayout& named) {
  const PlaneLayout& layout = named.layout;
  Plane plane(samples, layout);
  std::mt19937 random(7);
  for (int y = 0; y < samples.height; ++y) {
    for (int x = 0; x < samples.width; ++x) {
      for (int c = 0; c < layout.components; ++c) {
        std::uint8_t* at = plane.bytes.data() + y * plane.stride + x * layout.pixel_step +
                           c * layout.component_step;
        const auto value = std::lround(named.max * scene(x, y, c, samples.width, random))
                           << layout.shift;
        at[0] = static_cast<std::uint8_t>(layout.sample == kBig ? value >> 8 : value);
        if (bytes_of(layout) == 2) {
          at[1] = static_cast<std::uint8_t>(layout.sample == kBig ? value : value >> 8);
        }
      }
    }
  }
  return plane;
}

struct Planes {
  Plane input;
  Plane output;
};

struct Comparison {
  double worst = 0;      // grey levels of 8 bit
  double smooth = 0;     // the same where the picture is like a photograph
  double sum = 0;        // of all differences
  int valid = 0;         // samples compared
  int wrong_fill = 0;    // samples that should be filled, or should not
  int filled = 0;        // samples that are rightly filled
  int bytes_harmed = 0;  // of padding and of other components
};

// Every row where the counts are asked for; a third of them is as telling.
const int kRowStep = std::getenv("CALVIN_FULL") != nullptr ? 1 : 3;

// Compares what undistorting `input` gave with the reference.
Comparison compare(const Lens& lens, const Undistorter& undistorter, const NamedLayout& named,
                   const Planes& planes) {
  const Plane& input = planes.input;
  const Plane& output = planes.output;
  const PlaneLayout& layout = named.layout;
  const ImageSize frame = undistorter.output().image_size();
  const Subsampling& s = layout.subsampling;
  const Subsampling& t = layout.output_subsampling ? *layout.output_subsampling : s;
  const auto in_xs = reference::sites(frame.width, s.x_shift, s.x_cosited);
  const auto in_ys = reference::sites(frame.height, s.y_shift, s.y_cosited);
  const auto xs = reference::sites(frame.width, t.x_shift, t.x_cosited);
  const auto ys = reference::sites(frame.height, t.y_shift, t.y_cosited);
  const int width = static_cast<int>(xs.size());
  const int height = static_cast<int>(ys.size());
  const double fold = reference::fold(lens);
  std::vector<bool> ours(output.bytes.size());
  Comparison result;
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const auto [at, radius] =
          reference::source_place(lens, undistorter.source(), undistorter.output(), xs[i], ys[j]);
      // How far inside the source, px; the sign decides, the neighbourhood of zero does not.
      const double inside =
          radius > fold ? -1.0
                        : std::min({at.u, at.v, frame.width - 1 - at.u, frame.height - 1 - at.v});
      const bool looked_at = j % kRowStep == 0 || j + 1 == height;
      const bool certain =
          looked_at && std::abs(inside) > 4e-3 && !(std::abs(radius - fold) < 2e-3);
      for (int c = 0; c < layout.components; ++c) {
        const auto offset = j * output.stride + i * layout.pixel_step + c * layout.component_step;
        for (int b = 0; b < bytes_of(layout); ++b)
          ours[static_cast<std::size_t>(offset + b)] = true;
        if (!certain) continue;
        const int got = read_sample(output.bytes.data() + offset, layout);
        if (inside < 0) {
          ++(got == layout.fill[c] ? result.filled : result.wrong_fill);
          continue;
        }
        const auto read = [&](int x, int y) {
          return read_sample(input.bytes.data() + y * input.stride + x * layout.pixel_step +
                                 c * layout.component_step,
                             layout);
        };
        const double exact =
            reference::bilinear(read, width, height, reference::sample_at(in_xs, at.u),
                                reference::sample_at(in_ys, at.v));
        ++result.valid;
        const double difference = std::abs(got - exact) * 255 / named.max;
        result.sum += difference;
        result.worst = std::max(result.worst, difference);
        if (at.u < frame.width / 2 - 8) result.smooth = std::max(result.smooth, difference);
      }
    }
  }
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (!ours[i] && output.bytes[i] != 0xA5) ++result.bytes_harmed;
  }
  return result;
}

Planes undistort(const Undistorter& undistorter, std::size_t layout,
                 const Sampling& sampling = {}) {
  const PlaneLayout& l = kLayouts[layout].layout;
  const ImageSize samples = plane_size(undistorter.output().image_size(), l.subsampling);
  Planes planes{make_scene(samples, kLayouts[layout]), Plane(samples, l)};
  undistorter.apply(layout, {planes.input.bytes.data(), planes.input.stride},
                    {planes.output.bytes.data(), planes.output.stride}, sampling);
  return planes;
}

// Undistorts all of kLayouts.
Undistorter undistorter_for(const Camera& source, double alpha) {
  std::vector<PlaneLayout> layouts;
  for (const NamedLayout& l : kLayouts) layouts.push_back(l.layout);
  return Undistorter::make(source, {alpha, {}}, layouts).value();
}

class RemapPlane : public ::testing::TestWithParam<ImageSize> {};

TEST_P(RemapPlane, EqualsBilinearInDoublePrecisionWithinOneGreyLevel) {
  const ImageSize size = GetParam();
  for (const Lens& lens : kLenses) {
    const double focal = lens.model == "fisheye" ? 0.42 * size.width : 0.75 * size.width;
    const Camera source =
        reference::camera(lens, size, focal, 0.51 * size.width, 0.485 * size.height);
    for (const double alpha : {0.0, 1.0}) {
      const Undistorter undistorter = undistorter_for(source, alpha);
      for (std::size_t i = 0; i < kLayouts.size(); ++i) {
        const NamedLayout& named = kLayouts[i];
        SCOPED_TRACE(lens.name + ", " + named.name + ", alpha " + std::to_string(alpha));
        const Planes planes = undistort(undistorter, i);
        const Comparison result = compare(lens, undistorter, named, planes);
        // Half a level of rounding to the sample's depth; noise is as sharp as can be, and half a
        // level more is 0.001 px each way.
        const double rounding = 127.5 / named.max;
        EXPECT_LE(result.smooth, rounding + 0.1);
        EXPECT_LE(result.worst, rounding + 0.5);
        // Rounding alone makes 1/4.
        EXPECT_LE(result.sum, result.valid * (rounding / 2 + 0.26));
        EXPECT_EQ(result.wrong_fill, 0);
        EXPECT_EQ(result.bytes_harmed, 0);
        EXPECT_GT(result.valid, size.width * size.height / 30);
        EXPECT_EQ(result.filled > 0, alpha == 1 && !lens.k.empty());
      }
    }
  }
}

TEST_P(RemapPlane, AnIdentityCalibrationGivesIdenticalPixels) {
  const ImageSize size = GetParam();
  const std::vector<Lens> identities = {{"pinhole", "pinhole", {}},
                                        {"brown5", "brown5", {0, 0, 0, 0, 0}}};
  for (const Lens& lens : identities) {
    const Camera source = reference::camera(lens, size, 503.7, 300.2, 251.9);
    for (const double alpha : {0.0, 0.37, 1.0}) {
      const Undistorter undistorter = undistorter_for(source, alpha);
      for (std::size_t i = 0; i < kLayouts.size(); ++i) {
        if (kLayouts[i].layout.output_subsampling) continue;  // moves the samples
        SCOPED_TRACE(lens.name + ", " + kLayouts[i].name + ", alpha " + std::to_string(alpha));
        const Planes planes = undistort(undistorter, i);
        EXPECT_EQ(planes.input.bytes, planes.output.bytes);
      }
    }
  }
}

// 16 bits tell what single precision loses far from the origin.
TEST(RemapIdentity, AWidePictureStaysAsItIs) {
  const Lens lens = {"brown5", "brown5", {0, 0, 0, 0, 0}};
  for (const ImageSize size : {ImageSize{4103, 34}, ImageSize{66, 2051}}) {
    const Undistorter undistorter =
        undistorter_for(reference::camera(lens, size, 903.7, 1300.2, 21.9), 0.37);
    for (std::size_t i = 0; i < kLayouts.size(); ++i) {
      if (kLayouts[i].layout.output_subsampling) continue;  // moves the samples
      SCOPED_TRACE(std::string(kLayouts[i].name) + ", " + std::to_string(size.width));
      const Planes planes = undistort(undistorter, i);
      EXPECT_EQ(planes.input.bytes, planes.output.bytes);
    }
  }
}

TEST_P(RemapPlane, BicubicAndLanczosEqualDoublePrecisionWithinOneGreyLevel) {
  const ImageSize size = GetParam();
  const Lens& lens = kLenses[1];
  const Camera source =
      reference::camera(lens, size, 0.75 * size.width, 0.51 * size.width, 0.485 * size.height);
  const Undistorter undistorter = undistorter_for(source, 0.3);
  for (std::size_t l = 0; l < kLayouts.size(); ++l) {
    const NamedLayout& named = kLayouts[l];
    if (named.layout.output_subsampling) continue;
    const PlaneLayout& layout = named.layout;
    const Subsampling& s = layout.subsampling;
    const auto xs = reference::sites(size.width, s.x_shift, s.x_cosited);
    const auto ys = reference::sites(size.height, s.y_shift, s.y_cosited);
    const int width = static_cast<int>(xs.size());
    const int height = static_cast<int>(ys.size());
    for (const auto interpolation : {Interpolation::kBicubic, Interpolation::kLanczos}) {
      SCOPED_TRACE(std::string(named.name) +
                   (interpolation == Interpolation::kLanczos ? " 3" : ""));
      const Planes planes = undistort(undistorter, l, {interpolation, Outside::kFill});
      double worst = 0;
      for (int j = 0; j < height; j += 3 * kRowStep) {
        for (int i = 0; i < width; ++i) {
          const Pixel at =
              reference::source_place(lens, source, undistorter.output(), xs[i], ys[j]).pixel;
          const double inside =
              std::min({at.u, at.v, size.width - 1 - at.u, size.height - 1 - at.v});
          if (inside < 4e-3) continue;
          for (int c = 0; c < layout.components; ++c) {
            const auto offset = i * layout.pixel_step + c * layout.component_step;
            const auto read = [&](int x, int y) {
              return read_sample(planes.input.bytes.data() + y * planes.input.stride +
                                     x * layout.pixel_step + c * layout.component_step,
                                 layout);
            };
            const double x = reference::sample_at(xs, at.u);
            const double y = reference::sample_at(ys, at.v);
            const double exact =
                interpolation == Interpolation::kBicubic
                    ? reference::filtered(read, reference::cubic, width, height, x, y)
                    : reference::filtered(read, reference::lanczos3, width, height, x, y);
            const int got =
                read_sample(planes.output.bytes.data() + j * planes.output.stride + offset, layout);
            worst = std::max(worst, std::abs(got - std::clamp(exact, 0.0, 1.0 * named.max)));
          }
        }
      }
      // Rounding, and a level of 8 bit.
      EXPECT_LE(worst, 0.5 + named.max / 255.0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, RemapPlane,
                         ::testing::Values(ImageSize{641, 479}, ImageSize{322, 242}),
                         [](const auto& size) { return std::to_string(size.param.width); });

#if HWY_ARCH_X86
// The one that the machine takes is compared with the reference above.
TEST(RemapLanes, EveryInstructionSetGivesTheSame) {
  const ImageSize size = {322, 242};
  const Camera source = reference::camera(kLenses[3], size, 240, 160, 119);
  const Undistorter undistorter = undistorter_for(source, 0.4);
  for (std::size_t l = 0; l < kLayouts.size(); ++l) {
    const NamedLayout& named = kLayouts[l];
    const ImageSize samples = plane_size(size, named.layout.subsampling);
    for (const auto interpolation : {Interpolation::kNearest, Interpolation::kBilinear,
                                     Interpolation::kBicubic, Interpolation::kLanczos}) {
      const Sampling sampling = {interpolation, Outside::kReplicate};
      const Planes best = undistort(undistorter, l, sampling);
      // Bits below a target's are those of later instructions.
      for (const auto target : {HWY_AVX3, HWY_AVX2, HWY_SSE4, HWY_SSSE3, HWY_STATIC_TARGET}) {
        SCOPED_TRACE(std::string(named.name) + " " + hwy::TargetName(target));
        hwy::DisableTargets(static_cast<std::int64_t>(target) - 1);
        const Planes planes = undistort(undistorter, l, sampling);
        hwy::DisableTargets(0);
        int apart = 0;
        for (int y = 0; y < samples.height; ++y) {
          for (int x = 0; x < samples.width; ++x) {
            for (int c = 0; c < named.layout.components; ++c) {
              const auto at = y * best.output.stride + x * named.layout.pixel_step +
                              c * named.layout.component_step;
              const int difference = read_sample(best.output.bytes.data() + at, named.layout) -
                                     read_sample(planes.output.bytes.data() + at, named.layout);
              // Between two samples the nearest is whichever rounding takes.
              const double allowed = interpolation == Interpolation::kNearest
                                         ? 0
                                         : std::max(1.0, 1.5 * named.max / 255);
              if (std::abs(difference) > allowed) ++apart;
            }
          }
        }
        EXPECT_LE(apart, interpolation == Interpolation::kNearest ? 200 : 0);
      }
    }
  }
}
#endif

TEST(RemapMap, StaysInsideThePlaneForExtremeCalibrations) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> exponent(-3, 6);
  std::uniform_real_distribution<double> sign(-1, 1);
  const auto number = [&] { return (sign(random) < 0 ? -1 : 1) * std::pow(10, exponent(random)); };
  const ImageSize size = {50, 38};
  int made = 0;
  for (int i = 0; i < 60; ++i) {
    const Lens& shape = kLenses[static_cast<std::size_t>(i) % kLenses.size()];
    std::vector<double> p = {std::abs(number()), std::abs(number()), number(), number()};
    for (std::size_t k = 0; k < shape.k.size(); ++k) p.push_back(number());
    const auto source = Camera::make(shape.model, size, p);
    ASSERT_TRUE(source.has_value());
    for (const double alpha : {0.0, 0.5, 1.0}) {
      const auto output = output_camera(*source, {alpha, {}});
      if (!output) {
        EXPECT_FALSE(output.error().message.empty());
        continue;
      }
      ++made;
      for (const double value : output->parameters()) ASSERT_TRUE(std::isfinite(value));
      const Undistorter undistorter = undistorter_for(*source, alpha);
      for (std::size_t l = 0; l < kLayouts.size(); ++l) {
        // The rows end where the memory does.
        const Planes planes = undistort(undistorter, l);
        const auto padding = planes.output.bytes.end() - 13;
        EXPECT_TRUE(std::all_of(padding, padding + 13, [](auto byte) { return byte == 0xA5; }));
      }
    }
  }
  EXPECT_GT(made, 20);
}

TEST(RemapMap, ATinyPictureIsRefusedOrMapped) {
  for (const ImageSize size :
       {ImageSize{1, 1}, ImageSize{2, 1}, ImageSize{1, 5}, ImageSize{2, 2}, ImageSize{3, 3}}) {
    const Camera source = Camera::make("pinhole", size, {5, 5, 0.5, 0.5}).value();
    const auto undistorter = Undistorter::make(source, {}, {kLayouts[2].layout});
    EXPECT_EQ(undistorter.has_value(), size.width > 1 && size.height > 1) << size.width;
  }
}

TEST(RemapMap, StopsWhenAsked) {
  const Camera source = reference::camera(kLenses[1], {640, 480}, 480, 320, 240);
  std::stop_source stop;
  stop.request_stop();
  const auto undistorter = Undistorter::make(source, {}, {kLayouts[0].layout}, stop.get_token());
  ASSERT_FALSE(undistorter.has_value());
  EXPECT_EQ(undistorter.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace calvin
