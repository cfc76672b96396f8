#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "base/uninitialized.h"
#include "render/branching.h"
#include "render/camera_chains.h"
#include "render/camera_rays.h"
#include "render/caustic_photons.h"
#include "render/direct_light.h"
#include "render/path_reuse.h"
#include "render/radiance_cache.h"
#include "render/vertex.h"

namespace etendue {

/// What all paths of a picture have in common.
struct PathCommons {
  static constexpr int kMostLooks = 8;

  const RenderScene::Data& scene;
  RenderSettings settings;
  CameraRays camera_rays;
  bool every_light = false;     ///< each vertex asks every light; else it asks one
  bool hemisphere = false;      ///< direct light by uniform directions
  bool chooses_lights = false;  ///< which one is asked depends on where the vertex is, and how it scatters
  bool splits = false;          ///< early vertices ask several lights, and the camera's paths branch at glass
  /// Directions that a path's first vertex takes to look for lights, and at least so many lights that it asks, if it is
  /// neither diffuse nor a mirror.
  int looks = 1;
  std::optional<CausticPhotons> photons = {};
  std::optional<CameraChains> camera_chains = {};
  float cell_side = 0;  ///< of the first generation's cells of the cache, in metres; 0: nothing is looked up
  std::optional<RadianceCache> cache = {};
};

/// Up to kBatch paths of one pixel, carried from bounce to bounce together, so that camera rays and shadow rays of the
/// same bounce travel as packets and random numbers are made in one go. Made for one call to an integrator's
/// estimate().
class PathBatch {
 public:
  /// `shared` is where the paths leave what others can use: one of each sample, or nothing. If there are `records`, the
  /// paths serve them alone: each fills its own from the first vertex on that the cache is looked up at.
  PathBatch(const PathCommons& common, int x, int y, std::uint32_t first, std::span<PixelSample> samples,
            std::span<SharedPath> shared, std::span<std::optional<RadianceRecord>> records = {});

  /// Follows all paths to their ends, once. Returns the number of rays traced.
  std::uint64_t run();

 private:
  static constexpr int kBatch = Geometry::kBatch;

  /// A path under way: the ray that leaves its last vertex, and what it is worth.
  struct Path {
    Ray ray;
    Spectrum throughput{1};
    float pdf_bsdf = 0;     ///< of the ray's direction; 0: only this ray finds what it meets (camera, delta lobe)
    Receiver scattered_at;  ///< where that direction was chosen, as far as the choice of lights looks at it: the ray's
                            ///< origin, or before surfaces that it passed straight through
    float eta_scale =
        1;          ///< product of eta² along the path: what refraction did to the throughput is no reason to end it
    int depth = 0;  ///< bounces so far
    bool from_camera = true;        ///< has not been scattered yet
    bool is_branch = false;         ///< of a camera's path that went both ways
    bool is_among_chains = true;    ///< CameraChains go that way too
    int scatterings = 0;            ///< by anything but delta lobes
    float bsdf_samples = 1;         ///< directions that looked for lights where it was scattered last
    float light_samples = 1;        ///< that the last of these vertices took of the lights
    SpecularChain chain;            ///< since the last vertex that looked for lights
    CausticPhotons::Gleam gleam;    ///< of its last vertex, for the ray's direction
    float caustics = 1;             ///< weight of the light that photons find as well, at that vertex and before it
    bool records_caustics = false;  ///< that weight is to be multiplied with that of whoever looks the record up

    /// How far it is on the way to something that its neighbours, or the cache, can use.
    enum class Sharing { seeks_first, left_first, shares, keeps, seeks_record, records };
    Sharing sharing = Sharing::keeps;
    float inverse_survival = 1;  ///< of the last roulette
    Spectrum prefix{1};          ///< while it shares: its throughput before, which `throughput` then starts anew after
  };
  /// A direction that only looks for a light.
  struct Look {
    int path;
    Path from;  ///< the path, if it went that way
  };

  void start();
  void follow(int first_bounce);
  bool branches_off(int i) const;
  std::optional<BsdfSample> branch_off(int i);
  bool leave(int i, Path& path, const BsdfSample& sample);
  bool take_up_branches();
  void intersect();
  void look_behind_lights(int bounce);
  void arrive(int bounce);
  void share();
  void weigh_caustics();
  void look_up();
  void gather_photons();
  void sample_lights(int bounce);
  void sample_chosen_lights(int bounce, std::uint32_t seeking, int samples);
  void sample_given_light(int bounce, std::uint32_t light, std::uint32_t seeking, int samples);
  void sample_hemisphere(int bounce);
  void leave_first(int i, const BsdfSample& sample);
  static float worth(const Path& path);
  void scatter(int bounce);

  /// Path i's vertex as far as the choice of lights looks at it.
  Receiver asking(int i) const {
    return common_.chooses_lights ? receiver(vertices_[i]) : Receiver{vertices_[i].surface.position};
  }
  float bsdf_weight(const Path& path, std::uint32_t light, std::uint32_t part, float pdf) const;
  float bsdf_weight(const Path& path, const Vertex& met) const;
  float gleam_weight(const Path& path, std::uint32_t light, float pdf) const;
  int bsdf_samples(int i) const;
  void look_for_lights(int bounce);
  void flush_looks(std::span<const Look> looks);
  void see_infinity();
  void see_emission(int i);
  /// How many samples path i's vertex takes of chosen lights, or of each light, for `path`, which is there.
  int light_samples(int i, const Path& path) const;
  /// Of path i's first among `samples` samples a path.
  std::uint64_t sample_number(int i, std::int64_t samples) const {
    return (std::uint64_t{first_} + static_cast<std::uint64_t>(i)) * static_cast<std::uint64_t>(samples);
  }
  void aim_at(std::uint32_t light);
  void aim(int i, std::uint32_t light, const LightSample& sample, float density);
  void flush_shadow_rays();
  Spectrum transmittance(Ray ray, int most_surfaces);
  /// How many surfaces a shadow ray of path i may pass straight through. Where passing is a bounce, light of no size is
  /// not found by it, as in Mitsuba's path tracer.
  int most_surfaces_passed(int i, bool is_delta) const {
    if (!common_.settings.null_counts_as_bounce) return kUnlimitedDepth;
    return is_delta ? 0 : common_.settings.max_depth - paths_[i].depth - 1;
  }
  Spectrum emission_along(Ray ray);
  /// What light found by path i is added to.
  Spectrum& radiance_of(int i) {
    if (paths_[i].sharing == Path::Sharing::records) return records_[i]->radiance;
    return paths_[i].sharing == Path::Sharing::shares ? shared_[i].radiance : samples_[i].radiance;
  }
  /// The same for what photons find as well.
  Spectrum& caustics_of(int i) { return paths_[i].records_caustics ? records_[i]->caustics : radiance_of(i); }
  bool counts_emission(const Path& path) const { return !common_.hemisphere || path.pdf_bsdf == 0; }
  /// Whether a path that goes straight on uses up nothing.
  bool may_pass_freely(const Vertex& vertex) const {
    return !common_.settings.null_counts_as_bounce && !vertex.scattering.straight_through().is_black();
  }
  /// Whether path i may be scattered once more. Passing straight on is another matter.
  bool may_bounce(int i) const { return paths_[i].depth < common_.settings.max_depth; }
  /// Whether path i looks for lights.
  bool seeks_lights(int i) const {
    return may_bounce(i) && !vertices_[i].scattering.is_delta() && paths_[i].sharing != Path::Sharing::seeks_record;
  }
  std::optional<RadianceRecord> record_at(int i) const;
  bool is_known(int i);

  const PathCommons& common_;
  const RenderScene::Data& scene_;
  PixelSampler sampler_;
  std::uint32_t first_;
  std::span<PixelSample> samples_;
  std::span<SharedPath> shared_;
  std::span<std::optional<RadianceRecord>> records_;
  int x_, y_;  ///< of the pixel
  int count_;
  std::uint64_t rays_ = 0;

  Path paths_[kBatch];
  UninitializedArray<Vertex, kBatch> vertices_;
  RayHit hits_[kBatch];
  int active_[kBatch];
  int active_count_ = 0;

  /// What is to be asked of one light, so that all its answers can be found together.
  struct Aims {
    int count = 0;
    int path[kBatch];
    Point3 from[kBatch];
    Vec2 u[kBatch];
    std::uint32_t part[kBatch];
    float density[kBatch];  ///< how many samples a vertex is expected to take of that part

    void add(int i, const Point3& lit, const Vec2& position, std::uint32_t which, float expected) {
      path[count] = i;
      from[count] = lit;
      u[count] = position;
      part[count] = which;
      density[count++] = expected;
    }
  };
  Aims aims_;

  UninitializedArray<Path, kBatch * kMostBranches> branches_;
  int branch_of_[kBatch * kMostBranches];  ///< which path they left
  int branch_count_ = 0;
  int branches_left_[kBatch];

  Ray shadow_rays_[kBatch];
  Spectrum shadow_radiance_[kBatch];
  int shadow_path_[kBatch];
  int shadow_may_pass_[kBatch];  ///< so many surfaces
  int shadow_count_ = 0;
};

}  // namespace etendue
