#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace etendue {

inline constexpr std::uint32_t kNone = 0xffffffffu;

/// A polygon's corner as COLLADA and OBJ have it: an index into each stream of vertex data (kNone where there is no
/// such stream).
struct Corner {
  std::uint32_t position = 0, normal = kNone, uv = kNone;
};

/// Turns corners with an index for each stream into vertices with a single index: equal corners become one vertex.
/// Vertices at the same position form a chain, in which a corner is searched; there is nothing to hash.
class VertexTable {
 public:
  /// Forgets all vertices; positions will be below `position_count`. Costs the vertices that were there, not the
  /// positions.
  void restart(std::size_t position_count);
  /// Index of the vertex for `corner`, made if it is new.
  std::uint32_t vertex(const Corner& corner);
  /// The vertices in order of their indices.
  std::span<const Corner> vertices() const { return vertices_; }

 private:
  std::vector<std::uint32_t> newest_;  ///< for each position the head of its chain
  std::vector<std::uint32_t> older_;   ///< for each vertex the next of its chain
  std::vector<Corner> vertices_;
};

}  // namespace etendue
