#pragma once

#include <array>
#include <string>
#include <vector>

#include "image/image.h"

namespace etendue {

/// How many samples a pixel needs at least: both halves' means have variances then.
inline constexpr unsigned kMinimumToDenoise = 4;

/// Means over half of a picture's samples.
struct PictureHalf {
  Image color;
  Image variance;            ///< of `color`, from the samples' spread: at least the true one if they are stratified
  Image albedo;              ///< of the first surface, 0 … 1
  Image normal;              ///< of the first surface
  std::vector<float> depth;  ///< of the first surface, in any unit; 0 without one
};

/// A picture that is to be denoised. The samples of its halves are independent of each other: what they have in common
/// is the picture, what tells them apart is noise. All images have one size and finite values.
struct NoisyPicture {
  std::array<PictureHalf, 2> halves;
};

struct Denoised {
  Image image;
  std::string by;  ///< the denoiser's name
};

/// The picture with less noise, and some bias. It goes to the mean of the halves as their noise goes to zero; values
/// below 0 become 0. By Open Image Denoise if the machine has it, otherwise by regression on the features. Both are
/// mixed with the noisy picture wherever that seems nearer to the truth; pixels that are far brighter than all around
/// them in one half alone are darkened. The result does not depend on the number of threads.
Denoised denoise(const NoisyPicture& picture);
/// The same without Open Image Denoise.
Denoised denoise_by_regression(const NoisyPicture& picture);

}  // namespace etendue
