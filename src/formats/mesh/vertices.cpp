#include "formats/mesh/vertices.h"

namespace etendue {
namespace {
/// Positions with more different vertices than this get duplicates, so that a chain never takes long to search.
constexpr int kLongestSearch = 64;
}  // namespace

void VertexTable::restart(std::size_t position_count) {
  for (const Corner& vertex : vertices_) newest_[vertex.position] = kNone;
  vertices_.clear();
  older_.clear();
  if (newest_.size() < position_count) newest_.resize(position_count, kNone);
}

std::uint32_t VertexTable::vertex(const Corner& corner) {
  std::uint32_t& newest = newest_[corner.position];
  std::uint32_t v = newest;
  for (int searched = 0; v != kNone && searched < kLongestSearch; ++searched, v = older_[v])
    if (vertices_[v].normal == corner.normal && vertices_[v].uv == corner.uv) return v;
  older_.push_back(newest);
  newest = static_cast<std::uint32_t>(vertices_.size());
  vertices_.push_back(corner);
  return newest;
}

}  // namespace etendue
