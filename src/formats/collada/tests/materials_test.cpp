#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/collada/tests/test_document.h"

namespace etendue::collada {
namespace {

using test::Reading;
using ::testing::HasSubstr;

/// Reads the triangle with the material "mat" of an effect with this content.
Reading read_effect(std::string_view effect, std::string_view more = "", std::string_view instance = "") {
  return test::read(test::document(
      test::triangle_geometry() +
          fmt::format("<library_effects><effect id=\"e\">{}</effect></library_effects>{}<library_materials><material "
                      "id=\"mat\" "
                      "name=\"Paint\"><instance_effect url=\"#e\">{}</instance_effect></material></library_materials>",
                      effect, more, instance),
      "<node><instance_geometry url=\"#g\"><bind_material><technique_common><instance_material symbol=\"m\" "
      "target=\"#mat\"/>"
      "</technique_common></bind_material></instance_geometry></node>"));
}

std::string cgl(std::string_view model) {
  return fmt::format(
      "<profile_COMMON><technique><phong><diffuse><color>0.64 0.64 0.64 "
      "1</color></diffuse></phong></technique></profile_COMMON>"
      "<extra><technique profile=\"CGL\">{}</technique></extra>",
      model);
}

std::string common(std::string_view model) {
  return fmt::format("<profile_COMMON><technique>{}</technique></profile_COMMON>", model);
}

const scene::Material& material(const Reading& reading) {
  EXPECT_FALSE(reading.failed) << reading.messages;
  return reading.scene.materials.at(reading.scene.instances.at(0).material.index);
}

template <typename Surface>
Surface surface(const Reading& reading) {
  const auto* found = std::get_if<Surface>(&material(reading).surface);
  EXPECT_NE(found, nullptr);
  return found == nullptr ? Surface{} : *found;
}

Spectrum reflectance(const Reading& reading) {
  return std::get<Spectrum>(surface<scene::DiffuseMaterial>(reading).reflectance);
}

TEST(Materials, EveryCommonTechniqueIsLambertian) {
  for (const std::string_view name : {"phong", "lambert", "blinn"}) {
    const Reading reading = read_effect(common(fmt::format(
        "<{0}><emission><color>0 0 0 1</color></emission><diffuse><color>0.1 0.2 0.3 1</color></diffuse></{0}>",
        name)));
    EXPECT_EQ(reflectance(reading), Spectrum(0.1f, 0.2f, 0.3f)) << name;
    EXPECT_FALSE(scene::emits(material(reading)));
    EXPECT_EQ(material(reading).name, "Paint");
    EXPECT_FALSE(reading.scene.uses_cgl_profile);
  }
}

TEST(Materials, CommonEmissionShinesAndReflects) {
  const Reading reading = read_effect(common(
      "<lambert><emission><color>2 3 4 1</color></emission><diffuse><color>0.5 0.5 0.5 1</color></diffuse></lambert>"));
  EXPECT_EQ(material(reading).emission, scene::ColorInput(Spectrum(2, 3, 4)));
  EXPECT_EQ(reflectance(reading), Spectrum(0.5f));
}

TEST(Materials, ConstantTechniqueOnlyShines) {
  const Reading reading = read_effect(common("<constant><emission><color>1 1 0 1</color></emission></constant>"));
  surface<scene::NoReflection>(reading);
  EXPECT_EQ(material(reading).emission, scene::ColorInput(Spectrum(1, 1, 0)));
}

TEST(Materials, ParametersByReference) {
  const std::string effect =
      "<newparam sid=\"glow\"><float3>1 2 3</float3></newparam><profile_COMMON><newparam sid=\"paint\"><float4>0.1 0.2 "
      "0.3 1"
      "</float4></newparam><technique><phong><emission><param ref=\"glow\"/></emission><diffuse><param "
      "ref=\"paint\"/></diffuse>"
      "</phong></technique></profile_COMMON>";
  const Reading reading = read_effect(effect);
  EXPECT_EQ(reflectance(reading), Spectrum(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(material(reading).emission, scene::ColorInput(Spectrum(1, 2, 3)));
  const Reading overridden = read_effect(effect, "", "<setparam ref=\"paint\"><float3>0.7 0.8 0.9</float3></setparam>");
  EXPECT_EQ(reflectance(overridden), Spectrum(0.7f, 0.8f, 0.9f));
}

TEST(Materials, CglEmissionReflectsNothing) {
  const Reading reading = read_effect(cgl("<emission><radiance>10 9 8</radiance></emission>"));
  surface<scene::NoReflection>(reading);
  EXPECT_EQ(material(reading).emission, scene::ColorInput(Spectrum(10, 9, 8)));
  EXPECT_TRUE(reading.scene.uses_cgl_profile);
}

TEST(Materials, CglMirrorGlassRefraction) {
  EXPECT_EQ(surface<scene::MirrorMaterial>(read_effect(cgl("<mirror><reflectance>0.9 0.8 0.7</reflectance></mirror>")))
                .reflectance,
            Spectrum(0.9f, 0.8f, 0.7f));
  const auto glass =
      surface<scene::GlassMaterial>(read_effect(cgl("<glass><reflectance>1 1 0.5</reflectance><transmittance>0.5 1 "
                                                    "1</transmittance><roughness>0</roughness><ior>1.45</ior>"
                                                    "</glass>")));
  EXPECT_EQ(glass.reflectance, Spectrum(1, 1, 0.5f));
  EXPECT_EQ(glass.transmittance, Spectrum(0.5f, 1, 1));
  EXPECT_FLOAT_EQ(glass.ior, 1.45f);
  EXPECT_EQ(glass.fresnel, scene::Fresnel::schlick);
  const Reading refraction = read_effect(
      cgl("<refraction><transmittance>1 1 0.5</transmittance><roughness>0.2</roughness><ior>1.3</ior></refraction>"));
  EXPECT_FLOAT_EQ(surface<scene::RefractionMaterial>(refraction).ior, 1.3f);
  EXPECT_EQ(surface<scene::RefractionMaterial>(refraction).transmittance, Spectrum(1, 1, 0.5f));
  EXPECT_THAT(refraction.messages, HasSubstr("roughness is ignored"));
}

TEST(Materials, CglMicrofacetIsBeckmannMetal) {
  const auto metal = surface<scene::ConductorMaterial>(
      read_effect(cgl("<microfacet><eta>0.2 0.9 1.1</eta><k>3.9 2.4 2.2</k><alpha>0.4</alpha></microfacet>")));
  EXPECT_EQ(metal.eta, Spectrum(0.2f, 0.9f, 1.1f));
  EXPECT_EQ(metal.k, Spectrum(3.9f, 2.4f, 2.2f));
  EXPECT_EQ(metal.alpha_u, scene::FloatInput(0.4f));
  EXPECT_EQ(metal.alpha_v, scene::FloatInput(0.4f));
  EXPECT_EQ(metal.distribution, scene::Microfacets::beckmann);
  EXPECT_EQ(metal.reflectance, scene::ColorInput(Spectrum(1)));
}

TEST(Materials, CglDiffuseAndUnknownModels) {
  EXPECT_EQ(reflectance(read_effect(cgl("<diffuse><reflectance>0.1 0.2 0.3</reflectance></diffuse>"))),
            Spectrum(0.1f, 0.2f, 0.3f));
  const Reading unknown = read_effect(cgl("<velvet/>"));
  EXPECT_EQ(reflectance(unknown), Spectrum(0.64f));
  EXPECT_THAT(unknown.messages, HasSubstr("no surface known here; profile_COMMON is used"));
}

TEST(Materials, ImpossibleColoursAreClamped) {
  const Reading reading =
      read_effect(common("<lambert><emission><color>-1 0 1 1</color></emission><diffuse><color>1.5 -0.5 0.5 "
                         "1</color></diffuse></lambert>"));
  EXPECT_EQ(reflectance(reading), Spectrum(1, 0, 0.5f));
  EXPECT_EQ(material(reading).emission, scene::ColorInput(Spectrum(0, 0, 1)));
  EXPECT_THAT(reading.messages, HasSubstr("reflectance is outside 0 … 1"));
  EXPECT_THAT(reading.messages, HasSubstr("radiance is negative"));
}

TEST(Materials, TexturesThroughSamplerSurfaceAndShortcuts) {
  const std::string images =
      "<library_images><image id=\"wood-image\" "
      "name=\"wood\"><init_from>file:///nowhere/some%20wood.png</init_from></image></library_images>";
  const std::string model = common("<lambert><diffuse><texture texture=\"{}\" texcoord=\"UV\"/></diffuse></lambert>");
  const std::string params =
      "<newparam sid=\"surf\"><surface type=\"2D\"><init_from>wood-image</init_from></surface></newparam>"
      "<newparam sid=\"samp\"><sampler2D><source>surf</source></sampler2D></newparam>"
      "<newparam sid=\"new\"><sampler2D><instance_image url=\"#wood-image\"/></sampler2D></newparam>";
  for (const std::string_view name : {"samp", "surf", "new", "wood-image"}) {
    const Reading reading = read_effect(params + fmt::format(fmt::runtime(model), name), images);
    ASSERT_EQ(reading.scene.textures.size(), 1u) << name << reading.messages;
    EXPECT_EQ(std::get<scene::BitmapTexture>(reading.scene.textures[0].source).file, "/nowhere/some wood.png");
    EXPECT_EQ(reading.scene.textures[0].name, "wood");
    EXPECT_TRUE(
        std::holds_alternative<scene::Id<scene::Texture>>(surface<scene::DiffuseMaterial>(reading).reflectance));
  }
  const Reading missing = read_effect(params + fmt::format(fmt::runtime(model), "nothing"), images);
  EXPECT_EQ(reflectance(missing), Spectrum(0.5f));
  EXPECT_THAT(missing.messages, HasSubstr("the texture \"nothing\" names no image"));
}

TEST(Materials, ParametersThatReferToEachOtherEnd) {
  const Reading reading = read_effect(
      "<newparam sid=\"a\"><sampler2D><source>b</source></sampler2D></newparam><newparam "
      "sid=\"b\"><surface><init_from>a</init_from>"
      "</surface></newparam>" +
      common("<lambert><diffuse><texture texture=\"a\"/></diffuse></lambert>"));
  EXPECT_EQ(reflectance(reading), Spectrum(0.5f));
}

TEST(Materials, WhatIsWrongIsReportedTogether) {
  const Reading reading = test::read(test::document(
      test::triangle_geometry() + "<library_effects><effect id=\"steel\"><extra><technique "
                                  "profile=\"CGL\"><microfacet><eta>1 1 1</eta><alpha>0</alpha>"
                                  "</microfacet></technique></extra></effect></library_effects>"
                                  "<library_materials><material id=\"a\"><instance_effect url=\"#stele\"/></material>"
                                  "<material id=\"b\"><instance_effect url=\"#steel\"/></material></library_materials>",
      "<node><instance_geometry url=\"#g\"><bind_material><technique_common><instance_material symbol=\"m\" "
      "target=\"#a\"/>"
      "</technique_common></bind_material></instance_geometry>"
      "<instance_geometry url=\"#g\"><bind_material><technique_common><instance_material symbol=\"m\" target=\"#b\"/>"
      "</technique_common></bind_material></instance_geometry>"
      "<instance_geometry url=\"#h\"/></node>"));
  EXPECT_TRUE(reading.failed);
  EXPECT_THAT(reading.messages, HasSubstr("there is no <effect> with the id \"stele\"; did you mean \"steel\"?"));
  EXPECT_THAT(reading.messages, HasSubstr("alpha=0 is not above zero"));
  EXPECT_THAT(reading.messages, HasSubstr("there is no <geometry> with the id \"h\""));
}

}  // namespace
}  // namespace etendue::collada
