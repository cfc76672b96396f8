#include "image/io.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "base/error.h"
#include "base/tests/temporary_folder.h"

namespace etendue {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// No two pixels alike, no symmetry, values from below 0 to far above 1.
Image test_image(int width, int height, float scale = 1) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at(x, y) = Spectrum(static_cast<float>(x) / static_cast<float>(width),
                                static_cast<float>(y) / static_cast<float>(height),
                                static_cast<float>(x * y + 1) / static_cast<float>(width * height)) *
                       scale;
  return image;
}

Picture only(Image image) {
  return {std::move(image), {}, {}};
}

bool same_pixels(const Image& a, const Image& b) {
  return a.width() == b.width() && a.height() == b.height() && std::ranges::equal(a.pixels(), b.pixels());
}

/// Writes `values` (interleaved) as another program might.
template <typename Value>
void write_foreign(const std::filesystem::path& path, int width, int height, std::vector<std::string> channels,
                   const std::vector<Value>& values) {
  OIIO::ImageSpec spec(width, height, static_cast<int>(channels.size()), OIIO::BaseTypeFromC<Value>::value);
  spec.channelnames = std::move(channels);
  spec.alpha_channel = spec.channelindex("A");
  spec.attribute("oiio:UnassociatedAlpha", 1);
  const auto output = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(output && output->open(path.string(), spec)) << OIIO::geterror();
  ASSERT_TRUE(output->write_image(OIIO::BaseTypeFromC<Value>::value, values.data())) << output->geterror();
  ASSERT_TRUE(output->close());
}

/// The message of the input error that reading `path` throws; empty if it throws none.
std::string read_failure(const std::filesystem::path& path) {
  std::string first;
  try {
    read_image(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.failure(), Failure::input);
    first = error.what();
  }
  try {
    read_picture(path);
    EXPECT_EQ(first, "");
  } catch (const Error& error) {
    EXPECT_EQ(first, error.what());
  }
  return first;
}

TEST(Srgb, KnownValues) {
  // Computed from IEC 61966-2-1 with 40 digits.
  EXPECT_FLOAT_EQ(linear_to_srgb(0), 0);
  EXPECT_FLOAT_EQ(linear_to_srgb(0.001f), 0.01292f);
  EXPECT_NEAR(linear_to_srgb(0.18f), 0.4613561f, 1e-6f);
  EXPECT_NEAR(linear_to_srgb(0.5f), 0.7353569f, 1e-6f);
  EXPECT_NEAR(linear_to_srgb(1), 1, 1e-6f);
  EXPECT_NEAR(srgb_to_linear(0.5f), 0.2140411f, 1e-6f);
  EXPECT_NEAR(srgb_to_linear(0.02f), 0.001547988f, 1e-8f);
}

TEST(Srgb, CurvesAreInverseAndContinuous) {
  for (int i = 0; i <= 10000; ++i) {
    const float x = static_cast<float>(i) / 10000.0f;
    EXPECT_NEAR(srgb_to_linear(linear_to_srgb(x)), x, 2e-6f);
  }
  EXPECT_NEAR(linear_to_srgb(0.0031308f), linear_to_srgb(std::nextafter(0.0031308f, 1.0f)), 1e-5f);
}

TEST(WritePicture, FloatFormatsKeepEveryBit) {
  const TemporaryFolder folder;
  Image image = test_image(37, 23, 50);
  image.at(3, 4) = Spectrum(-1, 0x1p-140f, 3e38f);
  for (const char* name : {"a.exr", "a.tif", "a.tiff", "A.EXR"}) {
    write_picture(folder / name, only(image), {.exposure_stops = 3});
    EXPECT_TRUE(same_pixels(read_image(folder / name), image)) << name;
  }
}

TEST(WritePicture, RadianceKeepsEightBitsOfTheBrightestChannel) {
  const TemporaryFolder folder;
  const Image image = test_image(37, 23, 50);
  write_picture(folder / "a.hdr", only(image), {.exposure_stops = 3});
  const Image back = read_image(folder / "a.hdr");
  ASSERT_EQ(back.pixels().size(), image.pixels().size());
  for (std::size_t i = 0; i < image.pixels().size(); ++i)
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(back.pixels()[i][c], image.pixels()[i][c], image.pixels()[i].max() / 128) << i;
}

TEST(WritePicture, RadianceLimitsWhatItCannotHold) {
  const TemporaryFolder folder;
  Image image(9, 1, Spectrum(1));
  image.at(0, 0) = Spectrum(-1, kNaN, 0.5f);
  image.at(1, 0) = Spectrum(kInfinity, 1, 3.4e38f);
  write_picture(folder / "a.hdr", only(image));
  const Image back = read_image(folder / "a.hdr");
  EXPECT_EQ(back.at(0, 0).r, 0);
  EXPECT_EQ(back.at(0, 0).g, 0);
  EXPECT_NEAR(back.at(0, 0).b, 0.5f, 0.01f);
  EXPECT_GT(back.at(1, 0).r, 1e37f);
  EXPECT_GT(back.at(1, 0).b, 1e37f);
}

TEST(WritePicture, PngHoldsTheNearestByteOfTheExposedCurve) {
  const TemporaryFolder folder;
  const Image image = test_image(64, 48, 1.5f);
  for (const float stops : {0.0f, -1.0f, 2.5f}) {
    write_picture(folder / "a.png", only(image), {.exposure_stops = stops});
    const Image bytes = read_image(folder / "a.png", ColorEncoding::linear);
    for (std::size_t i = 0; i < image.pixels().size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const float shown = linear_to_srgb(std::min(1.0f, image.pixels()[i][c] * std::exp2(stops)));
        ASSERT_NEAR(bytes.pixels()[i][c] * 255, shown * 255, 0.5001f) << "stops " << stops << " pixel " << i;
      }
  }
}

TEST(WritePicture, PngClampsWhatNoScreenShows) {
  const TemporaryFolder folder;
  Image image(2, 1);
  image.at(0, 0) = Spectrum(kNaN, -kInfinity, -0.1f);
  image.at(1, 0) = Spectrum(kInfinity, 1.0f, 1e30f);
  write_picture(folder / "a.png", only(image));
  EXPECT_EQ(read_image(folder / "a.png").at(0, 0), Spectrum(0));
  EXPECT_EQ(read_image(folder / "a.png").at(1, 0), Spectrum(1));
}

TEST(WritePicture, PngReadsBackToTheLinearColour) {
  const TemporaryFolder folder;
  write_picture(folder / "a.png", only(Image(3, 3, Spectrum(0.18f, 0.5f, 0.9f))));
  const Spectrum back = read_image(folder / "a.png").at(1, 1);
  EXPECT_EQ(back.r, srgb_to_linear(118.0f / 255.0f));  // 0.4613561 · 255 = 117.6
  EXPECT_NEAR(back.g, 0.5f, 0.005f);
  EXPECT_NEAR(back.b, 0.9f, 0.005f);
}

TEST(WritePicture, JpegIsNearAndNotSubsampled) {
  const TemporaryFolder folder;
  Image image = test_image(64, 64);
  for (int y = 0; y < 64; ++y) image.at(32, y) = Spectrum(1, 0, 0);
  for (const char* name : {"a.jpg", "a.jpeg", "a.JPG"}) {
    write_picture(folder / name, only(image));
    const Image back = read_image(folder / name, ColorEncoding::linear);
    double squared = 0;
    for (std::size_t i = 0; i < image.pixels().size(); ++i)
      for (int c = 0; c < 3; ++c) squared += std::pow(back.pixels()[i][c] - linear_to_srgb(image.pixels()[i][c]), 2);
    EXPECT_LT(std::sqrt(squared / (3.0 * 64 * 64)), 0.012) << name;
    EXPECT_GT(back.at(32, 20).r - back.at(32, 20).g, 0.85f) << name;
  }
}

TEST(WritePicture, SameBytesEveryTime) {
  const TemporaryFolder folder;
  const Picture picture = {test_image(100, 80), {{"depth.Z", std::vector<float>(8000, 2.0f)}}, {{"seed", "7"}}};
  for (const std::string ending : {".png", ".jpg", ".exr", ".hdr"}) {
    write_picture(folder / ("a" + ending), picture);
    write_picture(folder / ("b" + ending), picture);
    EXPECT_EQ(read_bytes(folder / ("a" + ending)), read_bytes(folder / ("b" + ending))) << ending;
  }
}

TEST(WritePicture, LayersAndMetadataComeBack) {
  const TemporaryFolder folder;
  Picture picture{test_image(40, 130),
                  {},
                  {{"seed", "7"},
                   {"command line", "etendue render “ä b” -o x"},

                   {"a-key-that-is-longer-than-thirty-one-characters", std::string(500, 'x')}}};
  for (const char* name : {"albedo.R", "albedo.G", "albedo.B", "depth.Z", "normal.X", "normal.Y", "normal.Z",
                           "samples.N", "variance.R", "variance.G", "variance.B"}) {
    std::vector<float> values(picture.beauty.pixels().size());
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<float>(i * 31 + picture.channels.size()) * 0.37f;
    picture.channels.push_back({name, values});
  }
  write_picture(folder / "a.exr", picture);
  const Picture back = read_picture(folder / "a.exr");
  EXPECT_TRUE(same_pixels(back.beauty, picture.beauty));
  EXPECT_TRUE(same_pixels(read_image(folder / "a.exr"), picture.beauty));
  EXPECT_EQ(back.metadata, picture.metadata);
  ASSERT_EQ(back.channels.size(), picture.channels.size());
  for (const Channel& channel : picture.channels) {
    const auto same_name = [&](const Channel& other) { return other.name == channel.name; };
    const auto found = std::ranges::find_if(back.channels, same_name);
    ASSERT_NE(found, back.channels.end()) << channel.name;
    EXPECT_EQ(found->values, channel.values) << channel.name;
  }
}

TEST(WritePicture, OtherProgramsFindColoursFirstAndAttributesByName) {
  const TemporaryFolder folder;
  const std::vector<float> zeros(12, 0.0f);
  write_picture(folder / "a.exr", {test_image(4, 3),
                                   {{"albedo.R", zeros}, {"Z", zeros}, {"A.early", zeros}},
                                   {{"seed", "7"}, {"other:key", "kept"}}});
  const auto input = OIIO::ImageInput::open((folder / "a.exr").string());
  ASSERT_TRUE(input);
  const OIIO::ImageSpec& spec = input->spec();
  ASSERT_EQ(spec.nchannels, 6);
  EXPECT_THAT(std::vector<std::string>(spec.channelnames.begin(), spec.channelnames.begin() + 3),
              ElementsAre("R", "G", "B"));
  EXPECT_EQ(spec.format, OIIO::TypeDesc::FLOAT);
  EXPECT_EQ(spec.get_string_attribute("compression"), "zip");
  EXPECT_EQ(spec.get_string_attribute("etendue:seed"), "7");
  EXPECT_EQ(spec.get_string_attribute("other:key"), "kept");
}

TEST(WritePicture, UnknownEndingIsAMistakeOfTheRequest) {
  for (const char* name : {"picture", "picture.bmp", "picture.", "", "picture.png/", ".png"}) {
    try {
      check_writable(name, 2, 2);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.failure(), Failure::usage) << name;
      EXPECT_THAT(error.what(), HasSubstr(".png .jpg .jpeg .tif .tiff .exr .hdr"));
    }
    EXPECT_THROW(write_picture(name, only(test_image(2, 2))), Error);
  }
}

TEST(WritePicture, InconsistentPicturesAreRefused) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_picture(folder / "a.exr", Picture{}), Error);
  EXPECT_THROW(write_picture(folder / "a.exr", {test_image(4, 3), {{"depth.Z", std::vector<float>(11)}}, {}}), Error);
  EXPECT_TRUE(folder.names().empty());
}

TEST(WritePicture, WhatAFormatCannotHoldIsSaid) {
  const TemporaryFolder folder;
  const auto write = [&] { write_picture(folder / "a.jpg", only(Image(65501, 1))); };
  const auto check = [&] { check_writable(folder / "a.jpg", 1, 65501); };
  for (const std::function<void()>& action : {std::function<void()>(write), std::function<void()>(check)}) {
    try {
      action();
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(error.failure(), Failure::usage);
      EXPECT_THAT(error.what(), HasSubstr("a.jpg"));
      EXPECT_THAT(error.what(), HasSubstr("at most 65500 a side; choose another format"));
    }
  }
  check_writable(folder / "a.jpg", 65500, 65500);
  check_writable(folder / "a.png", 65536, 1);
  EXPECT_TRUE(folder.names().empty());
}

TEST(ReadImage, GreyBecomesThreeEqualChannels) {
  const TemporaryFolder folder;
  write_foreign<std::uint8_t>(folder / "grey.png", 2, 1, {"Y"}, {0, 128});
  const Image grey = read_image(folder / "grey.png");
  EXPECT_EQ(grey.at(0, 0), Spectrum(0));
  EXPECT_EQ(grey.at(1, 0), Spectrum(srgb_to_linear(128.0f / 255.0f)));
  write_foreign<std::uint8_t>(folder / "grey-alpha.png", 2, 1, {"Y", "A"}, {51, 10, 102, 255});
  EXPECT_FLOAT_EQ(read_image(folder / "grey-alpha.png", ColorEncoding::linear).at(0, 0).b, 0.2f);
}

TEST(ReadImage, AlphaIsDroppedAndNotMultipliedIn) {
  const TemporaryFolder folder;
  write_foreign<std::uint8_t>(folder / "a.png", 1, 1, {"R", "G", "B", "A"}, {255, 51, 102, 25});
  const Spectrum pixel = read_image(folder / "a.png", ColorEncoding::linear).at(0, 0);
  EXPECT_FLOAT_EQ(pixel.r, 1);
  EXPECT_FLOAT_EQ(pixel.g, 0.2f);
  EXPECT_FLOAT_EQ(pixel.b, 0.4f);
}

TEST(ReadImage, SixteenBitsAreDecodedWithAllOfThem) {
  const TemporaryFolder folder;
  write_foreign<std::uint16_t>(folder / "a.png", 1, 1, {"R", "G", "B"}, {32768, 32769, 65535});
  const Spectrum pixel = read_image(folder / "a.png").at(0, 0);
  EXPECT_FLOAT_EQ(pixel.r, srgb_to_linear(32768.0f / 65535.0f));
  EXPECT_FLOAT_EQ(pixel.g, srgb_to_linear(32769.0f / 65535.0f));
  EXPECT_GT(pixel.g, pixel.r);
  EXPECT_EQ(pixel.b, 1);
  EXPECT_FLOAT_EQ(read_image(folder / "a.png", ColorEncoding::linear).at(0, 0).r, 32768.0f / 65535.0f);
}

TEST(ReadImage, ColoursAreFoundByName) {
  const TemporaryFolder folder;
  write_foreign<float>(folder / "a.exr", 1, 1, {"A", "B", "G", "R", "a.X"}, {0.5f, 3, 2, 1, 9});
  EXPECT_EQ(read_image(folder / "a.exr").at(0, 0), Spectrum(1, 2, 3));
  write_foreign<float>(folder / "b.exr", 1, 1, {"Y"}, {7});
  EXPECT_EQ(read_image(folder / "b.exr").at(0, 0), Spectrum(7));
}

TEST(ReadImage, WhatCannotBeReadIsNamedWithTheReason) {
  const TemporaryFolder folder;
  EXPECT_THAT(read_failure(folder / "none.png"), HasSubstr("none.png: there is no such file"));
  EXPECT_THAT(read_failure(folder.path()), HasSubstr("it is a folder"));
  EXPECT_THAT(read_failure("/dev/zero"), HasSubstr("it is not a file"));
  write_bytes(folder / "empty.exr", "");
  EXPECT_THAT(read_failure(folder / "empty.exr"), HasSubstr("empty.exr: the file is empty"));
  for (const char* name : {"text.png", "text.exr", "text.jpg", "text.hdr", "text.tif", "text", "text.null"}) {
    write_bytes(folder / name, "This is not a picture at all, it only has its name.\n");
    const std::string message = read_failure(folder / name);
    EXPECT_THAT(message, HasSubstr(name));
    EXPECT_THAT(message, HasSubstr("it is not a picture of a known format, or damaged"));
    EXPECT_LT(message.size(), 400u);
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

TEST(ReadImage, ImpossibleSizesAreRefusedBeforeAnythingIsAllocated) {
  const TemporaryFolder folder;
  const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
  write_bytes(folder / "huge.hdr", head + "-Y 1000000 +X 1000000\n" + std::string(200, 'x'));
  EXPECT_THAT(read_failure(folder / "huge.hdr"), HasSubstr("1000000 × 1000000"));
  write_bytes(folder / "claims.hdr", head + "-Y 8000 +X 8000\n" + std::string(200, 'x'));
  EXPECT_THAT(read_failure(folder / "claims.hdr"), HasSubstr("claims 8000 × 8000"));
  write_bytes(folder / "zero.hdr", head + "-Y 0 +X 0\n" + std::string(200, 'x'));
  EXPECT_THAT(read_failure(folder / "zero.hdr"), HasSubstr("zero.hdr"));
}

class DamagedFile : public testing::TestWithParam<const char*> {};

TEST_P(DamagedFile, CutOffAtAnyPlaceIsRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path whole = folder / (std::string("whole") + GetParam());
  const std::filesystem::path cut = folder / (std::string("cut") + GetParam());
  write_picture(whole, only(test_image(64, 64, 3)));
  const std::string bytes = read_bytes(whole);
  for (const double share : {0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.98}) {
    write_bytes(cut, bytes.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size()))));
    EXPECT_THAT(read_failure(cut), HasSubstr(cut.string())) << GetParam() << " cut at " << share;
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, DamagedFile, testing::Values(".png", ".jpg", ".tif", ".exr", ".hdr"),
                         [](const auto& format) { return std::string(format.param + 1); });

}  // namespace
}  // namespace etendue
