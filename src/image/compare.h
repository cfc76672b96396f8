#pragma once

#include <cstddef>

#include "image/image.h"

namespace etendue {

/// How far a picture is from a reference. Over all pixels and channels of linear values, unless said otherwise.
struct PictureError {
  double mse = 0;           ///< mean of (a − r)²
  double relative_mse = 0;  ///< mean of (a − r)² / (r² + 0.01)
  double psnr_db = 0;       ///< of sRGB-encoded values in [0, 1], peak 1; infinite for equal pictures
  double max_error = 0;     ///< largest |a − r|
  double mean = 0;          ///< of the picture
  double reference_mean = 0;
  std::size_t invalid_pixels = 0;  ///< with a NaN or an infinity in either picture; left out of everything else
};

/// Throws Error(Failure::usage) if the sizes differ.
PictureError measure_error(const Image& image, const Image& reference);

/// A picture of which is known how certain it is.
struct SampledPicture {
  Image mean;
  Image variance;              ///< of one sample
  std::vector<float> samples;  ///< that each pixel took
};

/// From the channels variance.{R,G,B} and samples.N. Throws Error(Failure::usage) that says which of them is missing.
SampledPicture sampled_picture(const Picture& picture);

/// Welch's t-test of every pixel and channel: could two pictures be the same one, apart from noise?
struct WelchTest {
  double alpha = 0;  ///< p below this refuses a pixel: 1 − 0.99^(1/pixels) (Šidák), so that of all pixels of two equal
                     ///< pictures together none is refused, per channel, 99 times in 100
  double agreeing_share = 0;        ///< of the tested pixel-channels, those with p > alpha
  double rms_t = 0;                 ///< root mean square of t; near 1 where both pictures' variances are right
  Spectrum mean_difference_sigmas;  ///< (mean of a − mean of b) / its standard deviation, per channel
  std::size_t tested = 0;           ///< pixel-channels with two samples or more in both pictures and finite values
  Image p_values;                   ///< two-sided; 1 where not tested
};

/// t = (a − b) / √(v_a/n_a + v_b/n_b), degrees of freedom after Welch (1947) and Satterthwaite (1946). Variances below
/// `variance_floor` count as that much, so that pixels whose few samples were all alike are not taken for certain.
/// Throws Error(Failure::usage) if the sizes differ.
WelchTest welch_test(const SampledPicture& a, const SampledPicture& b, float variance_floor = 1e-4f);

/// Probability that |T| ≥ |t| for Student's distribution with `degrees` > 0 degrees of freedom.
double student_two_sided_p(double t, double degrees);

}  // namespace etendue
