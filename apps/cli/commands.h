#pragma once

#include "options.h"

namespace etendue {

/// Each runs one command to its end and returns the program's exit code; failures are Error.
int run(const PrintText&);
int run(const RenderOptions&);
int run(const InfoOptions&);
int run(const ConvertOptions&);
int run(const EnvmapOptions&);
int run(const DiffOptions&);

}  // namespace etendue
