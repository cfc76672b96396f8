#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "materials/bsdf.h"
#include "materials/tests/at_angle.h"
#include "testing/random.h"

/// What tests of BSDFs share.
namespace etendue {

inline const Spectrum kGoldEta(0.18f, 0.42f, 1.37f), kGoldK(3.42f, 2.35f, 1.77f), kPerfect(0), kAbsorbing(1);

inline const PlasticBoundary kSmoothPlastic(1.49f), kSmoothDiamond(2.4f);
inline const PlasticBoundary kBeckmannPlastic(1.49f, {MicrofacetKind::beckmann, 0.1f});
inline const PlasticBoundary kGgxPlastic(1.9f, {MicrofacetKind::ggx, 0.3f});

inline const DiffuseBsdf kColoured{{0.2f, 0.5f, 0.8f}};
inline const MirrorBsdf kMirror{{0.9f, 0.5f, 0.1f}};
inline const DielectricBsdf kGlass{Spectrum(1), Spectrum(1), 1.5f};
inline const RoughDielectricBsdf kRoughGlass{Spectrum(1), Spectrum(1), 1.5f, {MicrofacetKind::beckmann, 0.3f}};
inline const PlasticBsdf kPlastic{{0.2f, 0.5f, 0.8f}, Spectrum(1), &kSmoothPlastic};

/// From straight above to grazing, and from below.
inline const Vec3 kDirections[] = {{0, 0, 1},         at_angle(30, 40), at_angle(60, 200), at_angle(80, 100),
                                   at_angle(89, 300), at_angle(180, 0), at_angle(130, 70), at_angle(95, 10)};

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

inline Spectrum furnace(const Bsdf& bsdf, const Vec3& wo, TransportMode mode) {
  return furnace(bsdf, wo, mode, [](const BsdfSample&) { return true; });
}

/// Mean direction in which light from `wo` goes on through the surface.
inline Vec3 transmitted_direction(const Bsdf& bsdf, const Vec3& wo) {
  Random random(7);
  Vec3 sum(0, 0, wo.z > 0 ? -1e-6f : 1e-6f);
  for (int i = 0; i < 1000; ++i) {
    const auto s = sample_bsdf(bsdf, wo, random.point(), random.value());
    if (s && s->is_transmission()) sum += s->wi;
  }
  return normalize(sum);
}

inline void expect_near(const Spectrum& a, const Spectrum& b, float tolerance, const std::string& what) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << what;
}

}  // namespace etendue
