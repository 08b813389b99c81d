// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What examples/export-warp writes, evaluated as its readers do, shows the pixels of
// calibundistort.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "../../examples/export_warp_text.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/settings.hpp"
#include "calvin/remap/undistorter.hpp"
#include "exported_shaders.hpp"

using namespace calvin;
using export_warp::Warp;

namespace {

constexpr ImageSize kSize = {640, 480};
constexpr double kDegree = std::numbers::pi / 180;
constexpr char kBarrel[] =
    "fx=480,fy=478,cx=325,cy=236,k1=-0.28,k2=0.09,p1=0.0005,p2=-0.0007,k3=0.01,width=640,height="
    "480";
constexpr char kFisheye[] =
    "model=fisheye,fx=200,fy=201,cx=322,cy=238,k1=-0.02,k2=0.005,k3=-0.003,k4=0.0005,width=640,"
    "height=480";

Warp warp_of(const char* text, const ViewOptions& options) {
  const Camera camera = Camera::make(parse_calibration_setting(text).value()).value();
  return {camera, options, output_view(camera, options).value()};
}

// A soft picture, so that a place that is wrong by a part of a pixel shows.
GrayImage picture(ImageSize size) {
  GrayImage image(size.width, size.height);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      image.row(y)[x] = static_cast<std::uint8_t>(
          std::lround(128 + 60 * std::sin(x / 9.0) + 60 * std::cos(y / 7.0 + x / 40.0)));
    }
  }
  return image;
}

// What calibundistort makes of it; 7 where there is nothing to see.
GrayImage ours(const Warp& warp, const GrayImage& in, Interpolation interpolation) {
  const auto undistorter =
      Undistorter::make(warp.source, warp.options, {PlaneLayout{{}, 1, 1, 1, {7}}}).value();
  GrayImage out(warp.output().width, warp.output().height);
  undistorter.apply(0, {in.pixels.data(), in.width}, {out.pixels.data(), out.width},
                    {interpolation, Outside::kFill});
  return out;
}

double bilinear(const GrayImage& image, Pixel at) {
  const int x = std::clamp(static_cast<int>(at.u), 0, image.width - 2);
  const int y = std::clamp(static_cast<int>(at.v), 0, image.height - 2);
  const auto p = [&](int i, int j) { return image.view().at(x + i, y + j); };
  const double a = at.u - x;
  const double b = at.v - y;
  return (1 - b) * ((1 - a) * p(0, 0) + a * p(1, 0)) + b * ((1 - a) * p(0, 1) + a * p(1, 1));
}

// The pixels for the places that a reader finds: px of the source, or nothing. The picture changes
// by at most 15 levels in a pixel; `wrong` is what the format allows a place to be wrong by, px.
template <typename PlaceAt>
void expect_pixels(const Warp& warp, double wrong, PlaceAt place_at) {
  const GrayImage in = picture(warp.input());
  const GrayImage want = ours(warp, in, Interpolation::kBilinear);
  int seen = 0;
  int unseen = 0;
  for (int y = 0; y < want.height; ++y) {
    for (int x = 0; x < want.width; ++x) {
      const std::optional<Pixel> at = place_at(x, y);
      const double inside =
          at ? std::min({at->u, at->v, in.width - 1 - at->u, in.height - 1 - at->v}) : -1;
      if (at && std::abs(inside) < 0.02 + wrong) continue;
      const double got = inside > 0 ? bilinear(in, *at) : 7;
      ++(inside > 0 ? seen : unseen);
      ASSERT_LE(std::abs(got - want.view().at(x, y)), 1.3 + 15 * wrong) << x << " " << y;
    }
  }
  EXPECT_GT(seen, want.width * want.height / 3);
  EXPECT_EQ(unseen > 0, warp.options.alpha > 0 || warp.options.pan != 0);
}

template <typename T>
T number_at(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));  // little endian, as this machine
  return value;
}

TEST(Dw100, ShowsThePixels) {
  for (const ImageSize size : {ImageSize{640, 480}, ImageSize{328, 250}}) {
    ViewOptions options;
    options.output = size;
    const Warp warp = warp_of(kBarrel, options);
    const std::string bytes = export_warp::dw100(warp);
    const int columns = (size.width + 15) / 16 + 1;
    const int rows = (size.height + 15) / 16 + 1;
    ASSERT_EQ(bytes.size(), static_cast<std::size_t>(4 * columns * rows));
    const auto vertex = [&](int c, int r) {
      const auto v =
          number_at<std::uint32_t>(bytes, static_cast<std::size_t>(4 * (r * columns + c)));
      return Pixel{(v & 0xFFFF) / 16.0, (v >> 16) / 16.0};
    };
    // Linear within blocks of 16 px, the last ones smaller.
    const auto place_at = [&](int x, int y) -> std::optional<Pixel> {
      const int c = x / 16;
      const int r = y / 16;
      const double a = (x - 16.0 * c) / std::min(16, size.width - 16 * c);
      const double b = (y - 16.0 * r) / std::min(16, size.height - 16 * r);
      const auto mix = [&](double p, double q, double s, double t) {
        return (1 - b) * ((1 - a) * p + a * q) + b * ((1 - a) * s + a * t);
      };
      const Pixel p = vertex(c, r);
      const Pixel q = vertex(c + 1, r);
      const Pixel s = vertex(c, r + 1);
      const Pixel t = vertex(c + 1, r + 1);
      return Pixel{mix(p.u, q.u, s.u, t.u), mix(p.v, q.v, s.v, t.v)};
    };
    // 1/32 px of rounding, and what the lens bends lines within a block: 6 k1 r / f at most (.8 of
    // f off the axis), times 16^2 / 8 px; four times that where a block covers 32 px of the source.
    expect_pixels(warp, size == kSize ? 0.12 : 0.4, place_at);
  }
}

TEST(StMap, ShowsThePixels) {
  ViewOptions options;
  options.alpha = 1;
  options.output = {600, 500};
  const Warp warp = warp_of(kFisheye, options);
  for (const bool from_above : {false, true}) {
    const std::string exr = export_warp::stmap(warp, from_above);
    // Behind the header, which ffmpeg reads below: offsets of the rows.
    const std::size_t row_bytes = 3 * 4 * 600;
    const std::size_t first = exr.size() - 500 * (8 + row_bytes);
    const auto place_at = [&](int x, int y) -> std::optional<Pixel> {
      const auto row = static_cast<std::size_t>(y) * (8 + row_bytes);
      const auto value = [&](int channel) {
        return number_at<float>(
            exr, first + row + 8 + static_cast<std::size_t>(4 * (channel * 600 + x)));
      };
      if (value(0) == 0) return std::nullopt;
      const double down = from_above ? value(1) : 1.0 - value(1);
      return Pixel{640.0 * value(2) - 0.5, 480 * down - 0.5};
    };
    expect_pixels(warp, 1e-4, place_at);
  }
}

TEST(NvDewarper, ShowsThePixels) {
  for (const char* text : {kBarrel, kFisheye}) {
    ViewOptions options;
    options.alpha = 1;
    options.output = {500, 400};
    const Warp warp = warp_of(text, options);
    std::istringstream lines(export_warp::nvdewarper(warp).value());
    std::map<std::string, std::vector<double>> values;
    for (std::string line; std::getline(lines, line);) {
      const auto equals = line.find('=');
      if (equals == std::string::npos) continue;
      const std::string numbers = line.substr(equals + 1);
      for (const auto number : split(numbers, ';')) {
        values[line.substr(0, equals)].push_back(parse_double(number).value());
      }
    }
    EXPECT_EQ(values["width"].at(0), 500);
    EXPECT_EQ(values["output-height"].at(0), 400);
    const auto& k = values["distortion"];
    const bool fisheye = values["projection-type"].at(0) == 4;
    ASSERT_EQ(k.size(), fisheye ? 4U : 5U);
    const double limit = export_warp::widest_angle(warp.source);
    expect_pixels(warp, 1e-6, [&](int u, int v) -> std::optional<Pixel> {
      const double x = (u - values["dst-principal-point"].at(0)) / values["dst-focal-length"].at(0);
      const double y = (v - values["dst-principal-point"].at(1)) / values["dst-focal-length"].at(1);
      const double r2 = x * x + y * y;
      const double t = std::atan(std::sqrt(r2));
      if (t > limit) return std::nullopt;
      const double t2 = t * t;
      const double g =
          fisheye ? (r2 == 0 ? 1
                             : t / std::sqrt(r2) *
                                   (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])))))
                  : 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[2]));
      const double p = fisheye ? 0 : k[3];
      const double q = fisheye ? 0 : k[4];
      return Pixel{values["focal-length"].at(0) * (x * g + 2 * p * x * y + q * (r2 + 2 * x * x)) +
                       values["src-x0"].at(0),
                   values["focal-length"].at(1) * (y * g + p * (r2 + 2 * y * y) + 2 * q * x * y) +
                       values["src-y0"].at(0)};
    });
  }
  ViewOptions turned;
  turned.pan = 0.1;
  EXPECT_FALSE(export_warp::nvdewarper(warp_of(kBarrel, turned)).has_value());
  ViewOptions round;
  round.projection = Projection::kPanini;
  EXPECT_FALSE(export_warp::nvdewarper(warp_of(kBarrel, round)).has_value());
}

// The options that tests/pipelines/meson.build gives, once more.
template <typename Source>
void expect_shader(const char* text, const ViewOptions& options, Source source) {
  expect_pixels(warp_of(text, options), 1e-4, [&](int x, int y) -> std::optional<Pixel> {
    const glsl::vec3 p = source(glsl::vec2(x, y));
    return p.z > 0 ? std::optional(Pixel{p.x, p.y}) : std::nullopt;
  });
}

TEST(Glsl, ShowsThePixels) {
  ViewOptions options;
  options.pan = 15 * kDegree;
  options.tilt = -5 * kDegree;
  options.roll = 10 * kDegree;
  expect_shader(kBarrel, options, glsl::shader_brown::calvin_source);
  options = {};
  options.alpha = 1;
  options.projection = Projection::kEquirectangular;
  expect_shader(kFisheye, options, glsl::shader_fisheye::calvin_source);
  options.projection = Projection::kFisheye;
  options.zoom = 0.7;
  expect_shader(
      "model=doublesphere,fx=180,fy=181,cx=322,cy=238,xi=-0.2,alpha=0.57,width=640,height=480",
      options, glsl::shader_doublesphere::calvin_source);
  options = {};
  options.alpha = 0.5;
  options.projection = Projection::kPanini;
  expect_shader("model=ucm,fx=300,fy=301,cx=322,cy=238,alpha=0.6,width=640,height=480", options,
                glsl::shader_ucm::calvin_source);
  options.projection = Projection::kStereographic;
  expect_shader(
      "model=tilted14,fx=480,fy=478,cx=325,cy=236,k1=-0.28,k2=0.09,p1=0.0005,p2=-0.0007,k3=0.01,k4="
      "0.02,k5=0.01,k6=0.001,s1=0.002,s2=0.001,s3=-0.001,s4=0.0005,taux=0.02,tauy=-0.01,width=640,"
      "height=480",
      options, glsl::shader_tilted::calvin_source);
}

TEST(Glsl, HasEveryLens) {
  for (const auto& [setting, source] : glsl::kLensShaders) {
    SCOPED_TRACE(setting);
    expect_shader(setting, {}, source);
  }
}

// ---- ffmpeg itself
// --------------------------------------------------------------------------------

class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() /
              fmt::format("calvin-{}", std::random_device()())) {
    std::filesystem::create_directory(path_);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path_); }
  [[nodiscard]] std::string operator/(const char* name) const { return (path_ / name).string(); }
  void write(const char* name, const std::string& bytes) const {
    std::ofstream(path_ / name, std::ios::binary) << bytes;
  }
  [[nodiscard]] std::string read(const char* name) const {
    std::ifstream file(path_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  std::filesystem::path path_;
};

bool has_ffmpeg() { return std::system("ffmpeg -version >/dev/null 2>&1") == 0; }

TEST(Ffmpeg, ShowsThePixels) {
  if (!has_ffmpeg()) GTEST_SKIP() << "there is no ffmpeg here";
  ViewOptions options;
  options.alpha = 1;
  options.output = {602, 450};
  const Warp warp = warp_of(kBarrel, options);
  const GrayImage in = picture(kSize);
  const Folder folder;
  folder.write("in.pgm", "P5\n640 480\n255\n" + std::string(in.pixels.begin(), in.pixels.end()));
  folder.write("x.pgm", export_warp::ffmpeg_map(warp, false));
  folder.write("y.pgm", export_warp::ffmpeg_map(warp, true));
  const std::string command = fmt::format(
      "ffmpeg -v error -y -i {} -i {} -i {} -lavfi \"[0]format=gray[a];[a][1][2]remap=fill=black\" "
      "-pix_fmt gray -f rawvideo {}",
      folder / "in.pgm", folder / "x.pgm", folder / "y.pgm", folder / "out.gray");
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  const std::string got = folder.read("out.gray");
  const GrayImage want = ours(warp, in, Interpolation::kNearest);
  ASSERT_EQ(got.size(), want.pixels.size());
  int equal = 0;
  int black = 0;
  for (int y = 0; y < want.height; ++y) {
    for (int x = 0; x < want.width; ++x) {
      const auto place = warp.place(x, y);
      const auto i = static_cast<std::size_t>(y * want.width + x);
      const auto pixel = static_cast<std::uint8_t>(got[i]);
      const double inside =
          place ? std::min({place->u, place->v, 639 - place->u, 479 - place->v}) : -1;
      if (std::abs(inside) < 0.02 || std::abs(inside + 0.5) < 0.02) continue;
      if (inside < -0.5) {
        ++black;
        ASSERT_LE(pixel, 16) << x << " " << y;
        continue;
      }
      // Halfway between two pixels either is right.
      const auto halfway = [](double p) { return std::abs(p - std::floor(p) - 0.5) < 0.01; };
      if (halfway(place->u) || halfway(place->v)) continue;
      ++equal;
      // Half a pixel beyond the outermost centres ours shows nothing.
      const int shown = inside < 0 ? in.view().at(static_cast<int>(std::lround(place->u)),
                                                  static_cast<int>(std::lround(place->v)))
                                   : want.pixels[i];
      ASSERT_EQ(pixel, shown) << x << " " << y;
    }
  }
  EXPECT_GT(equal, 150000);
  EXPECT_GT(black, 1000);
}

// Alpha 0 fits the view to the outermost centres, but for rounding: a map that asked for these
// exactly had black pixels at the border.
TEST(Ffmpeg, HasNoHolesWhereAllPixelsAreValid) {
  constexpr char kCamera[] =
      "fx=510.349,fy=511.88,cx=326.54,cy=235.66,k1=-0.25,k2=0.08,p1=0.0006,p2=-0.0004,k3=-0.01,"
      "width=640,height=480";
  for (const char* text : {kCamera, kBarrel, kFisheye}) {
    const Warp warp = warp_of(text, {});
    for (const bool rows : {false, true}) {
      const std::string map = export_warp::ffmpeg_map(warp, rows);
      const std::size_t pixels = std::size_t{2} * 640 * 480;
      for (std::size_t i = map.size() - pixels; i < map.size(); i += 2) {
        const int at =
            static_cast<std::uint8_t>(map[i]) << 8 | static_cast<std::uint8_t>(map[i + 1]);
        ASSERT_LT(at, rows ? 480 : 640) << text << ", byte " << i;
      }
    }
  }
}
TEST(Ffmpeg, ReadsTheStMap) {
  if (!has_ffmpeg()) GTEST_SKIP() << "there is no ffmpeg here";
  ViewOptions options;
  options.output = {64, 48};
  const Warp warp = warp_of(kBarrel, options);
  const Folder folder;
  folder.write("map.exr", export_warp::stmap(warp, true));
  const std::string command =
      fmt::format("ffmpeg -v error -y -i {} -pix_fmt gbrpf32le -f rawvideo {}", folder / "map.exr",
                  folder / "map.raw");
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  const std::string planes = folder.read("map.raw");
  ASSERT_EQ(planes.size(), 3U * 4 * 64 * 48);
  for (const auto& [x, y] : {std::pair(0, 0), {63, 47}, {20, 31}}) {
    const Pixel place = warp.place(x, y).value();
    const auto at = static_cast<std::size_t>(4 * (y * 64 + x));
    EXPECT_NEAR(number_at<float>(planes, at), (place.v + 0.5) / 480, 1e-6);
    EXPECT_NEAR(number_at<float>(planes, at + 2 * 4 * 64 * 48), (place.u + 0.5) / 640, 1e-6);
  }
}

}  // namespace
