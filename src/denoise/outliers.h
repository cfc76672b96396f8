#pragma once

#include "denoise/estimate.h"

namespace etendue {

/// The picture in which no pixel of a half is brighter than three times both the same pixel of the other half and
/// nearly all pixels around it in either: rare, bright samples would otherwise become blots. What both halves see
/// stays.
Halves without_outliers(const Halves& noisy);

}  // namespace etendue
