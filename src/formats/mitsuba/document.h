#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/diagnostics.h"
#include "formats/report.h"
#include "formats/xml_file.h"

namespace etendue::mitsuba {

/// Values for $name, given from outside; they come before the file's own <default>s.
using Definitions = std::map<std::string, std::string>;

struct Attribute {
  std::string name, value;
  SourceLocation where;
};

/// An element of a scene, its $names replaced.
struct Element {
  std::string tag;
  std::vector<Attribute> attributes;
  std::vector<const Element*> children;
  SourceLocation where;
  bool is_old = false;  ///< from a file of version 0.x, its names brought to today's

  const Attribute* find(std::string_view name) const;
  /// The attribute's value; empty if there is none.
  std::string_view operator[](std::string_view name) const;
  std::string_view name() const { return (*this)["name"]; }
  std::string_view type() const { return (*this)["type"]; }
  /// Whether it describes something with properties of its own: a shape, a <spectrum type=…>, not a number.
  bool is_object() const;
};

/// A scene file and all it includes, as one tree: <include>, <default>, <path> and <alias> have done their work, each
/// <ref> leads somewhere, and nothing contains itself.
class Document {
 public:
  /// Reads `text`, the whole of the file `path`, and included files from disk. What is wrong is reported and left out;
  /// throws Problem where nothing is left to read.
  Document(std::string text, const std::filesystem::path& path, const Definitions& definitions,
           Diagnostics& diagnostics, Report& report);
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  const Element& scene() const { return *scene_; }
  /// The scene's version, as it stands in the file.
  const std::string& version() const { return version_; }

  /// The object that a <ref> names; any other element itself.
  const Element& resolved(const Element& element) const;

  /// The file that `name` means: in the folders of <path>, in the scene's, and in that of the file where it stands.
  /// Throws Problem if it is in none of them.
  std::filesystem::path find_file(std::string_view name, SourceLocation where) const;

 private:
  /// A file while it is read.
  struct Source {
    const XmlFile& xml;
    std::filesystem::path path;
    bool is_old;
  };
  struct Parameter {
    std::string value;
    bool from_outside, used;
  };

  Element* add_file(std::string text, const std::filesystem::path& path, SourceLocation included_at);
  Element* add_element(pugi::xml_node node, const Source& source, std::size_t depth);
  void add_child(Element& parent, pugi::xml_node node, const Source& source, std::size_t depth);
  void include(Element& parent, const Element& element, const Source& source);
  void add_search_folder(const Element& element, const Source& source);
  void add_alias(const Element& element);
  void add_id(std::string_view id, const Element& element);
  std::string substituted(std::string value, SourceLocation where);
  void check_references();
  std::size_t checked_height(const Element& element, std::unordered_map<const Element*, std::size_t>& heights,
                             std::size_t depth);
  void warn_about_unused_definitions();
  std::string id_hint(std::string_view id) const;

  Diagnostics& diagnostics_;
  Report& report_;
  std::deque<Element> elements_;
  const Element* scene_ = nullptr;
  std::string version_;
  std::map<std::string, Parameter, std::less<>> parameters_;
  std::unordered_map<std::string, const Element*> by_id_;
  std::unordered_map<const Element*, const Element*> targets_;  ///< of references
  std::vector<std::filesystem::path> search_;
  std::unordered_map<std::uint32_t, std::filesystem::path> folder_of_;  ///< of each file, by its index
  std::vector<std::filesystem::path> open_;                             ///< the files around the one that is read
  std::size_t included_ = 0;
};

/// "; did you mean "…"?" with the candidate nearest to `word`; empty if none is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& candidates);

}  // namespace etendue::mitsuba
