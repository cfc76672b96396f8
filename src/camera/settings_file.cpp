#include "camera/settings_file.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <fstream>
#include <numbers>
#include <string>
#include <system_error>
#include <vector>

#include "base/error.h"
#include "base/output_file.h"

namespace etendue {
namespace {

constexpr std::array kNames = {"horizontal field of view",
                               "vertical field of view",
                               "aspect ratio",
                               "near distance",
                               "far distance",
                               "position x",
                               "position y",
                               "position z",
                               "target x",
                               "target y",
                               "target z",
                               "phi",
                               "theta",
                               "r",
                               "smallest r",
                               "largest r",
                               "matrix row 1, right",
                               "matrix row 1, up",
                               "matrix row 1, back",
                               "matrix row 2, right",
                               "matrix row 2, up",
                               "matrix row 2, back",
                               "matrix row 3, right",
                               "matrix row 3, up",
                               "matrix row 3, back",
                               "screen width",
                               "screen height",
                               "screen distance",
                               "focal distance",
                               "lens radius"};

enum Field : std::size_t {
  h_fov,
  v_fov,
  aspect,
  near_distance,
  far_distance,
  position,
  matrix = 16,
  focal_distance = 28,
  lens_radius,
  field_count
};
static_assert(kNames.size() == field_count);

constexpr std::size_t kMaxBytes = 1 << 16;
constexpr double kRotationTolerance = 1e-2;  // people's files carry six digits, some fewer

struct Number {
  double value;
  std::size_t line, column;
};

/// The numbers of a settings file, and its errors in the user's words.
class Settings {
 public:
  Settings(std::string_view text, const std::filesystem::path& path) : path_(path) { parse(text); }

  bool has(std::size_t field) const { return field < numbers_.size(); }
  double operator[](std::size_t field) const { return numbers_[field].value; }
  Vec3 vector(std::size_t field, std::size_t stride = 1) const {
    return {static_cast<float>((*this)[field]), static_cast<float>((*this)[field + stride]),
            static_cast<float>((*this)[field + 2 * stride])};
  }

  void require(bool holds, std::size_t field, std::string_view demand) const {
    if (holds) return;
    const Number& n = numbers_[field];
    fail(n.line, n.column, fmt::format("the {} (number {}) is {}, but {}", kNames[field], field + 1, n.value, demand));
  }

 private:
  [[noreturn]] void fail(std::size_t line, std::size_t column, std::string_view message) const {
    throw Error(Failure::input, fmt::format("{}:{}:{}: error: {}", path_.string(), line, column, message));
  }

  void parse(std::string_view text) {
    std::size_t line = 1, line_start = 0, i = 0;
    while (i < text.size()) {
      if (text[i] == '\n') {
        ++line;
        line_start = ++i;
      } else if (is_space(text[i])) {
        ++i;
      } else {
        const std::size_t begin = i;
        while (i < text.size() && !is_space(text[i])) ++i;
        add(text.substr(begin, i - begin), line, begin - line_start + 1);
      }
    }
    if (numbers_.size() != focal_distance && numbers_.size() != field_count)
      fail(line, text.size() - line_start + 1,
           fmt::format("the {} (number {} of {}) is missing", kNames[numbers_.size()], numbers_.size() + 1,
                       +field_count));
  }

  void add(std::string_view word, std::size_t line, std::size_t column) {
    if (numbers_.size() == field_count)
      fail(line, column, fmt::format("a camera settings file ends after {} numbers", +field_count));
    double value = 0;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (status != std::errc() || end != word.data() + word.size())
      fail(line, column,
           fmt::format("\"{}\" stands where the {} (number {}) should be", shortened(word), kNames[numbers_.size()],
                       numbers_.size() + 1));
    numbers_.push_back({value, line, column});
  }

  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  /// For quoting: no control characters, not a page of it.
  static std::string shortened(std::string_view word) {
    std::string text(word.substr(0, 24));
    for (char& c : text)
      if (c < 0x20 || c == 0x7f) c = '?';
    return text;
  }

  std::filesystem::path path_;
  std::vector<Number> numbers_;
};

std::string read(const std::filesystem::path& path) {
  std::error_code ignored;
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path, ignored))
    throw Error(Failure::input, fmt::format("cannot read the camera settings {}: {}", path.string(),
                                            std::error_code(errno, std::generic_category()).message()));
  std::string text(kMaxBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kMaxBytes)
    throw Error(Failure::input, fmt::format("{} is no camera settings file: it is far longer than {} numbers",
                                            path.string(), +field_count));
  return text;
}

/// Finite, and small enough for a float.
bool is_ordinary(double value) {
  return std::abs(value) < 1e30;
}

void check(const Settings& s) {
  for (const std::size_t fov : {h_fov, v_fov})
    s.require(s[fov] >= 0.001 && s[fov] < 180, fov, "an angle between 0.001 and 180 degrees is needed");
  s.require(s[aspect] > 0 && is_ordinary(s[aspect]), aspect, "it has to be above 0");
  s.require(s[near_distance] >= 0 && is_ordinary(s[near_distance]), near_distance, "a distance of 0 or more is needed");
  s.require(s[far_distance] == 0 || s[far_distance] > s[near_distance], far_distance,
            "it has to lie beyond the near distance (or be 0: no limit)");
  for (std::size_t i = position; i < position + 3; ++i) s.require(is_ordinary(s[i]), i, "a finite number is needed");
  for (std::size_t i = matrix; i < matrix + 9; ++i)
    s.require(std::abs(s[i]) < 1 + kRotationTolerance, i, "a rotation has numbers between -1 and 1 only");
  if (!s.has(focal_distance)) return;
  s.require(s[lens_radius] >= 0 && is_ordinary(s[lens_radius]), lens_radius, "0 (a pinhole) or more is needed");
  s.require(is_ordinary(s[focal_distance]) && (s[focal_distance] > 0 || s[lens_radius] == 0), focal_distance,
            "a lens needs one above 0");
}

/// The matrix of the file, its axes made exactly orthonormal.
Transform frame_of(const Settings& s) {
  const Vec3 right = s.vector(matrix, 3), up = s.vector(matrix + 1, 3), back = s.vector(matrix + 2, 3);
  const Vec3 z = normalize(back), y = normalize(up - z * dot(up, z)), x = cross(y, z);
  const float deviation = std::max({length(right - x), length(up - y), length(back - z)});
  s.require(deviation <= kRotationTolerance, matrix,
            "numbers 17 to 25 are no rotation matrix (columns right, up, back)");
  return {x, y, z, s.vector(position)};
}

std::string format_settings(const Camera& camera, const Point3& target, int width, int height) {
  const auto full_angle_deg = [](float tan_half) { return 2 * std::atan(double{tan_half}) * 180 / std::numbers::pi; };
  const Transform& m = camera.to_world;
  const Vec3 offset = m.origin - target;
  const float r = length(offset);
  const float phi = r > 0 ? std::acos(std::clamp(offset.y / r, -1.0f, 1.0f)) : 0;
  const float theta = std::atan2(offset.x, offset.z);
  const double far_distance = camera.far_clip;

  std::string text =
      fmt::format("{} {} {} {} {}\n", full_angle_deg(camera.tan_half_x), full_angle_deg(camera.tan_half_y),
                  camera.tan_half_x / camera.tan_half_y, camera.near_clip, far_distance);
  text += fmt::format("{} {} {}\n{} {} {}\n", m.origin.x, m.origin.y, m.origin.z, target.x, target.y, target.z);
  text += fmt::format("{} {} {} {} {}\n", phi, theta, r, r / 10, r * 20);
  text += fmt::format("{} {} {} {} {} {} {} {} {}\n", m.x.x, m.y.x, m.z.x, m.x.y, m.y.y, m.z.y, m.x.z, m.y.z, m.z.z);
  text += fmt::format("{} {} {}\n", width, height, static_cast<float>(height) / (2 * camera.tan_half_y));
  text += fmt::format("{} {}\n", camera.focal_distance, camera.lens_radius);
  return text;
}

}  // namespace

Camera read_camera_settings(const std::filesystem::path& path, int width, int height) {
  return parse_camera_settings(read(path), path, width, height);
}

Camera parse_camera_settings(std::string_view text, const std::filesystem::path& path, int width, int height) {
  const Settings s(text, path);
  check(s);
  const auto tan_half = [&](Field fov) { return std::tan(s[fov] * std::numbers::pi / 360); };
  const double picture_aspect = static_cast<double>(width) / height;

  Camera camera;
  camera.to_world = frame_of(s);
  camera.tan_half_x = static_cast<float>(std::max(tan_half(h_fov), tan_half(v_fov) * picture_aspect));
  camera.tan_half_y = static_cast<float>(camera.tan_half_x / picture_aspect);
  camera.near_clip = static_cast<float>(s[near_distance]);
  camera.far_clip = is_ordinary(s[far_distance]) ? static_cast<float>(s[far_distance]) : 0;
  if (s.has(lens_radius)) {
    camera.lens_radius = static_cast<float>(s[lens_radius]);
    if (s[focal_distance] > 0) camera.focal_distance = static_cast<float>(s[focal_distance]);
  }
  return camera;
}

void write_camera_settings(const std::filesystem::path& path, const Camera& camera, const Point3& target, int width,
                           int height) {
  const std::string text = format_settings(camera, target, width, height);
  write_whole_file(path, std::as_bytes(std::span(text)));
}

}  // namespace etendue
