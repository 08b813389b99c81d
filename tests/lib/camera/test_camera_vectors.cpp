// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The lenses over vectors give what they give over doubles, with the instructions of every target
// that this machine has.
#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "camera/test_camera_vectors.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "calvin/camera/models.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::lens::HWY_NAMESPACE {

// points: `count` x, then y, then z; count is a multiple of 8, all aligned. out: whether it is
// valid, xy, jp and jd, each `count` numbers.
template <typename L>
void distort_with(const double* d, const double* points, std::size_t count, double* out) {
  for (std::size_t i = 0; i < count; i += DoubleVec::kSize) {
    const DoubleVec p[3] = {DoubleVec::load(points + i), DoubleVec::load(points + count + i),
                            DoubleVec::load(points + 2 * count + i)};
    DoubleVec rows[9 + 2 * L::kCount];
    const Mask valid = L::distort(d, p, rows + 1, rows + 3, rows + 9);
    rows[0] = select(valid, 1, 0);
    for (std::size_t row = 0; row < 9 + 2 * L::kCount; ++row) {
      rows[row].store(out + row * count + i);
    }
  }
}

// For the lens of that place in AllLenses.
void distort_lanes(std::size_t lens, const double* d, const double* points, std::size_t count,
                   double* out) {
  constexpr auto kAll = []<typename... L>(std::tuple<L...>*) {
    return std::array<decltype(&distort_with<Pinhole>), sizeof...(L)>{&distort_with<L>...};
  }(static_cast<AllLenses*>(nullptr));
  kAll[lens](d, points, count, out);
}

void angles(const double* y, const double* x, std::size_t count, double* out) {
  for (std::size_t i = 0; i < count; i += DoubleVec::kSize) {
    atan2(DoubleVec::load(y + i), DoubleVec::load(x + i)).store(out + i);
  }
}

}  // namespace calvin::lens::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <array>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <hwy/aligned_allocator.h>

#include "lens_samples.hpp"

namespace calvin::lens {
namespace {

HWY_EXPORT(distort_lanes);
HWY_EXPORT(angles);

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

using Numbers = hwy::AlignedFreeUniquePtr<double[]>;

Numbers numbers(std::size_t count) { return hwy::AllocateAligned<double>(count); }

// Every test runs once with each target of this machine.
class Vectors : public ::testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { use(GetParam()); }
  void TearDown() override { use(0); }

 private:
  static void use(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

INSTANTIATE_TEST_SUITE_P(EveryTarget, Vectors,
                         ::testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& test) { return std::string(hwy::TargetName(test.param)); });

constexpr std::size_t kPoints = 2048;

// Points on every side at distances from 1e-3 to 1e3, some close to the axis, on it and across it.
Numbers points() {
  Numbers p = numbers(3 * kPoints);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-3, 3);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double distance = std::pow(10, exponent(random));
    const std::size_t kind = i % 16;
    const double across = kind == 0 ? 0 : kind < 5 ? std::pow(10, 4 * exponent(random) - 12) : 1;
    p[i] = distance * across * normal(random);
    p[kPoints + i] = distance * across * normal(random);
    p[2 * kPoints + i] = kind == 5 ? 0 : distance * normal(random);
  }
  return p;
}

// The numbers that distort() gives for one point in one order: xy, jp, jd.
template <typename L>
struct Distorted {
  static constexpr std::size_t kRows = 8 + 2 * L::kCount;
  std::array<double, kRows> rows;
  bool valid;
};

template <typename L>
Distorted<L> distort_one(const std::vector<double>& d, const double* p) {
  Distorted<L> out;
  out.valid = L::template distort<double>(d.data(), p, out.rows.data(), out.rows.data() + 2,
                                          out.rows.data() + 8);
  return out;
}

std::size_t group_of(std::size_t row) { return row < 2 ? 0 : row < 8 ? 1 : 2; }

// What rounding may change xy, jp and jd by, over the rounding: the largest number of each, and how
// much it moves when the arguments do.
template <typename L>
std::array<double, 3> sensitivity(const std::vector<double>& d, const double* p) {
  constexpr double kStep = 1e-7;
  constexpr std::size_t kRows = Distorted<L>::kRows;
  const Distorted<L> here = distort_one<L>(d, p);
  std::array<double, kRows> sums;
  for (std::size_t row = 0; row < kRows; ++row) sums[row] = std::abs(here.rows[row]);
  for (std::size_t k = 0; k < 3 + d.size(); ++k) {
    std::array<double, 3> point = {p[0], p[1], p[2]};
    std::vector<double> coefficients = d;
    (k < 3 ? point[k] : coefficients[k - 3]) *= 1 + kStep;
    const Distorted<L> there = distort_one<L>(coefficients, point.data());
    for (std::size_t row = 0; row < kRows; ++row) {
      sums[row] += std::abs(there.rows[row] - here.rows[row]) / kStep;
    }
  }
  std::array<double, 3> largest{};
  for (std::size_t row = 0; row < kRows; ++row) {
    double& m = largest[group_of(row)];
    m = std::max(m, sums[row]);
  }
  return largest;
}

template <typename L>
void expect_same(std::size_t place, const std::vector<double>& d, const Numbers& p) {
  constexpr std::size_t kRows = Distorted<L>::kRows;
  Numbers out = numbers((kRows + 1) * kPoints);
  HWY_DYNAMIC_DISPATCH(distort_lanes)(place, d.data(), p.get(), kPoints, out.get());
  int valid = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double at[3] = {p[i], p[kPoints + i], p[2 * kPoints + i]};
    const Distorted<L> expected = distort_one<L>(d, at);
    ASSERT_EQ(out[i], expected.valid ? 1 : 0) << i;
    // Where rays graze the lens, differences of huge numbers are left: nobody asks for them.
    const double angle = std::atan2(std::hypot(at[0], at[1]), at[2]);
    if (!expected.valid || angle > samples::lens(L::kName).widest) continue;
    ++valid;
    const auto change = sensitivity<L>(d, at);
    for (std::size_t row = 0; row < kRows; ++row) {
      const double tolerance = 16 * kEpsilon * change[group_of(row)];
      ASSERT_NEAR(out[(row + 1) * kPoints + i], expected.rows[row], tolerance)
          << L::kName << " row " << row << " of (" << at[0] << ", " << at[1] << ", " << at[2]
          << ")";
    }
    if (at[0] == 0 && at[1] == 0) {
      EXPECT_EQ(out[kPoints + i], 0);
      EXPECT_EQ(out[2 * kPoints + i], 0);
    }
  }
  EXPECT_GT(valid, static_cast<int>(kPoints / 4));
}

TEST_P(Vectors, DistortAsDoublesDo) {
  const Numbers p = points();
  std::size_t place = 0;
  const auto check = [&]<typename L>() {
    for (const auto& d : samples::lens(L::kName).coefficients) expect_same<L>(place, d, p);
    ++place;
  };
  [&]<typename... L>(std::tuple<L...>*) {
    (check.template operator()<L>(), ...);
  }(static_cast<AllLenses*>(nullptr));
}

TEST_P(Vectors, KnowTheAngleOnEverySide) {
  constexpr std::size_t kCount = 1 << 14;
  Numbers y = numbers(kCount);
  Numbers x = numbers(kCount);
  Numbers found = numbers(kCount);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> exponent(-20, 20);
  for (std::size_t i = 0; i < kCount; ++i) {
    y[i] = std::pow(10, exponent(random));
    x[i] = (i % 2 == 0 ? 1 : -1) * y[i] * std::pow(10, exponent(random) * (i % 3 == 0 ? 1 : 0.05));
  }
  const double special[][2] = {{1, 0}, {1, -0.0},   {0, 1},     {0, -1},
                               {0, 0}, {1e-300, 1}, {1, 1e-300}};
  for (std::size_t i = 0; i < std::size(special); ++i) y[i] = special[i][0], x[i] = special[i][1];
  HWY_DYNAMIC_DISPATCH(angles)(y.get(), x.get(), kCount, found.get());
  for (std::size_t i = 0; i < kCount; ++i) {
    const double expected = std::atan2(y[i], x[i]);
    EXPECT_NEAR(found[i], expected, 4 * kEpsilon * expected) << y[i] << " / " << x[i];
  }
}

}  // namespace
}  // namespace calvin::lens

#endif  // HWY_ONCE
