#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <unordered_map>

#include "formats/xml_file.h"

namespace etendue::collada {

/// A COLLADA file as a tree of elements that knows its ids.
class Document {
 public:
  /// Parses `text`, the whole file. Throws Problem if it is not COLLADA, not well-formed, or ends early.
  Document(std::string text, const std::filesystem::path& path, std::uint32_t file);

  pugi::xml_node root() const { return file_.root(); }
  /// Folder that relative file names in the document start from.
  std::filesystem::path folder() const { return path_.parent_path(); }
  /// Whether any element has a <technique profile="CGL">.
  bool uses_cgl_profile() const { return uses_cgl_profile_; }

  /// Place of a character of the buffer; unknown for pointers elsewhere.
  SourceLocation locate(const char* text) const { return file_.locate(text); }
  /// Place of the element's "<".
  SourceLocation locate(pugi::xml_node element) const { return file_.locate(element); }

  /// The first <kind> whose id is `id` (percent-encoded or not), or the null node. Ids need to be unique among elements
  /// of one kind only, as careless exporters take them.
  pugi::xml_node find(std::string_view kind, std::string_view id) const;
  /// The element that `attribute` of `element` names ("#id"; percent-encoding is undone). Throws Problem if the
  /// attribute is missing, no <kind> has that id, or it is in another file.
  pugi::xml_node referenced(pugi::xml_node element, const char* attribute, std::string_view kind) const;

 private:
  void index_elements();
  std::string hint_about(std::string_view id, std::string_view kind) const;

  std::filesystem::path path_;
  XmlFile file_;
  std::unordered_map<std::string, pugi::xml_node> by_id_;  ///< under "kind#id"
  mutable int hints_left_ = 20;                            ///< each takes a look at all ids
  bool uses_cgl_profile_ = false;
};

/// Undoes percent-encoding (RFC 3986); a "%" that does not start a code stays.
std::string percent_decoded(std::string_view text);
/// The element's name if it has one, else its id.
std::string name_of(pugi::xml_node element);
/// `element`/extra/technique[@profile="CGL"], or the null node.
pugi::xml_node cgl_technique(pugi::xml_node element);
/// The first text directly inside `element`, without the white space around it.
std::string_view trimmed_text(pugi::xml_node element);

}  // namespace etendue::collada
