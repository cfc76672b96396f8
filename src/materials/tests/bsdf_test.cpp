#include "materials/bsdf.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "materials/fresnel.h"
#include "materials/tests/at_angle.h"
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
  double width = 1;       ///< of the narrowest lobe that is not a delta lobe
  bool symmetric = true;  ///< importance goes the way of radiance back
};

const PlasticBoundary kSmoothPlastic(1.49f), kSmoothDiamond(2.4f);
const PlasticBoundary kBeckmannPlastic(1.49f, {MicrofacetKind::beckmann, 0.1f});
const PlasticBoundary kGgxPlastic(1.9f, {MicrofacetKind::ggx, 0.3f});

const DiffuseBsdf kColoured{{0.2f, 0.5f, 0.8f}};
const MirrorBsdf kMirror{{0.9f, 0.5f, 0.1f}};
const DielectricBsdf kGlass{Spectrum(1), Spectrum(1), 1.5f};
const RoughDielectricBsdf kRoughGlass{Spectrum(1), Spectrum(1), 1.5f, {MicrofacetKind::beckmann, 0.3f}};
const PlasticBsdf kPlastic{{0.2f, 0.5f, 0.8f}, Spectrum(1), &kSmoothPlastic};

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

/// A part of the sphere with cells that resolve the BSDF's lobe there.
struct Part {
  SphereGrid grid;
  float side;  ///< the sign of z that belongs to it; 0: both

  bool contains(const Vec3& w) const { return side == 0 || w.z * side > 0; }
};

/// Mean direction in which light from `wo` goes on through the surface.
Vec3 transmitted_direction(const Bsdf& bsdf, const Vec3& wo) {
  Random random(7);
  Vec3 sum(0, 0, wo.z > 0 ? -1e-6f : 1e-6f);
  for (int i = 0; i < 1000; ++i) {
    const auto s = sample_bsdf(bsdf, wo, random.point(), random.value());
    if (s && s->is_transmission()) sum += s->wi;
  }
  return normalize(sum);
}

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

/// Share of the light that is scattered into directions for which `counts` holds, by sampling.
template <typename Predicate>
Spectrum furnace(const Bsdf& bsdf, const Vec3& wo, TransportMode mode, Predicate counts) {
  constexpr int kSide = 100, kCount = kSide * kSide;
  Random random(4);
  std::vector<float> choices(kCount);  // the lobe is chosen with evenly spread numbers, too
  for (int i = 0; i < kCount; ++i) choices[i] = (static_cast<float>(i) + 0.5f) / kCount;
  for (int i = kCount - 1; i > 0; --i)
    std::swap(choices[i], choices[static_cast<int>(random.value() * (static_cast<float>(i) + 1))]);
  double sum[3] = {};
  for (int i = 0; i < kCount; ++i) {
    const Vec2 jitter = random.point();
    const Vec2 u((static_cast<float>(i % kSide) + jitter.x) / kSide,
                 (static_cast<float>(i / kSide) + jitter.y) / kSide);
    const auto s =
        sample_bsdf(bsdf, wo, {std::min(u.x, kOneMinusEpsilon), std::min(u.y, kOneMinusEpsilon)}, choices[i], mode);
    if (!s || !counts(*s)) continue;
    for (int c = 0; c < 3; ++c) sum[c] += s->weight[c];
  }
  return {static_cast<float>(sum[0] / kCount), static_cast<float>(sum[1] / kCount),
          static_cast<float>(sum[2] / kCount)};
}

Spectrum furnace(const Bsdf& bsdf, const Vec3& wo, TransportMode mode) {
  return furnace(bsdf, wo, mode, [](const BsdfSample&) { return true; });
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
