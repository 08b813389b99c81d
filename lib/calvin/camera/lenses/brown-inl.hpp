// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Brown's radial and tangential distortion and what OpenCV built upon it, in its direction (ideal
// -> distorted), with x = X/Z, y = Y/Z, r^2 = x^2 + y^2:
//   g = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
//   x_d = x g + 2 p1 x y + p2 (r^2 + 2 x^2) + s1 r^2 + s2 r^4
//   y_d = y g + p1 (r^2 + 2 y^2) + 2 p2 x y + s3 r^2 + s4 r^4
// and a tilt of the sensor (tilt-inl.hpp) last.
// D. C. Brown, Close-Range Camera Calibration, Photogrammetric Engineering 37(8), 1971 (k1 k2 k3 p1
// p2); D. Claus, A. Fitzgibbon, A Rational Function Lens Distortion Model, CVPR 2005 (k4 k5 k6
// after it); J. Weng, P. Cohen, M. Herniou, Camera Calibration with Distortion Models and Accuracy
// Evaluation, PAMI 14(10), 1992 (s1 to s4); T. Louhichi et al., Self-calibration of Scheimpflug
// cameras, Measurement Science and Technology 18(8), 2007 (taux tauy).
#if defined(CALVIN_CAMERA_LENSES_BROWN_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_CAMERA_LENSES_BROWN_INL_HPP
#undef CALVIN_CAMERA_LENSES_BROWN_INL_HPP
#else
#define CALVIN_CAMERA_LENSES_BROWN_INL_HPP
#endif

#include <utility>

#include "calvin/camera/distortion.hpp"
#include "calvin/camera/double_vec-inl.hpp"
#include "calvin/camera/lenses/tilt-inl.hpp"
#include "calvin/geometry/polynomial.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::lens::HWY_NAMESPACE {

// kCoefficients of these, in OpenCV's order; the others are zero.
inline constexpr std::array<std::string_view, 14> kBrownNames = {
    "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "taux", "tauy"};
inline constexpr std::array<int, 14> kBrownOrders = {2, 4, 1, 1, 6, 2, 4, 6, 1, 3, 1, 3, 0, 0};
inline constexpr std::array<CoefficientRange, 14> kBrownTypical = {{{-0.3, 0.1},
                                                                    {-0.05, 0.12},
                                                                    {-1e-3, 1e-3},
                                                                    {-1e-3, 1e-3},
                                                                    {-0.03, 0.03},
                                                                    {-0.1, 0.1},
                                                                    {-0.02, 0.02},
                                                                    {-0.01, 0.01},
                                                                    {-1e-3, 1e-3},
                                                                    {-1e-3, 1e-3},
                                                                    {-1e-3, 1e-3},
                                                                    {-1e-3, 1e-3},
                                                                    {-0.03, 0.03},
                                                                    {-0.03, 0.03}}};

// The models that derive from it add no function. Their files go without Highway's pragmas: clang
// 19 warns of those where there is none.
template <int kCoefficients>
struct Brown {
  static_assert(kCoefficients == 4 || kCoefficients == 5 || kCoefficients == 8 ||
                kCoefficients == 12 || kCoefficients == 14);
  static constexpr int kCount = kCoefficients;
  static constexpr bool kPerspective = true;
  static constexpr std::array<std::array<double, kCount>, 1> kStarts = {};
  static constexpr OpenCvForm kOpenCv = OpenCvForm::kBrown;
  static constexpr std::array<std::string_view, kCount> kNames = [] {
    std::array<std::string_view, kCount> names;
    std::copy(kBrownNames.begin(), kBrownNames.begin() + kCount, names.begin());
    return names;
  }();
  static constexpr std::array<int, kCount> kOrders = [] {
    std::array<int, kCount> orders{};
    std::copy(kBrownOrders.begin(), kBrownOrders.begin() + kCount, orders.begin());
    return orders;
  }();
  static constexpr std::array<CoefficientRange, kCount> kTypical = [] {
    std::array<CoefficientRange, kCount> ranges{};
    std::copy(kBrownTypical.begin(), kBrownTypical.begin() + kCount, ranges.begin());
    return ranges;
  }();

  template <typename T>
  static HWY_INLINE MaskOf<T> distort(const double* d, const T* p, T* xy, T* jp, T* jd) {
    const T iz = 1 / p[2];
    const T x = p[0] * iz;
    const T y = p[1] * iz;
    T j[4];
    MaskOf<T> valid = p[2] > 1e-9 * (abs(p[0]) + abs(p[1]));
    valid = valid & flat(d, x, y, xy, j, jd);
    if constexpr (kTilted) valid = valid & tilt(d, xy, j, jd);
    if (jp != nullptr) {
      jp[0] = j[0] * iz;
      jp[1] = j[1] * iz;
      jp[2] = -(j[0] * x + j[1] * y) * iz;
      jp[3] = j[2] * iz;
      jp[4] = j[3] * iz;
      jp[5] = -(j[2] * x + j[3] * y) * iz;
    }
    return valid;
  }

  // The radial part alone decides: up to where it folds back or has a pole. The other terms are
  // checked where a point is projected: a tilt changes no fold, but ends at its horizon.
  static double limit(const double* d) {
    if constexpr (kTilted) {
      if (!Tilt(d[12], d[13]).possible()) return 0;
    }
    const Polynomial n = numerator(d);
    const Polynomial m = denominator(d);
    std::array<double, 7> slope{};  // of r n / m, times m^2, in r^2
    for (std::size_t i = 0; i < n.size(); ++i) {
      for (std::size_t k = 0; k < m.size(); ++k) {
        slope[i + k] += (1 + 2 * (static_cast<double>(i) - static_cast<double>(k))) * n[i] * m[k];
      }
    }
    return std::sqrt(std::min(smallest_positive_root(slope), smallest_positive_root(m)));
  }

  static double radius(const Eigen::Vector3d& p) { return std::hypot(p[0], p[1]) / p[2]; }

  // (p2, p1), (s1, s3) and (s2, s4) turn as (x, y) does, (tauy, -taux) too; but two tilts do not
  // commute, and a quarter turn would exchange them.
  static bool turn(double* d, Orientation o) {
    if constexpr (kTilted) {
      if (o.transpose && d[12] != 0 && d[13] != 0) return false;
      if (o.transpose) d[12] = -std::exchange(d[13], -d[12]);
      if (o.flip_x) d[13] = -d[13];
      if (o.flip_y) d[12] = -d[12];
    }
    if (o.transpose) std::swap(d[2], d[3]);
    if (o.flip_x) d[3] = -d[3];
    if (o.flip_y) d[2] = -d[2];
    if constexpr (kPrism) {
      for (int i = 8; i < 10; ++i) {
        if (o.transpose) std::swap(d[i], d[i + 2]);
        if (o.flip_x) d[i] = -d[i];
        if (o.flip_y) d[i + 2] = -d[i + 2];
      }
    }
    return true;
  }

  static std::optional<Eigen::Vector3d> undistort(const double* d, double limit, const double* xy) {
    double goal[2] = {xy[0], xy[1]};
    if constexpr (kTilted) {
      if (!Tilt(d[12], d[13]).undo(goal)) return std::nullopt;
    }
    const double target = std::hypot(goal[0], goal[1]);
    // Near enough for Newton. The other terms move the rim a little: start from the limit and let
    // it decide.
    constexpr double kNear = 1e-4;
    const auto image = [d](double s) { return radial(d, s); };
    const double r = invert_growing(image, target, limit, kNear).value_or(limit);
    if (!std::isfinite(r)) return std::nullopt;
    const double scale = target > 0 ? r / target : 1;
    double x = goal[0] * scale;
    double y = goal[1] * scale;
    double at[2];
    double j[4];
    bool arrived = false;
    for (int i = 0; i < 50 && !arrived; ++i) {
      if (!flat<double>(d, x, y, at, j, nullptr)) return std::nullopt;
      const double ex = at[0] - goal[0];
      const double ey = at[1] - goal[1];
      const double determinant = j[0] * j[3] - j[1] * j[2];
      if (!(determinant > 0)) return std::nullopt;
      const double dx = (j[3] * ex - j[1] * ey) / determinant;
      const double dy = (j[0] * ey - j[2] * ex) / determinant;
      x -= dx;
      y -= dy;
      // The error that is left goes with the square of the step, and grows towards a fold. Beside
      // a pole steps are short far from the answer.
      arrived = (dx * dx + dy * dy <= 1e-17 * std::min(determinant, 1.0) &&
                 std::abs(ex) + std::abs(ey) <= 1e-4 * (1 + target)) ||
                std::abs(ex) + std::abs(ey) <= 1e-15 * (1 + target);
    }
    if (!arrived) {  // rounding may move the last digits for ever
      if (!flat<double>(d, x, y, at, j, nullptr)) return std::nullopt;
      arrived = std::hypot(at[0] - goal[0], at[1] - goal[1]) <= 1e-11 * (1 + target);
    }
    if (!arrived || !(x * x + y * y <= limit * limit)) return std::nullopt;
    return Eigen::Vector3d(x, y, 1).normalized();
  }

  static std::string glsl() {
    std::string text = R"(  float a = d.x / d.z;
  float b = d.y / d.z;
  float r2 = a * a + b * b;
)";
    const std::string last = kCount == 4 ? "k2" : "(k2 + r2 * k3)";
    text += "  float radial = 1.0 + r2 * (k1 + r2 * " + last + ");\n";
    if (kRational) text += "  radial = radial / (1.0 + r2 * (k4 + r2 * (k5 + r2 * k6)));\n";
    text += R"(  float x = a * radial + 2.0 * p1 * a * b + p2 * (r2 + 2.0 * a * a);
  float y = b * radial + p1 * (r2 + 2.0 * b * b) + 2.0 * p2 * a * b;
)";
    if (kPrism) {
      text += R"(  x = x + r2 * (s1 + r2 * s2);
  y = y + r2 * (s3 + r2 * s4);
)";
    }
    if (kTilted) {
      text += R"(  float w = sin(tauy) * x - cos(tauy) * sin(taux) * y + cos(tauy) * cos(taux);
  y = (cos(tauy) * y - sin(taux) * sin(tauy) * x) / w;
  x = cos(taux) * x / w;
)";
    }
    return text;
  }

 private:
  static constexpr bool kRational = kCount >= 8;
  static constexpr bool kPrism = kCount >= 12;
  static constexpr bool kTilted = kCount >= 14;

  using Polynomial = std::array<double, 4>;  // in r^2, from the constant up
  static HWY_INLINE Polynomial numerator(const double* d) {
    if constexpr (kCount == 4) return {1, d[0], d[1], 0};
    return {1, d[0], d[1], d[4]};
  }
  static HWY_INLINE Polynomial denominator(const double* d) {
    if constexpr (kRational) return {1, d[5], d[6], d[7]};
    return {1, 0, 0, 0};
  }
  template <typename T>
  static HWY_INLINE T value(const Polynomial& c, T s) {
    return c[0] + s * (c[1] + s * (c[2] + s * c[3]));
  }
  template <typename T>
  static HWY_INLINE T slope(const Polynomial& c, T s) {
    return c[1] + s * (2 * c[2] + s * (3 * c[3]));
  }

  // {r g, its slope by r}; infinite past the pole.
  static std::pair<double, double> radial(const double* d, double r) {
    const double s = r * r;
    const Polynomial n = numerator(d);
    const Polynomial m = denominator(d);
    const double below = value(m, s);
    if (!(below > 0)) return {std::numeric_limits<double>::infinity(), 1};
    const double g = value(n, s) / below;
    return {r * g, g + 2 * s * (slope(n, s) - g * slope(m, s)) / below};
  }

  // The distortion without the tilt. j: 2x2 derivatives by (x, y), jd as in distort(). False past
  // the pole.
  template <typename T>
  static HWY_INLINE MaskOf<T> flat(const double* d, T x, T y, T* xy, T* j, T* jd) {
    const T r2 = x * x + y * y;
    const T below = value(denominator(d), r2);
    T im = 1;
    if constexpr (kRational) im = 1 / below;
    const T g = value(numerator(d), r2) * im;
    T dg = 2 * slope(numerator(d), r2);  // dg/dx = x dg
    if constexpr (kRational) dg = (dg - 2 * g * slope(denominator(d), r2)) * im;
    const double p1 = d[2];
    const double p2 = d[3];
    xy[0] = x * g + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
    xy[1] = y * g + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
    j[0] = g + x * x * dg + 2 * p1 * y + 6 * p2 * x;
    j[1] = x * y * dg + 2 * p1 * x + 2 * p2 * y;
    j[2] = j[1];
    j[3] = g + y * y * dg + 6 * p1 * y + 2 * p2 * x;
    if constexpr (kPrism) add_prism(d + 8, x, y, r2, xy, j);
    if (jd != nullptr) {
      radial_columns(x, r2, g, im, jd);
      radial_columns(y, r2, g, im, jd + kCount);
      jd[2] = jd[kCount + 3] = 2 * x * y;
      jd[3] = r2 + 2 * x * x;
      jd[kCount + 2] = r2 + 2 * y * y;
      if constexpr (kPrism) {
        jd[8] = jd[kCount + 10] = r2;
        jd[9] = jd[kCount + 11] = r2 * r2;
        jd[10] = jd[11] = jd[kCount + 8] = jd[kCount + 9] = T(0);
      }
    }
    return below > 0;
  }

  template <typename T>
  static HWY_INLINE void radial_columns(T x, T r2, T g, T im, T* row) {
    T power = x * r2 * im;
    for (const int k : {0, 1, 4}) {
      if (k < kCount) row[k] = power;
      if constexpr (kRational) row[k == 4 ? 7 : 5 + k] = -g * power;
      power = power * r2;
    }
  }

  template <typename T>
  static HWY_INLINE void add_prism(const double* s, T x, T y, T r2, T* xy, T* j) {
    xy[0] = xy[0] + r2 * (s[0] + s[1] * r2);
    xy[1] = xy[1] + r2 * (s[2] + s[3] * r2);
    const T along_x = 2 * (s[0] + 2 * s[1] * r2);
    const T along_y = 2 * (s[2] + 2 * s[3] * r2);
    j[0] = j[0] + x * along_x;
    j[1] = j[1] + y * along_x;
    j[2] = j[2] + x * along_y;
    j[3] = j[3] + y * along_y;
  }

  template <typename T>
  static HWY_INLINE void turn_column(const T* j, T& above, T& below) {
    const T x = above;
    above = j[0] * x + j[1] * below;
    below = j[2] * x + j[3] * below;
  }

  template <typename T>
  static HWY_INLINE MaskOf<T> tilt(const double* d, T* xy, T* j, T* jd) {
    T jx[4];
    T jt[4];
    const MaskOf<T> valid = Tilt(d[12], d[13]).apply(xy, jx, jt);
    turn_column(jx, j[0], j[2]);
    turn_column(jx, j[1], j[3]);
    if (jd != nullptr) {
      for (int i = 0; i < 12; ++i) turn_column(jx, jd[i], jd[kCount + i]);
      jd[12] = jt[0], jd[13] = jt[1];
      jd[kCount + 12] = jt[2], jd[kCount + 13] = jt[3];
    }
    return valid;
  }
};

}  // namespace calvin::lens::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CALVIN_CAMERA_LENSES_BROWN_INL_HPP
