#include "preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace etendue {
namespace {

using Rgb = std::array<int, 3>;

/// Mean of the pixels that cell (x, y) of a `columns` × `rows` grid covers, each cell at least one pixel.
Spectrum cell_mean(const Image& picture, int x, int y, int columns, int rows) {
  const auto edge = [](int i, int cells, int pixels) { return static_cast<int>(std::int64_t{i} * pixels / cells); };
  const int x0 = edge(x, columns, picture.width()), y0 = edge(y, rows, picture.height());
  const int x1 = std::max(x0 + 1, edge(x + 1, columns, picture.width()));
  const int y1 = std::max(y0 + 1, edge(y + 1, rows, picture.height()));
  Spectrum sum;
  for (int j = y0; j < y1; ++j)
    for (int i = x0; i < x1; ++i) sum += picture.at(i, j);
  return sum / static_cast<float>((x1 - x0) * (y1 - y0));
}

Rgb to_bytes(const Spectrum& radiance, float scale) {
  Rgb bytes;
  for (int c = 0; c < 3; ++c)
    bytes[c] = static_cast<int>(std::lround(255 * std::clamp(linear_to_srgb(radiance[c] * scale), 0.0f, 1.0f)));
  return bytes;
}

}  // namespace

std::string half_block_picture(const Image& picture, const TerminalSize& terminal, const ToneMapping& tone) {
  if (picture.empty()) return {};
  const double fit = std::min({1.0, static_cast<double>(terminal.columns) / picture.width(),
                               2.0 * std::max(1, terminal.rows - 2) / picture.height()});
  const int columns = std::max(1, static_cast<int>(picture.width() * fit));
  const int rows = std::max(1, static_cast<int>(picture.height() * fit));
  const float scale = std::exp2(tone.exposure_stops);

  std::string text;
  const auto out = std::back_inserter(text);
  for (int y = 0; y < rows; y += 2) {
    for (int x = 0; x < columns; ++x) {
      const Rgb top = to_bytes(cell_mean(picture, x, y, columns, rows), scale);
      const Rgb bottom = y + 1 < rows ? to_bytes(cell_mean(picture, x, y + 1, columns, rows), scale) : Rgb{};
      fmt::format_to(out, "\x1b[38;2;{};{};{};48;2;{};{};{}m▀", top[0], top[1], top[2], bottom[0], bottom[1],
                     bottom[2]);
    }
    text += "\x1b[0m\n";
  }
  return text;
}

void Preview::paint(const Image& picture) {
  const std::string lines = half_block_picture(picture, terminal_, tone_);
  const std::string back_up = lines_painted_ > 0 ? fmt::format("\x1b[{}A", lines_painted_) : "";
  write_terminal("\r\x1b[K" + back_up + lines);
  lines_painted_ = static_cast<int>(std::ranges::count(lines, '\n'));
}

}  // namespace etendue
