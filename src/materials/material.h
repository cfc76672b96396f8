#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "geometry/geometry.h"
#include "materials/bsdf.h"
#include "materials/texture.h"
#include "math/frame.h"
#include "scene/scene.h"

namespace etendue {

/// A material whose BSDF is the same everywhere.
struct UniformMaterial {
  Bsdf bsdf;
};
struct DiffuseMaterial {
  ColorSource reflectance;
};
struct ConductorMaterial {
  Spectrum eta, k;
  ColorSource reflectance;
  MicrofacetKind kind;
  FloatSource alpha_u, alpha_v;
};
struct SmoothConductorMaterial {
  Spectrum eta, k;
  ColorSource reflectance;
};
struct ThinGlassMaterial {
  ColorSource reflectance, transmittance;
  float ior;
};
struct RoughGlassMaterial {
  ColorSource reflectance, transmittance;
  float ior;
  MicrofacetKind kind;
  FloatSource alpha_u, alpha_v;
};
struct PlasticMaterial {
  ColorSource diffuse, specular;
  std::shared_ptr<const PlasticBoundary> boundary;
  bool nonlinear;
};
struct PrincipledMaterial {
  ColorSource base_color;
  FloatSource roughness, anisotropic, metallic, spec_trans, spec_tint, sheen, sheen_tint, flatness, clearcoat,
      clearcoat_gloss;
  PrincipledParameters fixed;  ///< what does not vary
};
struct PrincipledThinMaterial {
  ColorSource base_color;
  FloatSource roughness, anisotropic, spec_trans, eta, spec_tint, sheen, sheen_tint, flatness, diff_trans;
  PrincipledThinParameters fixed;
};
/// No boundary: light passes straight on.
struct NullMaterial {};
struct BlendMaterial {
  std::uint32_t first, second;
  FloatSource weight;  ///< of the second
};
struct MaskMaterial {
  std::uint32_t inner;
  FloatSource opacity;
};
struct TwoSidedMaterial {
  std::uint32_t front, back;
};
struct BumpMaterial {
  std::uint32_t inner;
  std::uint32_t height;  ///< texture
  float scale;
  scene::TiltHandling handling = {};
};
struct NormalMapMaterial {
  std::uint32_t inner;
  std::uint32_t normals;  ///< texture
  scene::TiltHandling handling = {};
};

/// What a surface is made of, compiled. Those that name others (blend, mask, …) do so by index into Materials.
struct Material {
  std::variant<UniformMaterial, DiffuseMaterial, ConductorMaterial, SmoothConductorMaterial, ThinGlassMaterial,
               RoughGlassMaterial, PlasticMaterial, PrincipledMaterial, PrincipledThinMaterial, NullMaterial,
               BlendMaterial, MaskMaterial, TwoSidedMaterial, BumpMaterial, NormalMapMaterial>
      surface;
  ColorSource emission = Spectrum(0);  ///< radiance leaving the front
  bool one_sided = false;              ///< black from behind
  bool needs_texture_point = false;    ///< scatter() looks at the texture coordinates
  bool needs_tangents = false;         ///< scatter() looks at the tangents
  bool may_pass = false;               ///< light may go straight through (null, mask, thin glass)
  bool gleams = false;                 ///< rough metal that is smooth enough to focus light
  bool specular = false;  ///< all light, or much, may be scattered into one direction (mirrors, smooth glass)
};
using Materials = std::vector<Material>;

/// Sets the flags `needs_…`, `may_pass`, `gleams` and `specular` of all materials from what they and those they name
/// are made of.
void resolve_needs(Materials& materials);

/// A surface point with all that materials may ask for.
struct MaterialPoint {
  SurfaceHit surface;
  TexturePoint texture;             ///< if the material needs_texture_point
  Parametrization parametrization;  ///< if it needs_tangents
};

/// What a surface does with light at one point, seen from `wo`. Directions are unit and in world space.
class Scattering {
 public:
  Scattering() = default;

  /// f(wo, wi) · |cos θi| and the density of sample(). Zero where only an interpolated or mapped normal would let light
  /// come from.
  BsdfEval eval(const Vec3& wi) const;
  /// Where light may come from; Lobe::straight for light that passes as if nothing were there.
  std::optional<BsdfSample> sample(Vec2 u, float choice, TransportMode mode = TransportMode::radiance) const;

  /// Where light comes from two directions only, a mirror's and a refracted one: the probability of the mirror's, which
  /// sample() takes for every `choice` below it.
  std::optional<float> reflection_probability() const {
    const auto* boundary = opacity_ == 1 ? std::get_if<DielectricBsdf>(&bsdf()) : nullptr;
    if (boundary == nullptr || boundary->boundary == Boundary::thin) return std::nullopt;
    return boundary->reflection_probability(wo_local_);
  }

  /// Whether it is rough metal that focuses light.
  bool gleams() const {
    const auto* metal = opacity_ == 1 && !mapped_ ? std::get_if<ConductorBsdf>(&bsdf()) : nullptr;
    return metal != nullptr && metal->gleams();
  }
  /// Density with which sample() would give `wo` if the surface were seen from `wi`.
  float reverse_pdf(const Vec3& wi) const { return eval_bsdf(bsdf(), frame_.to_local(wi), wo_local_).pdf * opacity_; }

  bool is_delta() const { return opacity_ == 0 || etendue::is_delta(bsdf()); }
  bool transmits() const { return etendue::transmits(bsdf()); }
  Spectrum albedo() const { return etendue::albedo(bsdf()) * opacity_; }
  /// Whether it looks the same from everywhere on the side that it is seen from.
  bool is_lambertian() const { return opacity_ == 1 && !mapped_ && std::holds_alternative<DiffuseBsdf>(bsdf()); }
  /// The same surface, if it is Lambertian, with a reflectance of 1.
  void whiten() {
    shared_ = nullptr;
    own_ = DiffuseBsdf{Spectrum(1)};
  }
  Gloss gloss() const { return etendue::gloss(bsdf()); }
  const Vec3& normal() const { return frame_.n; }
  /// Probability that the surface is there at all.
  float opacity() const { return opacity_; }
  /// Share of the light from behind that comes straight through: what Lobe::straight samples.
  Spectrum straight_through() const {
    return Spectrum(1 - opacity_) + etendue::straight_through(bsdf(), wo_local_) * opacity_;
  }

 private:
  friend class MaterialEvaluator;

  /// Whether all there is is the BSDF.
  bool is_plain() const { return opacity_ == 1 && bump_alpha2_ == 0; }
  bool is_consistent(const Vec3& wi, const Vec3& wi_local) const;
  float shadowing(const Vec3& wi) const;

  const Bsdf& bsdf() const { return shared_ != nullptr ? *shared_ : own_; }

  const Bsdf* shared_ = nullptr;  ///< the material's, if it is the same everywhere
  Bsdf own_ = BlackBsdf{};        ///< else that of this point
  Frame frame_;
  Vec3 geometric_normal_;
  Vec3 wo_, wo_local_;
  float opacity_ = 1;
  // Bump and normal maps: the normal that they tilted, and α² of the bumps that cast shadows (Estevez, Lecocq and
  // Stellios 2019).
  bool mapped_ = false;
  Vec3 unmapped_normal_;
  float bump_alpha2_ = 0;
};

/// How `materials[index]` scatters light at a point.
Scattering scatter(const Materials& materials, std::uint32_t index, const Textures& textures,
                   const MaterialPoint& point, const Vec3& wo);

}  // namespace etendue
