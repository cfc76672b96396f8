#pragma once

#include <string>

#include "image/image.h"
#include "image/io.h"
#include "terminal.h"

namespace etendue {

/// The picture as lines of "▀" in 24-bit colour, two pixels a character, shrunk to fit the terminal (one row stays free
/// for the progress line); every line ends with a line feed. Averages are of linear radiance.
std::string half_block_picture(const Image& picture, const TerminalSize& terminal, const ToneMapping& tone);

/// Repaints the picture in place on standard error.
class Preview {
 public:
  Preview(const TerminalSize& terminal, const ToneMapping& tone) : terminal_(terminal), tone_(tone) {}

  /// The cursor stands at the start of the line below the picture, before and after.
  void paint(const Image& picture);

 private:
  TerminalSize terminal_;
  ToneMapping tone_;
  int lines_painted_ = 0;
};

}  // namespace etendue
