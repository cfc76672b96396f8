#include "formats/mitsuba/document.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <set>

#include "base/text.h"
#include "formats/mitsuba/tags.h"

namespace etendue::mitsuba {
namespace {

namespace fs = std::filesystem;

// Bounds on what a small file can unfold to.
constexpr std::size_t kDeepestNesting = 100, kDeepestInclude = 15, kMostIncludes = 1000, kMostElements = 20'000'000;
constexpr std::size_t kLongestValue = 1 << 24;
constexpr std::size_t kMostCandidates = 1000, kLongestCandidate = 64;

bool is_element(pugi::xml_node node) {
  return node.type() == pugi::node_element;
}

bool is_name_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Whether a version, "0.6.0", is before 2.
bool is_old_version(std::string_view version, SourceLocation where) {
  int major = 0;
  const auto [stop, status] = std::from_chars(version.data(), version.data() + version.size(), major);
  if (status != std::errc() || (stop != version.data() + version.size() && *stop != '.'))
    throw Problem(fmt::format("the version {} is not like \"3.0.0\"", in_quotes(version)), where);
  return major < 2;
}

std::string read_whole(const fs::path& path, SourceLocation where) {
  std::ifstream file(path, std::ios::binary);
  std::error_code error;
  std::string text(static_cast<std::size_t>(fs::file_size(path, error)), '\0');
  if (error || !file.read(text.data(), static_cast<std::streamsize>(text.size())))
    throw Problem(fmt::format("the file {} cannot be read", path.string()), where);
  return text;
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

std::vector<std::string_view> keys(const auto& map) {
  std::vector<std::string_view> result;
  for (const auto& [key, value] : map)
    if (key.size() <= kLongestCandidate && result.size() < kMostCandidates) result.push_back(key);
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace

const Attribute* Element::find(std::string_view name) const {
  const auto found =
      std::find_if(attributes.begin(), attributes.end(), [&](const Attribute& a) { return a.name == name; });
  return found == attributes.end() ? nullptr : &*found;
}

std::string_view Element::operator[](std::string_view name) const {
  const Attribute* attribute = find(name);
  return attribute == nullptr ? std::string_view() : attribute->value;
}

bool Element::is_object() const {
  return is_object_tag(tag) || (tag == "spectrum" && find("type") != nullptr);
}

Document::Document(std::string text, const fs::path& path, const Definitions& definitions, Diagnostics& diagnostics,
                   Report& report)
    : diagnostics_(diagnostics), report_(report), search_{path.parent_path()} {
  for (const auto& [name, value] : definitions) parameters_[name] = {value, true, false};
  scene_ = add_file(std::move(text), path, {});
  if (scene_->tag != "scene")
    throw Problem(fmt::format("the root element is <{}>, not <scene>: this is not a Mitsuba scene",
                              std::string_view(scene_->tag).substr(0, 60)),
                  scene_->where);
  check_references();
  warn_about_unused_definitions();
}

Element* Document::add_file(std::string text, const fs::path& path, SourceLocation included_at) {
  if (open_.size() >= kDeepestInclude)
    throw Problem(fmt::format("files include files more than {} deep", kDeepestInclude), included_at);
  const std::uint32_t index = diagnostics_.add_file(path);
  folder_of_[index] = path.parent_path();
  const XmlFile xml(std::move(text), index, {"Mitsuba", ""});
  const pugi::xml_attribute version = xml.root().attribute("version");
  if (!version)
    throw Problem(fmt::format("<{}> does not say which version of the format it is: write version=\"3.0.0\"",
                              std::string_view(xml.root().name()).substr(0, 60)),
                  xml.locate(xml.root()));
  if (included_ == 0) version_ = version.value();
  const Source source{xml, path, is_old_version(version.value(), xml.locate(version.value()))};
  open_.push_back(path);
  Element* root = add_element(xml.root(), source, 0);
  open_.pop_back();
  return root;
}

/// The element with all that stands in it. An included file's root comes with depth 0 as well.
Element* Document::add_element(pugi::xml_node node, const Source& source, std::size_t depth) {
  const SourceLocation where = source.xml.locate(node);
  if (depth > kDeepestNesting)
    throw Problem(fmt::format("elements are nested more than {} deep", kDeepestNesting), where);
  if (elements_.size() >= kMostElements)
    throw Problem(fmt::format("with all that is included there are more than {} elements", kMostElements), where);
  Element& element = elements_.emplace_back();
  element.tag = node.name();
  element.where = where;
  element.is_old = source.is_old;
  for (const pugi::xml_attribute attribute : node.attributes()) {
    const SourceLocation at = source.xml.locate(attribute.value());
    element.attributes.push_back({attribute.name(), substituted(attribute.value(), at), at});
  }
  if (source.is_old) upgrade_names(element, depth == 0 ? "" : node.parent().attribute("type").value());
  check_element(element, depth == 0 ? "" : node.parent().name());
  if (const Attribute* id = element.find("id"); id != nullptr && element.is_object()) add_id(id->value, element);

  const bool has_content = element.is_object() || element.tag == "transform";
  for (const pugi::xml_node child : node.children()) {
    if (!is_element(child)) continue;
    try {
      if (!has_content)
        throw Problem(fmt::format("<{}> holds no elements; is a \"/\" missing at its end?", element.tag),
                      source.xml.locate(child));
      add_child(element, child, source, depth + 1);
    } catch (const Problem& problem) {
      report_.error(problem);
    }
  }
  return &element;
}

void Document::add_child(Element& parent, pugi::xml_node node, const Source& source, std::size_t depth) {
  Element* child = add_element(node, source, depth);
  if (child->tag == "include") return include(parent, *child, source);
  if (child->tag == "path") return add_search_folder(*child, source);
  if (child->tag == "alias") return add_alias(*child);
  if (child->tag == "default") {
    const auto name = (*child)["name"];
    if (name.empty()) throw Problem("a <default> needs a name", child->where);
    parameters_.try_emplace(std::string(name), Parameter{std::string((*child)["value"]), false, true});
    return;
  }
  parent.children.push_back(child);
}

void Document::include(Element& parent, const Element& element, const Source& source) {
  if (++included_ > kMostIncludes)
    throw Problem(fmt::format("more than {} files are included", kMostIncludes), element.where);
  const Attribute& name = *element.find("filename");
  const fs::path beside = source.path.parent_path() / name.value;
  const fs::path path = is_file(beside) ? beside : find_file(name.value, name.where);
  const auto is_same = [&](const fs::path& other) {
    std::error_code error;
    return path == other || fs::equivalent(path, other, error);
  };
  if (std::any_of(open_.begin(), open_.end(), is_same))
    throw Problem(fmt::format("{} includes itself", path.string()), name.where);

  const std::size_t folders = search_.size();
  Element* root = add_file(read_whole(path, name.where), path, element.where);
  // The folders that it names come after those of the file that includes it.
  std::rotate(search_.begin(), search_.end() - static_cast<std::ptrdiff_t>(folders), search_.end());
  if (root->tag == "scene") {
    parent.children.insert(parent.children.end(), root->children.begin(), root->children.end());
    return;
  }
  if (const Attribute* given = element.find("name"); given != nullptr && root->find("name") == nullptr)
    root->attributes.push_back(*given);
  parent.children.push_back(root);
}

void Document::add_search_folder(const Element& element, const Source& source) {
  const Attribute& value = *element.find("value");
  std::vector<fs::path> candidates{source.path.parent_path() / value.value};
  for (const fs::path& folder : search_) candidates.push_back(folder / value.value);
  for (const fs::path& candidate : candidates) {
    std::error_code error;
    if (!fs::is_directory(candidate, error)) continue;
    search_.insert(search_.begin(), candidate.lexically_normal());
    return;
  }
  throw Problem(fmt::format("there is no folder {}", in_quotes(value.value)), value.where);
}

void Document::add_alias(const Element& element) {
  const Attribute &id = *element.find("id"), &as = *element.find("as");
  const auto found = by_id_.find(id.value);
  if (found == by_id_.end())
    throw Problem(fmt::format("nothing above has the id {}{}", in_quotes(id.value), id_hint(id.value)), id.where);
  if (!by_id_.emplace(as.value, found->second).second)
    throw Problem(fmt::format("the id {} is taken already", in_quotes(as.value)), as.where);
}

void Document::add_id(std::string_view id, const Element& element) {
  const auto [place, is_new] = by_id_.emplace(id, &element);
  if (!is_new)
    throw Problem(fmt::format("the id {} is taken already, by the <{}> in line {}", in_quotes(id), place->second->tag,
                              place->second->where.line),
                  element.where);
}

/// $name becomes the value of the longest name that fits, "\$" a dollar.
std::string Document::substituted(std::string value, SourceLocation where) {
  if (value.find('$') == std::string::npos) return value;
  std::string result;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (value.compare(i, 2, "\\$") == 0) {
      result += value[++i];
      continue;
    }
    if (value[i] != '$') {
      result += value[i];
      continue;
    }
    const std::string_view rest = std::string_view(value).substr(i + 1);
    Parameter* longest = nullptr;
    std::size_t length = 0;
    for (auto& [name, parameter] : parameters_)
      if (rest.starts_with(name) && name.size() >= length) {
        longest = &parameter;
        length = name.size();
      }
    if (longest == nullptr) {
      const auto end = std::find_if_not(rest.begin(), rest.end(), is_name_character);
      const std::string_view name = rest.substr(0, static_cast<std::size_t>(end - rest.begin()));
      throw Problem(fmt::format("nothing defines ${0}{1}; add <default name=\"{0}\" value=\"…\"/> or give -D {0}=…",
                                name.substr(0, 60), did_you_mean(name, keys(parameters_))),
                    where);
    }
    longest->used = true;
    result += longest->value;
    i += length;
    if (result.size() > kLongestValue)
      throw Problem("with all that is put in for $names this value gets too long", where);
  }
  return result;
}

const Element& Document::resolved(const Element& element) const {
  const auto target = targets_.find(&element);
  return target == targets_.end() ? element : *target->second;
}

fs::path Document::find_file(std::string_view name, SourceLocation where) const {
  if (name.empty()) throw Problem("a file name is missing", where);
  std::vector<fs::path> folders = search_;
  if (const auto own = folder_of_.find(where.file); own != folder_of_.end()) folders.push_back(own->second);
  for (const fs::path& folder : folders)
    if (fs::path candidate = folder / name; is_file(candidate)) return candidate;
  std::set<std::string> looked;
  for (const fs::path& folder : folders) looked.insert(folder.empty() ? "the working folder" : folder.string());
  throw Problem(fmt::format("there is no file {}{}", in_quotes(name),
                            fs::path(name).is_absolute() ? "" : fmt::format(" in {}", fmt::join(looked, ", "))),
                where);
}

/// Follows all references, so that whoever reads the scene may do so blindly.
void Document::check_references() {
  for (Element& element : elements_) {
    const auto is_dangling = [&](const Element* child) {
      if (child->tag != "ref") return false;
      const Attribute& id = *child->find("id");
      const auto found = by_id_.find(id.value);
      if (found == by_id_.end()) {
        report_.error(
            Problem(fmt::format("nothing has the id {}{}", in_quotes(id.value), id_hint(id.value)), id.where));
        return true;
      }
      targets_[child] = found->second;
      return false;
    };
    std::erase_if(element.children, is_dangling);
  }
  std::unordered_map<const Element*, std::size_t> heights;
  checked_height(*scene_, heights, 0);
}

/// How deep the element's content is nested, references followed. Throws Problem if it contains itself.
std::size_t Document::checked_height(const Element& element, std::unordered_map<const Element*, std::size_t>& heights,
                                     std::size_t depth) {
  constexpr std::size_t kOpen = ~std::size_t{0};
  const auto [place, is_new] = heights.emplace(&element, kOpen);
  if (!is_new && place->second == kOpen)
    throw Problem(fmt::format("the <{}> {} contains itself", element.tag, in_quotes(element["id"])), element.where);
  if (!is_new && depth + place->second <= kDeepestNesting) return place->second;
  if (depth > kDeepestNesting || !is_new)
    throw Problem(fmt::format("objects are nested more than {} deep", kDeepestNesting), element.where);
  std::size_t height = 0;
  for (const Element* child : element.children)
    if (child->is_object() || child->tag == "ref")
      height = std::max(height, 1 + checked_height(resolved(*child), heights, depth + 1));
  return heights[&element] = height;
}

void Document::warn_about_unused_definitions() {
  std::vector<std::string_view> defaults;
  for (const auto& [name, parameter] : parameters_)
    if (!parameter.from_outside) defaults.push_back(name);
  for (const auto& [name, parameter] : parameters_)
    if (parameter.from_outside && !parameter.used)
      report_.warning(
          fmt::format("-D {0}=…: the scene does not ask for ${0}{1}", name.substr(0, 60), did_you_mean(name, defaults)),
          scene_->where);
}

std::string Document::id_hint(std::string_view id) const {
  return id.size() > kLongestCandidate ? std::string() : did_you_mean(id, keys(by_id_));
}

std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& candidates) {
  if (word.size() > kLongestCandidate) return {};
  const auto nearest = nearest_word(word, candidates);
  return nearest ? fmt::format("; did you mean {}?", in_quotes(*nearest)) : std::string();
}

}  // namespace etendue::mitsuba
