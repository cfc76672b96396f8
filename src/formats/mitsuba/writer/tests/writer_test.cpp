#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "formats/formats.h"
#include "formats/mitsuba/tests/test_scene.h"
#include "formats/mitsuba/writer/scene_writer.h"
#include "formats/mitsuba/writer/sky_pictures.h"
#include "formats/mitsuba/writer/tests/scene_text.h"
#include "formats/volume_file.h"
#include "image/io.h"

namespace etendue::mitsuba {
namespace {

namespace fs = std::filesystem;
using test::first_difference;
using test::text_of;
using ::testing::HasSubstr;

/// What writing a description and reading it again gives.
struct Copy {
  scene::SceneDescription scene;
  std::string told_writing, told_reading;
  std::string xml;
};

std::string messages(const Diagnostics& diagnostics) {
  std::string text;
  for (const Diagnostic& d : diagnostics.all())
    if (d.severity != Severity::info) text += diagnostics.format(d) + "\n";
  return text;
}

std::string content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

Copy copy(const scene::SceneDescription& scene, const fs::path& file) {
  Copy result;
  Diagnostics writing, reading;
  write_file(file, scene, writing);
  result.told_writing = messages(writing);
  result.xml = content(file);
  result.scene = read_scene(file, reading);
  result.told_reading = messages(reading);
  return result;
}

/// The same, in silence.
scene::SceneDescription silent_copy(const scene::SceneDescription& scene, const fs::path& file) {
  Copy result = copy(scene, file);
  EXPECT_EQ(result.told_writing, "");
  EXPECT_EQ(result.told_reading, "") << result.xml;
  return std::move(result.scene);
}

constexpr const char* kPly = R"(ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property float nx
property float ny
property float nz
property float u
property float v
property float r
property float g
property float b
property float weight_0
element face 2
property list uchar int vertex_indices
property float tint_x
property float tint_y
property float tint_z
end_header
0 0 0 0 0 1 0 0 0.1 0.2 0.3 4
1 0 0 0 0 1 1 0 0.4 0.5 0.6 5
1 1 0.1 0 0 1 1 1 0.7 0.8 0.9 6
0 1 0 0 1 0 0.25 1 0.15 0.25 0.35 7
3 0 1 2 1 2 3
3 0 2 3 4 5 6
)";

/// One of everything that a Mitsuba scene can say and we understand, nothing as it is by default.
constexpr const char* kEverything = R"(<scene version="3.0.0">
<integrator type="volpath"><integer name="max_depth" value="7"/><boolean name="hide_emitters" value="true"/>
  </integrator>
<sensor type="thinlens" id="my \$camera">
  <transform name="to_world"><lookat origin="1 2 3" target="0.3 0.1 0" up="0 1 0"/></transform>
  <float name="fov" value="37.5"/><float name="near_clip" value="0.125"/><float name="far_clip" value="123.4"/>
  <float name="aperture_radius" value="0.07"/><float name="focus_distance" value="3.3"/>
  <sampler type="independent"><integer name="sample_count" value="17"/></sampler>
  <film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="48"/>
    <integer name="crop_offset_x" value="3"/><integer name="crop_offset_y" value="4"/>
    <integer name="crop_width" value="20"/><integer name="crop_height" value="10"/>
    <rfilter type="mitchell"><float name="B" value="0.4"/><float name="C" value="0.3"/></rfilter></film>
  <ref id="haze"/>
</sensor>

<texture type="bitmap" id="picture"><string name="filename" value="a &amp; \$b.png"/>
  <string name="wrap_mode" value="mirror"/>
  <string name="filter_type" value="nearest"/><boolean name="raw" value="true"/>
  <transform name="to_uv"><scale x="2" y="3"/><rotate z="1" angle="30"/><translate x="0.1" y="0.7"/></transform>
  </texture>
<texture type="bitmap" id="clamped"><string name="filename" value="a &amp; \$b.png"/>
  <string name="wrap_mode" value="clamp"/></texture>
<texture type="checkerboard" id="board"><rgb name="color0" value="0.1 0.2 0.3"/><ref name="color1" id="clamped"/>
  <transform name="to_uv"><scale x="10" y="20"/></transform></texture>
<texture type="mesh_attribute" id="paint"><string name="name" value="vertex_color"/><float name="scale" value="0.5"/>
  </texture>
<volume type="gridvolume" id="grid"><string name="filename" value="grid.vol"/><string name="wrap_mode" value="repeat"/>
  <string name="filter_type" value="nearest"/><transform name="to_world"><translate x="-0.5"/>
  <rotate y="1" angle="20"/></transform></volume>
<texture type="volume" id="in space"><ref name="volume" id="grid"/></texture>
<medium type="homogeneous" id="haze"><rgb name="sigma_t" value="1.5 2 2.5"/><rgb name="albedo" value="0.9 0.8 0.7"/>
  <float name="scale" value="0.1"/><phase type="hg"><float name="g" value="-0.3"/></phase></medium>
<medium type="heterogeneous" id="smoke"><ref name="sigma_t" id="grid"/><float name="albedo" value="0.3"/></medium>

<bsdf type="plastic" id="glow"><rgb name="diffuse_reflectance" value="0.2 0.3 0.4"/>
  <spectrum name="specular_reflectance" type="srgb"><rgb name="color" value="1.5 1 0.5"/></spectrum></bsdf>
<bsdf type="diffuse" id="grey"><rgb name="reflectance" value="0.123456789 0.2 0.3"/></bsdf>
<bsdf type="conductor" id="gold"><string name="material" value="Au"/><ref name="specular_reflectance" id="board"/>
  </bsdf>

<emitter type="point" id="p"><point name="position" x="1" y="2" z="-0.1"/><rgb name="intensity" value="1 2 3"/>
  </emitter>
<emitter type="spot"><transform name="to_world"><lookat origin="1 1 1" target="0 0.5 0" up="0 0 1"/></transform>
  <rgb name="intensity" value="4 5 6"/><float name="cutoff_angle" value="33"/><float name="beam_width" value="11"/>
  <ref name="texture" id="picture"/></emitter>
<emitter type="projector"><transform name="to_world"><lookat origin="3 1 1" target="0 0.5 0" up="0 0 1"/></transform>
  <ref name="irradiance" id="board"/><float name="scale" value="2"/><float name="fov" value="21"/></emitter>
<emitter type="directional"><vector name="direction" x="1" y="-2" z="0.3"/><rgb name="irradiance" value="7 8 9"/>
  </emitter>
<emitter type="envmap"><string name="filename" value="sky.exr"/><float name="scale" value="0.7"/>
  <transform name="to_world"><rotate x="1" angle="90"/><rotate z="1" angle="25"/></transform></emitter>

<shape type="ply" id="mesh"><string name="filename" value="mesh.ply"/>
  <transform name="to_world"><scale x="-1" y="2" z="3"/><translate x="0.1"/></transform>
  <bsdf type="twosided"><ref id="grey"/></bsdf></shape>
<shape type="ply"><string name="filename" value="mesh.ply"/><boolean name="face_normals" value="true"/>
  <bsdf type="diffuse"><ref name="reflectance" id="paint"/></bsdf></shape>
<shape type="ply"><string name="filename" value="mesh.ply"/><boolean name="flip_normals" value="true"/>
  <bsdf type="diffuse"><ref name="reflectance" id="in space"/></bsdf></shape>
<shape type="rectangle"><ref id="grey"/><emitter type="area"><ref name="radiance" id="picture"/></emitter></shape>
<shape type="cube"><boolean name="flip_normals" value="true"/><ref id="gold"/></shape>
<shape type="sphere"><float name="radius" value="0.3"/><point name="center" x="1" y="2" z="3"/>
  <ref name="interior" id="smoke"/>
  <transform name="to_world"><rotate x="1" y="2" angle="40"/><scale value="1.7"/></transform>
  <bsdf type="null"/></shape>
<shape type="sphere"><boolean name="flip_normals" value="true"/><ref name="exterior" id="haze"/>
  <ref name="interior" id="smoke"/>
  <bsdf type="dielectric"><float name="int_ior" value="1.3"/><rgb name="specular_reflectance" value="0.5 0.6 0.7"/>
  <rgb name="specular_transmittance" value="0.8 0.7 0.6"/></bsdf></shape>
<shape type="sphere"><transform name="to_world"><scale x="-1"/></transform><emitter type="area">
  <rgb name="radiance" value="9 8 7"/></emitter></shape>
<shape type="disk"><boolean name="flip_normals" value="true"/><transform name="to_world"><scale x="2"/></transform>
  <bsdf type="thindielectric"><float name="int_ior" value="1.7"/><ref name="specular_reflectance" id="picture"/>
  </bsdf></shape>
<shape type="cylinder"><point name="p0" x="1" y="0" z="0"/><point name="p1" x="1" y="3" z="1"/>
  <float name="radius" value="0.4"/>
  <bsdf type="roughdielectric"><float name="alpha_u" value="0.2"/><ref name="alpha_v" id="board"/>
    <string name="distribution" value="ggx"/></bsdf></shape>
<shape type="cylinder"><transform name="to_world"><scale z="-2"/></transform>
  <bsdf type="roughconductor"><rgb name="eta" value="1.1 1.2 1.3"/><rgb name="k" value="5 6 7"/>
  <float name="alpha" value="0.25"/></bsdf></shape>
<shape type="bsplinecurve"><string name="filename" value="hair.txt"/>
  <bsdf type="plastic"><float name="int_ior" value="1.6"/><boolean name="nonlinear" value="true"/>
  <ref name="diffuse_reflectance" id="board"/></bsdf></shape>
<shape type="linearcurve"><string name="filename" value="hair.txt"/><transform name="to_world"><scale value="2"/>
  </transform>
  <bsdf type="roughplastic"><float name="alpha" value="0.3"/><string name="distribution" value="ggx"/>
  <rgb name="specular_reflectance" value="0.9 0.8 0.7"/></bsdf></shape>
<shape type="shapegroup" id="pair"><shape type="disk"><ref id="grey"/></shape>
  <shape type="sphere"><transform name="to_world"><translate y="3"/></transform>
  <bsdf type="mask"><ref name="opacity" id="picture"/><bsdf type="twosided"><ref id="gold"/><ref id="grey"/></bsdf>
  </bsdf></shape></shape>
<shape type="instance"><ref id="pair"/><transform name="to_world"><translate z="5"/></transform></shape>
<shape type="instance"><ref id="pair"/><transform name="to_world"><scale x="2" y="2" z="-2"/></transform></shape>
<shape type="disk"><bsdf type="blendbsdf"><ref name="weight" id="board"/><ref id="gold"/><ref id="grey"/></bsdf></shape>
<shape type="disk"><ref id="glow"/></shape>
<shape type="disk"><bsdf type="bumpmap"><ref id="board"/><float name="scale" value="0.2"/><ref id="grey"/>
<boolean name="use_shadowing_function" value="false"/></bsdf>
  </shape>
<shape type="disk"><bsdf type="normalmap"><ref name="normalmap" id="picture"/><ref id="gold"/>
<boolean name="flip_invalid_normals" value="false"/></bsdf></shape>
<shape type="disk"><bsdf type="principled"><rgb name="base_color" value="0.9 0.1 0.2"/>
  <float name="roughness" value="0.31"/>
  <float name="anisotropic" value="0.32"/><float name="metallic" value="0.33"/><float name="spec_trans" value="0.34"/>
  <float name="spec_tint" value="0.35"/><float name="sheen" value="0.36"/><float name="sheen_tint" value="0.37"/>
  <float name="flatness" value="0.38"/><float name="clearcoat" value="0.39"/>
  <float name="clearcoat_gloss" value="0.41"/>
  <float name="eta" value="1.42"/><float name="main_specular_sampling_rate" value="0.43"/>
  <float name="clearcoat_sampling_rate" value="0.44"/><float name="diffuse_reflectance_sampling_rate" value="0.45"/>
  </bsdf></shape>
<shape type="disk"><bsdf type="principledthin"><ref name="base_color" id="board"/><ref name="roughness" id="board"/>
  <float name="anisotropic" value="0.32"/><float name="spec_trans" value="0.34"/><float name="eta" value="1.33"/>
  <float name="spec_tint" value="0.35"/><float name="sheen" value="0.36"/><float name="sheen_tint" value="0.37"/>
  <float name="flatness" value="0.38"/><float name="diff_trans" value="1.39"/>
  <float name="specular_reflectance_sampling_rate" value="0.41"/>
  <float name="specular_transmittance_sampling_rate" value="0.42"/>
  <float name="diffuse_reflectance_sampling_rate" value="0.43"/>
  <float name="diffuse_transmittance_sampling_rate" value="0.44"/></bsdf></shape>
</scene>)";

class Writer : public ::testing::Test {
 protected:
  Writer() {
    write_picture(folder_.path() / "a & $b.png", {Image(8, 4, Spectrum(0.5f)), {}, {}});
    write_picture(folder_.path() / "sky.exr", {Image(8, 4, Spectrum(0.5f)), {}, {}});
    folder_.add("mesh.ply", kPly);
    folder_.add(
        "hair.txt",
        "0 0 0 0.1\n1 0 0 0.2\n2 0.5 0 0.1\n3 0 1 0.1\n4 1 1 0.05\n\n0 1 0 0.1\n1 1 0 0.2\n2 1 0 0.1\n3 1 1 0.1\n");
    scene::GridVolume grid{{2, 1, 3}, 3, {}, {}, {}};
    for (int i = 0; i < 18; ++i) grid.values.push_back(0.1f * static_cast<float>(i));
    folder_.add("grid.vol", volume_file_bytes(grid));
  }

  fs::path file(const std::string& name) const { return folder_.path() / name; }
  scene::SceneDescription read(std::string_view xml) const {
    Diagnostics diagnostics;
    scene::SceneDescription scene = read_scene(folder_.add("scene.xml", xml), diagnostics);
    EXPECT_EQ(messages(diagnostics), "");
    return scene;
  }
  /// A scene of version 3 with this content, written and read again without a word, gives the same text.
  void expect_equal_copy(std::string_view content) const {
    const scene::SceneDescription scene =
        read(fmt::format("<scene version=\"3.0.0\"><integrator type=\"path\"/>{}</scene>", content));
    EXPECT_EQ(text_of(silent_copy(scene, file("copy.xml"))), text_of(scene)) << mitsuba::content(file("copy.xml"));
  }

  test::Folder folder_;
};

TEST_F(Writer, WhatIsReadAgainIsTheSame) {
  const scene::SceneDescription scene = read(kEverything);
  const scene::SceneDescription again = silent_copy(scene, file("copy.xml"));
  EXPECT_EQ(text_of(again), text_of(scene));
  EXPECT_EQ(again.meshes.size(), scene.meshes.size()) << "what is placed twice is one file";
  EXPECT_EQ(again.instances[0].name, "mesh");
  EXPECT_EQ(text_of(silent_copy(again, file("copy of copy.xml"))), text_of(scene));
  EXPECT_EQ(content(file("copy_files/mesh.ply")), content(file("copy of copy_files/mesh.ply")));
}

TEST_F(Writer, AllCameras) {
  expect_equal_copy(R"(<sensor type="perspective"><float name="fov" value="60"/><string name="fov_axis" value="y"/>
    <float name="principal_point_offset_x" value="0.1"/><float name="principal_point_offset_y" value="-0.2"/>
    <film type="hdrfilm"><rfilter type="tent"><float name="radius" value="1.5"/></rfilter></film></sensor>)");
  expect_equal_copy(R"(<sensor type="orthographic"><transform name="to_world"><scale x="4" y="4" z="2"/>
    <lookat origin="1 2 3" target="1 2 0" up="0 1 0"/></transform><float name="near_clip" value="0.5"/>
  <float name="far_clip" value="64"/>
    <film type="hdrfilm"><rfilter type="lanczos"><integer name="lobes" value="4"/></rfilter></film></sensor>)");
  expect_equal_copy(
      R"(<sensor type="radiancemeter"><point name="origin" x="1" y="2" z="3"/>
  <vector name="direction" x="0" y="0" z="-1"/>
    <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/><rfilter type="box"/>
  </film></sensor>)");
  expect_equal_copy(R"(<shape type="disk"/><shape type="sphere"><sensor type="irradiancemeter">
    <sampler type="independent"><integer name="sample_count" value="5"/></sampler>
    <film type="hdrfilm"><rfilter type="catmullrom"/></film></sensor></shape>)");
}

TEST_F(Writer, PathCountsWhatVolpathDoesNot) {
  for (const std::string_view type : {"path", "volpath"}) {
    const auto scene = read(fmt::format(
        R"(<scene version="3.0.0"><integrator type="{}"/><shape type="disk"><bsdf type="null"/></shape></scene>)",
        type));
    EXPECT_EQ(silent_copy(scene, file("copy.xml")).hints.null_counts_as_bounce, type == "path");
  }
}

/// A disk of this material.
scene::SceneDescription disk_of(scene::Surface surface) {
  scene::SceneDescription scene;
  scene.materials.push_back({"m", std::move(surface), Spectrum(0), {}});
  scene.disks.push_back({"disk", {}});
  scene.instances.push_back({"disk", scene::Id<scene::Disk>{0}, {0}, {}, {}});
  return scene;
}

TEST_F(Writer, MaterialsOfTheTeachingRenderer) {
  const auto material = [&](scene::Surface surface, std::string_view warning) {
    const Copy result = copy(disk_of(std::move(surface)), file("copy.xml"));
    EXPECT_THAT(result.told_writing, HasSubstr(std::string(warning)));
    EXPECT_EQ(result.told_writing.empty(), warning.empty());
    EXPECT_EQ(result.told_reading, "");
    return result.scene.materials.at(result.scene.instances.at(0).material.index);
  };
  const scene::Material diffuse = material(scene::DiffuseMaterial{Spectrum(0.3f)}, "");
  EXPECT_FALSE(diffuse.one_sided);
  EXPECT_EQ(std::get<scene::DiffuseMaterial>(diffuse.surface).reflectance, scene::ColorInput(Spectrum(0.3f)));

  const scene::Material mirror = material(scene::MirrorMaterial{Spectrum(0.9f, 0.8f, 0.7f)}, "");
  EXPECT_FALSE(mirror.one_sided);
  EXPECT_TRUE(std::get<scene::ConductorMaterial>(mirror.surface).eta.is_black());
  EXPECT_EQ(std::get<scene::ConductorMaterial>(mirror.surface).reflectance,
            scene::ColorInput(Spectrum(0.9f, 0.8f, 0.7f)));

  const scene::Material glass =
      material(scene::GlassMaterial{Spectrum(0.9f), Spectrum(0.8f), 1.45f, scene::Fresnel::schlick},
               "exact reflectance is written");
  EXPECT_EQ(std::get<scene::GlassMaterial>(glass.surface).ior, 1.45f);
  EXPECT_EQ(std::get<scene::GlassMaterial>(glass.surface).transmittance, Spectrum(0.8f));

  const scene::Material refraction =
      material(scene::RefractionMaterial{Spectrum(0.8f), 1.4f}, "without reflection is written");
  EXPECT_TRUE(std::get<scene::GlassMaterial>(refraction.surface).reflectance.is_black());

  const scene::Material black = material(scene::NoReflection{}, "");
  EXPECT_EQ(std::get<scene::DiffuseMaterial>(black.surface).reflectance, scene::ColorInput(Spectrum(0)));

  scene::ConductorMaterial metal;
  metal.alpha_u = metal.alpha_v = 1e-6f;
  const scene::Material polished = material(metal, "0.0001 is written");
  EXPECT_EQ(std::get<scene::ConductorMaterial>(polished.surface).alpha_u, scene::FloatInput(1e-4f));
}

scene::SceneDescription lit_by(scene::LightSource source, const Transform& to_world) {
  scene::SceneDescription scene = disk_of(scene::DiffuseMaterial{});
  scene.lights.push_back({"lamp", std::move(source), to_world, {}});
  return scene;
}

TEST_F(Writer, RectangleLightsBecomeShapes) {
  for (const float side : {1.0f, -1.0f}) {
    const Transform to_world = Transform::translation({1, 2, 3}) * Transform::scaling({4 * side, 6, 1});
    const scene::SceneDescription scene =
        silent_copy(lit_by(scene::RectangleLight{Spectrum(5)}, to_world), file("copy.xml"));
    EXPECT_TRUE(scene.lights.empty());
    const scene::Instance& lamp = scene.instances.at(0);
    EXPECT_EQ(lamp.name, "lamp");
    EXPECT_EQ(scene.materials.at(lamp.material.index).emission, scene::ColorInput(Spectrum(5)));
    const scene::Mesh& mesh = scene.meshes.at(std::get<scene::Id<scene::Mesh>>(lamp.shape).index);
    const float mirrored = lamp.to_world.determinant() < 0 ? -1.0f : 1.0f;
    EXPECT_LT(lamp.to_world.normal(mesh.normals.at(0)).z * mirrored, 0) << "it shines along -z";
    Vec3 least(1e9f), most(-1e9f);
    for (const Point3& p : mesh.positions)
      for (int i = 0; i < 3; ++i) {
        least[i] = std::min(least[i], lamp.to_world.point(p)[i]);
        most[i] = std::max(most[i], lamp.to_world.point(p)[i]);
      }
    EXPECT_EQ(least, Vec3(-1, -1, 3));
    EXPECT_EQ(most, Vec3(3, 5, 3));
  }
}

TEST_F(Writer, LightFromAboveBecomesAPicture) {
  const Copy result = copy(lit_by(scene::HemisphereLight{Spectrum(1, 2, 3)}, {}), file("copy.xml"));
  EXPECT_THAT(result.told_writing, HasSubstr("blurred over 0.2 degrees"));
  EXPECT_EQ(result.told_reading, "");
  const Image map = read_image(std::get<scene::EnvironmentLight>(result.scene.lights.at(0).source).file);
  EXPECT_EQ(map.at(1, 0), Spectrum(1, 2, 3));
  EXPECT_EQ(map.at(1, map.height() / 2 - 1), Spectrum(1, 2, 3));
  EXPECT_EQ(map.at(1, map.height() / 2), Spectrum(0));
}

TEST_F(Writer, SpotsWithAPowerOfTheCosineBecomePictures) {
  scene::SpotLight spot{Spectrum(3), 40, 8};
  const Copy result = copy(lit_by(spot, {}), file("copy.xml"));
  EXPECT_THAT(result.told_writing, HasSubstr("written as a picture"));
  EXPECT_EQ(result.told_reading, "");
  const auto& again = std::get<scene::SpotLight>(result.scene.lights.at(0).source);
  EXPECT_EQ(again.beam_deg, 40.0f);
  const scene::Texture& texture = result.scene.textures.at(again.texture->index);
  EXPECT_TRUE(std::get<scene::BitmapTexture>(texture.source).raw);
  EXPECT_EQ(texture.to_uv.y, (std::array<float, 2>{0, 1}));
  // 20 degrees off the axis: tan 20° / tan 40° of the way from the picture's middle to its edge.
  const Image falloff = read_image(std::get<scene::BitmapTexture>(texture.source).file);
  const int x = static_cast<int>(0.5 * falloff.width() * (1 + 0.36397 / 0.83910));
  EXPECT_NEAR(falloff.at(x, falloff.height() / 2).r, std::pow(0.93969, 8), 0.003);

  spot.cutoff_deg = 85;
  EXPECT_THAT(copy(lit_by(spot, {}), file("copy.xml")).told_writing, HasSubstr("is left out"));
}

TEST_F(Writer, TurnedMaps) {
  const fs::path sky = file("sky.exr");
  const scene::SceneDescription scene =
      silent_copy(lit_by(scene::EnvironmentLight{sky, 2, 90, false}, {}), file("copy.xml"));
  // Turned counter-clockwise by a quarter, what is seen towards −z is seen towards −x.
  EXPECT_LT(length(scene.lights.at(0).to_world.vector({0, 0, -1}) - Vec3(-1, 0, 0)), 1e-6f);
  EXPECT_EQ(std::get<scene::EnvironmentLight>(scene.lights[0].source).intensity, 2);
  EXPECT_TRUE(fs::equivalent(std::get<scene::EnvironmentLight>(scene.lights[0].source).file, sky));
  EXPECT_FALSE(fs::exists(file("copy_files"))) << "nothing stands beside this scene";
}

TEST_F(Writer, MirroredMapsAreRewritten) {
  Image map(4, 2);
  for (int i = 0; i < 8; ++i) map.at(i % 4, i / 4) = Spectrum(static_cast<float>(1 + i));
  const Image mirrored = mirrored_map(map);
  ASSERT_EQ(mirrored.width(), 4);
  ASSERT_EQ(mirrored.height(), 5);
  const float expected[] = {1, 1, 3, 5, 5};  // pole, middle of the upper strip, between, middle of the lower, pole
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 4; ++x)
      EXPECT_EQ(mirrored.at(3 - x, y).r, expected[y] + static_cast<float>(x)) << x << " " << y;
}

TEST_F(Writer, NamesBecomeIds) {
  scene::SceneDescription scene = disk_of(scene::DiffuseMaterial{});
  scene.materials.push_back(scene.materials[0]);
  scene.materials[0].name = scene.materials[1].name = "<a \"& b\"> Straße.1";
  scene.instances.push_back(scene.instances[0]);
  scene.instances[1].material = {1};
  scene.instances[0].name = scene.instances[1].name = "_arg";
  const Copy result = copy(scene, file("copy.xml"));
  EXPECT_EQ(result.told_reading, "") << result.xml;
  EXPECT_EQ(result.scene.instances.at(0).name, "disk_arg");
  EXPECT_EQ(result.scene.instances.at(1).name, "disk_arg-2");
}

TEST_F(Writer, MissingPicturesAreGrey) {
  scene::SceneDescription scene = disk_of(scene::DiffuseMaterial{scene::Id<scene::Texture>{0}});
  scene.textures.push_back({"gone", scene::BitmapTexture{file("gone.png")}, {}, {}});
  const Copy result = copy(scene, file("copy.xml"));
  EXPECT_THAT(result.told_writing, HasSubstr("a picture is not there; grey is written"));
  EXPECT_EQ(result.told_reading, "");
  EXPECT_EQ(std::get<scene::CheckerboardTexture>(result.scene.textures.at(0).source).color1,
            scene::ColorInput(Spectrum(0.5f)));
}

TEST_F(Writer, EmptyMeshesAreLeftOut) {
  scene::SceneDescription scene = disk_of(scene::DiffuseMaterial{});
  scene.meshes.emplace_back();
  scene.instances[0].shape = scene::Id<scene::Mesh>{0};
  const Copy result = copy(scene, file("copy.xml"));
  EXPECT_THAT(result.told_writing, HasSubstr("without triangles is left out"));
  EXPECT_TRUE(result.scene.instances.empty());
}

TEST_F(Writer, NothingIsLeftOfWhatFails) {
  const scene::SceneDescription scene = read(kEverything);
  Diagnostics diagnostics;
  EXPECT_THROW(write_scene(file("none/copy.xml"), scene, diagnostics), Error);
  EXPECT_THROW(write_scene(file("copy.dae"), scene, diagnostics), Error);
  folder_.add("copy_files/precious.txt", "of somebody else");
  EXPECT_THROW(write_scene(file("copy.xml"), scene, diagnostics), Error);
  fs::remove_all(file("copy_files"));

  scene::SceneDescription broken = scene;  // a map that cannot be read: found when meshes were written already
  broken.lights.push_back({"map", scene::EnvironmentLight{file("none.exr"), 1, 0, true}, {}, {}});
  EXPECT_THROW(write_scene(file("copy.xml"), broken, diagnostics), Error);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path()))
    EXPECT_FALSE(entry.path().filename().string().find("copy") != std::string::npos) << entry.path();
}

TEST_F(Writer, WhatTheSceneNeedsIsNotOverwritten) {
  scene::SceneDescription scene = lit_by(scene::HemisphereLight{Spectrum(1)}, {});
  Diagnostics diagnostics;
  write_scene(file("copy.xml"), scene, diagnostics);
  scene.lights.push_back({"map", scene::EnvironmentLight{file("copy_files/lamp.exr"), 1, 0, false}, {}, {}});
  const std::string before = content(file("copy_files/lamp.exr"));
  EXPECT_THROW(write_scene(file("copy.xml"), scene, diagnostics), Error);
  EXPECT_EQ(content(file("copy_files/lamp.exr")), before);
}

/// The scenes that others made, if they are here: written and read again they are the same.
TEST_F(Writer, SharedScenes) {
  const char* shared = std::getenv("ETENDUE_SHARED");
  if (shared == nullptr) GTEST_SKIP() << "ETENDUE_SHARED is not set: the shared scenes are not here";
  int mitsuba = 0, collada = 0;
  for (const char* folder : {"conformance/mitsuba/tests/scenes", "scenes/cs184"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(shared) / folder)) {
      const fs::path& path = entry.path();
      const bool is_collada = path.extension() == ".dae";
      if (!is_collada && (path.extension() != ".xml" || !path.filename().string().starts_with("test_"))) continue;
      SCOPED_TRACE(path.string());
      Diagnostics reading;
      scene::SceneDescription scene = read_scene(path, reading);
      if (scene.media.empty())
        scene.hints.null_counts_as_bounce = true;  // there is nothing that would count, or it is so
      const Copy first = copy(scene, file("copy.xml"));
      EXPECT_EQ(first.told_reading, "");
      if (is_collada) {
        EXPECT_EQ(first_difference(text_of(silent_copy(first.scene, file("copy 2.xml"))), text_of(first.scene)), "");
        EXPECT_EQ(first.scene.instances.size() + first.scene.lights.size(),
                  scene.instances.size() + scene.lights.size());
      } else {
        EXPECT_EQ(first.told_writing, "");
        EXPECT_EQ(first_difference(text_of(first.scene), text_of(scene)), "");
      }
      ++(is_collada ? collada : mitsuba);
    }
  EXPECT_EQ(mitsuba, 20);
  EXPECT_GT(collada, 0);
}

}  // namespace
}  // namespace etendue::mitsuba
