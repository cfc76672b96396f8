#include "materials/material.h"

#include <gtest/gtest.h>

#include <cmath>

namespace etendue {
namespace {

const Vec3 kUp(0, 0, 1);

MaterialPoint flat_point() {
  MaterialPoint point;
  point.surface = {Point3(0), kUp, kUp, 0};
  point.texture = {{0.25f, 0.25f}, Point3(0), nullptr, {}};
  point.parametrization.uv = point.texture.uv;
  point.parametrization.dp_du = {1, 0, 0};
  point.parametrization.dp_dv = {0, 1, 0};
  return point;
}

Vec3 direction(float theta, float phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

Material diffuse(float reflectance) {
  return {UniformMaterial{DiffuseBsdf{Spectrum(reflectance)}}};
}

Scattering scattering(Materials materials, const Vec3& wo, const Textures& textures = {},
                      const MaterialPoint& point = flat_point()) {
  resolve_needs(materials);
  return scatter(materials, 0, textures, point, wo);
}

/// ∫ f cos dω over the whole sphere, and the share that the mean of the samples' weights gives.
std::pair<double, double> albedo_both_ways(const Scattering& s) {
  constexpr int kTheta = 400, kPhi = 400;
  double integral = 0, sampled = 0;
  for (int i = 0; i < kTheta; ++i)
    for (int j = 0; j < kPhi; ++j) {
      const float theta = kPi * (static_cast<float>(i) + 0.5f) / kTheta,
                  phi = 2 * kPi * (static_cast<float>(j) + 0.5f) / kPhi;
      integral += s.eval(direction(theta, phi)).f_cos.g * std::sin(theta) * (kPi / kTheta) * (2 * kPi / kPhi);
      const auto sample = s.sample({(static_cast<float>(i) + 0.5f) / kTheta, (static_cast<float>(j) + 0.5f) / kPhi},
                                   (static_cast<float>((i * 7919 + j * 104729) % 10007) + 0.5f) / 10007);
      if (sample && sample->lobe != Lobe::straight) sampled += sample->weight.g / (kTheta * kPhi);
    }
  return {integral, sampled};
}

TEST(Material, DiffuseTakesItsColourFromConstantOrTexture) {
  const Textures textures = {BitmapTexture{Texels(Image(1, 1, Spectrum(0.7f)))}};
  EXPECT_EQ(scattering({diffuse(0.3f)}, kUp).albedo(), Spectrum(0.3f));
  EXPECT_NEAR(scattering({Material{DiffuseMaterial{std::uint32_t{0}}}}, kUp, textures).albedo().g, 0.7f, 1e-6);
}

TEST(Material, OneSidedIsBlackFromBehind) {
  Material front = diffuse(0.5f);
  front.one_sided = true;
  EXPECT_GT(scattering({front}, kUp).eval(kUp).f_cos.g, 0);
  EXPECT_EQ(scattering({front}, -kUp).eval(-kUp).f_cos.g, 0);
  EXPECT_GT(scattering({diffuse(0.5f)}, -kUp).eval(-kUp).f_cos.g, 0);
}

TEST(Material, TwoSidedShowsEachSideItsOwn) {
  Material red = diffuse(0.2f), blue = diffuse(0.8f);
  red.one_sided = blue.one_sided = true;
  const Materials materials = {Material{TwoSidedMaterial{1, 2}}, red, blue};
  EXPECT_NEAR(scattering(materials, kUp).eval(kUp).f_cos.g, 0.2f * kInvPi, 1e-6);
  EXPECT_NEAR(scattering(materials, -kUp).eval(-kUp).f_cos.g, 0.8f * kInvPi, 1e-6);
  EXPECT_EQ(scattering(materials, -kUp).eval(kUp).f_cos.g, 0);
}

TEST(Material, MaskDividesLightByItsOpacity) {
  const Materials materials = {Material{MaskMaterial{1, 0.3f}}, diffuse(0.5f)};
  const Scattering s = scattering(materials, kUp);
  EXPECT_NEAR(s.opacity(), 0.3f, 1e-6);
  const auto [integral, sampled] = albedo_both_ways(s);
  EXPECT_NEAR(integral, 0.15, 1e-3);
  EXPECT_NEAR(sampled, 0.15, 1e-3);
  const auto straight = s.sample({0.5f, 0.5f}, 0.31f);
  ASSERT_TRUE(straight && straight->lobe == Lobe::straight);
  EXPECT_EQ(straight->wi, -kUp);
  EXPECT_EQ(straight->weight, Spectrum(1));
}

TEST(Material, NullIsNotThere) {
  const Scattering s = scattering({Material{NullMaterial{}}}, kUp);
  EXPECT_EQ(s.opacity(), 0);
  EXPECT_TRUE(s.is_delta());
  EXPECT_EQ(s.sample({0.5f, 0.5f}, 0.0f)->lobe, Lobe::straight);
}

TEST(Material, BlendIsTheMeanOfBoth) {
  const Materials materials = {Material{BlendMaterial{1, 2, 0.25f}}, diffuse(0.8f), diffuse(0.4f)};
  EXPECT_NEAR(scattering(materials, kUp).eval(kUp).f_cos.g, (0.75f * 0.8f + 0.25f * 0.4f) * kInvPi, 1e-6);
}

TEST(Material, NeedsReachThroughEveryLayer) {
  Materials materials = {Material{MaskMaterial{1, 0.5f}}, Material{BumpMaterial{2, 0, 1}}, diffuse(0.5f),
                         Material{TwoSidedMaterial{0, 2}}};
  resolve_needs(materials);
  EXPECT_TRUE(materials[3].needs_tangents && materials[3].may_pass && materials[3].needs_texture_point);
  EXPECT_FALSE(materials[2].needs_tangents || materials[2].may_pass);
  EXPECT_FALSE(materials[1].may_pass);
}

/// A normal map of one colour, tilted towards +x by `angle`.
Textures tilted_map(float angle) {
  const Vec3 n = direction(angle, 0);
  return {BitmapTexture{Texels(Image(1, 1, Spectrum(0.5f * n.x + 0.5f, 0.5f * n.y + 0.5f, 0.5f * n.z + 0.5f)))}};
}

TEST(Material, NormalMapTiltsTheCosine) {
  const float tilt = 0.4f;
  const Materials materials = {Material{NormalMapMaterial{1, 0}}, diffuse(1)};
  const Scattering s = scattering(materials, kUp, tilted_map(tilt));
  EXPECT_NEAR(dot(s.normal(), direction(tilt, 0)), 1, 1e-5);
  // Along the untilted normal nothing is in the bumps' shadow.
  EXPECT_NEAR(s.eval(kUp).f_cos.g, std::cos(tilt) * kInvPi, 1e-5);
  EXPECT_EQ(s.eval(direction(1.5f, kPi)).f_cos.g, 0);  // above the surface, below the tilted one
  EXPECT_EQ(s.eval(direction(1.7f, 0)).f_cos.g, 0);    // the other way round
  const auto [integral, sampled] = albedo_both_ways(s);
  EXPECT_NEAR(integral, sampled, 2e-3);
  EXPECT_LT(integral, 1);
}

TEST(Material, NormalMapsThatTurnAwayAreTurnedBack) {
  const Vec3 wo = direction(1.4f, kPi);
  const Materials materials = {Material{NormalMapMaterial{1, 0}}, diffuse(1)};
  const Scattering s = scattering(materials, wo, tilted_map(0.5f));
  EXPECT_NEAR(dot(s.normal(), direction(0.5f, kPi)), 1, 1e-5);
}

TEST(Material, NormalMapsMayLeaveNormalsAndLightAlone) {
  const scene::TiltHandling alone{.turn_back = false, .cast_shadows = false};
  const Materials materials = {Material{NormalMapMaterial{1, 0, alone}}, diffuse(1)};
  EXPECT_NEAR(dot(scattering(materials, direction(1.4f, kPi), tilted_map(0.5f)).normal(), direction(0.5f, 0)), 1, 1e-5);
  const Vec3 grazing = direction(1.5f, 0);
  const Scattering s = scattering(materials, kUp, tilted_map(0.5f));
  EXPECT_NEAR(s.eval(grazing).f_cos.g, dot(grazing, direction(0.5f, 0)) * kInvPi, 1e-5);
  const Materials shadowed = {Material{NormalMapMaterial{1, 0}}, diffuse(1)};
  EXPECT_LT(scattering(shadowed, kUp, tilted_map(0.5f)).eval(grazing).f_cos.g, 0.9f * s.eval(grazing).f_cos.g);
}

/// Seen from behind, a tilted surface with two sides reflects as it does from the front.
TEST(Material, NormalMapsTiltTheBacksOfTwoSidedSurfaces) {
  const Materials materials = {Material{NormalMapMaterial{1, 0}}, Material{TwoSidedMaterial{2, 2}}, diffuse(1)};
  const Scattering front = scattering(materials, kUp, tilted_map(0.4f));
  const Scattering back = scattering(materials, -kUp, tilted_map(0.4f));
  for (const float angle : {0.0f, 0.7f, 1.2f}) {
    EXPECT_GT(front.eval(direction(angle, 0)).f_cos.g, 0);
    EXPECT_NEAR(back.eval(-direction(angle, 0)).f_cos.g, front.eval(direction(angle, 0)).f_cos.g, 1e-6);
  }
}

TEST(Material, BumpsFollowTheSlope) {
  Image ramp(64, 1);
  for (int x = 0; x < 64; ++x) ramp.at(x, 0) = Spectrum(static_cast<float>(x) / 64);  // slope 1 in u but for the seam
  const Textures textures = {BitmapTexture{Texels(ramp)}};
  const Materials materials = {Material{BumpMaterial{1, 0, 0.5f}}, diffuse(1)};
  const Scattering s = scattering(materials, kUp, textures);
  EXPECT_NEAR(dot(s.normal(), normalize(Vec3(-0.5f, 0, 1))), 1, 1e-4);
}

}  // namespace
}  // namespace etendue
