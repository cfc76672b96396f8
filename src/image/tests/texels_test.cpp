#include "image/texels.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "base/tests/temporary_folder.h"

namespace etendue {
namespace {

constexpr int kWidth = 150, kHeight = 70;

/// A picture of bytes; every texel tells where it is.
void write_bytes(const std::filesystem::path& path, int channels) {
  std::vector<std::uint8_t> values;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < channels; ++c) values.push_back(static_cast<std::uint8_t>(c == 0 ? x : c == 1 ? y : x ^ y));
  auto out = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(out && out->open(path.string(), OIIO::ImageSpec(kWidth, kHeight, channels, OIIO::TypeDesc::UINT8)));
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::UINT8, values.data()));
  out->close();
}

/// The largest difference of any channel of any texel.
float difference(const Texels& texels, const Image& image) {
  float largest = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(texels.at(x, y)[c] - image.at(x, y)[c]));
  return largest;
}

TEST(Texels, BytesTilesAndImagesAgree) {
  const TemporaryFolder folder;
  for (const int channels : {1, 2, 3, 4})
    for (const ColorEncoding encoding : {ColorEncoding::srgb, ColorEncoding::linear}) {
      const std::filesystem::path path = folder / ("c" + std::to_string(channels) + ".png");
      write_bytes(path, channels);
      const Image image = read_image(path, encoding);
      const Texels in_memory = read_texels(path, encoding), on_disk = read_texels(path, encoding, 0);
      EXPECT_EQ(in_memory.width(), kWidth);
      EXPECT_EQ(on_disk.height(), kHeight);
      EXPECT_LE(difference(in_memory, image), 1e-6f) << channels;
      EXPECT_LE(difference(on_disk, image), 1e-6f) << channels;
    }
}

TEST(Texels, FloatsAreClampedOnRequest) {
  Image image(2, 1);
  image.at(0, 0) = {0.5f, 3, -1};
  image.at(1, 0) = {0.25f, std::numeric_limits<float>::quiet_NaN(), 1};
  Texels texels(image);
  EXPECT_EQ(texels.clamp(2), 2u);
  EXPECT_EQ(texels.at(0, 0), Spectrum(0.5f, 2, 0));
  EXPECT_EQ(texels.at(1, 0), Spectrum(0.25f, 0, 1));
}

TEST(Texels, DamagedFilesAreNamed) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.png") << "not a picture";
  EXPECT_THROW(read_texels(folder / "a.png", ColorEncoding::srgb), Error);
  EXPECT_THROW(read_texels(folder / "b.png", ColorEncoding::srgb), Error);
}

}  // namespace
}  // namespace etendue
