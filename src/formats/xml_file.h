#pragma once

#include <cstddef>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "formats/problem.h"

namespace etendue {

/// What a format's XML files are called in messages, and what they start with.
struct XmlKind {
  std::string_view format;  ///< "COLLADA"
  std::string_view root;    ///< "COLLADA"; empty: any element
};

/// An XML file as a tree of elements, parsed in place: names, values and texts of the tree are pointers into the one
/// buffer that holds the file, which is how a place in the tree becomes a line and a column.
class XmlFile {
 public:
  /// Parses `text`, the whole file. Throws Problem if it is not XML of that kind, not well-formed, or ends early.
  XmlFile(std::string text, std::uint32_t file, const XmlKind& kind);
  XmlFile(const XmlFile&) = delete;
  XmlFile& operator=(const XmlFile&) = delete;

  pugi::xml_node root() const { return xml_.document_element(); }

  /// Place of a character of the buffer; unknown for pointers elsewhere.
  SourceLocation locate(const char* text) const;
  /// Place of the element's "<".
  SourceLocation locate(pugi::xml_node element) const;

 private:
  void reject_malformed(const pugi::xml_parse_result& result, std::size_t last_tag_end) const;

  std::uint32_t file_;
  std::string text_;
  std::vector<std::size_t> line_starts_;  ///< offsets; kept because parsing in place overwrites line ends
  pugi::xml_document xml_;
};

/// `text` in quotation marks for a message, cut if it is long.
std::string in_quotes(std::string_view text);

}  // namespace etendue
