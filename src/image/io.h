#pragma once

#include <filesystem>
#include <string_view>

#include "image/image.h"

namespace etendue {

/// How the numbers of an 8- or 16-bit file are to be read; float files are always linear.
enum class ColorEncoding { srgb, linear };

/// Reads any format OpenImageIO knows, to linear RGB: grey becomes equal channels, alpha is dropped.
/// Throws Error(Failure::input) naming the file and the reason.
Image read_image(const std::filesystem::path& path, ColorEncoding encoding = ColorEncoding::srgb);

/// Reads every channel of a float picture as this program writes it: beauty, named channels and metadata.
/// Throws Error(Failure::input).
Picture read_picture(const std::filesystem::path& path);

/// How linear radiance becomes the bytes of a PNG or JPEG: multiplied by 2^exposure_stops, then the sRGB transfer curve
/// (IEC 61966-2-1), clamped to [0, 1]. Float formats ignore it.
struct ToneMapping {
  float exposure_stops = 0;
};

/// Writes `picture` in the format that the extension names: .png .jpg .jpeg (8 bit sRGB), .tif .tiff .exr (float; EXR
/// with all named channels and metadata), .hdr (Radiance RGBE). The file appears whole or not at all: it is written
/// under a temporary name in the same folder, flushed, and renamed. Throws Error(Failure::output) naming the file, the
/// reason and the remedy; Error(Failure::usage) for an extension it does not know and a picture too large for its
/// format.
void write_picture(const std::filesystem::path& path, const Picture& picture, const ToneMapping& tone = {});

/// Throws what write_picture would throw for a bad extension, a picture of width × height pixels that its format cannot
/// hold, a missing folder or one that cannot be written to: called before a long render, so that nobody learns it
/// afterwards.
void check_writable(const std::filesystem::path& path, int width, int height);

/// The sRGB transfer curve and its inverse, one channel.
float linear_to_srgb(float linear);
float srgb_to_linear(float encoded);

}  // namespace etendue
