#include "materials/bsdf.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "materials/fresnel.h"
#include "testing/quadrature.h"
#include "testing/random.h"
#include "testing/sphere_grid.h"

/// Every BSDF of the list is tested for all that BSDFs promise; a new one is told of by ListIsComplete until it stands
/// here.
namespace etendue {
namespace {

const Spectrum kGoldEta(0.18f, 0.42f, 1.37f), kGoldK(3.42f, 2.35f, 1.77f), kPerfect(0), kAbsorbing(1);

struct NamedBsdf {
  std::string name;
  Bsdf bsdf;
};

std::vector<NamedBsdf> all_bsdfs() {
  std::vector<NamedBsdf> list = {
      {"white diffuse", DiffuseBsdf{Spectrum(1)}},
      {"coloured diffuse", DiffuseBsdf{{0.2f, 0.5f, 0.8f}}},
      {"mirror", MirrorBsdf{{0.9f, 0.5f, 0.1f}}},
      {"glass", DielectricBsdf{Spectrum(1), Spectrum(1), 1.5f}},
      {"Schlick's glass", DielectricBsdf{Spectrum(1), Spectrum(1), 1.45f, true}},
      {"air in water", DielectricBsdf{Spectrum(1), Spectrum(1), 0.75f}},
      {"tinted glass", DielectricBsdf{{0.9f, 0.5f, 0.2f}, {0.1f, 0.7f, 0.6f}, 2.4f}},
      {"pure refraction", RefractionBsdf{{0.9f, 0.6f, 0.3f}, 1.33f}},
      {"gold, tinted", ConductorBsdf{kGoldEta, kGoldK, {0.9f, 0.7f, 0.5f}, {MicrofacetKind::beckmann, 0.3f}}},
      {"black", BlackBsdf{}},
  };
  for (const MicrofacetKind kind : {MicrofacetKind::beckmann, MicrofacetKind::ggx})
    for (const float alpha : {0.01f, 0.05f, 0.2f, 0.5f, 1.0f}) {
      const std::string name = kind == MicrofacetKind::beckmann ? "Beckmann " : "GGX ";
      list.push_back({name + "gold of width " + std::to_string(alpha),
                      ConductorBsdf{kGoldEta, kGoldK, Spectrum(1), {kind, alpha}}});
      list.push_back({name + "perfect metal of width " + std::to_string(alpha),
                      ConductorBsdf{kPerfect, kAbsorbing, Spectrum(1), {kind, alpha}}});
    }
  return list;
}

Vec3 at_angle(float theta_deg, float phi_deg) {
  const float theta = radians(theta_deg), phi = radians(phi_deg);
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// From straight above to grazing, and from below.
const Vec3 kDirections[] = {{0, 0, 1},         at_angle(30, 40), at_angle(60, 200), at_angle(80, 100),
                            at_angle(89, 300), at_angle(180, 0), at_angle(130, 70), at_angle(95, 10)};

std::string at(const NamedBsdf& named, const Vec3& wo) {
  return named.name + " from " + std::to_string(degrees(std::acos(wo.z))) + " degrees";
}

TEST(Bsdf, ListIsComplete) {
  std::set<std::size_t> alternatives;
  for (const NamedBsdf& named : all_bsdfs()) alternatives.insert(named.bsdf.index());
  EXPECT_EQ(alternatives.size(), std::variant_size_v<Bsdf>) << "a BSDF is missing in all_bsdfs()";
}

/// Width of a rough metal's distribution, 1 for everything else. D(z) = 1 / (π α²) for both kinds.
double width_of(const Bsdf& bsdf) {
  const auto* conductor = std::get_if<ConductorBsdf>(&bsdf);
  return conductor == nullptr ? 1.0 : 1 / std::sqrt(std::numbers::pi * conductor->microfacets.density({0, 0, 1}));
}

/// Cells along the horizon, at which scattering ends; for narrow lobes about the direction of perfect reflection.
SphereGrid grid_for(const Bsdf& bsdf, const Vec3& wo) {
  const double width = width_of(bsdf);
  return width < 0.1 ? SphereGrid({-wo.x, -wo.y, wo.z}, width) : SphereGrid();
}

TEST(Bsdf, SamplesFollowTheDensity) {
  TestFamily family;
  for (const NamedBsdf& named : all_bsdfs()) {
    if (is_delta(named.bsdf)) continue;
    for (const Vec3& wo : kDirections) {
      Random random(1);
      const auto sample = [&]() -> std::optional<Vec3> {
        const std::optional<BsdfSample> s = sample_bsdf(named.bsdf, wo, random.point(), random.value());
        return s ? std::optional(s->wi) : std::nullopt;
      };
      const auto density = [&](const Vec3& wi) { return static_cast<double>(eval_bsdf(named.bsdf, wo, wi).pdf); };
      family.add(at(named, wo), direction_test(grid_for(named.bsdf, wo), 40000, sample, density).p);
    }
  }
  EXPECT_TRUE(family.holds());
}

TEST(Bsdf, SampleAndEvaluationAgree) {
  for (const NamedBsdf& named : all_bsdfs()) {
    Random random(2);
    for (const Vec3& wo : kDirections)
      for (int i = 0; i < 300; ++i) {
        const std::optional<BsdfSample> s = sample_bsdf(named.bsdf, wo, random.point(), random.value());
        if (!s) continue;
        ASSERT_NEAR(length(s->wi), 1, 1e-5f) << at(named, wo);
        ASSERT_TRUE(is_finite(s->weight)) << at(named, wo);
        const BsdfEval eval = eval_bsdf(named.bsdf, wo, s->wi);
        if (s->is_delta()) {
          EXPECT_EQ(s->pdf, 0) << at(named, wo);
          EXPECT_TRUE(eval.f_cos.is_black() && eval.pdf == 0) << at(named, wo);
          continue;
        }
        EXPECT_FALSE(is_delta(named.bsdf)) << named.name;
        ASSERT_GT(s->pdf, 0) << at(named, wo);
        // The half vector found again has rounding errors that a narrow lobe magnifies.
        const float tolerance = width_of(named.bsdf) < 0.05 ? 1e-2f : 1e-3f;
        ASSERT_NEAR(eval.pdf / s->pdf, 1, tolerance) << at(named, wo);
        for (int c = 0; c < 3; ++c)
          ASSERT_NEAR(eval.f_cos[c], s->weight[c] * s->pdf, tolerance * s->pdf) << at(named, wo);
      }
  }
}

TEST(Bsdf, DeltaKindsSayWhichTheyAre) {
  for (const NamedBsdf& named : all_bsdfs()) {
    Random random(3);
    for (int i = 0; i < 100; ++i) {
      const std::optional<BsdfSample> s = sample_bsdf(named.bsdf, kDirections[1], random.point(), random.value());
      if (s) {
        EXPECT_EQ(s->is_delta(), is_delta(named.bsdf)) << named.name;
      }
    }
  }
}

/// Share of the light that is scattered, by sampling.
Spectrum furnace(const Bsdf& bsdf, const Vec3& wo, TransportMode mode, int side = 64) {
  Random random(4);
  double sum[3] = {};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const Vec2 jitter = random.point();
      const Vec2 u((static_cast<float>(x) + jitter.x) / static_cast<float>(side),
                   (static_cast<float>(y) + jitter.y) / static_cast<float>(side));
      // The lobe is chosen with evenly spread numbers, too.
      const float choice = (static_cast<float>(y * side + x) + 0.5f) / static_cast<float>(side * side);
      if (const auto s =
              sample_bsdf(bsdf, wo, {std::min(u.x, kOneMinusEpsilon), std::min(u.y, kOneMinusEpsilon)}, choice, mode))
        for (int c = 0; c < 3; ++c) sum[c] += s->weight[c];
    }
  const double n = static_cast<double>(side) * side;
  return {static_cast<float>(sum[0] / n), static_cast<float>(sum[1] / n), static_cast<float>(sum[2] / n)};
}

TEST(Bsdf, ScattersNoMoreThanArrives) {
  for (const NamedBsdf& named : all_bsdfs())
    for (const Vec3& wo : kDirections) {
      const Spectrum share = furnace(named.bsdf, wo, TransportMode::importance);
      for (int c = 0; c < 3; ++c) {
        EXPECT_GE(share[c], 0) << at(named, wo);
        EXPECT_LE(share[c], 1 + 1e-5f) << at(named, wo);
      }
    }
}

TEST(Bsdf, ScatteredShareIsTheIntegralOfTheEvaluation) {
  for (const NamedBsdf& named : all_bsdfs()) {
    if (is_delta(named.bsdf)) continue;
    for (const Vec3& wo : kDirections) {
      const auto red = [&](const Vec3& wi) { return static_cast<double>(eval_bsdf(named.bsdf, wo, wi).f_cos.r); };
      const double integral = integrate_sphere(grid_for(named.bsdf, wo), red, 1e-5);
      EXPECT_NEAR(furnace(named.bsdf, wo, TransportMode::radiance).r, integral, 5e-3) << at(named, wo);
    }
  }
}

TEST(Bsdf, ReflectionIsReciprocal) {
  for (const NamedBsdf& named : all_bsdfs()) {
    Random random(5);
    for (int i = 0; i < 2000; ++i) {
      Vec3 wo = random.direction(), wi = random.direction();
      if (i % 2 == 0) wi = normalize(Vec3(-wo.x, -wo.y, wo.z) + wi * 0.1f);  // where narrow lobes are
      if (std::abs(wo.z) < 1e-3f || std::abs(wi.z) < 1e-3f) continue;
      const Spectrum there = eval_bsdf(named.bsdf, wo, wi).f_cos / std::abs(wi.z);
      const Spectrum back = eval_bsdf(named.bsdf, wi, wo).f_cos / std::abs(wo.z);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(there[c], back[c], 1e-3f * there[c] + 1e-6f) << at(named, wo);
    }
  }
}

TEST(Bsdf, NothingIsNanAtTheEnds) {
  const float kEnds[] = {0, 0x1p-24f, 0.5f, kOneMinusEpsilon};
  std::vector<Vec3> directions(std::begin(kDirections), std::end(kDirections));
  for (const float z : {1e-3f, 1e-6f, 1e-12f, 1e-30f, 0.0f, -0.0f, -1e-12f, -1e-3f})
    directions.push_back(normalize(Vec3(0.6f, -0.8f, z)));
  for (const NamedBsdf& named : all_bsdfs())
    for (const Vec3& wo : directions) {
      for (const float u : kEnds)
        for (const float v : kEnds)
          for (const float choice : kEnds) {
            const auto s = sample_bsdf(named.bsdf, wo, {u, v}, choice);
            if (!s) continue;
            EXPECT_TRUE(is_finite(s->wi) && is_finite(s->weight) && std::isfinite(s->pdf)) << at(named, wo);
            EXPECT_NEAR(length(s->wi), 1, 1e-5f) << at(named, wo);
            EXPECT_TRUE(s->weight.r >= 0 && s->weight.g >= 0 && s->weight.b >= 0) << at(named, wo);
            EXPECT_EQ(s->wi.z * wo.z < 0, s->lobe == Lobe::delta_transmission) << at(named, wo);
          }
      for (const Vec3& wi : directions) {
        const BsdfEval eval = eval_bsdf(named.bsdf, wo, wi);
        EXPECT_TRUE(is_finite(eval.f_cos) && !std::isnan(eval.pdf)) << at(named, wo) << ", to " << wi;
        EXPECT_TRUE(eval.f_cos.r >= 0 && eval.pdf >= 0) << at(named, wo) << ", to " << wi;
      }
    }
}

void expect_near(const Spectrum& a, const Spectrum& b, float tolerance, const std::string& what) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << what;
}

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
      EXPECT_EQ(s->lobe, Lobe::delta_transmission);
      out.transmitted = s;
    }
  }
  return out;
}

TEST(Glass, LosesNothing) {
  for (const bool schlick : {false, true})
    for (const float ior : {0.75f, 1.33f, 1.5f, 2.4f})
      for (const Vec3& wo : kDirections) {
        const DielectricBsdf glass{Spectrum(1), Spectrum(1), ior, schlick};
        expect_near(furnace(glass, wo, TransportMode::importance), Spectrum(1), 1e-5f,
                    "glass of index " + std::to_string(ior));
      }
}

TEST(Glass, DividesLightByFresnel) {
  const Spectrum reflectance(0.9f, 0.5f, 0.2f), transmittance(0.1f, 0.7f, 0.6f);
  for (const bool schlick : {false, true})
    for (const float ior : {0.75f, 1.5f, 2.4f})
      for (const Vec3& wo : kDirections) {
        const DielectricBsdf glass{reflectance, transmittance, ior, schlick};
        const float eta = wo.z > 0 ? ior : 1 / ior, c = std::abs(wo.z);
        const float fresnel = schlick ? fresnel_schlick(c, eta) : fresnel_dielectric(c, eta);
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
  for (const Bsdf& bsdf :
       {Bsdf(DielectricBsdf{Spectrum(1), Spectrum(1), 1.5f}), Bsdf(RefractionBsdf{Spectrum(1), 1.5f})})
    for (const Vec3& wo : kDirections) {
      const float eta = wo.z > 0 ? 1.5f : 1 / 1.5f;
      const Lobes found = lobes(bsdf, wo, TransportMode::radiance);
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
  for (const bool schlick : {false, true}) {
    const Lobes found = lobes(DielectricBsdf{Spectrum(1), Spectrum(1), 1.5f, schlick}, wo, TransportMode::radiance);
    EXPECT_FALSE(found.transmitted);
    ASSERT_TRUE(found.reflected);
    EXPECT_EQ(found.reflected->weight, Spectrum(1));
    EXPECT_EQ(found.reflected->wi, Vec3(-wo.x, -wo.y, wo.z));
    EXPECT_EQ(found.reflected->eta, 1);
  }
  EXPECT_FALSE(sample_bsdf(RefractionBsdf{Spectrum(1), 1.5f}, wo, {0.5f, 0.5f}, 0.5f));
}

TEST(Glass, RadianceScalesWithTheSquaredIndex) {
  for (const NamedBsdf& named : all_bsdfs())
    for (const Vec3& wo : kDirections)
      for (const float choice : {0.01f, 0.5f, 0.99f}) {
        const auto radiance = sample_bsdf(named.bsdf, wo, {0.3f, 0.6f}, choice, TransportMode::radiance);
        const auto importance = sample_bsdf(named.bsdf, wo, {0.3f, 0.6f}, choice, TransportMode::importance);
        ASSERT_EQ(radiance.has_value(), importance.has_value()) << at(named, wo);
        if (!radiance) continue;
        const float scale = 1 / square(radiance->eta);  // 1 unless transmitted
        EXPECT_EQ(radiance->eta == 1, radiance->lobe != Lobe::delta_transmission) << at(named, wo);
        expect_near(radiance->weight, importance->weight * scale, 1e-6f, at(named, wo));
      }
}

TEST(Glass, WayInAndOutRestoresRadianceAndDirection) {
  for (const Bsdf& bsdf :
       {Bsdf(DielectricBsdf{Spectrum(1), Spectrum(1), 1.5f}), Bsdf(RefractionBsdf{Spectrum(1), 1.5f})})
    for (const Vec3& wo : {at_angle(0, 0), at_angle(30, 40), at_angle(75, 200)}) {
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

// --- Microfacets -----------------------------------------------------------------------------------------------------

struct NamedMicrofacets {
  std::string name;
  MicrofacetDistribution distribution;
  float alpha;
};

std::vector<NamedMicrofacets> all_microfacets() {
  std::vector<NamedMicrofacets> list;
  for (const float alpha : {1e-3f, 0.01f, 0.05f, 0.1f, 0.3f, 0.6f, 1.0f}) {
    list.push_back({"Beckmann " + std::to_string(alpha), {MicrofacetKind::beckmann, alpha}, alpha});
    list.push_back({"GGX " + std::to_string(alpha), {MicrofacetKind::ggx, alpha}, alpha});
  }
  return list;
}

const Vec3 kViews[] = {{0, 0, 1},         at_angle(5, 200),  at_angle(45, 30),
                       at_angle(75, 140), at_angle(85, 260), at_angle(89.5f, 77)};

TEST(Microfacets, CoverTheSurfaceOnce) {
  for (const NamedMicrofacets& m : all_microfacets()) {
    const auto projected = [&](const Vec3& w) {
      return static_cast<double>(m.distribution.density(w)) * std::max(w.z, 0.0f);
    };
    EXPECT_NEAR(integrate_sphere(SphereGrid({0, 0, 1}, 0.5 * m.alpha), projected), 1, 2e-3) << m.name;
  }
}

TEST(Microfacets, VisibleOnesCoverTheProjection) {
  // ∫ G₁(w) max(0, w·m) D(m) dm = w.z (Heitz 2014, eq. 11).
  for (const NamedMicrofacets& m : all_microfacets())
    for (const Vec3& w : kViews) {
      const auto pdf = [&](const Vec3& n) {
        return n.z > 0 ? static_cast<double>(m.distribution.visible_pdf(w, n)) : 0.0;
      };
      EXPECT_NEAR(integrate_sphere(SphereGrid({0, 0, 1}, 0.5 * m.alpha), pdf), 1, 2e-3) << m.name << ' ' << w.z;
    }
}

TEST(Microfacets, VisibleSamplesFollowTheirDensity) {
  TestFamily family;
  for (const NamedMicrofacets& m : all_microfacets())
    for (const Vec3& w : kViews) {
      Random random(6);
      const auto pdf = [&](const Vec3& n) {
        return n.z > 0 ? static_cast<double>(m.distribution.visible_pdf(w, n)) : 0.0;
      };
      const auto sample = [&] { return std::optional(m.distribution.sample_visible(w, random.point())); };
      family.add(m.name + " from cosine " + std::to_string(w.z),
                 direction_test(SphereGrid({0, 0, 1}, 0.5 * m.alpha), 60000, sample, pdf).p);
    }
  EXPECT_TRUE(family.holds());
}

TEST(Microfacets, AreVisibleBetweenNotAtAllAndWholly) {
  for (const NamedMicrofacets& m : all_microfacets()) {
    float before = 1;
    for (int i = 0; i <= 900; ++i) {
      const float g = m.distribution.visibility(at_angle(static_cast<float>(i) * 0.1f, 33));
      EXPECT_GE(g, 0) << m.name;
      EXPECT_LE(g, before + 2e-4f) << m.name << ' ' << i;  // Beckmann's is cut off where it is 1 but for 1e-9
      before = g;
    }
    EXPECT_EQ(m.distribution.visibility({0, 0, 1}), 1) << m.name;
  }
}

TEST(Microfacets, SamplesAreFiniteUnitAndUp) {
  const float kEnds[] = {0, 0x1p-24f, 1e-4f, 0.5f, 1 - 1e-4f, kOneMinusEpsilon};
  std::vector<Vec3> views(std::begin(kViews), std::end(kViews));
  for (const float z : {1e-3f, 1e-6f, 1e-12f, 1e-30f}) views.push_back(normalize(Vec3(-0.6f, 0.8f, z)));
  for (const NamedMicrofacets& m : all_microfacets())
    for (const Vec3& w : views)
      for (const float u : kEnds)
        for (const float v : kEnds) {
          const Vec3 n = m.distribution.sample_visible(w, {u, v});
          EXPECT_TRUE(is_finite(n)) << m.name << ' ' << w.z << ' ' << u << ' ' << v;
          EXPECT_NEAR(length(n), 1, 1e-5f) << m.name;
          EXPECT_GE(n.z, 0) << m.name;
          EXPECT_FALSE(std::isnan(m.distribution.visible_pdf(w, n))) << m.name << ' ' << w.z << ' ' << u << ' ' << v;
        }
}

TEST(Microfacets, WidthHasALowerEnd) {
  const MicrofacetDistribution zero(MicrofacetKind::ggx, 0),
      least(MicrofacetKind::ggx, MicrofacetDistribution::kMinAlpha);
  EXPECT_EQ(zero.density({0, 0, 1}), least.density({0, 0, 1}));
}

}  // namespace
}  // namespace etendue
