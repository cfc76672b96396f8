#include "materials/bsdf.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "materials/fresnel.h"
#include "materials/tests/bsdf_kit.h"
#include "testing/quadrature.h"
#include "testing/random.h"
#include "testing/sphere_grid.h"

/// Every BSDF of the list is tested for all that BSDFs promise; a new one is told of by ListIsComplete until it stands
/// here.
namespace etendue {
namespace {

struct NamedBsdf {
  std::string name;
  Bsdf bsdf;
  double width = 1;       ///< of the narrowest lobe that is not a delta lobe
  bool symmetric = true;  ///< importance goes the way of radiance back
};

/// principled_test.cpp has more of these; here they are one of the list.
PrincipledParameters principled_metal() {
  PrincipledParameters p;
  p.base_color = {0.8f, 0.5f, 0.2f};
  p.metallic = 0.6f;
  p.anisotropic = 0.5f;
  p.clearcoat = 0.5f;
  return p;
}
PrincipledParameters principled_glass() {
  PrincipledParameters p;
  p.base_color = {0.8f, 0.9f, 0.6f};
  p.spec_trans = 1;
  return p;
}
PrincipledThinParameters principled_sheet() {
  PrincipledThinParameters p;
  p.base_color = {0.8f, 0.5f, 0.2f};
  p.spec_trans = 0.4f;
  p.diff_trans = 0.7f;
  return p;
}

std::vector<NamedBsdf> all_bsdfs() {
  std::vector<NamedBsdf> list = {
      {"white diffuse", DiffuseBsdf{Spectrum(1)}},
      {"coloured diffuse", kColoured},
      {"mirror", kMirror},
      {"smooth gold", MirrorBsdf{{0.9f, 0.7f, 0.5f}, kGoldEta, kGoldK}},
      {"glass", kGlass},
      {"Schlick's glass", DielectricBsdf{Spectrum(1), Spectrum(1), 1.45f, Boundary::schlick}},
      {"air in water", DielectricBsdf{Spectrum(1), Spectrum(1), 0.75f}},
      {"tinted glass", DielectricBsdf{{0.9f, 0.5f, 0.2f}, {0.1f, 0.7f, 0.6f}, 2.4f}},
      {"pure refraction", DielectricBsdf{Spectrum(1), {0.9f, 0.6f, 0.3f}, 1.33f, Boundary::transmit_only}},
      {"thin glass", DielectricBsdf{Spectrum(1), Spectrum(1), 1.5f, Boundary::thin}},
      {"tinted thin glass", DielectricBsdf{{0.9f, 0.5f, 0.2f}, {0.1f, 0.7f, 0.6f}, 1.8f, Boundary::thin}},
      {"gold, tinted", ConductorBsdf{kGoldEta, kGoldK, {0.9f, 0.7f, 0.5f}, {MicrofacetKind::beckmann, 0.3f}}},
      {"brushed gold", ConductorBsdf{kGoldEta, kGoldK, Spectrum(1), {MicrofacetKind::ggx, 0.15f, 0.5f}}},
      {"brushed metal", ConductorBsdf{kPerfect, kAbsorbing, Spectrum(1), {MicrofacetKind::beckmann, 0.6f, 0.2f}}},
      {"rough glass", kRoughGlass},
      {"rough air in water", RoughDielectricBsdf{Spectrum(1), Spectrum(1), 0.75f, {MicrofacetKind::ggx, 0.4f}}},
      {"brushed, tinted rough glass",
       RoughDielectricBsdf{{0.9f, 0.5f, 0.2f}, {0.1f, 0.7f, 0.6f}, 2.4f, {MicrofacetKind::ggx, 0.2f, 0.6f}}},
      {"rough glass that only transmits",
       RoughDielectricBsdf{Spectrum(0), Spectrum(1), 1.33f, {MicrofacetKind::beckmann, 0.4f}}},
      {"rough glass that only reflects",
       RoughDielectricBsdf{Spectrum(1), Spectrum(0), 1.33f, {MicrofacetKind::beckmann, 0.4f}}},
      {"very rough glass", RoughDielectricBsdf{Spectrum(1), Spectrum(1), 1.5f, {MicrofacetKind::ggx, 0.9f}}},
      {"Beckmann glass of width 0.05",
       RoughDielectricBsdf{Spectrum(1), Spectrum(1), 1.5f, {MicrofacetKind::beckmann, 0.05f}}, 0.05},
      {"GGX glass of width 0.01", RoughDielectricBsdf{Spectrum(1), Spectrum(1), 1.5f, {MicrofacetKind::ggx, 0.01f}},
       0.01},
      {"plastic", kPlastic},
      {"nonlinear plastic", PlasticBsdf{{0.2f, 0.5f, 0.9f}, {0.9f, 0.7f, 0.5f}, &kSmoothDiamond, true}},
      {"white plastic", PlasticBsdf{Spectrum(1), Spectrum(1), &kSmoothPlastic}},
      {"rough plastic", PlasticBsdf{{0.2f, 0.5f, 0.8f}, Spectrum(1), &kBeckmannPlastic}},
      {"rough, tinted nonlinear plastic", PlasticBsdf{{0.2f, 0.5f, 0.9f}, {0.9f, 0.7f, 0.5f}, &kGgxPlastic, true}},
      {"rough black plastic", PlasticBsdf{Spectrum(0), Spectrum(1), &kGgxPlastic}},
      {"black plastic without reflection", PlasticBsdf{Spectrum(0), Spectrum(0), &kSmoothPlastic}},
      {"principled", PrincipledBsdf(principled_metal())},
      {"principled glass", PrincipledBsdf(principled_glass())},
      {"thin principled", PrincipledThinBsdf(principled_sheet()), 1,
       false},  // what goes through is not symmetric in Mitsuba's form
      {"black", BlackBsdf{}},
      {"half mirror, half diffuse", BlendBsdf{kMirror, kColoured, 0.7f}},
      {"mirror or glass", BlendBsdf{kMirror, kGlass, 0.3f}},
      {"plastic or rough glass", BlendBsdf{kPlastic, kRoughGlass, 0.4f}},
      {"only the first", BlendBsdf{kColoured, kMirror, 0}},
      {"only the second", BlendBsdf{kMirror, kRoughGlass, 1}},
  };
  for (const MicrofacetKind kind : {MicrofacetKind::beckmann, MicrofacetKind::ggx})
    for (const float alpha : {0.01f, 0.05f, 0.2f, 0.5f, 1.0f}) {
      const std::string name = kind == MicrofacetKind::beckmann ? "Beckmann " : "GGX ";
      list.push_back({name + "gold of width " + std::to_string(alpha),
                      ConductorBsdf{kGoldEta, kGoldK, Spectrum(1), {kind, alpha}}, alpha});
      list.push_back({name + "perfect metal of width " + std::to_string(alpha),
                      ConductorBsdf{kPerfect, kAbsorbing, Spectrum(1), {kind, alpha}}, alpha});
    }
  return list;
}

/// Those that are narrower than float arithmetic can test well; they must stay finite.
std::vector<NamedBsdf> extreme_bsdfs() {
  static const PlasticBoundary polished(1.49f, {MicrofacetKind::beckmann, 0});
  std::vector<NamedBsdf> list = all_bsdfs();
  for (const MicrofacetKind kind : {MicrofacetKind::beckmann, MicrofacetKind::ggx}) {
    list.push_back({"polished metal", ConductorBsdf{kGoldEta, kGoldK, Spectrum(1), {kind, 0}}});
    list.push_back({"scratched metal", ConductorBsdf{kGoldEta, kGoldK, Spectrum(1), {kind, 0, 1}}});
    for (const float ior : {0.5f, 1.0f, 1.0001f, 1.5f, 10.0f}) {
      list.push_back({"polished glass of index " + std::to_string(ior),
                      RoughDielectricBsdf{Spectrum(1), Spectrum(1), ior, {kind, 0}}});
      list.push_back({"rough glass of index " + std::to_string(ior),
                      RoughDielectricBsdf{Spectrum(1), Spectrum(1), ior, {kind, 1}}});
    }
  }
  list.push_back({"polished plastic", PlasticBsdf{Spectrum(1), Spectrum(1), &polished, true}});
  for (const Boundary boundary : {Boundary::fresnel, Boundary::schlick, Boundary::transmit_only, Boundary::thin})
    list.push_back({"no boundary", DielectricBsdf{Spectrum(1), Spectrum(1), 1, boundary}});
  return list;
}

std::string at(const NamedBsdf& named, const Vec3& wo) {
  return named.name + " from " + std::to_string(degrees(std::acos(wo.z))) + " degrees";
}

TEST(Bsdf, ListIsComplete) {
  std::set<std::size_t> alternatives;
  for (const NamedBsdf& named : all_bsdfs()) alternatives.insert(named.bsdf.index());
  EXPECT_EQ(alternatives.size(), std::variant_size_v<Bsdf>) << "a BSDF is missing in all_bsdfs()";
}

/// A part of the sphere with cells that resolve the BSDF's lobe there.
struct Part {
  SphereGrid grid;
  float side;  ///< the sign of z that belongs to it; 0: both

  bool contains(const Vec3& w) const { return side == 0 || w.z * side > 0; }
};

/// Cells along the horizon, at which scattering ends; for narrow lobes about where light is reflected and refracted.
std::vector<Part> parts_for(const NamedBsdf& named, const Vec3& wo) {
  if (named.width >= 0.1) return {{SphereGrid(), 0}};
  std::vector<Part> parts = {{SphereGrid({-wo.x, -wo.y, wo.z}, named.width), wo.z}};
  if (transmits(named.bsdf)) parts.push_back({SphereGrid(transmitted_direction(named.bsdf, wo), named.width), -wo.z});
  return parts;
}

TEST(Bsdf, SamplesFollowTheDensity) {
  TestFamily family;
  for (const NamedBsdf& named : all_bsdfs()) {
    if (is_delta(named.bsdf)) continue;
    for (const Vec3& wo : kDirections)
      for (const Part& part : parts_for(named, wo)) {
        Random random(1);
        const auto sample = [&]() -> std::optional<Vec3> {
          const std::optional<BsdfSample> s = sample_bsdf(named.bsdf, wo, random.point(), random.value());
          return s && !s->is_delta() && part.contains(s->wi) ? std::optional(s->wi) : std::nullopt;
        };
        const auto density = [&](const Vec3& wi) {
          return part.contains(wi) ? static_cast<double>(eval_bsdf(named.bsdf, wo, wi).pdf) : 0.0;
        };
        family.add(at(named, wo), direction_test(part.grid, 40000, sample, density).p);
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
        if (is_delta(named.bsdf)) {
          EXPECT_TRUE(eval.f_cos.is_black() && eval.pdf == 0) << at(named, wo);
        }
        if (s->is_delta()) {
          EXPECT_EQ(s->pdf, 0) << at(named, wo);
          continue;
        }
        ASSERT_GT(s->pdf, 0) << at(named, wo);
        // The half vector found again has rounding errors that a narrow lobe magnifies.
        const float tolerance = named.width < 0.05 ? 1e-2f : 1e-3f;
        ASSERT_NEAR(eval.pdf / s->pdf, 1, tolerance) << at(named, wo);
        for (int c = 0; c < 3; ++c)
          ASSERT_NEAR(eval.f_cos[c], s->weight[c] * s->pdf, tolerance * s->pdf) << at(named, wo);
      }
  }
}

TEST(Bsdf, KeepsWhatItSaysOfItself) {
  for (const NamedBsdf& named : all_bsdfs()) {
    Random random(3);
    bool seen_beyond = false;
    for (const Vec3& wo : kDirections)
      for (int i = 0; i < 100; ++i) {
        const Vec3 wi = random.direction();
        if (!eval_bsdf(named.bsdf, wo, wi).f_cos.is_black()) {
          EXPECT_FALSE(is_delta(named.bsdf)) << named.name;
          seen_beyond |= wo.z * wi.z < 0;
        }
        const std::optional<BsdfSample> s = sample_bsdf(named.bsdf, wo, random.point(), random.value());
        if (!s) continue;
        EXPECT_TRUE(s->is_delta() || !is_delta(named.bsdf)) << named.name;
        seen_beyond |= s->is_transmission();
      }
    EXPECT_TRUE(transmits(named.bsdf) || !seen_beyond) << named.name;
  }
}

TEST(Bsdf, ScattersNoMoreThanArrives) {
  for (const NamedBsdf& named : all_bsdfs())
    for (const Vec3& wo : kDirections) {
      const Spectrum share = furnace(named.bsdf, wo, TransportMode::importance);
      for (int c = 0; c < 3; ++c) {
        EXPECT_GE(share[c], 0) << at(named, wo);
        EXPECT_LE(share[c], 1 + 3e-3f) << at(named, wo);  // where lobes mix, samples weigh more or less than 1
      }
    }
}

TEST(Bsdf, ScatteredShareIsTheIntegralOfTheEvaluation) {
  for (const NamedBsdf& named : all_bsdfs()) {
    if (is_delta(named.bsdf)) continue;
    for (const Vec3& wo : kDirections)
      for (const Part& part : parts_for(named, wo)) {
        const auto red = [&](const Vec3& wi) {
          return part.contains(wi) ? static_cast<double>(eval_bsdf(named.bsdf, wo, wi).f_cos.r) : 0.0;
        };
        const auto counts = [&](const BsdfSample& s) { return !s.is_delta() && part.contains(s.wi); };
        EXPECT_NEAR(furnace(named.bsdf, wo, TransportMode::radiance, counts).r, integrate_sphere(part.grid, red, 1e-5),
                    8e-3)
            << at(named, wo);
      }
  }
}

TEST(Bsdf, ImportanceGoesTheWayOfRadianceBack) {
  // f*(wo, wi) = f(wi, wo) (Veach 1997, section 3.7.5); where nothing is refracted, that is reciprocity.
  for (const NamedBsdf& named : all_bsdfs()) {
    if (!named.symmetric) continue;
    Random random(5);
    for (int i = 0; i < 3000; ++i) {
      Vec3 wo = random.direction(), wi = random.direction();
      if (i % 3 == 0) wi = normalize(Vec3(-wo.x, -wo.y, wo.z) + wi * 0.1f);  // where narrow lobes are
      if (i % 3 == 1) wi = normalize(-wo + wi * 0.3f);
      if (std::abs(wo.z) < 1e-3f || std::abs(wi.z) < 1e-3f) continue;
      const Spectrum there = eval_bsdf(named.bsdf, wo, wi, TransportMode::importance).f_cos / std::abs(wi.z);
      const Spectrum back = eval_bsdf(named.bsdf, wi, wo, TransportMode::radiance).f_cos / std::abs(wo.z);
      // Refraction by a narrow lobe magnifies the rounding of its half vector.
      const float tolerance = named.width < 0.1 ? 1e-2f : 1e-3f;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(there[c], back[c], tolerance * there[c] + 5e-6f) << at(named, wo);
    }
  }
}

TEST(Bsdf, NothingIsNanAtTheEnds) {
  const float kEnds[] = {0, 0x1p-24f, 0.5f, kOneMinusEpsilon};
  std::vector<Vec3> directions(std::begin(kDirections), std::end(kDirections));
  for (const float z : {1e-3f, 1e-6f, 1e-12f, 1e-30f, 0.0f, -0.0f, -1e-12f, -1e-3f}) {
    directions.push_back(normalize(Vec3(0.6f, -0.8f, z)));
    directions.push_back(normalize(Vec3(-0.6f, 0.8f, z)));
  }
  for (const NamedBsdf& named : extreme_bsdfs())
    for (const Vec3& wo : directions) {
      for (const float u : kEnds)
        for (const float v : kEnds)
          for (const float choice : kEnds) {
            const auto s = sample_bsdf(named.bsdf, wo, {u, v}, choice);
            if (!s) continue;
            EXPECT_TRUE(is_finite(s->wi) && is_finite(s->weight) && std::isfinite(s->pdf)) << at(named, wo);
            EXPECT_NEAR(length(s->wi), 1, 1e-5f) << at(named, wo);
            EXPECT_TRUE(s->weight.r >= 0 && s->weight.g >= 0 && s->weight.b >= 0) << at(named, wo);
            EXPECT_EQ((s->wi.z < 0) != (wo.z < 0), s->is_transmission()) << at(named, wo);
          }
      for (const Vec3& wi : directions) {
        const BsdfEval eval = eval_bsdf(named.bsdf, wo, wi);
        EXPECT_TRUE(is_finite(eval.f_cos) && !std::isnan(eval.pdf)) << at(named, wo) << ", to " << wi;
        EXPECT_TRUE(eval.f_cos.r >= 0 && eval.pdf >= 0) << at(named, wo) << ", to " << wi;
      }
    }
}

TEST(Bsdf, RadianceScalesWithTheSquaredIndex) {
  for (const NamedBsdf& named : all_bsdfs())
    for (const Vec3& wo : kDirections)
      for (const float choice : {0.01f, 0.5f, 0.99f}) {
        const auto radiance = sample_bsdf(named.bsdf, wo, {0.3f, 0.6f}, choice, TransportMode::radiance);
        const auto importance = sample_bsdf(named.bsdf, wo, {0.3f, 0.6f}, choice, TransportMode::importance);
        ASSERT_EQ(radiance.has_value(), importance.has_value()) << at(named, wo);
        if (!radiance) continue;
        const float scale = 1 / square(radiance->eta);  // 1 unless refracted
        EXPECT_TRUE(radiance->eta == 1 || radiance->is_transmission()) << at(named, wo);
        expect_near(radiance->weight, importance->weight * scale, 1e-6f, at(named, wo));
        const BsdfEval there = eval_bsdf(named.bsdf, wo, radiance->wi, TransportMode::radiance);
        const BsdfEval back = eval_bsdf(named.bsdf, wo, radiance->wi, TransportMode::importance);
        EXPECT_EQ(there.pdf, back.pdf) << at(named, wo);
        expect_near(there.f_cos, back.f_cos * scale, 1e-5f * (1 + there.f_cos.max()), at(named, wo));
      }
}

}  // namespace
}  // namespace etendue
