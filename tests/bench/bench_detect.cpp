// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Detectors beside each other: recall, corner error, time with and without a board and in a video,
// and real sets.
//   bench_detect [IMAGES] [NEGATIVES] [WIDTH HEIGHT]
// IMAGES per class (200) at 1920x1080; 1000 NEGATIVES. With CALVIN_DATA the real sets too.
// CALVIN_BENCH_PEERS=0: ours alone, which takes minutes instead of hours. CALVIN_BENCH_CLASS: the
// classes alone whose names hold it, and no video.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include <Eigen/LU>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "detect_scenes.hpp"
#include "detect_subjects.hpp"
#include "spread.hpp"

namespace bench {
namespace {

constexpr double kWrong = 1;  // px: a corner further off is none

// Of those that are numbers.
double quantile(std::vector<double> values, double share) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }),
               values.end());
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  return values[std::min(at, values.size() - 1)];
}

double distance(const calvin::Pixel& a, const calvin::Pixel& b) {
  return std::hypot(a.u - b.u, a.v - b.v);
}

double nearest(const std::vector<calvin::Pixel>& all, const calvin::Pixel& to) {
  double least = INFINITY;
  for (const auto& p : all) least = std::min(least, distance(p, to));
  return least;
}

// The least mean square distance of an unbiased estimate of a corner's place from its pixels: the
// noise and the gradients of the noiseless picture, out to half way to the next corner. The errors
// of a compressed picture depend on each other and on what it shows: there it is the square
// distance of the estimate by least squares that knows the noiseless picture.
double least_square_error(const Scene& scene, std::size_t corner, const SceneClass& kind) {
  const calvin::Pixel at = scene.truth.uv[corner];
  double spacing = INFINITY;
  for (std::size_t i = 0; i < scene.truth.uv.size(); ++i) {
    if (i != corner) spacing = std::min(spacing, distance(scene.truth.uv[i], at));
  }
  const int reach = static_cast<int>(spacing / 2) + 1;
  const int u = static_cast<int>(std::lround(at.u));
  const int v = static_cast<int>(std::lround(at.v));
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (int y = std::max(v - reach, 1); y <= std::min(v + reach, scene.clean.rows - 2); ++y) {
    for (int x = std::max(u - reach, 1); x <= std::min(u + reach, scene.clean.cols - 2); ++x) {
      if (std::hypot(x - at.u, y - at.v) > spacing / 2) continue;
      // White is white, however bright.
      const auto grey = [&](int dx, int dy) {
        return std::clamp(static_cast<double>(scene.clean.at<float>(y + dy, x + dx)), 0.0, 255.0);
      };
      const Eigen::Vector2d gradient = {(grey(1, 0) - grey(-1, 0)) / 2,
                                        (grey(0, 1) - grey(0, -1)) / 2};
      normal += gradient * gradient.transpose();
      right += gradient * (scene.image.at<std::uint8_t>(y, x) - grey(0, 0));
    }
  }
  if (kind.jpeg > 0) return (normal.inverse() * right).squaredNorm();
  constexpr double kRounding = 1.0 / 12;
  return (kind.noise * kind.noise + kRounding) * normal.inverse().trace();
}

struct Score {
  int found = 0;         // pictures with at least the wanted corners, all of them right
  int wrong = 0;         // pictures with a corner that is none, or is another one
  double square = 0;     // px^2, sums over corners
  double bound = 0;      // px^2
  double predicted = 0;  // px^2
  double bias_u = 0, bias_v = 0;
  int corners = 0;
  std::vector<double> ms;
};

// By ids where they are certain, else by place: a peer's order, an open labelling.
void add(const Scene& scene, const SceneClass& kind, const Found& found, Score& score) {
  score.ms.push_back(found.ms);
  const calvin::Observation& o = found.observation;
  if (!o.found()) return;
  const bool by_ids = !o.sigma.empty() && o.ambiguous.empty();
  Score image;
  int wrong = 0;
  for (std::size_t i = 0; i < o.uv.size(); ++i) {
    std::size_t at = 0;
    double least = INFINITY;
    for (std::size_t k = 0; k < scene.truth.uv.size(); ++k) {
      if (by_ids && scene.truth.ids[k] != o.ids[i]) continue;
      const double d = distance(scene.truth.uv[k], o.uv[i]);
      if (d < least) {
        least = d;
        at = k;
      }
    }
    if (!(least < kWrong)) {
      if (nearest(scene.covered, o.uv[i]) > kWrong) ++wrong;
      continue;
    }
    ++image.corners;
    image.square += least * least;
    image.bound += least_square_error(scene, at, kind);
    if (!o.sigma.empty()) image.predicted += 2 * o.sigma[i] * o.sigma[i];
    image.bias_u += o.uv[i].u - scene.truth.uv[at].u;
    image.bias_v += o.uv[i].v - scene.truth.uv[at].v;
  }
  const auto visible = static_cast<int>(scene.truth.uv.size());
  score.wrong += wrong > 0;
  score.found += wrong == 0 && 5 * image.corners >= (kind.whole() ? 5 : 4) * visible;
  score.square += image.square;
  score.bound += image.bound;
  score.predicted += image.predicted;
  score.bias_u += image.bias_u;
  score.bias_v += image.bias_v;
  score.corners += image.corners;
}

void print_header(const std::vector<Subject>& all) {
  std::printf("%-16s", "");
  for (const Subject& s : all) std::printf(" | %-34s", s.name.c_str());
  std::printf("\n%-16s", "class");
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::printf(" | %6s %5s %7s %6s %6s", "found%", "wrong", "RMS px", "ms", "p95");
  }
  std::printf(" | ours: RMS/bound predicted/RMS bias px\n");
}

void classes(const std::vector<Subject>& all, int images, calvin::ImageSize size,
             std::vector<Score>& totals) {
  print_header(all);
  const char* only = std::getenv("CALVIN_BENCH_CLASS");
  for (const SceneClass& kind : scene_classes()) {
    if (only != nullptr && std::string_view(kind.name).find(only) == std::string_view::npos) {
      continue;
    }
    std::vector<Score> scores(all.size());
    for (int i = 0; i < images; ++i) {
      const Scene scene = make_scene(kind, size, 1000 + static_cast<std::uint64_t>(i));
      for (std::size_t k = 0; k < all.size(); ++k) {
        add(scene, kind, all[k].look(scene.image, scene.board), scores[k]);
      }
    }
    std::printf("%-16s", kind.name);
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Score& s = scores[k];
      std::printf(" | %6.1f %5d %7.4f %6.2f %6.2f", 100.0 * s.found / images, s.wrong,
                  std::sqrt(s.square / s.corners), quantile(s.ms, 0.5), quantile(s.ms, 0.95));
      totals[k].found += s.found;
      totals[k].ms.insert(totals[k].ms.end(), s.ms.begin(), s.ms.end());
    }
    const Score& s = scores[0];
    std::printf(" | %5.2f %5.2f %7.4f\n", std::sqrt(s.square / s.bound),
                std::sqrt(s.predicted / s.square), std::hypot(s.bias_u, s.bias_v) / s.corners);
    std::fflush(stdout);
  }
}

// `all_ms`: of each subject, in the order of the pictures. The ratios are of single pictures, in
// which the peer was asked.
void print_times(const char* what, const std::vector<Subject>& all,
                 const std::vector<std::vector<double>>& all_ms, const std::vector<int>& found) {
  std::printf("\n%-18s %-20s %8s %8s %8s %8s %8s   %s\n", what, "", "images", "found", "median",
              "p95", "max ms", "of ours, median (from .. to)");
  for (std::size_t k = 0; k < all.size(); ++k) {
    const std::vector<double>& ms = all_ms[k];
    const auto asked = std::count_if(ms.begin(), ms.end(), [](double m) { return !std::isnan(m); });
    const Spread ratio = spread_of(ratios(ms, all_ms[0]));
    std::printf("%-18s %-20s %8d %8d %8.2f %8.2f %8.2f   %.1f (%.1f .. %.1f)\n", "",
                all[k].name.c_str(), static_cast<int>(asked), found[k], quantile(ms, 0.5),
                quantile(ms, 0.95), quantile(ms, 1), ratio.median, ratio.least, ratio.most);
  }
}

// Pictures without a board, looked at by all for a checkerboard, or for what they look for.
void negatives_by(const char* title, const std::vector<Subject>& all, int images,
                  calvin::ImageSize size) {
  const auto board = calvin::parse_board("checkerboard:9x6:25mm").value();
  std::vector<std::vector<double>> ms(all.size());
  std::vector<int> found(all.size());
  for (int i = 0; i < images; ++i) {
    const cv::Mat image = make_negative(size, static_cast<std::uint64_t>(i));
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Found f = all[k].look(image, board);
      ms[k].push_back(f.ms);
      found[k] += f.observation.found();
    }
  }
  print_times(title, all, ms, found);
  std::fflush(stdout);
}

// mrgingham is not asked for a board of its own kind: it crashes in clutter.
void negatives(const std::vector<Subject>& all, int images, calvin::ImageSize size) {
  negatives_by("without the board", all, images, size);
}

// The same pictures, looked at by ours for boards of other kinds: each beside the checkerboard.
void negatives_of_kinds(int images, calvin::ImageSize size) {
  std::vector<Subject> all;
  for (const char* text : {"checkerboard:9x6:25mm", "puzzle:14x9:20mm", "aprilgrid:6x6:88mm:0.3",
                           "aruco:6x5:60mm:15mm:DICT_6X6_250", "circles:7x5:30mm"}) {
    const auto board = calvin::parse_board(text);
    if (!board) continue;  // a build without dictionaries
    all.emplace_back(std::string(text).substr(0, 20),
                     [own = *board](const cv::Mat& image, const calvin::Board&) {
                       return by_calvin(image, own);
                     });
  }
  negatives_by("without any board", all, images, size);
}

// A board that a hand moves, 1280x720: each frame followed from the one before, and searched.
void videos(int frames) {
  const auto board = calvin::parse_board("checkerboard:9x6:25mm").value();
  const calvin::Camera camera = calvin::default_camera({1280, 720});
  const calvin::BoardRenderer renderer(camera);
  const auto follower = std::move(*calvin::make_detector(board));
  const auto searcher = std::move(*calvin::make_detector(board));
  std::vector<double> followed;
  std::vector<double> searched;
  std::vector<double> shares;  // of each scene
  int found = 0;
  constexpr int kScene = 60;  // frames, 2 s
  for (int n = 0; n < frames; ++n) {
    const auto seed = static_cast<std::uint64_t>(n / kScene);
    const calvin::Motion motion(calvin::MotionKind::kHand, camera, board, seed);
    const calvin::GrayImage image =
        renderer.render(board, motion.camera_from_board(n % kScene / 30.0),
                        {.noise = 2, .blur = 0.8, .seed = static_cast<std::uint64_t>(n)});
    const double begin = thread_ms();
    const auto seen = follower->follow(image.view(), static_cast<std::uint64_t>(n) * 33'333'333);
    const double middle = thread_ms();
    (void)searcher->detect(image.view());
    followed.push_back(middle - begin);
    searched.push_back(thread_ms() - middle);
    found += seen.observation.found();
    if ((n + 1) % kScene == 0) {
      const auto middle_of = [n](const std::vector<double>& ms) {
        return quantile({ms.begin() + n + 1 - kScene, ms.begin() + n + 1}, 0.5);
      };
      shares.push_back(middle_of(followed) / middle_of(searched));
    }
  }
  std::printf("\n%-18s %8s %8s %8s %8s\n", "hand video, 720p", "frames", "found", "median", "p95");
  std::printf("%-18s %8d %8d %8.2f %8.2f\n", "followed", frames, found, quantile(followed, 0.5),
              quantile(followed, 0.95));
  std::printf("%-18s %8d %8s %8.2f %8.2f\n", "searched", frames, "", quantile(searched, 0.5),
              quantile(searched, 0.95));
  if (!shares.empty()) {
    const Spread share = spread_of(shares);
    std::printf("followed / searched, scenes of %d frames: %.2f (%.2f .. %.2f)\n", kScene,
                share.median, share.least, share.most);
  }
  std::fflush(stdout);
}

struct RealSet {
  const char* folder;
  const char* prefix;  // of the pictures' names
  const char* board;
};
constexpr RealSet kRealSets[] = {
    {"opencv-samples", "left", "checkerboard:9x6:25mm"},
    {"opencv-samples", "right", "checkerboard:9x6:25mm"},
    {"chess-carnd-lanes", "calibration", "checkerboard:9x6:25mm"},
    {"chess-caliscope", "cam_", "checkerboard:9x6:25mm"},
    {"fisheye-camodocal", "img", "checkerboard:9x6:80mm"},
    {"fisheye-urban1", "Fisheye1_", "checkerboard:8x6:32.5mm"},
    {"fisheye190-ocamcalib", "Fisheye190deg", "checkerboard:6x7:30mm"},
    {"kalibr-test-images", "testImageCheckerboard", "checkerboard:9x8:25mm"},
};

// Boards of which all corners were found, and of ours those of which a part was.
void real_sets(const std::vector<Subject>& all, const char* data) {
  std::printf("\n%-24s %6s", "real set", "images");
  for (const Subject& s : all) std::printf(" %18s", s.name.c_str());
  std::printf(" %8s\n", "in part");
  for (const RealSet& set : kRealSets) {
    const auto folder = std::filesystem::path(data) / set.folder;
    if (!std::filesystem::exists(folder)) continue;
    const auto board = calvin::parse_board(set.board).value();
    int images = 0;
    int parts = 0;
    std::vector<int> found(all.size());
    for (const auto& file : std::filesystem::directory_iterator(folder)) {
      if (file.path().filename().string().rfind(set.prefix, 0) != 0) continue;
      const cv::Mat image = cv::imread(file.path().string(), cv::IMREAD_GRAYSCALE);
      if (image.empty()) continue;
      ++images;
      for (std::size_t k = 0; k < all.size(); ++k) {
        const auto o = all[k].look(image, board).observation;
        const bool whole = static_cast<int>(o.ids.size()) == board.point_count();
        found[k] += whole;
        if (k == 0) parts += o.found() && !whole;
      }
    }
    std::printf("%-24s %6d", (std::string(set.folder) + "/" + set.prefix).substr(0, 24).c_str(),
                images);
    for (const int f : found) std::printf(" %18d", f);
    std::printf(" %8d\n", parts);
    std::fflush(stdout);
  }
}

int number(int argc, char** argv, int at, int otherwise) {
  return argc > at ? std::atoi(argv[at]) : otherwise;
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const int images = bench::number(argc, argv, 1, 200);
  const int negatives = bench::number(argc, argv, 2, 1000);
  const calvin::ImageSize size = {bench::number(argc, argv, 3, 1920),
                                  bench::number(argc, argv, 4, 1080)};
  auto all = bench::subjects();
  const char* peers = std::getenv("CALVIN_BENCH_PEERS");
  if (peers != nullptr && std::string_view(peers) == "0") all.resize(1, all.front());

  if (std::getenv("CALVIN_BENCH_CLASS") == nullptr) bench::videos(3 * images);
  std::vector<bench::Score> totals(all.size());
  bench::classes(all, images, size, totals);
  std::vector<std::vector<double>> ms;
  std::vector<int> found;
  for (const auto& t : totals) {
    ms.push_back(t.ms);
    found.push_back(t.found);
  }
  bench::print_times("with a board", all, ms, found);
  bench::negatives(all, negatives, size);
  bench::negatives_of_kinds(negatives, size);
  if (const char* data = std::getenv("CALVIN_DATA")) bench::real_sets(all, data);
  return 0;
}
