#pragma once

#include "math/spectrum.h"

namespace etendue {

/// Share of unpolarised light that a smooth dielectric boundary reflects (Fresnel's equations; Pharr, Jakob, Humphreys
/// 2023, section 9.3.5). `cos_i` ≥ 0 on the side the light comes from; `eta` = index on the far side / index on this
/// side. 1 under total internal reflection.
float fresnel_dielectric(float cos_i, float eta);

/// Schlick's approximation (1994), with the cosine on the thinner side, so that it is the same from both sides and
/// reaches 1 where total internal reflection begins. Arguments as above.
float fresnel_schlick(float cos_i, float eta);

/// Share reflected by a metal of complex index eta + i·k against vacuum, per channel. `cos_i` ≥ 0.
Spectrum fresnel_conductor(float cos_i, const Spectrum& eta, const Spectrum& k);

}  // namespace etendue
