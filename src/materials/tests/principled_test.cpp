#include "materials/principled.h"

#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <type_traits>
#include <vector>

#include "materials/principled_thin.h"
#include "testing/random.h"
#include "testing/sphere_grid.h"

namespace etendue {
namespace {

static_assert(BsdfModel<PrincipledBsdf> && BsdfModel<PrincipledThinBsdf>);
static_assert(std::is_trivially_copyable_v<PrincipledBsdf> && sizeof(PrincipledBsdf) <= 120);
static_assert(std::is_trivially_copyable_v<PrincipledThinBsdf> && sizeof(PrincipledThinBsdf) <= 120);

// --- The formulas once more, in double precision and in the order of the papers --------------------------------------
// "2012" is Burley, "Physically Based Shading at Disney", "2015" is "Extending the Disney BRDF to a BSDF with
// Integrated Subsurface Scattering". Cosines keep their signs, microfacets point away from the inside.
namespace reference {

using Colour = Imath::V3d;  // of RGB

Vec3d exact(const Vec3& w) {
  return Vec3d(w.x, w.y, w.z).normalized();
}
Colour colour(const Spectrum& s) {
  return {s.r, s.g, s.b};
}
double fifth(double x) {
  return x * x * x * x * x;
}
double mix(double a, double b, double t) {
  return (1 - t) * a + t * b;
}
Colour mix(const Colour& a, const Colour& b, double t) {
  return a * (1 - t) + b * t;
}

Colour tint(const Colour& base) {
  const double y = 0.2126 * base.x + 0.7152 * base.y + 0.0722 * base.z;
  return y > 0 ? base / y : Colour(1);
}

/// A dielectric of index `eta` below the normal, seen at a cosine that is negative from below.
double fresnel(double cosine, double eta) {
  if (eta == 1) return 0;
  const double n1 = cosine > 0 ? 1 : eta, n2 = cosine > 0 ? eta : 1, c1 = std::abs(cosine);
  const double s2 = n1 / n2 * std::sqrt(1 - c1 * c1);
  if (s2 >= 1) return 1;
  const double c2 = std::sqrt(1 - s2 * s2);
  const double s = (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2), p = (n1 * c2 - n2 * c1) / (n1 * c2 + n2 * c1);
  return (s * s + p * p) / 2;
}

/// Schlick's approximation from above, with the angle in the thinner medium.
Colour schlick(const Colour& normal, double cosine, double eta) {
  double c = cosine;
  if (eta < 1) c = std::sqrt(std::max(0.0, 1 - (1 - cosine * cosine) / (eta * eta)));
  return normal + (Colour(1) - normal) * fifth(1 - std::clamp(c, 0.0, 1.0));
}

struct Ggx {
  double ax, ay;
  Ggx(double roughness, double anisotropic) {
    const double aspect = std::sqrt(1 - 0.9 * anisotropic);
    ax = std::max(0.001, roughness * roughness / aspect);
    ay = std::max(0.001, roughness * roughness * aspect);
  }
  double d(const Vec3d& m) const {
    const double e = m.x * m.x / (ax * ax) + m.y * m.y / (ay * ay) + m.z * m.z;
    return 1 / (std::numbers::pi * ax * ay * e * e);
  }
  double g(const Vec3d& w, const Vec3d& m) const {
    if (w.dot(m) * w.z <= 0) return 0;
    const double t2 = (ax * ax * w.x * w.x + ay * ay * w.y * w.y) / (w.z * w.z);
    return 2 / (1 + std::sqrt(1 + t2));
  }
};

/// Diffuse, retro-reflection, the imitation of subsurface scattering and sheen, times the cosine to the light.
Colour diffuse(const Vec3d& v, const Vec3d& l, const Colour& base, double roughness, double flatness, double weight,
               const Colour& sheen) {
  const Vec3d h = (v + l).normalized();
  const double d = h.dot(l), fl = fifth(1 - l.z), fv = fifth(1 - v.z);
  const double rr = 2 * roughness * d * d;
  const double lambert = (1 - fl / 2) * (1 - fv / 2), retro = rr * (fl + fv + fl * fv * (rr - 1));
  const double f90 = roughness * d * d;
  const double fss = mix(1, f90, fl) * mix(1, f90, fv);
  const double ss = 1.25 * (fss * (1 / (l.z + v.z) - 0.5) + 0.5);
  return (base * (weight / std::numbers::pi * mix(lambert + retro, ss, flatness)) + sheen * fifth(1 - d)) * l.z;
}

Colour principled(const PrincipledParameters& p, const Vec3d& v, const Vec3d& l, bool radiance) {
  const Colour base = colour(p.base_color);
  const double n = p.spec_trans > 0 && p.eta == 1 ? 1.001 : static_cast<double>(p.eta);
  const double metal = p.metallic, opaque = (1 - metal) * (1.0 - p.spec_trans), glass = (1 - metal) * p.spec_trans;
  const bool front = v.z > 0, same_side = v.z * l.z > 0;
  const double path = front ? n : 1 / n;
  Vec3d m = (same_side ? v + l : v + l * path).normalized();
  if (m.z < 0) m = -m;
  const double side = front ? 1 : -1, vm = v.dot(m), lm = l.dot(m), f = fresnel(vm, n);
  const Ggx ggx(p.roughness, p.anisotropic);
  const double dg = ggx.d(m) * ggx.g(v, m) * ggx.g(l, m);

  if (!same_side) {
    if (vm * side <= 0 || lm * side >= 0) return Colour(0);
    const double jacobian = std::abs(path * path * vm * lm / (v.z * (vm + path * lm) * (vm + path * lm)));
    const double scale = radiance ? 1 / (path * path) : 1;
    return Colour(std::sqrt(base.x), std::sqrt(base.y), std::sqrt(base.z)) * (glass * (1 - f) * dg * jacobian * scale);
  }
  if (!front) return Colour(glass * f * dg / (4 * std::abs(v.z)));
  Colour value(0);
  if (f > 0) {
    const Colour tinted = tint(base) * std::pow((n - 1) / (n + 1), 2);
    const Colour share = Colour((1 - metal) * (1.0 - p.spec_tint) * f) + schlick(base, vm, n) * metal +
                         schlick(tinted, vm, n) * ((1 - metal) * p.spec_tint);
    value += share * (dg / (4 * v.z));
  }
  if (p.clearcoat > 0) {
    const double a2 = std::pow(mix(0.1, 0.001, p.clearcoat_gloss), 2);
    const double d = (a2 - 1) / (std::numbers::pi * std::log(a2) * (1 + (a2 - 1) * m.z * m.z));
    Ggx shadow(0.5, 0);
    value += schlick(Colour(0.04), vm, n) * (0.25 * p.clearcoat * d * shadow.g(v, m) * shadow.g(l, m) * l.z);
  }
  const Colour sheen = mix(Colour(1), tint(base), p.sheen_tint) * (p.sheen * (1 - metal));
  return value + diffuse(v, l, base, p.roughness, p.flatness, opaque, sheen);
}

Colour thin(const PrincipledThinParameters& p, Vec3d v, Vec3d l) {
  const Colour base = colour(p.base_color);
  if (v.z < 0) v = -v, l = -l;
  const double glass = p.spec_trans, back = (1 - glass) * (1 - p.diff_trans / 2.0), n = p.eta;
  const Vec3d up(l.x, l.y, std::abs(l.z));
  const Vec3d m = (v + up).normalized();
  const double f = fresnel(v.dot(m), n);
  if (l.z < 0) {
    const Ggx ggx((0.65 * n - 0.35) * p.roughness, p.anisotropic);
    const Colour lambert = base * ((1 - glass) * p.diff_trans / 2.0 / std::numbers::pi * -l.z);
    return lambert + base * (glass * (1 - f) * ggx.d(m) * ggx.g(v, m) * ggx.g(l, m) / (4 * v.z));
  }
  const Ggx ggx(p.roughness, p.anisotropic);
  const Colour tinted = tint(base) * std::pow((n - 1) / (n + 1), 2);
  const Colour share = mix(Colour(f), schlick(tinted, v.dot(m), n), p.spec_tint);
  const Colour sheen = mix(Colour(1), tint(base), p.sheen_tint) * (p.sheen * back);
  return share * (glass * ggx.d(m) * ggx.g(v, m) * ggx.g(l, m) / (4 * v.z)) +
         diffuse(v, l, base, p.roughness, p.flatness, back, sheen);
}

}  // namespace reference

// --- What is tested --------------------------------------------------------------------------------------------------

struct Solid {
  std::string name;
  PrincipledParameters parameters;
  PrincipledBsdf bsdf{parameters};
  double narrowest = 1;  ///< least width of a lobe about the mirror direction

  Imath::V3d expected(const Vec3& wo, const Vec3& wi, TransportMode mode) const {
    return reference::principled(parameters, reference::exact(wo), reference::exact(wi),
                                 mode == TransportMode::radiance);
  }
};

struct Thin {
  std::string name;
  PrincipledThinParameters parameters;
  PrincipledThinBsdf bsdf{parameters};
  double narrowest = 1;

  Imath::V3d expected(const Vec3& wo, const Vec3& wi, TransportMode) const {
    return reference::thin(parameters, reference::exact(wo), reference::exact(wi));
  }
};

constexpr Spectrum kWhite(1), kOrange(0.9f, 0.5f, 0.1f), kBlack(0);

std::vector<Solid> solids() {
  std::vector<Solid> list;
  const auto add = [&](std::string name, const PrincipledParameters& p) {
    const double alpha = std::max(1e-3f, square(p.roughness) * std::sqrt(1 - 0.9f * p.anisotropic));
    const double coat = p.clearcoat > 0 ? lerp(p.clearcoat_gloss, 0.1f, 0.001f) : 1;
    list.push_back({std::move(name), p, PrincipledBsdf(p), std::min(alpha, coat)});
  };
  add("plain", {});
  add("flat, rough", {.base_color = kOrange, .roughness = 1, .flatness = 0.7f});
  add("tinted dielectric", {.base_color = kOrange, .roughness = 0.3f, .spec_tint = 0.8f, .eta = 1.8f});
  add("brushed metal", {.base_color = kOrange, .roughness = 0.4f, .anisotropic = 0.9f, .metallic = 1});
  add("half metal", {.base_color = kOrange, .roughness = 0.5f, .metallic = 0.6f, .spec_tint = 0.3f});
  add("velvet", {.base_color = kOrange, .roughness = 0.8f, .sheen = 1, .sheen_tint = 0.6f, .flatness = 0.3f});
  add("sheen on black", {.base_color = kBlack, .roughness = 0.6f, .spec_tint = 1, .sheen = 1, .sheen_tint = 1});
  add("car paint", {.base_color = kOrange, .roughness = 0.5f, .clearcoat = 1, .clearcoat_gloss = 0.2f});
  add("glossy coat on metal",
      {.base_color = kOrange, .roughness = 0.4f, .metallic = 0.7f, .clearcoat = 0.8f, .clearcoat_gloss = 1});
  add("frosted glass", {.base_color = kWhite, .roughness = 0.5f, .spec_trans = 1});
  add("orange glass", {.base_color = kOrange, .roughness = 0.3f, .anisotropic = 0.5f, .spec_trans = 1, .eta = 1.33f});
  add("half glass", {.base_color = kOrange, .roughness = 0.6f, .spec_trans = 0.5f, .spec_tint = 0.5f, .sheen = 0.4f});
  add("glass with sheen", {.base_color = kOrange, .roughness = 0.4f, .spec_trans = 1, .sheen = 0.8f});
  add("bubbles", {.base_color = kWhite, .roughness = 0.5f, .spec_trans = 0.8f, .eta = 0.7f});
  add("thin air",
      {.base_color = kOrange, .roughness = 0.5f, .metallic = 0.2f, .spec_tint = 0.5f, .clearcoat = 0.6f, .eta = 0.6f});
  add("no boundary", {.base_color = kOrange, .roughness = 0.5f, .metallic = 0.5f, .clearcoat = 0.5f, .eta = 1});
  add("hardly bending", {.base_color = kOrange, .roughness = 0.9f, .spec_trans = 0.7f, .eta = 1});
  add("metal that would be glass", {.base_color = kOrange, .roughness = 0.4f, .metallic = 1, .spec_trans = 1});
  add("everything", {.base_color = kOrange,
                     .roughness = 0.45f,
                     .anisotropic = 0.6f,
                     .metallic = 0.3f,
                     .spec_trans = 0.4f,
                     .spec_tint = 0.5f,
                     .sheen = 0.5f,
                     .sheen_tint = 0.5f,
                     .flatness = 0.5f,
                     .clearcoat = 0.5f,
                     .clearcoat_gloss = 0.5f,
                     .eta = 1.6f,
                     .main_specular_rate = 2,
                     .clearcoat_rate = 0.5f,
                     .diffuse_rate = 0.7f});
  add("smooth metal", {.base_color = kOrange, .roughness = 0, .metallic = 1});
  add("smooth plastic", {.base_color = kOrange, .roughness = 0.1f});
  return list;
}

std::vector<Thin> sheets() {
  std::vector<Thin> list;
  const auto add = [&](std::string name, const PrincipledThinParameters& p) {
    const double aspect = std::sqrt(1 - 0.9f * p.anisotropic), scaled = (0.65 * p.eta - 0.35) * p.roughness;
    const double alpha = p.spec_trans > 0 ? std::min<double>(square(p.roughness), scaled * scaled) * aspect : 1;
    list.push_back({std::move(name), p, PrincipledThinBsdf(p), std::max(alpha, 1e-3)});
  };
  add("paper", {});
  add("leaf", {.base_color = kOrange, .roughness = 0.7f, .diff_trans = 0.8f, .flatness = 0.4f});
  add("screen", {.base_color = kOrange, .diff_trans = 2});
  add("window", {.base_color = kWhite, .roughness = 0.5f, .spec_trans = 1});
  add("brushed window",
      {.base_color = kOrange, .roughness = 0.5f, .anisotropic = 0.8f, .spec_trans = 0.9f, .eta = 1.8f});
  add("tinted film",
      {.base_color = kOrange, .roughness = 0.4f, .spec_trans = 0.6f, .diff_trans = 0.5f, .spec_tint = 0.7f});
  add("velvet curtain", {.base_color = kOrange, .roughness = 0.8f, .diff_trans = 1.2f, .sheen = 1, .sheen_tint = 0.5f});
  add("sheen on black",
      {.base_color = kBlack, .roughness = 0.4f, .spec_trans = 0.5f, .spec_tint = 1, .sheen = 1, .sheen_tint = 1});
  add("void in water",
      {.base_color = kOrange, .roughness = 0.8f, .spec_trans = 0.7f, .diff_trans = 1, .eta = 0.8f, .spec_tint = 0.5f});
  add("no boundary", {.base_color = kOrange, .roughness = 0.8f, .spec_trans = 0.7f, .eta = 1, .spec_tint = 0.2f});
  add("everything", {.base_color = kOrange,
                     .roughness = 0.6f,
                     .anisotropic = 0.4f,
                     .spec_trans = 0.5f,
                     .diff_trans = 0.8f,
                     .eta = 1.4f,
                     .spec_tint = 0.4f,
                     .sheen = 0.6f,
                     .sheen_tint = 0.5f,
                     .flatness = 0.5f,
                     .specular_reflection_rate = 2,
                     .specular_transmission_rate = 0.5f,
                     .diffuse_rate = 0.7f,
                     .diffuse_transmission_rate = 1.5f});
  return list;
}

/// Both kinds of materials go through the same tests.
template <typename Test>
void for_each_material(const Test& test) {
  for (const Solid& solid : solids()) test(solid);
  for (const Thin& sheet : sheets()) test(sheet);
}

Vec3 at_angle(float theta_deg, float phi_deg) {
  const float theta = radians(theta_deg), phi = radians(phi_deg);
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

const Vec3 kDirections[] = {{0, 0, 1},         at_angle(30, 40), at_angle(60, 200), at_angle(80, 100),
                            at_angle(88, 300), at_angle(180, 0), at_angle(130, 70), at_angle(95, 10)};

std::string at(const std::string& name, const Vec3& wo) {
  return name + " from " + std::to_string(degrees(std::acos(wo.z))) + " degrees";
}

/// Index inside / outside by which light is bent: sheets do not.
float refractive_index(const Solid& solid) {
  return solid.parameters.eta == 1 ? 1.001f : solid.parameters.eta;
}
float refractive_index(const Thin&) {
  return 1;
}

/// Cells that resolve both sides' lobes. On wide ones the horizon, where scattering jumps, is not inside of cells.
class TwoSidedGrid {
 public:
  TwoSidedGrid(const auto& material, const Vec3& wo)
      : wo_(wo),
        reflection_(grid(material.narrowest, {-wo.x, -wo.y, wo.z})),
        transmission_(grid(refractive_index(material) == 1.001f ? 1e-3 : material.narrowest, -wo)) {}

  std::vector<double> integrals(const SphereGrid::Density& density, double tolerance) const {
    std::vector<double> out =
        reflection_.integrals([&](const Vec3& w) { return is_reflection(w) ? density(w) : 0.0; }, tolerance);
    const std::vector<double> more =
        transmission_.integrals([&](const Vec3& w) { return is_reflection(w) ? 0.0 : density(w); }, tolerance);
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }
  std::size_t cell(const Vec3& w) const {
    return is_reflection(w) ? reflection_.cell(w) : reflection_.size() + transmission_.cell(w);
  }

 private:
  static SphereGrid grid(double width, const Vec3& axis) {
    return width < 0.1 ? SphereGrid(axis, width, 12, 16) : SphereGrid({0, 0, 1}, 1, 12, 16);
  }
  bool is_reflection(const Vec3& w) const { return w.z * wo_.z > 0; }

  Vec3 wo_;
  SphereGrid reflection_, transmission_;
};

// --- Values ----------------------------------------------------------------------------------------------------------

/// Relative error of values: floats tell microfacets apart as well as their width, grazing angles and the bend allow.
double rounding(const auto& material, const Vec3& wo, const Vec3& wi) {
  const double bend = material.parameters.eta == 1 ? 1e-3 : 1;
  return 5e-4 + 1e-6 / (material.narrowest * std::min({std::abs(wo.z), std::abs(wi.z), static_cast<float>(bend)}));
}

TEST(Principled, ValuesAreThoseOfTheFormulas) {
  for_each_material([](const auto& material) {
    Random random(1);
    for (int i = 0; i < 400; ++i) {
      const Vec3 wo = random.direction();
      Vec3 wi = random.direction();
      if (i % 2 == 0) {  // where the lobes are
        const auto s = material.bsdf.sample(wo, random.point(), random.value(), TransportMode::radiance);
        if (s) wi = s->wi;
      }
      for (const TransportMode mode : {TransportMode::radiance, TransportMode::importance}) {
        const Spectrum f = material.bsdf.eval(wo, wi, mode).f_cos;
        const Imath::V3d expected = material.expected(wo, wi, mode);
        const double tolerance = rounding(material, wo, wi);
        for (int c = 0; c < 3; ++c)
          ASSERT_NEAR(f[c], expected[c], tolerance * expected[c] + 1e-7) << at(material.name, wo) << ", " << wi;
      }
    }
  });
}

TEST(Principled, OnlyGlassIsSeenFromInside) {
  for (const Solid& solid : solids()) {
    const bool glass = solid.parameters.spec_trans > 0 && solid.parameters.metallic < 1;
    EXPECT_EQ(solid.bsdf.transmits(), glass) << solid.name;
    EXPECT_EQ(solid.bsdf.sample(at_angle(130, 70), {0.4f, 0.3f}, 0.5f, TransportMode::radiance).has_value(), glass)
        << solid.name;
  }
}

TEST(Principled, SheetsLookTheSameFromBothSides) {
  Random random(2);
  for (const Thin& sheet : sheets())
    for (int i = 0; i < 100; ++i) {
      const Vec3 wo = random.direction(), wi = random.direction(), flip(1, 1, -1);
      const BsdfEval a = sheet.bsdf.eval(wo, wi, TransportMode::radiance);
      const BsdfEval b = sheet.bsdf.eval(wo * flip, wi * flip, TransportMode::radiance);
      EXPECT_EQ(a.f_cos, b.f_cos) << at(sheet.name, wo);
      EXPECT_EQ(a.pdf, b.pdf) << at(sheet.name, wo);
    }
}

TEST(Principled, IsReciprocal) {
  for_each_material([](const auto& material) {
    Random random(3);
    for (int i = 0; i < 500; ++i) {
      const Vec3 wo = random.direction(), wi = random.direction();
      if (std::abs(wo.z) < 1e-2f || std::abs(wi.z) < 1e-2f) continue;
      float scale = 1;  // f / η² is what is reciprocal (Veach 1997, section 5.2)
      if (wo.z * wi.z < 0) {
        const float eta = refractive_index(material);
        if (eta == 1 && material.parameters.spec_trans > 0) continue;  // Mitsuba's sheets of glass are not
        scale = wo.z > 0 ? square(eta) : 1 / square(eta);
      }
      const Spectrum there = material.bsdf.eval(wo, wi, TransportMode::importance).f_cos / std::abs(wi.z);
      const Spectrum back = material.bsdf.eval(wi, wo, TransportMode::importance).f_cos * (scale / std::abs(wo.z));
      const double tolerance = rounding(material, wo, wi);
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(there[c], back[c], tolerance * there[c] + 1e-6f) << at(material.name, wo);
    }
  });
}

TEST(Principled, WeightsOutOfRangeAreBroughtIntoIt) {
  const PrincipledBsdf bsdf({.base_color = {-1, 0.5f, 2}, .metallic = -3, .spec_trans = 7, .clearcoat = 9});
  const PrincipledBsdf brought({.base_color = {0, 0.5f, 2}, .metallic = 0, .spec_trans = 1, .clearcoat = 1});
  const Vec3 wo = at_angle(40, 10), wi = at_angle(30, 170);
  EXPECT_EQ(bsdf.eval(wo, wi, TransportMode::radiance).f_cos, brought.eval(wo, wi, TransportMode::radiance).f_cos);
}

// --- Sampling --------------------------------------------------------------------------------------------------------

TEST(Principled, SamplesFollowTheDensity) {
  constexpr int kCount = 40000;
  TestFamily family;
  for_each_material([&](const auto& material) {
    for (const Vec3& wo : kDirections) {
      const TwoSidedGrid grid(material, wo);
      std::vector<double> expected = grid.integrals(
          [&](const Vec3& wi) { return static_cast<double>(material.bsdf.eval(wo, wi, TransportMode::radiance).pdf); },
          1e-6);
      expected.push_back(std::max(0.0, 1 - std::accumulate(expected.begin(), expected.end(), 0.0)));  // no direction
      for (double& e : expected) e *= kCount;
      std::vector<double> observed(expected.size());
      Random random(4);
      for (int i = 0; i < kCount; ++i) {
        const auto s = material.bsdf.sample(wo, random.point(), random.value(), TransportMode::radiance);
        ++observed[s ? grid.cell(s->wi) : observed.size() - 1];
      }
      family.add(at(material.name, wo), chi_square_test(observed, expected).p);
    }
  });
  EXPECT_TRUE(family.holds());
}

TEST(Principled, SamplesAverageToTheIntegral) {
  TestFamily family;
  for_each_material([&](const auto& material) {
    for (const Vec3& wo : kDirections) {
      Random random(5);
      RunningMean mean;
      for (int i = 0; i < 20000; ++i) {
        const auto s = material.bsdf.sample(wo, random.point(), random.value(), TransportMode::importance);
        mean.add(s ? s->weight.g : 0.0);
      }
      const std::vector<double> cells =
          TwoSidedGrid(material, wo)
              .integrals(
                  [&](const Vec3& wi) {
                    return static_cast<double>(material.bsdf.eval(wo, wi, TransportMode::importance).f_cos.g);
                  },
                  1e-5);
      const double integral = std::accumulate(cells.begin(), cells.end(), 0.0);
      family.add(at(material.name, wo), mean.p_value(integral, 1e-3));
    }
  });
  EXPECT_TRUE(family.holds());
}

TEST(Principled, SampleAndEvaluationAgree) {
  for_each_material([](const auto& material) {
    Random random(6);
    for (const TransportMode mode : {TransportMode::radiance, TransportMode::importance})
      for (const Vec3& wo : kDirections)
        for (int i = 0; i < 300; ++i) {
          const auto s = material.bsdf.sample(wo, random.point(), random.value(), mode);
          if (!s) continue;
          ASSERT_NEAR(length(s->wi), 1, 1e-5f) << at(material.name, wo);
          ASSERT_GT(s->pdf, 0) << at(material.name, wo);
          ASSERT_EQ(s->is_transmission(), s->wi.z * wo.z < 0) << at(material.name, wo);
          ASSERT_FALSE(s->is_delta());
          const BsdfEval eval = material.bsdf.eval(wo, s->wi, mode);
          ASSERT_FLOAT_EQ(eval.pdf, s->pdf) << at(material.name, wo);
          for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(eval.f_cos[c], s->weight[c] * s->pdf, 1e-5f * eval.f_cos[c]) << at(material.name, wo);
          const float inside = refractive_index(material);
          ASSERT_FLOAT_EQ(s->eta, !s->is_transmission() ? 1 : wo.z > 0 ? inside : 1 / inside) << at(material.name, wo);
        }
  });
}

/// Share of the light that is scattered.
double scattered(const auto& bsdf, const Vec3& wo, TransportMode mode = TransportMode::importance) {
  Random random(7);
  RunningMean mean;
  for (int i = 0; i < 40000; ++i) {
    const auto s = bsdf.sample(wo, random.point(), random.value(), mode);
    mean.add(s ? s->weight.max() : 0.0);
  }
  return mean.mean();
}

TEST(Principled, GlassAndMetalScatterNoMoreThanArrives) {
  for (const float roughness : {0.0f, 0.1f, 0.4f, 0.7f, 1.0f})
    for (const Vec3& wo : kDirections) {
      const std::string what = at("roughness " + std::to_string(roughness), wo);
      const PrincipledBsdf metal({.base_color = kWhite, .roughness = roughness, .metallic = 1});
      const PrincipledBsdf glass({.base_color = kWhite, .roughness = roughness, .spec_trans = 1});
      const PrincipledThinBsdf window({.base_color = kWhite, .roughness = roughness, .spec_trans = 1});
      EXPECT_LE(scattered(metal, wo), 1 + 3e-3) << what;
      EXPECT_LE(scattered(glass, wo), 1 + 3e-3) << what;
      EXPECT_LE(scattered(window, wo), 1 + 3e-3) << what;
      if (roughness < 0.2f && std::abs(wo.z) > 0.4f) {  // and hardly less where nothing is shadowed
        EXPECT_GT(scattered(glass, wo), 0.99) << what;
        EXPECT_GT(scattered(window, wo), 0.99) << what;
        if (wo.z > 0) {
          EXPECT_GT(scattered(metal, wo), 0.99) << what;
        }
      }
    }
}

TEST(Principled, ZeroRatesDoNotSample) {
  const PrincipledBsdf gloss({.diffuse_rate = 0}), matte({.main_specular_rate = 0});
  Random random(8);
  for (int i = 0; i < 1000; ++i) {
    const Vec2 u = random.point();
    const float choice = random.value();
    const auto a = gloss.sample(kDirections[1], u, choice, TransportMode::radiance);
    EXPECT_TRUE(!a || a->lobe == Lobe::glossy);
    const auto b = matte.sample(kDirections[1], u, choice, TransportMode::radiance);
    EXPECT_TRUE(b && b->lobe == Lobe::diffuse);
  }
}

// --- The ends of all ranges ------------------------------------------------------------------------------------------

void expect_sane(const auto& bsdf, const std::string& name) {
  const float kEnds[] = {0, 0x1p-24f, 0.3f, kOneMinusEpsilon};
  std::vector<Vec3> directions(std::begin(kDirections), std::end(kDirections));
  for (const float z : {1e-3f, 1e-6f, 1e-20f, 1e-30f, 1e-44f, 0.0f, -1e-12f, -1e-3f}) {
    directions.push_back(normalize(Vec3(0.6f, -0.8f, z)));
    directions.push_back(normalize(Vec3(-0.6f, 0.8f, z)));
  }
  for (const Vec3& wo : directions) {
    for (const float u : kEnds)
      for (const float v : kEnds)
        for (const float choice : kEnds) {
          const auto s = bsdf.sample(wo, {u, v}, choice, TransportMode::radiance);
          if (!s) continue;
          ASSERT_TRUE(is_finite(s->wi) && is_finite(s->weight) && std::isfinite(s->pdf)) << at(name, wo);
          ASSERT_TRUE(s->weight.r >= 0 && s->weight.g >= 0 && s->weight.b >= 0) << at(name, wo);
          ASSERT_NEAR(length(s->wi), 1, 1e-5f) << at(name, wo);
        }
    for (const Vec3& wi : directions) {
      const BsdfEval eval = bsdf.eval(wo, wi, TransportMode::radiance);
      ASSERT_TRUE(is_finite(eval.f_cos) && std::isfinite(eval.pdf)) << at(name, wo) << ", to " << wi;
      ASSERT_TRUE(eval.f_cos.r >= 0 && eval.f_cos.g >= 0 && eval.f_cos.b >= 0 && eval.pdf >= 0)
          << at(name, wo) << ", to " << wi;
    }
  }
  ASSERT_TRUE(is_finite(bsdf.albedo())) << name;
}

TEST(Principled, NothingIsNanAtTheEnds) {
  for_each_material([](const auto& material) { expect_sane(material.bsdf, material.name); });
  for (const float eta : {0.1f, 0.999f, 1.0f, 1.0000001f, 1.001f, 1.5f, 10.0f})
    for (const float roughness : {0.0f, 1.0f})
      for (int bits = 0; bits < 32; ++bits) {
        const auto bit = [&](int i) { return (bits >> i & 1) != 0 ? 1.0f : 0.0f; };
        const std::string name = "eta " + std::to_string(eta) + ", roughness " + std::to_string(roughness) +
                                 ", corner " + std::to_string(bits);
        const Spectrum base = (bits & 16) != 0 ? Spectrum(bit(0) * 1e-40f) : kWhite;
        expect_sane(PrincipledBsdf({.base_color = base,
                                    .roughness = roughness,
                                    .anisotropic = bit(2),
                                    .metallic = bit(0),
                                    .spec_trans = bit(1),
                                    .spec_tint = bit(2),
                                    .sheen = bit(3),
                                    .sheen_tint = 1,
                                    .flatness = bit(3),
                                    .clearcoat = bit(3),
                                    .clearcoat_gloss = bit(2),
                                    .eta = eta}),
                    name);
        expect_sane(PrincipledThinBsdf({.base_color = base,
                                        .roughness = roughness,
                                        .anisotropic = bit(2),
                                        .spec_trans = bit(1),
                                        .diff_trans = 2 * bit(0),
                                        .eta = eta,
                                        .spec_tint = bit(2),
                                        .sheen = bit(3),
                                        .flatness = bit(3)}),
                    name);
      }
}

}  // namespace
}  // namespace etendue
