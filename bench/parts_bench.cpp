// What the parts cost by themselves: random numbers, BSDFs, lights.

#include <benchmark/benchmark.h>

#include "lights/light.h"
#include "materials/bsdf.h"
#include "sampling/sampler.h"
#include "sampling/warp.h"

namespace etendue {
namespace {

constexpr int kBatch = 16;

/// Points of the unit square to feed the measured function with.
struct Points {
  float u[kBatch], v[kBatch];
  explicit Points(std::uint32_t first) { PixelSampler(SamplerKind::sobol, 0, 3, 4).points(0, first, kBatch, u, v); }
};

void bench_sampler(benchmark::State& state) {
  const PixelSampler sampler(static_cast<SamplerKind>(state.range(0)), 0, 7, 11);
  float u[kBatch], v[kBatch];
  std::uint32_t dimension = 0;
  for (auto _ : state) {
    sampler.points(dimension++, 0, kBatch, u, v);
    benchmark::DoNotOptimize(u);
    benchmark::DoNotOptimize(v);
  }
  state.SetItemsProcessed(state.iterations() * kBatch);
}
BENCHMARK(bench_sampler)
    ->ArgName("kind")
    ->Arg(static_cast<int>(SamplerKind::sobol))
    ->Arg(static_cast<int>(SamplerKind::independent));

template <typename T>
T make_bsdf();
template <>
DiffuseBsdf make_bsdf() {
  return {Spectrum(0.5f)};
}
template <>
DielectricBsdf make_bsdf() {
  return {Spectrum(1), Spectrum(1), 1.5f};
}
template <>
ConductorBsdf make_bsdf() {
  return {{0.2f, 0.9f, 1.1f}, {3.9f, 2.4f, 2.1f}, Spectrum(1), MicrofacetDistribution(MicrofacetKind::beckmann, 0.1f)};
}

template <typename T>
void bench_bsdf_sample(benchmark::State& state) {
  const Bsdf bsdf = make_bsdf<T>();
  const Vec3 wo = normalize(Vec3(0.4f, -0.2f, 0.7f));
  const Points p(0);
  for (auto _ : state)
    for (int i = 0; i < kBatch; ++i) benchmark::DoNotOptimize(sample_bsdf(bsdf, wo, {p.u[i], p.v[i]}, p.u[i]));
  state.SetItemsProcessed(state.iterations() * kBatch);
}
BENCHMARK(bench_bsdf_sample<DiffuseBsdf>);
BENCHMARK(bench_bsdf_sample<DielectricBsdf>);
BENCHMARK(bench_bsdf_sample<ConductorBsdf>);

void bench_light_sample(benchmark::State& state, const Light& light, const Point3& from) {
  const Points p(0);
  for (auto _ : state)
    for (int i = 0; i < kBatch; ++i) benchmark::DoNotOptimize(sample_light(light, 0, from, {p.u[i], p.v[i]}));
  state.SetItemsProcessed(state.iterations() * kBatch);
}

const Light kRectangle = RectangleLight{Rectangle({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}), Spectrum(1)};
BENCHMARK_CAPTURE(bench_light_sample, rectangle_by_solid_angle, kRectangle, Point3(0, 1, 0));
BENCHMARK_CAPTURE(bench_light_sample, rectangle_by_area, kRectangle, Point3(0, 9, 0));
BENCHMARK_CAPTURE(bench_light_sample, sphere, SphereLight{Point3(0), 1, Spectrum(1)}, Point3(0, 3, 0));

void bench_environment_sample(benchmark::State& state) {
  EnvironmentLight light;
  light.map = Image(1024, 512);
  for (int y = 0; y < 512; ++y)
    for (int x = 0; x < 1024; ++x) light.map.at(x, y) = Spectrum(x == 300 && y == 100 ? 5000.0f : 1.0f);
  light.distribution = TexelDistribution(lookup_means(light.map, light.orientation.rows()));
  bench_light_sample(state, light, Point3(0));
}
BENCHMARK(bench_environment_sample);

}  // namespace
}  // namespace etendue
