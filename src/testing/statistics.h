#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace etendue {

/// Regularized upper incomplete gamma function Q(a, x) = Γ(a, x) / Γ(a), a > 0, x ≥ 0 (Abramowitz and Stegun
/// 1964, 6.5).
double gamma_q(double a, double x);

/// Probability that a χ² variable with `degrees` degrees of freedom is at least `statistic`; 1 without any freedom.
double chi_square_p(double statistic, int degrees);

/// Probability that a standard normal variable is at least |z| away from 0.
double normal_p(double z);

/// Probability that a variable of Student's t distribution with at most some thousand degrees of freedom is at least
/// |t| away from 0.
double student_p(double t, double degrees);

/// Level for each of `tests` independent tests so that all pass with probability 1 − alpha (Šidák 1967).
double sidak(double alpha, std::size_t tests);

/// Pearson's test that counts follow expectations of the same sum. Cells that expect fewer than 5 are pooled.
struct ChiSquareTest {
  double statistic = 0;
  int degrees = 0;
  double p = 1;
};
ChiSquareTest chi_square_test(std::span<const double> observed, std::span<const double> expected);

/// The same with equal expectations.
ChiSquareTest uniform_test(std::span<const double> observed);

/// Mean and its standard error, one value after the other (Welford 1962).
class RunningMean {
 public:
  void add(double value);
  double mean() const { return mean_; }
  double standard_error() const;
  /// That the values' expectation is `expected`, for many values: by the normal distribution. `tolerance` is what
  /// rounding may do.
  double p_value(double expected, double tolerance = 0) const;
  /// The same for few values that are normally distributed: Student's t-test.
  double student_p_value(double expected, double tolerance = 0) const;
  /// That both have one expectation, for few of independent values that are normally distributed: Welch's t-test
  /// (1947). `tolerance`: by how much expectations may differ.
  double p_value(const RunningMean& other, double tolerance = 0) const;

 private:
  double mean_ = 0, squares_ = 0;
  std::size_t count_ = 0;
};

/// The tests of one hypothesis under many circumstances, judged together at α = 0.01.
class TestFamily {
 public:
  void add(std::string name, double p) { tests_.push_back({std::move(name), p}); }
  /// Success if no p-value is below the Šidák level; else the message names those that are.
  ::testing::AssertionResult holds() const;

 private:
  struct Test {
    std::string name;
    double p;
  };
  std::vector<Test> tests_;
};

}  // namespace etendue
