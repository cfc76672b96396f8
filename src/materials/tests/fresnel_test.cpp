#include "materials/fresnel.h"

#include <gtest/gtest.h>

#include <complex>
#include <limits>

#include "math/vec.h"

namespace etendue {
namespace {

using Complex = std::complex<double>;

/// Amplitude reflection coefficients of Fresnel's equations at a boundary to the relative index `n`.
struct Amplitudes {
  Complex s, p;
};
Amplitudes amplitudes(double cos_i, Complex n) {
  const Complex cos_t = std::sqrt(1.0 - (1 - cos_i * cos_i) / (n * n));
  return {(cos_i - n * cos_t) / (cos_i + n * cos_t), (n * cos_i - cos_t) / (n * cos_i + cos_t)};
}

double unpolarised(double cos_i, Complex n) {
  const Amplitudes a = amplitudes(cos_i, n);
  return 0.5 * (std::norm(a.s) + std::norm(a.p));
}

constexpr float kIndices[] = {0.4f, 1 / 1.5f, 0.99f, 1.01f, 1.33f, 1.5f, 2.4f, 5};

float cosine(int i) {
  return static_cast<float>(i) / 200;
}

TEST(FresnelDielectric, AgreesWithFresnelsEquations) {
  for (const float eta : kIndices)
    for (int i = 1; i <= 200; ++i) {
      const float c = cosine(i);
      const bool total = (1 - static_cast<double>(c) * c) / (static_cast<double>(eta) * eta) >= 1;
      EXPECT_NEAR(fresnel_dielectric(c, eta), total ? 1.0 : unpolarised(c, eta), 2e-6) << eta << ' ' << c;
    }
}

TEST(FresnelDielectric, HasTheWellKnownValues) {
  EXPECT_NEAR(fresnel_dielectric(1, 1.5f), 0.04f, 1e-7);
  EXPECT_EQ(fresnel_dielectric(0, 1.5f), 1);
  EXPECT_EQ(fresnel_dielectric(0.5f, 1 / 1.5f), 1);    // totally reflected
  EXPECT_NEAR(fresnel_dielectric(0.3f, 1), 0, 1e-12);  // no boundary
}

TEST(FresnelDielectric, ReflectsNoneOfTheParallelLightAtBrewstersAngle) {
  for (const float eta : {1.33f, 1.5f, 2.4f}) {
    const double c = std::cos(std::atan(static_cast<double>(eta)));
    EXPECT_NEAR(std::norm(amplitudes(c, eta).p), 0, 1e-12);
    EXPECT_NEAR(fresnel_dielectric(static_cast<float>(c), eta), 0.5 * std::norm(amplitudes(c, eta).s), 1e-6);
  }
}

TEST(FresnelDielectric, IsTheSameFromBothSides) {
  for (const float eta : {1.33f, 1.5f, 2.4f})
    for (int i = 1; i <= 200; ++i) {
      const float c = cosine(i), beyond = std::sqrt(1 - (1 - c * c) / (eta * eta));
      EXPECT_NEAR(fresnel_dielectric(c, eta), fresnel_dielectric(beyond, 1 / eta), 2e-4);
    }
}

TEST(FresnelSchlick, IsTheFormulaAndTheSameFromBothSides) {
  for (const float eta : {1.33f, 1.5f, 2.4f}) {
    const double r0 = std::pow((eta - 1.0) / (eta + 1.0), 2);
    for (int i = 1; i <= 200; ++i) {
      const float c = cosine(i), beyond = std::sqrt(1 - (1 - c * c) / (eta * eta));
      EXPECT_NEAR(fresnel_schlick(c, eta), r0 + (1 - r0) * std::pow(1.0 - c, 5), 1e-6);
      EXPECT_NEAR(fresnel_schlick(beyond, 1 / eta), fresnel_schlick(c, eta), 1e-4);
    }
    EXPECT_EQ(fresnel_schlick(0, eta), 1);
    EXPECT_EQ(fresnel_schlick(0.2f, 1 / eta), 1);
    const float critical = std::sqrt(1 - 1 / (eta * eta));
    EXPECT_NEAR(fresnel_schlick(critical + 1e-6f, 1 / eta), 1, 0.02f);  // no jump where total reflection begins
  }
}

TEST(FresnelConductor, AgreesWithFresnelsEquations) {
  const Complex metals[] = {{0.2, 3.9}, {0.14, 2.4}, {1.5, 7.6}, {2.9, 3.1}, {0.05, 0.5}, {10, 0.1}, {1, 1e-3}};
  for (const Complex& n : metals)
    for (int i = 1; i <= 200; ++i) {
      const Spectrum f =
          fresnel_conductor(cosine(i), Spectrum(static_cast<float>(n.real())), Spectrum(static_cast<float>(n.imag())));
      EXPECT_NEAR(f.g, unpolarised(cosine(i), n), 1e-5) << n << ' ' << cosine(i);
    }
}

TEST(FresnelConductor, TreatsChannelsByThemselves) {
  const Spectrum f = fresnel_conductor(0.7f, {0.2f, 1.1f, 1.4f}, {3.9f, 2.6f, 1.9f});
  EXPECT_NEAR(f.r, unpolarised(0.7, {0.2, 3.9}), 1e-5);
  EXPECT_NEAR(f.g, unpolarised(0.7, {1.1, 2.6}), 1e-5);
  EXPECT_NEAR(f.b, unpolarised(0.7, {1.4, 1.9}), 1e-5);
}

TEST(FresnelConductor, WithoutAbsorptionIsTheDielectric) {
  for (const float eta : kIndices)
    for (int i = 1; i <= 200; ++i) {
      // Near the angle of total reflection the reflectance has an infinite slope: rounding shows.
      const float critical = eta < 1 ? std::sqrt(1 - eta * eta) : -1.0f;
      if (std::abs(cosine(i) - critical) < 0.01f) continue;
      EXPECT_NEAR(fresnel_conductor(cosine(i), Spectrum(eta), Spectrum(0)).r, fresnel_dielectric(cosine(i), eta), 2e-5)
          << eta << ' ' << cosine(i);
    }
}

TEST(Fresnel, ConductorLikeTheOutsideNeverReflectsLessThanNothing) {
  for (int i = 0; i <= 10000; ++i)
    for (const float eta : {1.0f, 1.00001f})
      EXPECT_GE(fresnel_conductor(static_cast<float>(i) / 10000, Spectrum(eta), Spectrum(0)).r, 0);
}

TEST(Fresnel, StaysWithinZeroAndOne) {
  const auto expect_share = [](float f) {
    EXPECT_GE(f, 0);
    EXPECT_LE(f, 1 + 1e-6f);
  };
  for (const float c : {0.0f, 1e-30f, 1e-6f, 0.5f, kOneMinusEpsilon, 1.0f}) {
    for (const float eta : {1e-3f, 0.5f, 1.0f, 1.5f, 1e3f}) {
      expect_share(fresnel_dielectric(c, eta));
      expect_share(fresnel_schlick(c, eta));
    }
    for (const float eta : {0.0f, 1e-4f, 1.0f, 100.0f})
      for (const float k : {0.0f, 1e-4f, 1.0f, 100.0f})
        expect_share(fresnel_conductor(c, Spectrum(eta), Spectrum(k)).r);
  }
}

}  // namespace
}  // namespace etendue
