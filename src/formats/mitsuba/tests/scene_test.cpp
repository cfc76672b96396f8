#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "formats/mitsuba/tests/test_scene.h"

namespace etendue::mitsuba {
namespace {

using test::read;
using test::Reading;
using ::testing::HasSubstr;

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
  EXPECT_LT(length(a - b), tolerance) << a << " is not " << b;
}

const scene::SceneDescription& good(const Reading& reading) {
  EXPECT_FALSE(reading.failed) << reading.messages;
  EXPECT_EQ(reading.messages, "");
  return reading.scene;
}

/// A disk with this <bsdf>.
Reading read_bsdf(std::string_view bsdf) {
  return read(fmt::format("<shape type=\"disk\">{}</shape>", bsdf));
}

template <typename Surface>
Surface surface(const Reading& reading) {
  const scene::SceneDescription& scene = good(reading);
  const auto* found = std::get_if<Surface>(&scene.materials.at(scene.instances.at(0).material.index).surface);
  EXPECT_NE(found, nullptr);
  return found == nullptr ? Surface{} : *found;
}

bool one_sided(const Reading& reading) {
  return reading.scene.materials.at(reading.scene.instances.at(0).material.index).one_sided;
}

// ---- transforms ----------------------------------------------------------------------------------------------------

TEST(Transforms, StepsFollowEachOther) {
  const Reading reading = read(
      "<shape type=\"rectangle\"><transform name=\"to_world\"><translate x=\"1\"/><rotate z=\"1\" angle=\"90\"/><scale "
      "value=\"2\"/><matrix value=\"1 0 0 5  0 1 0 0  0 0 1 0  0 0 0 1\"/></transform></shape>");
  expect_near(good(reading).instances[0].to_world.point({0, 0, 0}), {5, 2, 0});
}

TEST(Transforms, CamerasLookAsTheyAreTold) {
  const Reading reading = read(
      "<sensor type=\"perspective\"><transform name=\"to_world\"><lookat origin=\"1 2 3\" target=\"1 2 -7\" up=\"0 1 "
      "0\"/></transform></sensor>");
  const Transform& t = good(reading).cameras.at(0).to_world;
  expect_near(t.origin, {1, 2, 3});
  expect_near(t.vector({0, 0, -1}), {0, 0, -1});
  expect_near(t.vector({1, 0, 0}), {1, 0, 0});
  expect_near(t.vector({0, 1, 0}), {0, 1, 0});
}

// ---- spectra -------------------------------------------------------------------------------------------------------

TEST(Colors, ConstantsOfSurfacesAndLights) {
  EXPECT_EQ(surface<scene::DiffuseMaterial>(
                read_bsdf("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.1, 0.2 0.3\"/></bsdf>"))
                .reflectance,
            scene::ColorInput(Spectrum(0.1f, 0.2f, 0.3f)));
  EXPECT_EQ(surface<scene::DiffuseMaterial>(
                read_bsdf("<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"0.5\"/></bsdf>"))
                .reflectance,
            scene::ColorInput(Spectrum(0.5f)));
  const auto radiance = [](std::string_view value) {
    const Reading reading = read(fmt::format("<emitter type=\"constant\">{}</emitter>", value));
    return std::get<scene::ConstantLight>(good(reading).lights.at(0).source).radiance;
  };
  EXPECT_EQ(radiance("<rgb name=\"radiance\" value=\"2\"/>"), Spectrum(2));
  EXPECT_EQ(radiance("<float name=\"radiance\" value=\"2\"/>"), Spectrum(2));
  EXPECT_EQ(radiance(""), Spectrum(1));
  const Spectrum tinted = radiance("<spectrum name=\"radiance\" value=\"2\"/>");  // equal energy is not Rec. 709 white
  EXPECT_NEAR(tinted.r, 2 * 1.2048f, 2e-3f);
  EXPECT_NEAR(tinted.g, 2 * 0.9483f, 2e-3f);
  EXPECT_NEAR(tinted.b, 2 * 0.9089f, 2e-3f);
  const Spectrum flat = radiance("<spectrum name=\"radiance\" value=\"360:2, 830:2\"/>");
  EXPECT_NEAR(flat.r, tinted.r, 1e-2f);
  EXPECT_NEAR(flat.b, tinted.b, 1e-2f);
  EXPECT_EQ(radiance("<spectrum name=\"radiance\" type=\"d65\"><float name=\"scale\" value=\"3\"/></spectrum>"),
            Spectrum(3));
}

TEST(Colors, ReflectancesStayInRange) {
  const Reading reading = read_bsdf("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"2 0.5 -1\"/></bsdf>");
  EXPECT_THAT(reading.messages, HasSubstr("is not in 0 … 1"));
  EXPECT_EQ(std::get<scene::DiffuseMaterial>(reading.scene.materials[0].surface).reflectance,
            scene::ColorInput(Spectrum(1, 0.5f, 0)));
}

// ---- materials -----------------------------------------------------------------------------------------------------

TEST(Materials, OpaqueOnesAreOneSided) {
  for (const char* type : {"diffuse", "conductor", "roughconductor", "plastic", "roughplastic"})
    EXPECT_TRUE(one_sided(read_bsdf(fmt::format("<bsdf type=\"{}\"/>", type)))) << type;
  for (const char* type : {"dielectric", "thindielectric", "roughdielectric", "principled", "principledthin", "null"})
    EXPECT_FALSE(one_sided(read_bsdf(fmt::format("<bsdf type=\"{}\"/>", type)))) << type;
  EXPECT_TRUE(one_sided(read("<shape type=\"disk\"/>")));
}

TEST(Materials, Indices) {
  EXPECT_FLOAT_EQ(surface<scene::GlassMaterial>(read_bsdf("<bsdf type=\"dielectric\"/>")).ior, 1.5046f / 1.000277f);
  EXPECT_FLOAT_EQ(surface<scene::GlassMaterial>(
                      read_bsdf("<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"Water\"/><float "
                                "name=\"ext_ior\" value=\"1\"/></bsdf>"))
                      .ior,
                  1.333f);
  EXPECT_FLOAT_EQ(surface<scene::PlasticMaterial>(read_bsdf("<bsdf type=\"plastic\"/>")).ior, 1.49f / 1.000277f);
  EXPECT_FLOAT_EQ(surface<scene::PrincipledMaterial>(read_bsdf("<bsdf type=\"principled\"/>")).eta, 1.5f);
  EXPECT_NEAR(surface<scene::PrincipledMaterial>(
                  read_bsdf("<bsdf type=\"principled\"><float name=\"specular\" value=\"1\"/></bsdf>"))
                  .eta,
              1.7890f, 1e-3f);
  EXPECT_THAT(read_bsdf("<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"watr\"/></bsdf>").messages,
              HasSubstr("did you mean \"water\"?"));
}

TEST(Materials, Metals) {
  const auto mirror = surface<scene::ConductorMaterial>(read_bsdf("<bsdf type=\"conductor\"/>"));
  EXPECT_EQ(mirror.eta, Spectrum(0));
  EXPECT_EQ(mirror.alpha_u, scene::FloatInput(0.0f));
  const auto gold = surface<scene::ConductorMaterial>(
      read_bsdf("<bsdf type=\"roughconductor\"><string name=\"material\" value=\"Au\"/><string name=\"distribution\" "
                "value=\"ggx\"/><float "
                "name=\"alpha_u\" value=\"0.2\"/><float name=\"alpha_v\" value=\"0.3\"/></bsdf>"));
  EXPECT_LT(gold.eta.r, gold.eta.b);
  EXPECT_EQ(gold.alpha_v, scene::FloatInput(0.3f));
  EXPECT_EQ(gold.distribution, scene::Microfacets::ggx);
  EXPECT_THAT(read_bsdf("<bsdf type=\"roughconductor\"><float name=\"alpha_u\" value=\"0.2\"/></bsdf>").messages,
              HasSubstr("alpha_v"));
}

TEST(Materials, OnesWithinOthers) {
  const Reading blend = read_bsdf(
      "<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.25\"/><bsdf type=\"diffuse\"/><bsdf "
      "type=\"conductor\"/></bsdf>");
  const auto mixed = surface<scene::BlendMaterial>(blend);
  EXPECT_TRUE(std::holds_alternative<scene::DiffuseMaterial>(blend.scene.materials[mixed.first.index].surface));
  EXPECT_TRUE(std::holds_alternative<scene::ConductorMaterial>(blend.scene.materials[mixed.second.index].surface));
  EXPECT_EQ(mixed.weight, scene::FloatInput(0.25f));

  const Reading both = read_bsdf("<bsdf type=\"twosided\"><bsdf type=\"diffuse\"/></bsdf>");
  surface<scene::DiffuseMaterial>(both);
  EXPECT_FALSE(one_sided(both));
  const auto sides =
      surface<scene::TwoSidedMaterial>(read_bsdf("<bsdf type=\"twosided\"><bsdf type=\"plastic\"/></bsdf>"));
  EXPECT_EQ(sides.front, sides.back);
  EXPECT_THAT(read_bsdf("<bsdf type=\"twosided\"><bsdf type=\"dielectric\"/></bsdf>").messages,
              HasSubstr("let nothing through"));
  EXPECT_THAT(read_bsdf("<bsdf type=\"mask\"/>").messages, HasSubstr("\"mask\" needs a <bsdf> in it"));
}

// ---- textures ------------------------------------------------------------------------------------------------------

TEST(Textures, PicturesStandOnTheirHeads) {
  const test::Folder folder;
  folder.add("a.png", "x");
  const Reading reading = test::read_text(
      "<scene version=\"3.0.0\"><shape type=\"disk\"><bsdf type=\"diffuse\"><texture type=\"bitmap\" "
      "name=\"reflectance\"><string "
      "name=\"filename\" value=\"a.png\"/><string name=\"wrap_mode\" value=\"clamp\"/><transform name=\"to_uv\"><scale "
      "x=\"2\" "
      "y=\"3\"/><translate x=\"0.5\" y=\"0.25\"/></transform></texture></bsdf></shape></scene>",
      folder.path() / "s.xml");
  const scene::Texture& texture = good(reading).textures.at(0);
  EXPECT_EQ(std::get<scene::BitmapTexture>(texture.source).wrap, scene::TextureWrap::clamp);
  // (u, v) = (0.1, 0.2) is (0.7, 0.85) in Mitsuba, from the top: 0.15 from the bottom.
  const scene::UvTransform& t = texture.to_uv;
  EXPECT_FLOAT_EQ(t.x[0] * 0.1f + t.y[0] * 0.2f + t.offset[0], 0.7f);
  EXPECT_FLOAT_EQ(t.x[1] * 0.1f + t.y[1] * 0.2f + t.offset[1], 0.15f);
}

TEST(Textures, CheckerboardsAsColoursAndAsNumbers) {
  const Reading reading = read_bsdf(
      "<bsdf type=\"principled\"><texture type=\"checkerboard\" name=\"base_color\" id=\"c\"><transform "
      "name=\"to_uv\"><scale x=\"4\" "
      "y=\"2\"/></transform></texture><ref id=\"c\" name=\"roughness\"/></bsdf>");
  const auto material = surface<scene::PrincipledMaterial>(reading);
  const auto& color = reading.scene.textures[std::get<scene::Id<scene::Texture>>(material.base_color).index];
  const auto& number = reading.scene.textures[std::get<scene::Id<scene::Texture>>(material.roughness).index];
  EXPECT_EQ(color.to_uv.x[0], 4);
  EXPECT_EQ(color.to_uv.y[1], 2);
  EXPECT_EQ(std::get<scene::CheckerboardTexture>(color.source).color0, scene::ColorInput(Spectrum(0.4f)));
  EXPECT_EQ(std::get<scene::CheckerboardTexture>(number.source).color0, scene::ColorInput(Spectrum(0.2f)));
}

// ---- emitters ------------------------------------------------------------------------------------------------------

TEST(Emitters, PlacesAndDirections) {
  const Reading reading = read(
      "<emitter type=\"point\"><point name=\"position\" x=\"1\" y=\"2\" z=\"3\"/><rgb name=\"intensity\" "
      "value=\"4\"/></emitter>"
      "<emitter type=\"directional\"><vector name=\"direction\" value=\"0,0,-2\"/></emitter>"
      "<emitter type=\"spot\"><transform name=\"to_world\"><lookat origin=\"0 3 0\" target=\"0 0 0\" up=\"0 0 "
      "1\"/></transform></emitter>"
      "<emitter type=\"projector\"><transform name=\"to_world\"><lookat origin=\"0 0 0\" target=\"0 0 1\" up=\"0 1 "
      "0\"/></transform></emitter>");
  const auto& lights = good(reading).lights;
  ASSERT_EQ(lights.size(), 4u);
  EXPECT_EQ(std::get<scene::PointLight>(lights[0].source).intensity, Spectrum(4));
  expect_near(lights[0].to_world.origin, {1, 2, 3});
  expect_near(lights[1].to_world.vector({0, 0, -1}), {0, 0, -1});
  const auto& spot = std::get<scene::SpotLight>(lights[2].source);
  EXPECT_FLOAT_EQ(spot.cutoff_deg, 20);
  EXPECT_FLOAT_EQ(spot.beam_deg.value(), 15);
  expect_near(lights[2].to_world.vector({0, 0, -1}), {0, -1, 0});
  expect_near(lights[2].to_world.vector({0, 1, 0}), {0, 0, -1});  // a spot's picture hangs upside down
  EXPECT_NEAR(std::get<scene::ProjectorLight>(lights[3].source).scale, kPi, 1e-5f);
  expect_near(lights[3].to_world.vector({0, 0, -1}), {0, 0, 1});
  expect_near(lights[3].to_world.vector({0, 1, 0}), {0, 1, 0});
}

TEST(Emitters, ShapesThatShine) {
  const Reading reading = read(
      "<shape type=\"rectangle\"><emitter type=\"area\"><rgb name=\"radiance\" value=\"1 2 3\"/></emitter></shape>"
      "<shape type=\"cube\"><bsdf type=\"diffuse\" id=\"d\"/><emitter type=\"area\"/></shape><shape type=\"disk\"><ref "
      "id=\"d\"/></shape>");
  const auto& scene = good(reading);
  const auto material = [&](int i) {
    return scene.materials[scene.instances[static_cast<std::size_t>(i)].material.index];
  };
  EXPECT_EQ(material(0).emission, scene::ColorInput(Spectrum(1, 2, 3)));
  EXPECT_TRUE(std::holds_alternative<scene::NoReflection>(material(0).surface));
  EXPECT_EQ(material(1).emission, scene::ColorInput(Spectrum(1)));
  EXPECT_TRUE(std::holds_alternative<scene::DiffuseMaterial>(material(1).surface));
  EXPECT_FALSE(scene::emits(material(2)));
}

// ---- sensors and integrators ---------------------------------------------------------------------------------------

float fov(std::string_view properties,
          std::string_view size = "<integer name=\"width\" value=\"200\"/><integer name=\"height\" value=\"100\"/>") {
  const Reading reading =
      read(fmt::format("<sensor type=\"perspective\">{}<film type=\"hdrfilm\">{}</film></sensor>", properties, size));
  return good(reading).cameras.at(0).xfov_deg;
}

TEST(Sensors, FieldsOfView) {
  const auto of = [](std::string_view axis) {
    return fov(fmt::format("<float name=\"fov\" value=\"90\"/><string name=\"fov_axis\" value=\"{}\"/>", axis));
  };
  const float wide = 2 * degrees(std::atan(2.0f));
  EXPECT_FLOAT_EQ(of("x"), 90);
  EXPECT_NEAR(of("y"), wide, 1e-3f);
  EXPECT_NEAR(of("smaller"), wide, 1e-3f);
  EXPECT_FLOAT_EQ(of("larger"), 90);
  EXPECT_NEAR(of("diagonal"), 2 * degrees(std::atan(2 / std::sqrt(5.0f))), 1e-3f);
  const float half_width = std::sqrt(36.0f * 36 + 24 * 24) / 100 * 2 / std::sqrt(5.0f);
  EXPECT_NEAR(fov(""), 2 * degrees(std::atan(half_width)), 1e-3f);
  EXPECT_NEAR(fov("<string name=\"focal_length\" value=\"50mm\"/>"), fov(""), 1e-5f);
}

TEST(Sensors, Films) {
  const Reading reading = read(
      "<sensor type=\"thinlens\"><float name=\"aperture_radius\" value=\"0.5\"/><float name=\"focus_distance\" "
      "value=\"4\"/><film "
      "type=\"hdrfilm\"><integer name=\"width\" value=\"64\"/><integer name=\"height\" value=\"32\"/><integer "
      "name=\"crop_offset_x\" "
      "value=\"8\"/><integer name=\"crop_width\" value=\"16\"/><rfilter type=\"mitchell\"><float name=\"B\" "
      "value=\"0.5\"/></rfilter></film>"
      "<sampler type=\"independent\"><integer name=\"sample_count\" value=\"9\"/></sampler></sensor><sensor "
      "type=\"perspective\"/>");
  const auto& scene = good(reading);
  const scene::Camera& lens = scene.cameras.at(0);
  EXPECT_EQ(lens.lens_radius, 0.5f);
  EXPECT_EQ(lens.focal_distance, 4);
  EXPECT_EQ(lens.film.crop, (std::array<int, 4>{8, 0, 16, 32}));
  EXPECT_EQ(lens.film.filter->kind, scene::FilterKind::mitchell);
  EXPECT_EQ(lens.film.filter->b, 0.5f);
  EXPECT_EQ(scene.hints.samples_per_pixel, 9);
  EXPECT_EQ(scene.cameras.at(1).film.width, 768);
  EXPECT_EQ(scene.cameras.at(1).film.filter->kind, scene::FilterKind::gaussian);
  EXPECT_EQ(scene.cameras.at(1).film.filter->radius, 2);
  EXPECT_THAT(read("<sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"width\" "
                   "value=\"2000000000\"/></film></sensor>")
                  .messages,
              HasSubstr("it needs to be in 1 … 65536"));
}

TEST(Sensors, MetersOnSurfaces) {
  const Reading reading = read(
      "<shape type=\"disk\"/><shape type=\"rectangle\"><sensor type=\"irradiancemeter\"><film "
      "type=\"hdrfilm\"><rfilter "
      "type=\"box\"/></film></sensor></shape>");
  const scene::Camera& camera = good(reading).cameras.at(0);
  EXPECT_EQ(camera.projection, scene::Projection::irradiance);
  EXPECT_EQ(camera.measured_shape, 1u);
}

TEST(Integrators, DepthsAreBounces) {
  const auto hints = [](std::string_view integrator) { return good(read(integrator)).hints; };
  const auto path = hints(
      "<integrator type=\"moment\"><integrator type=\"path\"><integer name=\"max_depth\" "
      "value=\"6\"/></integrator></integrator>");
  EXPECT_EQ(path.max_depth, 5);
  EXPECT_TRUE(path.null_counts_as_bounce);
  const auto volume =
      hints("<integrator type=\"volpathmis\"><boolean name=\"hide_emitters\" value=\"true\"/></integrator>");
  EXPECT_FALSE(volume.max_depth.has_value());
  EXPECT_FALSE(volume.null_counts_as_bounce);
  EXPECT_TRUE(volume.hide_emitters);
  EXPECT_EQ(hints("<integrator type=\"direct\"/>").max_depth, 1);
  EXPECT_THAT(read("<integrator type=\"bdpt\"/>").messages,
              HasSubstr("the integrator \"bdpt\" is not known here; \"path\" is used"));
}

TEST(Integrators, PathSeesNoMedia) {
  const auto scene_for = [](std::string_view integrator) {
    return read(
        fmt::format("<integrator type=\"{}\"/><shape type=\"sphere\"><medium type=\"homogeneous\" "
                    "name=\"interior\"/></shape><sensor type=\"perspective\"><medium "
                    "type=\"homogeneous\"/></sensor>",
                    integrator));
  };
  const Reading volume = scene_for("volpath");
  EXPECT_EQ(good(volume).media.size(), 2u);
  const Reading path = scene_for("path");
  EXPECT_THAT(path.messages, HasSubstr("this integrator sees no media"));
  EXPECT_TRUE(path.scene.media.empty());
  EXPECT_FALSE(path.scene.instances.at(0).separates_media || path.scene.instances.at(0).interior);
  EXPECT_FALSE(path.scene.cameras.at(0).medium);
}

// ---- shapes and media ----------------------------------------------------------------------------------------------

TEST(Shapes, CubesFaceOutwards) {
  for (const bool flip : {false, true}) {
    const Reading reading =
        read(fmt::format("<shape type=\"cube\"><boolean name=\"flip_normals\" value=\"{}\"/></shape>", flip));
    const scene::Mesh& mesh = good(reading).meshes.at(0);
    ASSERT_EQ(mesh.triangles.size(), 12u);
    double area = 0;
    for (const auto& t : mesh.triangles) {
      const Vec3 n = cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]);
      area += length(n) / 2;
      EXPECT_GT(dot(n, mesh.normals[t[0]]), 0);
      EXPECT_EQ(dot(n, mesh.positions[t[0]]) > 0, !flip);
    }
    EXPECT_NEAR(area, 24, 1e-4);
  }
}

TEST(Shapes, SpheresAndCylinders) {
  const Reading reading = read(
      "<shape type=\"sphere\"><point name=\"center\" value=\"1 2 3\"/><float name=\"radius\" value=\"2\"/><transform "
      "name=\"to_world\"><scale x=\"-1\"/></transform></shape><shape type=\"cylinder\"><point name=\"p0\" value=\"1 0 "
      "0\"/><point name=\"p1\" "
      "value=\"1 0 4\"/><float name=\"radius\" value=\"0.5\"/></shape>");
  const auto& instances = good(reading).instances;
  expect_near(instances[0].to_world.origin, {-1, 2, 3});
  EXPECT_TRUE(instances[0].flip_normals);
  EXPECT_FALSE(instances[1].flip_normals);
  expect_near(instances[1].to_world.point({0, 0, 1}), {1, 0, 4});
  EXPECT_NEAR(length(instances[1].to_world.vector({1, 0, 0})), 0.5f, 1e-6f);
}

TEST(Shapes, GroupsAreKeptOnce) {
  const Reading reading = read(
      "<shape type=\"shapegroup\" id=\"g\"><shape type=\"disk\"/></shape><shape type=\"shapegroup\" id=\"h\"><shape "
      "type=\"instance\"><ref "
      "id=\"g\"/></shape><shape type=\"instance\"><ref id=\"g\"/><transform name=\"to_world\"><translate "
      "x=\"2\"/></transform></shape></shape>"
      "<shape type=\"instance\"><ref id=\"h\"/></shape><shape type=\"instance\"><ref id=\"h\"/></shape>");
  const auto& scene = good(reading);
  EXPECT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.disks.size(), 1u);
  ASSERT_EQ(scene.groups.size(), 2u);
  EXPECT_EQ(scene.groups[1].instances.size(), 2u);
  EXPECT_EQ(scene.instances[0].shape, scene.instances[1].shape);
}

TEST(Media, ParametersAndBoundaries) {
  const Reading reading = read(
      "<medium type=\"homogeneous\" id=\"m\"><rgb name=\"sigma_t\" value=\"1 2 3\"/><float name=\"scale\" "
      "value=\"2\"/><phase "
      "type=\"hg\"/></medium><medium type=\"homogeneous\" id=\"n\"><rgb name=\"sigma_s\" value=\"1\"/><rgb "
      "name=\"sigma_a\" "
      "value=\"3\"/></medium><shape type=\"sphere\"><ref name=\"interior\" id=\"m\"/><ref name=\"exterior\" "
      "id=\"n\"/><bsdf "
      "type=\"null\"/></shape><shape type=\"sphere\"/>");
  const auto& scene = good(reading);
  ASSERT_EQ(scene.media.size(), 2u);
  EXPECT_EQ(scene.media[0].sigma_t, scene::VolumeInput(Spectrum(1, 2, 3)));
  EXPECT_EQ(scene.media[0].albedo, scene::VolumeInput(Spectrum(0.75f)));
  EXPECT_EQ(scene.media[0].scale, 2);
  EXPECT_FLOAT_EQ(std::get<scene::HenyeyGreensteinPhase>(scene.media[0].phase).g, 0.8f);
  EXPECT_EQ(scene.media[1].sigma_t, scene::VolumeInput(Spectrum(4)));
  EXPECT_EQ(scene.media[1].albedo, scene::VolumeInput(Spectrum(0.25f)));
  EXPECT_TRUE(scene.instances[0].separates_media);
  EXPECT_EQ(scene.instances[0].interior->index, 0u);
  EXPECT_EQ(scene.instances[0].exterior->index, 1u);
  EXPECT_FALSE(scene.instances[1].separates_media);
}

TEST(Media, HeterogeneousOnesEndWhereTheirExtinctionDoes) {
  const Reading reading = read(
      "<medium type=\"heterogeneous\" id=\"m\"><volume name=\"sigma_t\" type=\"constvolume\"><rgb name=\"value\" "
      "value=\"1 2 3\"/><transform name=\"to_world\"><scale value=\"2\"/></transform></volume></medium>"
      "<shape type=\"sphere\"><ref name=\"interior\" id=\"m\"/><bsdf type=\"null\"/></shape>");
  const auto& scene = good(reading);
  ASSERT_EQ(scene.media.size(), 1u);
  const auto id = std::get<scene::Id<scene::Volume>>(scene.media[0].sigma_t);
  EXPECT_EQ(scene.volumes[id.index].to_world.x, Vec3(2, 0, 0));
  const auto& grid = std::get<scene::GridVolume>(scene.volumes[id.index].source);
  EXPECT_EQ(grid.values, (std::vector<float>{1, 2, 3}));
}

TEST(Shapes, CurveFilesThatAreWrong) {
  const test::Folder folder;
  folder.add("short.txt", "0 0 0 1\n1 0 0 1\n\n");
  folder.add("word.txt", "0 0 zero 1\n");
  const auto outcome = [&](std::string_view file) {
    return test::read_text(
               fmt::format("<scene version=\"3.0.0\"><shape type=\"bsplinecurve\"><string name=\"filename\" "
                           "value=\"{}\"/></shape></scene>",
                           file),
               folder.path() / "s.xml")
        .messages;
  };
  EXPECT_THAT(outcome("short.txt"), HasSubstr("has 2 control points; it needs 4"));
  EXPECT_THAT(outcome("word.txt"), HasSubstr("word.txt:1: a control point is four numbers"));
  EXPECT_THAT(outcome("none.txt"), HasSubstr("there is no file \"none.txt\""));
}

}  // namespace
}  // namespace etendue::mitsuba
