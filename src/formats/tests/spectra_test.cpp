#include "formats/spectra.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "formats/conductors.h"

namespace etendue {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

void expect_near(const Spectrum& found, const Spectrum& expected, float relative) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], relative * std::abs(expected[i])) << "channel " << i;
}

SpectralCurve flat(double value) {
  return {{300, 900}, {value, value}};
}

TEST(Spectra, AFlatReflectanceIsGrey) {
  expect_near(to_rgb(flat(0.25), SpectrumRole::reflectance), Spectrum(0.25f), 2e-4f);
  EXPECT_EQ(constant_to_rgb(0.25, SpectrumRole::reflectance), Spectrum(0.25f));
}

// Equal-energy white, XYZ = (1, 1, 1), in Rec. 709: the row sums of its matrix.
TEST(Spectra, AFlatEmissionIsEqualEnergyWhite) {
  const Spectrum white(1.204794f, 0.948291f, 0.908916f);
  expect_near(constant_to_rgb(2, SpectrumRole::emission), 2 * white, 1e-6f);
  expect_near(to_rgb(flat(2), SpectrumRole::emission), 2 * white, 5e-4f);
}

TEST(Spectra, DaylightIsWhite) {
  expect_near(to_rgb(illuminant_d65(), SpectrumRole::emission), Spectrum(1), 2e-4f);
}

// Computed apart from this program, by the definition.
TEST(Spectra, CurvesOfTheConformanceScenes) {
  expect_near(to_rgb(parse_curve("400:0, 500:8, 600:15.6, 700:18.4"), SpectrumRole::emission),
              {20.710848f, 10.854640f, 2.771153f}, 1e-5f);
  expect_near(to_rgb(parse_curve("400:0.78, 500:0.78, 600:0.78, 700:0.78"), SpectrumRole::reflectance),
              {0.777228f, 0.780675f, 0.776890f}, 1e-5f);
}

// Chromaticity of Planck's radiator at 2855.5 K is that of CIE illuminant A: x = 0.44758, y = 0.40745.
TEST(Spectra, ABlackBodyHasTheColourOfIlluminantA) {
  const Spectrum found = to_rgb(blackbody(2855.5), SpectrumRole::emission);
  const float x = 0.412453f * found.r + 0.357580f * found.g + 0.180423f * found.b;
  const float y = 0.212671f * found.r + 0.715160f * found.g + 0.072169f * found.b;
  const float z = 0.019334f * found.r + 0.119193f * found.g + 0.950227f * found.b;
  EXPECT_NEAR(x / (x + y + z), 0.44758f, 3e-4f);
  EXPECT_NEAR(y / (x + y + z), 0.40745f, 3e-4f);
}

// Wien's law in the form of the radiance at its peak: B(2.897771955e-3 m·K / T) = 4.0957e-6 · T⁵ W·m⁻³·sr⁻¹.
TEST(Spectra, ABlackBodyHasPlancksRadiance) {
  const SpectralCurve sun = blackbody(2897771.955 / 500);
  EXPECT_NEAR(sun.values[140], 4.09567e-6 * std::pow(2897771.955 / 500, 5) * 1e-9, 1e-4 * sun.values[140]);
  EXPECT_LT(sun.values[130], sun.values[140]);
  EXPECT_LT(sun.values[150], sun.values[140]);
}

TEST(Spectra, ColoursOutOfRangeAreClamped) {
  const SpectralCurve green = parse_curve("509:0 510:1 511:0");
  EXPECT_EQ(to_rgb(green, SpectrumRole::emission).r, 0);
  EXPECT_EQ(to_rgb(flat(3), SpectrumRole::reflectance), Spectrum(1));
  expect_near(to_rgb(flat(3), SpectrumRole::unbounded), Spectrum(3), 2e-4f);
}

TEST(Spectra, CurvesAreParsedWithCommasOrSpaces) {
  const SpectralCurve curve = parse_curve(" 400:1,500:2.5\n6e2:+3 ");
  EXPECT_EQ(curve.wavelengths_nm, (std::vector<double>{400, 500, 600}));
  EXPECT_EQ(curve.values, (std::vector<double>{1, 2.5, 3}));
}

TEST(Spectra, BadCurvesAreRejected) {
  EXPECT_THAT([] { parse_curve("400:1, 500"); }, ThrowsMessage<Error>(HasSubstr("\"500\"")));
  EXPECT_THAT([] { parse_curve("400:1, 500:x"); }, ThrowsMessage<Error>(HasSubstr("\"x\" is not a number")));
  EXPECT_THAT([] { parse_curve("400:1, 500:nan"); }, ThrowsMessage<Error>(HasSubstr("is not a number")));
  EXPECT_THAT([] { parse_curve("500:1, 400:2"); }, ThrowsMessage<Error>(HasSubstr("400 does not lie beyond")));
  EXPECT_THAT([] { parse_curve("500:1"); }, ThrowsMessage<Error>(HasSubstr("at least two")));
  EXPECT_THAT([] { parse_curve(""); }, ThrowsMessage<Error>(HasSubstr("at least two")));
}

class SpdFile : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) const {
    std::ofstream(file_) << text;
    return file_;
  }
  void TearDown() override { std::filesystem::remove(file_); }

 private:
  std::filesystem::path file_ =
      std::filesystem::temp_directory_path() /
      ("etendue-" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + ".spd");
};

TEST_F(SpdFile, IsRead) {
  const SpectralCurve curve = read_spd(write("# lamp\r\n400 1\r\n\n500\t2 # middle\n600 4"));
  EXPECT_EQ(curve.wavelengths_nm, (std::vector<double>{400, 500, 600}));
  EXPECT_EQ(curve.values, (std::vector<double>{1, 2, 4}));
}

TEST_F(SpdFile, SaysWhereItIsWrong) {
  EXPECT_THAT([&] { read_spd(write("400 1\n500 2 3\n")); }, ThrowsMessage<Error>(HasSubstr(".spd:2: a line must")));
  EXPECT_THAT([&] { read_spd(write("400 1\n\nabc 2\n")); }, ThrowsMessage<Error>(HasSubstr(".spd:3: \"abc\" is not")));
  EXPECT_THAT([&] { read_spd("/no/such.spd"); }, ThrowsMessage<Error>(HasSubstr("/no/such.spd: the file cannot")));
}

TEST(Conductors, AllNamesAreKnown) {
  for (const std::string_view name : conductor_names()) {
    const std::optional<ComplexIor> ior = named_conductor(name);
    ASSERT_TRUE(ior) << name;
    EXPECT_TRUE(is_finite(ior->eta) && is_finite(ior->k)) << name;
    if (name == "none") continue;
    EXPECT_GT(ior->eta.max(), 0) << name;
    EXPECT_TRUE(named_conductor(std::string(name) + "_palik")) << name;
  }
  EXPECT_GE(conductor_names().size(), 38u);
  EXPECT_FALSE(named_conductor("Unobtainium"));
  EXPECT_EQ(named_conductor("none")->eta, Spectrum(0));
}

// As other renderers have integrated the same measurements.
TEST(Conductors, HaveTheirPublishedColours) {
  const auto expect = [](std::string_view name, const Spectrum& eta, const Spectrum& k, float relative) {
    SCOPED_TRACE(name);
    expect_near(named_conductor(name)->eta, eta, relative);
    expect_near(named_conductor(name)->k, k, relative);
  };
  expect("Ag", {0.15526f, 0.11672f, 0.13838f}, {4.82834f, 3.12225f, 2.14695f}, 0.005f);
  expect("Al", {1.65746f, 0.88037f, 0.52123f}, {9.22387f, 6.26952f, 4.83700f}, 0.005f);
  expect("Au", {0.14312f, 0.37496f, 1.44248f}, {3.98316f, 2.38572f, 1.60322f}, 0.005f);
  expect("Cu", {0.20044f, 0.92403f, 1.10221f}, {3.91295f, 2.45285f, 2.14219f}, 0.005f);
  expect("W", {4.37070f, 3.30030f, 2.99827f}, {3.50068f, 2.60487f, 2.27319f}, 0.01f);
}

}  // namespace
}  // namespace etendue
