#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "materials/bsdf.h"
#include "materials/fresnel.h"
#include "materials/tests/bsdf_kit.h"
#include "testing/quadrature.h"
#include "testing/sphere_grid.h"
#include "testing/statistics.h"

/// Each surface against the theory that it alone obeys.
namespace etendue {
namespace {

TEST(Diffuse, ScattersItsReflectanceOnTheSideOfTheLight) {
  const DiffuseBsdf diffuse{{0.2f, 0.5f, 0.8f}};
  for (const Vec3& wo : kDirections) {
    expect_near(furnace(diffuse, wo, TransportMode::radiance), diffuse.reflectance, 1e-5f, "diffuse");
    const Vec3 wi(0.6f, 0, wo.z > 0 ? 0.8f : -0.8f);
    expect_near(eval_bsdf(diffuse, wo, wi).f_cos, diffuse.reflectance * (0.8f * kInvPi), 1e-6f, "diffuse");
    EXPECT_TRUE(eval_bsdf(diffuse, wo, -wi).f_cos.is_black());
  }
}

TEST(Mirror, ReflectsItsReflectance) {
  const MirrorBsdf mirror{{0.9f, 0.5f, 0.1f}};
  for (const Vec3& wo : kDirections) {
    const auto s = sample_bsdf(mirror, wo, {0.1f, 0.9f}, 0.5f);
    ASSERT_TRUE(s);
    EXPECT_EQ(s->wi, Vec3(-wo.x, -wo.y, wo.z));
    EXPECT_EQ(s->lobe, Lobe::delta_reflection);
    EXPECT_EQ(s->weight, mirror.reflectance);
  }
}

/// Both lobes of a dielectric: the samples that the ends of `choice` give, and how probable reflection is.
struct Lobes {
  std::optional<BsdfSample> reflected, transmitted;
  float reflection_probability = 0;
};
Lobes lobes(const Bsdf& bsdf, const Vec3& wo, TransportMode mode) {
  constexpr int kCount = 1 << 14;
  Lobes out;
  for (int i = 0; i < kCount; ++i) {
    const auto s = sample_bsdf(bsdf, wo, {0.5f, 0.5f}, (static_cast<float>(i) + 0.5f) / kCount, mode);
    if (!s) continue;
    if (s->lobe == Lobe::delta_reflection) {
      out.reflected = s;
      out.reflection_probability += 1.0f / kCount;
    } else {
      EXPECT_TRUE(s->lobe == Lobe::delta_transmission || s->lobe == Lobe::straight);
      out.transmitted = s;
    }
  }
  return out;
}

TEST(Glass, LosesNothing) {
  for (const Boundary boundary : {Boundary::fresnel, Boundary::schlick, Boundary::thin})
    for (const float ior : {0.75f, 1.33f, 1.5f, 2.4f})
      for (const Vec3& wo : kDirections) {
        const DielectricBsdf glass{Spectrum(1), Spectrum(1), ior, boundary};
        expect_near(furnace(glass, wo, TransportMode::importance), Spectrum(1), 1e-5f,
                    "glass of index " + std::to_string(ior));
      }
}

TEST(Glass, DividesLightByFresnel) {
  const Spectrum reflectance(0.9f, 0.5f, 0.2f), transmittance(0.1f, 0.7f, 0.6f);
  for (const Boundary boundary : {Boundary::fresnel, Boundary::schlick})
    for (const float ior : {0.75f, 1.5f, 2.4f})
      for (const Vec3& wo : kDirections) {
        const DielectricBsdf glass{reflectance, transmittance, ior, boundary};
        const float eta = wo.z > 0 ? ior : 1 / ior, c = std::abs(wo.z);
        const float fresnel = boundary == Boundary::schlick ? fresnel_schlick(c, eta) : fresnel_dielectric(c, eta);
        const Lobes found = lobes(glass, wo, TransportMode::importance);
        const std::string what = "index " + std::to_string(eta) + ", cosine " + std::to_string(c);
        ASSERT_TRUE(found.reflected) << what;
        const float p = found.reflection_probability;
        expect_near(found.reflected->weight * p, reflectance * fresnel, 2e-3f, what);
        ASSERT_EQ(found.transmitted.has_value(), fresnel < 1) << what;
        if (found.transmitted) {
          expect_near(found.transmitted->weight * (1 - p), transmittance * (1 - fresnel), 2e-3f, what);
        }
      }
}

TEST(Glass, RefractsBySnellsLaw) {
  for (const Boundary boundary : {Boundary::fresnel, Boundary::transmit_only})
    for (const Vec3& wo : kDirections) {
      const float eta = wo.z > 0 ? 1.5f : 1 / 1.5f;
      const Lobes found = lobes(DielectricBsdf{Spectrum(1), Spectrum(1), 1.5f, boundary}, wo, TransportMode::radiance);
      const bool total = std::hypot(wo.x, wo.y) >= eta;
      ASSERT_EQ(found.transmitted.has_value(), !total);
      if (total) continue;
      const Vec3& wi = found.transmitted->wi;
      EXPECT_NEAR(wi.x * eta, -wo.x, 1e-6f);
      EXPECT_NEAR(wi.y * eta, -wo.y, 1e-6f);
      EXPECT_LT(wi.z * wo.z, 0);
      EXPECT_FLOAT_EQ(found.transmitted->eta, eta);
    }
}

TEST(Glass, ReflectsTotallyBeyondTheCriticalAngle) {
  const Vec3 wo = at_angle(180 - 45, 30);  // 41.8 degrees is critical
  for (const Boundary boundary : {Boundary::fresnel, Boundary::schlick}) {
    const Lobes found = lobes(DielectricBsdf{Spectrum(1), Spectrum(1), 1.5f, boundary}, wo, TransportMode::radiance);
    EXPECT_FALSE(found.transmitted);
    ASSERT_TRUE(found.reflected);
    EXPECT_EQ(found.reflected->weight, Spectrum(1));
    EXPECT_EQ(found.reflected->wi, Vec3(-wo.x, -wo.y, wo.z));
    EXPECT_EQ(found.reflected->eta, 1);
  }
  EXPECT_FALSE(
      sample_bsdf(DielectricBsdf{Spectrum(1), Spectrum(1), 1.5f, Boundary::transmit_only}, wo, {0.5f, 0.5f}, 0.5f));
}

TEST(Glass, WayInAndOutRestoresRadianceAndDirection) {
  for (const Boundary boundary : {Boundary::fresnel, Boundary::transmit_only})
    for (const Vec3& wo : {at_angle(0, 0), at_angle(30, 40), at_angle(75, 200)}) {
      const DielectricBsdf bsdf{Spectrum(1), Spectrum(1), 1.5f, boundary};
      const Lobes in = lobes(bsdf, wo, TransportMode::radiance);
      ASSERT_TRUE(in.transmitted);
      // At the other face of a slab, turned so that its outside is above: the light goes on along the same line.
      const Lobes out = lobes(bsdf, -in.transmitted->wi * Vec3(1, 1, -1), TransportMode::radiance);
      const Lobes back = lobes(bsdf, in.transmitted->wi, TransportMode::radiance);
      ASSERT_TRUE(out.transmitted || back.transmitted);
      ASSERT_TRUE(back.transmitted);
      EXPECT_LT(length(back.transmitted->wi - wo), 1e-5f);
      expect_near(in.transmitted->weight * back.transmitted->weight, Spectrum(1), 1e-5f, "both ways");
      EXPECT_NEAR(in.transmitted->eta * back.transmitted->eta, 1, 1e-6f);
    }
}

TEST(ThinGlass, SumsUpWhatGoesToAndFro) {
  for (const float ior : {0.75f, 1.33f, 1.5f, 2.4f})
    for (const Vec3& wo : kDirections) {
      const double once = fresnel_dielectric(std::abs(wo.z), ior), in = 1 - once;
      double reflected = once, inside = in;
      for (int i = 0; i < 100000 && inside > 1e-12;
           ++i) {  // at the far boundary, back at the near one, again at the far one, …
        inside *= once;
        if (i % 2 == 0) reflected += inside * in;
      }
      const Lobes found =
          lobes(DielectricBsdf{Spectrum(1), Spectrum(1), ior, Boundary::thin}, wo, TransportMode::radiance);
      EXPECT_NEAR(found.reflection_probability, reflected, 2e-4) << ior << ' ' << wo;
      if (found.reflection_probability < 1) {
        ASSERT_TRUE(found.transmitted) << ior << ' ' << wo;
        EXPECT_EQ(found.transmitted->wi, -wo);
        EXPECT_EQ(found.transmitted->eta, 1);
        EXPECT_EQ(found.transmitted->lobe, Lobe::straight);
        expect_near(found.transmitted->weight, Spectrum(1), 1e-6f, "thin glass");
      }
    }
}

TEST(Mirror, OfMetalReflectsByFresnel) {
  for (const Vec3& wo : kDirections) {
    const auto s = sample_bsdf(MirrorBsdf{{0.9f, 0.5f, 0.1f}, kGoldEta, kGoldK}, wo, {0.1f, 0.9f}, 0.5f);
    ASSERT_TRUE(s);
    EXPECT_EQ(s->weight, Spectrum(0.9f, 0.5f, 0.1f) * fresnel_conductor(std::abs(wo.z), kGoldEta, kGoldK));
  }
}

TEST(Conductor, PerfectMetalScattersWhatSingleScatteringDoes) {
  // F = 1: what is missing to 1 is the light that would meet the surface again, G₁ averaged over what is seen.
  for (const MicrofacetKind kind : {MicrofacetKind::beckmann, MicrofacetKind::ggx}) {
    float before = 1;
    for (const float alpha : {0.01f, 0.2f, 0.5f, 1.0f}) {
      const float share = furnace(ConductorBsdf{kPerfect, kAbsorbing, Spectrum(1), {kind, alpha}}, at_angle(45, 0),
                                  TransportMode::radiance)
                              .r;
      EXPECT_LE(share, before + 1e-4f) << alpha;  // rougher metal loses more
      before = share;
    }
    const float smooth = furnace(ConductorBsdf{kPerfect, kAbsorbing, Spectrum(1), {kind, 0.01f}}, at_angle(45, 0),
                                 TransportMode::radiance)
                             .r;
    EXPECT_NEAR(smooth, 1, 1e-3f);
    EXPECT_LT(before, 0.95f);
    EXPECT_GT(before, 0.3f);
  }
}

TEST(Conductor, NearlySmoothIsAMirrorWithFresnel) {
  for (const Vec3& wo : {at_angle(10, 0), at_angle(60, 120)}) {
    const Spectrum share = furnace(ConductorBsdf{kGoldEta, kGoldK, Spectrum(1), {MicrofacetKind::beckmann, 0.002f}}, wo,
                                   TransportMode::radiance);
    expect_near(share, fresnel_conductor(wo.z, kGoldEta, kGoldK), 1e-3f, "gold");
  }
}

TEST(RoughGlass, NearlySmoothIsGlass) {
  for (const MicrofacetKind kind : {MicrofacetKind::beckmann, MicrofacetKind::ggx})
    for (const float ior : {0.75f, 1.5f})
      for (const Vec3& wo : {at_angle(10, 0), at_angle(70, 120), at_angle(150, 30), at_angle(110, 200)}) {
        const RoughDielectricBsdf rough{Spectrum(1), Spectrum(1), ior, {kind, 1e-3f}};
        const Lobes smooth = lobes(DielectricBsdf{Spectrum(1), Spectrum(1), ior}, wo, TransportMode::radiance);
        for (const bool through : {false, true}) {
          const auto share = furnace(rough, wo, TransportMode::radiance, [&](const BsdfSample& s) {
                               return s.is_transmission() == through;
                             }).r;
          const float p = through ? 1 - smooth.reflection_probability : smooth.reflection_probability;
          const auto& expected = through ? smooth.transmitted : smooth.reflected;
          EXPECT_NEAR(share, expected ? p * expected->weight.r : 0.0f, 3e-3f) << ior << ' ' << wo << ' ' << through;
        }
        if (smooth.transmitted) {
          EXPECT_LT(length(transmitted_direction(rough, wo) - smooth.transmitted->wi), 1e-3f) << ior << ' ' << wo;
        }
      }
}

TEST(RoughGlass, IsDividedByFresnelAtItsFacets) {
  // Both lobes over G₁(wi) are the visible facets once: nothing is lost (Heitz 2014, section 5.2), while no facet sends
  // light down or up again.
  const MicrofacetDistribution microfacets(MicrofacetKind::beckmann, 0.15f, 0.25f);
  const RoughDielectricBsdf rough{Spectrum(1), Spectrum(1), 1.5f, microfacets};
  for (const Vec3& wo : {at_angle(0, 0), at_angle(25, 40), at_angle(160, 300)}) {
    const auto unshadowed = [&](const Vec3& wi) {
      return static_cast<double>(eval_bsdf(rough, wo, wi, TransportMode::importance).f_cos.r /
                                 microfacets.visibility(wi));
    };
    EXPECT_NEAR(integrate_sphere(SphereGrid(), unshadowed), 1, 1e-3) << wo;
  }
}

// --- Plastic ---------------------------------------------------------------------------------------------------------

/// Share of diffuse light that a boundary to the index n > 1 reflects (Walsh 1926, "The Reflection Factor of a Polished
/// Glass Surface for Diffused Light").
double diffuse_reflectance_outside(double n) {
  const double n2 = n * n, n4 = n2 * n2;
  return 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
         n2 * (n2 - 1) * (n2 - 1) / std::pow(n2 + 1, 3) * std::log((n - 1) / (n + 1)) -
         2 * n * n2 * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
         8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) * (n4 - 1)) * std::log(n);
}

TEST(Plastic, SmoothBoundaryKeepsWhatWalshFound) {
  for (const float n : {1.1f, 1.33f, 1.49f, 1.9f, 2.4f}) {
    // What is let out is what is let in over n² (reciprocity).
    const double expected = 1 - (1 - diffuse_reflectance_outside(n)) / (static_cast<double>(n) * n);
    EXPECT_NEAR(PlasticBoundary(n).internal_reflectance(), expected, 1e-4) << n;
  }
}

/// Share of light that leaves a smooth layer over a base of reflectance `base`: one walk. It enters at `cosine`.
bool walk_leaves(Random& random, float cosine, float ior, float base) {
  if (random.value() < fresnel_dielectric(cosine, ior)) return true;
  while (random.value() < base) {
    const float up = std::sqrt(random.value());  // the base scatters with the cosine
    if (random.value() >= fresnel_dielectric(up, 1 / ior)) return true;
  }
  return false;
}

/// All that a plastic scatters, from its evaluation and its delta lobe.
double scattered_share(const PlasticBsdf& plastic, const Vec3& wo) {
  const auto diffuse = [&](double z) {
    const auto cosine = static_cast<float>(z);
    return 2 * std::numbers::pi * eval_bsdf(plastic, wo, {safe_sqrt(1 - square(cosine)), 0, cosine}).f_cos.r;
  };
  return integrate(diffuse, 0, 1, 1e-7) + 1 - plastic.boundary->transmittance(wo.z);
}

TEST(Plastic, NonlinearScattersWhatAWalkInTheLayerDoes) {
  TestFamily family;
  for (const PlasticBoundary* boundary : {&kSmoothPlastic, &kSmoothDiamond})
    for (const float base : {0.2f, 0.9f, 1.0f})
      for (const Vec3& wo : {at_angle(0, 0), at_angle(60, 0), at_angle(85, 0)}) {
        Random random(8);
        RunningMean walks;
        for (int i = 0; i < 100000; ++i) walks.add(walk_leaves(random, wo.z, boundary->ior(), base) ? 1 : 0);
        const double share = scattered_share({Spectrum(base), Spectrum(1), boundary, true}, wo);
        if (base == 1) {
          EXPECT_NEAR(share, 1, 1e-3) << boundary->ior();
        } else {
          family.add(std::to_string(base) + " at " + std::to_string(wo.z), walks.p_value(share, 2e-4));
        }
      }
  EXPECT_TRUE(family.holds());
}

TEST(Plastic, LinearKeepsTheColourOfItsBase) {
  for (const PlasticBoundary* boundary : {&kSmoothPlastic, &kSmoothDiamond})
    for (const float base : {0.0f, 0.2f, 0.9f, 1.0f})
      for (const Vec3& wo : {at_angle(0, 0), at_angle(60, 0), at_angle(85, 0)}) {
        const double in = boundary->transmittance(wo.z);
        EXPECT_NEAR(scattered_share({Spectrum(base), Spectrum(1), boundary, false}, wo), 1 - in + in * base, 1e-3);
      }
}

TEST(Plastic, RoughBoundaryLetsThroughWhatRoughGlassDoes) {
  for (const PlasticBoundary* boundary : {&kBeckmannPlastic, &kGgxPlastic}) {
    const RoughDielectricBsdf glass{Spectrum(1), Spectrum(1), boundary->ior(), *boundary->microfacets()};
    double inside = 0, integral = 0;
    for (int i = 0; i < 64; ++i) {
      const float cosine = static_cast<float>(i) / 63, sine = safe_sqrt(1 - square(cosine));
      if (i % 9 == 1) {
        const auto through = [&](const Vec3& wi) {
          return wi.z < 0
                     ? static_cast<double>(eval_bsdf(glass, {sine, 0, cosine}, wi, TransportMode::importance).f_cos.r)
                     : 0.0;
        };
        EXPECT_NEAR(boundary->transmittance(cosine), integrate_sphere(SphereGrid(), through, 1e-5), 1e-3) << cosine;
      }
      const auto back = [](const BsdfSample& s) { return !s.is_transmission(); };
      const double kept = 2 * cosine * furnace(glass, {sine, 0, -cosine}, TransportMode::importance, back).r;
      inside += kept / 64;
      integral += kept * (i == 63 ? 0.5 : 1) / 63;
    }
    EXPECT_NEAR(boundary->internal_reflectance(), inside, 2e-3);
    EXPECT_NEAR(boundary->internal_reflectance() / integral, 1, 0.03);
  }
}

TEST(Plastic, NearlySmoothBoundaryIsSmooth) {
  const PlasticBoundary polished(1.49f, {MicrofacetKind::ggx, 1e-3f});
  for (int i = 2; i < 64; ++i) {  // along the surface even these facets matter
    const float cosine = static_cast<float>(i) / 63;
    EXPECT_NEAR(polished.transmittance(cosine), kSmoothPlastic.transmittance(cosine), 1e-3f) << cosine;
  }
  EXPECT_NEAR(polished.internal_reflectance(), kSmoothPlastic.internal_reflectance(), 0.02f);
}

TEST(Plastic, ReflectsAtTheBoundaryAsItsFacetsDo) {
  // A black base leaves the boundary's reflection alone: rough glass that is seen from outside.
  const PlasticBsdf plastic{Spectrum(0), Spectrum(1), &kGgxPlastic};
  const RoughDielectricBsdf glass{Spectrum(1), Spectrum(0), kGgxPlastic.ior(), *kGgxPlastic.microfacets()};
  Random random(9);
  for (int i = 0; i < 1000; ++i) {
    Vec3 wo = random.direction(), wi = random.direction();
    wo.z = std::abs(wo.z);
    wi.z = std::abs(wi.z);
    const BsdfEval a = eval_bsdf(plastic, wo, wi), b = eval_bsdf(glass, wo, wi);
    EXPECT_NEAR(a.f_cos.r, b.f_cos.r, 1e-5f * b.f_cos.r) << wo << wi;
  }
}

// --- Blend -----------------------------------------------------------------------------------------------------------

TEST(Blend, IsTheMeanOfItsTwo) {
  const LeafBsdf leaves[] = {kColoured, kMirror, kRoughGlass, kPlastic, BlackBsdf{}};
  const auto alone = [](const LeafBsdf& leaf) { return std::visit([](const auto& bsdf) { return Bsdf(bsdf); }, leaf); };
  for (const LeafBsdf& a : leaves)
    for (const LeafBsdf& b : leaves)
      for (const float weight : {0.0f, 0.3f, 1.0f})
        for (const Vec3& wo : {at_angle(30, 40), at_angle(110, 10)}) {
          const BlendBsdf blend{a, b, weight};
          const Vec3 wi = at_angle(wo.z > 0 ? 160 : 20, 220);
          expect_near(eval_bsdf(blend, wo, wi).f_cos,
                      eval_bsdf(alone(a), wo, wi).f_cos * (1 - weight) + eval_bsdf(alone(b), wo, wi).f_cos * weight,
                      1e-6f, "blend");
          expect_near(furnace(blend, wo, TransportMode::radiance),
                      furnace(alone(a), wo, TransportMode::radiance) * (1 - weight) +
                          furnace(alone(b), wo, TransportMode::radiance) * weight,
                      1e-2f, "blend of " + std::to_string(a.index()) + " and " + std::to_string(b.index()));
        }
}

}  // namespace
}  // namespace etendue
