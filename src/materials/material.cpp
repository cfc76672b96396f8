#include "materials/material.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sampling/hash.h"

namespace etendue {
namespace {

/// What a material asks for by itself, without those that it names.
struct Needs {
  bool texture_point = false, tangents = false, passes = false, gleams = false, specular = false;
  std::vector<std::uint32_t> inner;
};

/// Collects what a material asks for.
struct NeedsFinder {
  Needs needs;
  void look(const ColorSource& s) { needs.texture_point |= std::holds_alternative<std::uint32_t>(s); }
  void look(const FloatSource& s) { needs.texture_point |= std::holds_alternative<std::uint32_t>(s); }
  template <typename... Sources>
  void look_at(const Sources&... sources) {
    (look(sources), ...);
  }
  void widths(const FloatSource& u, const FloatSource& v) {
    look_at(u, v);
    needs.tangents |= u != v;
  }
  /// Without texture and zero there is no direction to it.
  void anisotropy(const FloatSource& a) {
    look(a);
    needs.tangents |= a != FloatSource(0.0f);
  }

  void operator()(const UniformMaterial& m) {
    needs.passes = !straight_through(m.bsdf, {0, 0, 1}).is_black();
    const auto* glass = std::get_if<DielectricBsdf>(&m.bsdf);
    const auto* metal = std::get_if<ConductorBsdf>(&m.bsdf);
    needs.gleams = metal != nullptr && metal->gleams();
    needs.specular = std::holds_alternative<MirrorBsdf>(m.bsdf) || (glass != nullptr && !needs.passes);
  }
  void operator()(const DiffuseMaterial& m) { look(m.reflectance); }
  void operator()(const ConductorMaterial& m) {
    look(m.reflectance), widths(m.alpha_u, m.alpha_v), needs.gleams = true;
  }
  void operator()(const SmoothConductorMaterial& m) { look(m.reflectance), needs.specular = true; }
  void operator()(const ThinGlassMaterial& m) { look_at(m.reflectance, m.transmittance), needs.passes = true; }
  void operator()(const RoughGlassMaterial& m) {
    look_at(m.reflectance, m.transmittance), widths(m.alpha_u, m.alpha_v);
  }
  void operator()(const PlasticMaterial& m) { look_at(m.diffuse, m.specular); }
  void operator()(const PrincipledMaterial& m) {
    look_at(m.base_color, m.roughness, m.metallic, m.spec_trans, m.spec_tint, m.sheen, m.sheen_tint, m.flatness,
            m.clearcoat, m.clearcoat_gloss);
    anisotropy(m.anisotropic);
  }
  void operator()(const PrincipledThinMaterial& m) {
    look_at(m.base_color, m.roughness, m.spec_trans, m.eta, m.spec_tint, m.sheen, m.sheen_tint, m.flatness,
            m.diff_trans);
    anisotropy(m.anisotropic);
  }
  void operator()(const NullMaterial&) { needs.passes = true; }
  void operator()(const BlendMaterial& m) { look(m.weight), needs.inner = {m.first, m.second}; }
  void operator()(const MaskMaterial& m) { look(m.opacity), needs.passes = true, needs.inner = {m.inner}; }
  void operator()(const TwoSidedMaterial& m) { needs.inner = {m.front, m.back}; }
  void operator()(const BumpMaterial& m) { needs.texture_point = needs.tangents = true, needs.inner = {m.inner}; }
  void operator()(const NormalMapMaterial& m) { needs.texture_point = needs.tangents = true, needs.inner = {m.inner}; }
};

Needs own_needs(const Material& material) {
  NeedsFinder finder;
  std::visit(finder, material.surface);
  finder.look(material.emission);
  return finder.needs;
}

/// Pseudo-random number of a point, for choices that no sampler's dimension is kept for.
float hashed_choice(const Point3& p) {
  std::uint32_t hash = 0;
  for (int i = 0; i < 3; ++i) hash = hash_combine(hash, std::bit_cast<std::uint32_t>(p[i]));
  return to_unit_float(hash);
}

}  // namespace

void resolve_needs(Materials& materials) {
  std::vector<Needs> needs;
  for (const Material& material : materials) needs.push_back(own_needs(material));
  // A material's inner ones may stand before or behind it, nested to any depth: repeat until nothing changes.
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < materials.size(); ++i)
      for (const std::uint32_t inner : needs[i].inner) {
        const Needs before = needs[i];
        needs[i].texture_point |= needs[inner].texture_point;
        needs[i].tangents |= needs[inner].tangents;
        needs[i].passes |= needs[inner].passes;
        needs[i].gleams |= needs[inner].gleams;
        needs[i].specular |= needs[inner].specular;
        changed |= before.texture_point != needs[i].texture_point || before.tangents != needs[i].tangents ||
                   before.passes != needs[i].passes || before.gleams != needs[i].gleams ||
                   before.specular != needs[i].specular;
      }
  }
  for (std::size_t i = 0; i < materials.size(); ++i) {
    materials[i].needs_texture_point = needs[i].texture_point;
    materials[i].needs_tangents = needs[i].tangents;
    materials[i].may_pass = needs[i].passes;
    materials[i].gleams = needs[i].gleams;
    materials[i].specular = needs[i].specular;
  }
}

/// Works from the outermost material inwards, tilting the frame and thinning the surface on the way to a BSDF.
class MaterialEvaluator {
 public:
  MaterialEvaluator(const Materials& materials, const Textures& textures, const MaterialPoint& point, const Vec3& wo,
                    Scattering& out)
      : materials_(materials), textures_(textures), point_(point), out_(out) {
    out_.wo_ = wo;
    out_.geometric_normal_ = point.surface.geometric_normal;
  }

  void run(std::uint32_t index) {
    const Vec3 &ng = point_.surface.geometric_normal, &ns = point_.surface.shading_normal;
    // Where the interpolated normal turns away from a viewer who sees the front, only the true one makes sense.
    const bool consistent = dot(ns, out_.wo_) * dot(ng, out_.wo_) > 0;
    const Vec3& n = consistent ? ns : ng;
    out_.frame_ = materials_[index].needs_tangents ? Frame::from_normal_and_tangent(n, point_.parametrization.dp_du)
                                                   : Frame::from_normal(n);
    enter(index);
    out_.wo_local_ = out_.frame_.to_local(out_.wo_);
  }

 private:
  void enter(std::uint32_t index) {
    const Material& material = materials_[index];
    if (material.one_sided && dot(out_.wo_, out_.frame_.n) <= 0) return;
    if (const auto* uniform = std::get_if<UniformMaterial>(&material.surface))
      enter_surface(*uniform);
    else
      std::visit([&](const auto& surface) { enter_surface(surface); }, material.surface);
  }

  void enter_surface(const UniformMaterial& m) { out_.shared_ = &m.bsdf; }
  void enter_surface(const DiffuseMaterial& m) { out_.own_ = DiffuseBsdf{color(m.reflectance)}; }
  void enter_surface(const ConductorMaterial& m) {
    out_.own_ = ConductorBsdf{m.eta, m.k, color(m.reflectance),
                              MicrofacetDistribution(m.kind, number(m.alpha_u), number(m.alpha_v))};
  }
  void enter_surface(const SmoothConductorMaterial& m) { out_.own_ = MirrorBsdf{color(m.reflectance), m.eta, m.k}; }
  void enter_surface(const ThinGlassMaterial& m) {
    out_.own_ = DielectricBsdf{color(m.reflectance), color(m.transmittance), m.ior, Boundary::thin};
  }
  void enter_surface(const RoughGlassMaterial& m) {
    out_.own_ = RoughDielectricBsdf{color(m.reflectance), color(m.transmittance), m.ior,
                                    MicrofacetDistribution(m.kind, number(m.alpha_u), number(m.alpha_v))};
  }
  void enter_surface(const PlasticMaterial& m) {
    out_.own_ = PlasticBsdf{color(m.diffuse), color(m.specular), m.boundary.get(), m.nonlinear};
  }
  void enter_surface(const PrincipledMaterial& m) {
    PrincipledParameters p = m.fixed;
    p.base_color = color(m.base_color);
    p.roughness = number(m.roughness);
    p.anisotropic = number(m.anisotropic);
    p.metallic = number(m.metallic);
    p.spec_trans = number(m.spec_trans);
    p.spec_tint = number(m.spec_tint);
    p.sheen = number(m.sheen);
    p.sheen_tint = number(m.sheen_tint);
    p.flatness = number(m.flatness);
    p.clearcoat = number(m.clearcoat);
    p.clearcoat_gloss = number(m.clearcoat_gloss);
    out_.own_ = PrincipledBsdf(p);
  }
  void enter_surface(const PrincipledThinMaterial& m) {
    PrincipledThinParameters p = m.fixed;
    p.base_color = color(m.base_color);
    p.roughness = number(m.roughness);
    p.anisotropic = number(m.anisotropic);
    p.spec_trans = number(m.spec_trans);
    p.eta = number(m.eta);
    p.spec_tint = number(m.spec_tint);
    p.sheen = number(m.sheen);
    p.sheen_tint = number(m.sheen_tint);
    p.flatness = number(m.flatness);
    p.diff_trans = number(m.diff_trans);
    out_.own_ = PrincipledThinBsdf(p);
  }
  void enter_surface(const NullMaterial&) { out_.opacity_ = 0; }
  void enter_surface(const MaskMaterial& m) {
    out_.opacity_ *= std::clamp(number(m.opacity), 0.0f, 1.0f);
    enter(m.inner);
  }
  /// Seen from behind, the frame is mirrored.
  void enter_surface(const TwoSidedMaterial& m) {
    const bool from_behind = dot(out_.wo_, out_.frame_.n) < 0;
    if (from_behind) out_.frame_.n = -out_.frame_.n, out_.unmapped_normal_ = -out_.unmapped_normal_;
    enter(from_behind ? m.back : m.front);
  }
  void enter_surface(const BlendMaterial& m) {
    const float weight = std::clamp(number(m.weight), 0.0f, 1.0f);
    const Scattering before = out_;
    enter(m.first);
    const Scattering first = out_;
    out_ = before;
    enter(m.second);
    const std::optional<LeafBsdf> a = leaf(first.bsdf()), b = leaf(out_.bsdf());
    const bool alike =
        first.frame_.n == out_.frame_.n && first.opacity_ == out_.opacity_ && first.mapped_ == out_.mapped_;
    if (a && b && alike) {
      out_.own_ = BlendBsdf{*a, *b, weight};
      out_.shared_ = nullptr;
    } else if (hashed_choice(point_.surface.position) >=
               weight) {  // layers that have too little in common: one of the two
      out_ = first;
    }
  }
  /// The tangents follow the displaced surface p + n·h (Blinn 1978), whose normal is their cross product.
  void enter_surface(const BumpMaterial& m) {
    const Vec2 slope = luminance_gradient(textures_, m.height, point_.texture) * m.scale;
    const Vec3 &n = out_.frame_.n, &dp_du = point_.parametrization.dp_du, &dp_dv = point_.parametrization.dp_dv;
    const Vec3 du = dp_du + n * (slope.x - dot(n, dp_du)), dv = dp_dv + n * (slope.y - dot(n, dp_dv));
    Vec3 tilted = cross(du, dv);
    if (dot(tilted, n) < 0) tilted = -tilted;
    tilt(tilted, dp_du, m.handling);
    enter(m.inner);
  }
  void enter_surface(const NormalMapMaterial& m) {
    const Spectrum c = evaluate_texture(textures_, m.normals, point_.texture);
    tilt(out_.frame_.to_world({2 * c.r - 1, 2 * c.g - 1, 2 * c.b - 1}), out_.frame_.s, m.handling);
    enter(m.inner);
  }

  /// Replaces the frame by one about `normal` (any length, world).
  void tilt(const Vec3& normal, const Vec3& tangent, const scene::TiltHandling& handling) {
    const float l = length(normal);
    if (!(l > 0) || !std::isfinite(l)) return;
    const Vec3 old = out_.frame_.n;
    Vec3 n = normal * (1 / l);
    if (handling.turn_back && dot(old, out_.wo_) * dot(n, out_.wo_) <= 0) n = old * (2 * dot(n, old)) - n;
    out_.unmapped_normal_ = old;
    out_.mapped_ = true;
    out_.bump_alpha2_ = handling.cast_shadows ? shadow_alpha2(dot(n, old)) : 0;
    out_.frame_ = Frame::from_normal_and_tangent(n, tangent);
  }

  /// Of bumps whose normals are tilted by this cosine (Estevez, Lecocq and Stellios 2019, eq. 2).
  static float shadow_alpha2(float cosine) {
    const float cos2 = square(cosine);
    return cos2 > 0 ? std::min(0.125f * std::max(0.0f, 1 - cos2) / cos2, 1.0f) : 1.0f;
  }

  static std::optional<LeafBsdf> leaf(const Bsdf& bsdf) {
    return std::visit(
        [](const auto& b) -> std::optional<LeafBsdf> {
          if constexpr (std::is_same_v<std::decay_t<decltype(b)>, BlendBsdf>)
            return std::nullopt;
          else
            return b;
        },
        bsdf);
  }

  Spectrum color(const ColorSource& source) const { return evaluate_color(source, textures_, point_.texture); }
  float number(const FloatSource& source) const { return evaluate_float(source, textures_, point_.texture); }

  const Materials& materials_;
  const Textures& textures_;
  const MaterialPoint& point_;
  Scattering& out_;  // a few hundred bytes, filled in where they are needed
};

Scattering scatter(const Materials& materials, std::uint32_t index, const Textures& textures,
                   const MaterialPoint& point, const Vec3& wo) {
  Scattering out;
  MaterialEvaluator(materials, textures, point, wo, out).run(index);
  return out;
}

/// A direction that the shading frame takes for reflected must be so for the true surface, and for a mapped normal also
/// for the one it tilted: else light would leak through opaque surfaces. Transparent ones let it through anyway; there
/// nothing is gained by losing it.
bool Scattering::is_consistent(const Vec3& wi, const Vec3& wi_local) const {
  const bool same_side = wi_local.z * wo_local_.z > 0;
  if (!transmits() && (dot(wi, geometric_normal_) * dot(wo_, geometric_normal_) > 0) != same_side) return false;
  return !mapped_ || dot(wi, unmapped_normal_) * wi_local.z > 0;
}

/// Share of the light that the bumps' own shadows leave (Estevez, Lecocq and Stellios 2019, "A Microfacet-Based
/// Shadowing Function to Solve the Bump Terminator Problem", eq. 2 and 3), doubled: their G₁ is 1 for wi along the
/// untilted normal.
float Scattering::shadowing(const Vec3& wi) const {
  if (bump_alpha2_ == 0) return 1;
  const float cos2 = square(dot(wi, unmapped_normal_));
  if (!(cos2 > 0)) return 0;
  const float tan2 = std::max(0.0f, 1 - cos2) / cos2;
  return 2 / (1 + std::sqrt(1 + bump_alpha2_ * tan2));
}

BsdfEval Scattering::eval(const Vec3& wi) const {
  const Vec3 wi_local = frame_.to_local(wi);
  if (!is_consistent(wi, wi_local)) return {};
  if (is_plain()) return eval_bsdf(bsdf(), wo_local_, wi_local);
  BsdfEval eval = eval_bsdf(bsdf(), wo_local_, wi_local);
  eval.f_cos *= opacity_ * shadowing(wi);
  eval.pdf *= opacity_;
  return eval;
}

std::optional<BsdfSample> Scattering::sample(Vec2 u, float choice, TransportMode mode) const {
  if (opacity_ < 1) {
    if (choice >= opacity_) return BsdfSample{-wo_, Spectrum(1), 0, Lobe::straight, 1};
    choice = std::min(choice / opacity_, kOneMinusEpsilon);
  }
  std::optional<BsdfSample> sample = sample_bsdf(bsdf(), wo_local_, u, choice, mode);
  if (!sample) return std::nullopt;
  // Nearly of unit length: one of Newton's steps makes it so, or rounding would grow along chains of refractions.
  const Vec3 turned = frame_.to_world(sample->wi);
  const Vec3 wi = turned * (1.5f - 0.5f * length_squared(turned));
  if (!is_consistent(wi, sample->wi)) return std::nullopt;
  sample->wi = wi;
  if (is_plain()) return sample;
  sample->weight *= shadowing(wi);
  sample->pdf *= opacity_;
  return sample;
}

}  // namespace etendue
