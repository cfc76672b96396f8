#include "testing/statistics.h"

#include <cmath>

#include "testing/quadrature.h"
#include "testing/random.h"
#include "testing/sphere_grid.h"

namespace etendue {
namespace {

TEST(GammaQ, AgreesWithClosedForms) {
  for (const double x : {0.01, 0.5, 1.0, 3.0, 10.0, 40.0}) {
    EXPECT_NEAR(gamma_q(1, x), std::exp(-x), 1e-13);
    EXPECT_NEAR(gamma_q(0.5, x), std::erfc(std::sqrt(x)), 1e-13);
    EXPECT_NEAR(gamma_q(3, x), std::exp(-x) * (1 + x + x * x / 2), 1e-13);
  }
}

TEST(ChiSquare, AgreesWithTables) {  // upper 5 % and 1 % points
  EXPECT_NEAR(chi_square_p(3.841459, 1), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_p(18.30704, 10), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_p(135.8067, 100), 0.01, 1e-6);
}

TEST(ChiSquare, PValuesOfATrueHypothesisAreUniform) {
  Random random(1);
  std::vector<double> histogram(10);
  for (int repetition = 0; repetition < 500; ++repetition) {
    std::vector<double> counts(20);
    for (int i = 0; i < 2000; ++i) ++counts[static_cast<std::size_t>(random.value() * 20)];
    ++histogram[static_cast<std::size_t>(std::min(uniform_test(counts).p * 10, 9.0))];
  }
  EXPECT_GT(uniform_test(histogram).p, 0.01);
}

TEST(ChiSquare, RefusesAWrongDensity) {
  Random random(2);
  // Uniform directions, claimed to be brighter by a tenth on one side.
  const auto wrong = direction_test(
      SphereGrid(), 100000, [&] { return std::optional(random.direction()); },
      [](const Vec3& w) { return (1 + 0.1 * w.x) / (4 * std::numbers::pi); });
  EXPECT_LT(wrong.p, 1e-6);
  const auto right = direction_test(
      SphereGrid(), 100000, [&] { return std::optional(random.direction()); },
      [](const Vec3&) { return 1 / (4 * std::numbers::pi); });
  EXPECT_GT(right.p, 0.01);
}

TEST(ChiSquare, CountsWhatGivesNoDirection) {
  Random random(3);
  const auto sample = [&](float kept) {
    return [&random, kept] { return random.value() < kept ? std::optional(random.direction()) : std::nullopt; };
  };
  const auto density = [](const Vec3&) { return 0.5 / (4 * std::numbers::pi); };
  EXPECT_GT(direction_test(SphereGrid(), 100000, sample(0.5f), density).p, 0.01);
  EXPECT_LT(direction_test(SphereGrid(), 100000, sample(0.54f), density).p, 1e-6);
}

TEST(Student, AgreesWithTables) {  // two-sided 5 %, 1 % and 0.1 % points
  EXPECT_NEAR(student_p(12.70620, 1), 0.05, 1e-6);
  EXPECT_NEAR(student_p(-3.169273, 10), 0.01, 1e-7);
  EXPECT_NEAR(student_p(3.645959, 30), 0.001, 1e-8);
  EXPECT_NEAR(student_p(1.962339, 1000), 0.05, 1e-6);
}

TEST(Sidak, LeavesAlphaForAllTogether) {
  EXPECT_DOUBLE_EQ(sidak(0.01, 1), 0.01);
  EXPECT_NEAR(1 - std::pow(1 - sidak(0.01, 1000), 1000), 0.01, 1e-12);
}

TEST(TestFamily, FailsForOneOutlierOnly) {
  TestFamily family;
  EXPECT_FALSE(family.holds());
  for (int i = 0; i < 100; ++i) family.add("usual", 0.005);
  EXPECT_TRUE(family.holds());
  family.add("outlier", 1e-5);
  EXPECT_FALSE(family.holds());
}

TEST(RunningMean, KnowsItsError) {
  Random random(4);
  RunningMean mean;
  for (int i = 0; i < 100000; ++i) mean.add(random.value());
  EXPECT_NEAR(mean.standard_error(), std::sqrt(1.0 / 12 / 100000), 1e-5);
  EXPECT_GT(mean.p_value(0.5), 0.01);
  EXPECT_LT(mean.p_value(0.51), 1e-6);
  EXPECT_GT(mean.p_value(0.51, 0.01), 0.01);
}

TEST(RunningMean, WelchsTestIsExactForFewValues) {
  Random random(5);
  std::vector<double> histogram(10);
  for (int repetition = 0; repetition < 2000; ++repetition) {
    RunningMean a, b;
    const auto normal = [&] {
      return std::sqrt(-2 * std::log(1 - random.value())) * std::cos(2 * kPi * random.value());
    };
    for (int i = 0; i < 6; ++i) a.add(3 + normal());
    for (int i = 0; i < 8; ++i) b.add(3 + 2 * normal());
    ++histogram[static_cast<std::size_t>(std::min(a.p_value(b) * 10, 9.0))];
  }
  EXPECT_GT(uniform_test(histogram).p, 0.01);
}

TEST(RunningMean, WelchsTestRefusesOtherExpectations) {
  RunningMean a, b;
  for (int i = 0; i < 8; ++i) {
    a.add(1 + 0.001 * (i % 3));
    b.add(1.01 + 0.002 * (i % 2));
  }
  EXPECT_LT(a.p_value(b), 1e-4);
  EXPECT_GT(a.p_value(b, 0.01), 0.01);
}

TEST(Quadrature, IntegratesPeaksAndJumps) {
  EXPECT_NEAR(integrate([](double x) { return std::exp(-1e4 * x * x); }, -1, 1), std::sqrt(std::numbers::pi) / 100,
              1e-9);
  EXPECT_NEAR(integrate([](double x, double y) { return std::exp(x + 2 * y); }, Box2{0, 1, 0, 1}, 1e-9),
              (std::exp(1) - 1) * (std::exp(2) - 1) / 2, 1e-8);
  EXPECT_NEAR(integrate([](double x, double y) { return x * x + y * y < 1 ? 1.0 : 0.0; }, Box2{0, 1, 0, 1}, 1e-9),
              std::numbers::pi / 4, 1e-3);
}

TEST(SphereGrid, ResolvesAnyWidth) {
  const Vec3 axis = normalize(Vec3(0.3f, -0.8f, 0.2f));
  const double whole = 4 * std::numbers::pi;
  EXPECT_NEAR(integrate_sphere(SphereGrid(axis), [=](const Vec3&) { return 1 / whole; }), 1, 1e-5);
  for (const double focus : {1e-4, 1e-2, 1.0}) {
    const SphereGrid grid(axis, focus);
    const Frame frame = Frame::from_normal(axis);
    const auto cone = [&](const Vec3& w) {  // constant within the angle `focus`
      return std::hypot(dot(w, frame.s), dot(w, frame.t)) < std::sin(focus) && dot(w, frame.n) > 0
                 ? 1 / (2 * std::numbers::pi * 2 * std::pow(std::sin(focus / 2), 2))
                 : 0.0;
    };
    EXPECT_NEAR(integrate_sphere(grid, cone), 1, 5e-3);
  }
}

}  // namespace
}  // namespace etendue
