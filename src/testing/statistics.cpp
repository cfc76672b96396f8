#include "testing/statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "testing/quadrature.h"

namespace etendue {
namespace {

constexpr double kPrecision = 1e-15;
constexpr int kMaxTerms = 100000;

/// x^a e^(−x) / Γ(a)
double gamma_prefactor(double a, double x) {
  return std::exp(a * std::log(x) - x - std::lgamma(a));
}

/// P(a, x) by its power series (Abramowitz and Stegun 6.5.29); fast for x < a + 1.
double gamma_p_series(double a, double x) {
  double term = 1 / a, sum = term;
  for (int n = 1; n < kMaxTerms && term > kPrecision * sum; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return sum * gamma_prefactor(a, x);
}

/// Q(a, x) by its continued fraction (6.5.31), evaluated from the front by Lentz's method; fast for x > a + 1.
double gamma_q_fraction(double a, double x) {
  constexpr double kTiny = 1e-300;
  double b = x + 1 - a, c = 1 / kTiny, d = 1 / b, value = d;
  for (int n = 1; n < kMaxTerms; ++n) {
    const double numerator = -n * (n - a);
    b += 2;
    d = 1 / (numerator * d + b);
    c = b + numerator / c;
    const double factor = c * d;
    value *= factor;
    if (std::abs(factor - 1) < kPrecision) break;
  }
  return value * gamma_prefactor(a, x);
}

}  // namespace

double gamma_q(double a, double x) {
  if (x <= 0) return 1;
  return x < a + 1 ? 1 - gamma_p_series(a, x) : gamma_q_fraction(a, x);
}

double chi_square_p(double statistic, int degrees) {
  return degrees > 0 ? gamma_q(0.5 * degrees, 0.5 * statistic) : 1.0;
}

double normal_p(double z) {
  return std::erfc(std::abs(z) / std::sqrt(2.0));
}

double student_p(double t, double degrees) {
  // With t = √degrees · tan θ the density is proportional to cos^(degrees − 1) θ.
  const double norm = std::exp(std::lgamma(0.5 * (degrees + 1)) - std::lgamma(0.5 * degrees));
  return 2 * norm / std::sqrt(std::numbers::pi) *
         integrate([&](double theta) { return std::pow(std::cos(theta), degrees - 1); },
                   std::atan(std::abs(t) / std::sqrt(degrees)), std::numbers::pi / 2);
}

double sidak(double alpha, std::size_t tests) {
  return -std::expm1(std::log1p(-alpha) / static_cast<double>(std::max<std::size_t>(tests, 1)));
}

ChiSquareTest chi_square_test(std::span<const double> observed, std::span<const double> expected) {
  constexpr double kEnough = 5;
  std::vector<std::size_t> order(expected.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return expected[a] < expected[b]; });

  ChiSquareTest test;
  double pooled_observed = 0, pooled_expected = 0;
  for (const std::size_t i : order) {
    pooled_observed += observed[i];
    pooled_expected += expected[i];
    if (pooled_expected < kEnough) continue;
    const double difference = pooled_observed - pooled_expected;
    test.statistic += difference * difference / pooled_expected;
    ++test.degrees;
    pooled_observed = pooled_expected = 0;
  }
  --test.degrees;
  test.p = chi_square_p(test.statistic, test.degrees);
  return test;
}

ChiSquareTest uniform_test(std::span<const double> observed) {
  const double total = std::accumulate(observed.begin(), observed.end(), 0.0);
  const std::vector<double> expected(observed.size(), total / static_cast<double>(observed.size()));
  return chi_square_test(observed, expected);
}

void RunningMean::add(double value) {
  ++count_;
  const double before = value - mean_;
  mean_ += before / static_cast<double>(count_);
  squares_ += before * (value - mean_);
}

double RunningMean::standard_error() const {
  if (count_ < 2) return 0;
  const auto n = static_cast<double>(count_);
  return std::sqrt(squares_ / (n - 1) / n);
}

double RunningMean::p_value(double expected, double tolerance) const {
  const double excess = std::max(std::abs(mean_ - expected) - tolerance, 0.0);
  if (excess == 0) return 1;
  return normal_p(excess / standard_error());
}

double RunningMean::student_p_value(double expected, double tolerance) const {
  const double excess = std::max(std::abs(mean_ - expected) - tolerance, 0.0);
  if (excess == 0) return 1;
  return student_p(excess / standard_error(), static_cast<double>(count_ - 1));
}

double RunningMean::p_value(const RunningMean& other, double tolerance) const {
  const double excess = std::max(std::abs(mean_ - other.mean_) - tolerance, 0.0);
  if (excess == 0) return 1;
  const double a = std::pow(standard_error(), 2), b = std::pow(other.standard_error(), 2);
  if (a + b == 0) return 0;
  // Welch's and Satterthwaite's degrees of freedom.
  const auto n = static_cast<double>(count_), m = static_cast<double>(other.count_);
  return student_p(excess / std::sqrt(a + b), (a + b) * (a + b) / (a * a / (n - 1) + b * b / (m - 1)));
}

::testing::AssertionResult TestFamily::holds() const {
  if (tests_.empty()) return ::testing::AssertionFailure() << "nothing was tested";
  const double level = sidak(0.01, tests_.size());
  ::testing::AssertionResult result = ::testing::AssertionFailure();
  result << tests_.size() << " tests, refused where p < " << level << ":";
  bool all = true;
  for (const Test& test : tests_) {
    if (test.p >= level) continue;
    all = false;
    result << "\n  " << test.name << ": p = " << test.p;
  }
  return all ? ::testing::AssertionSuccess() : result;
}

}  // namespace etendue
