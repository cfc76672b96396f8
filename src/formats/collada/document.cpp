#include "formats/collada/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <vector>

#include "base/text.h"

namespace etendue::collada {
namespace {

constexpr std::string_view kWhiteSpace = " \t\r\n";

/// The next element in document order; null after the last one below `root`.
pugi::xml_node next_element(pugi::xml_node node, pugi::xml_node root) {
  if (node.first_child()) return node.first_child();
  while (node != root && !node.next_sibling()) node = node.parent();
  return node == root ? pugi::xml_node() : node.next_sibling();
}

std::string key_of(std::string_view kind, std::string_view id) {
  return fmt::format("{}#{}", kind, percent_decoded(id));
}

}  // namespace

Document::Document(std::string text, const std::filesystem::path& path, std::uint32_t file)
    : path_(path), file_(std::move(text), file, {"COLLADA", "COLLADA"}) {
  index_elements();
}

void Document::index_elements() {
  for (pugi::xml_node node = root(); node; node = next_element(node, root())) {
    if (const pugi::xml_attribute id = node.attribute("id")) by_id_.emplace(key_of(node.name(), id.value()), node);
    if (std::strcmp(node.name(), "technique") == 0 && std::strcmp(node.attribute("profile").value(), "CGL") == 0)
      uses_cgl_profile_ = true;
  }
}

pugi::xml_node Document::find(std::string_view kind, std::string_view id) const {
  const auto found = by_id_.find(key_of(kind, id));
  return found == by_id_.end() ? pugi::xml_node() : found->second;
}

pugi::xml_node Document::referenced(pugi::xml_node element, const char* attribute, std::string_view kind) const {
  const pugi::xml_attribute reference = element.attribute(attribute);
  if (!reference) throw Problem(fmt::format("<{}> has no \"{}\"", element.name(), attribute), locate(element));
  const std::string_view url = reference.value();
  const SourceLocation where = locate(reference.value());
  if (!url.starts_with('#'))
    throw Problem(fmt::format("<{}> refers to {}: references to other files are not supported; to this file they start "
                              "with \"#\"",
                              element.name(), in_quotes(url)),
                  where);
  const std::string_view id = url.substr(1);
  if (const pugi::xml_node target = find(kind, id)) return target;
  throw Problem(fmt::format("there is no <{}> with the id {}{}", kind, in_quotes(id), hint_about(id, kind)), where);
}

/// What the file has instead of the missing <kind> called `id`: another kind of element, or a similar id.
std::string Document::hint_about(std::string_view id, std::string_view kind) const {
  constexpr std::size_t kMostCandidates = 1000, kLongestWord = 64;
  if (id.size() > kLongestWord || hints_left_ == 0) return {};
  --hints_left_;
  const std::string decoded = percent_decoded(id);
  std::vector<std::string_view> candidates;
  for (const auto& [key, node] : by_id_) {
    const std::string_view candidate = std::string_view(key).substr(key.find('#') + 1);
    if (node.name() != kind && candidate == decoded) return fmt::format("; a <{}> has that id", node.name());
    if (node.name() == kind && candidate.size() <= kLongestWord && candidates.size() < kMostCandidates)
      candidates.push_back(candidate);
  }
  std::sort(candidates.begin(), candidates.end());
  const auto nearest = nearest_word(decoded, candidates);
  return nearest ? fmt::format("; did you mean {}?", in_quotes(*nearest)) : std::string();
}

std::string percent_decoded(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned char code = 0;
    const char* const digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() && std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
      out += static_cast<char>(code);
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

std::string name_of(pugi::xml_node element) {
  const pugi::xml_attribute name = element.attribute("name");
  return name ? name.value() : element.attribute("id").value();
}

pugi::xml_node cgl_technique(pugi::xml_node element) {
  for (const pugi::xml_node extra : element.children("extra"))
    if (const pugi::xml_node technique = extra.find_child_by_attribute("technique", "profile", "CGL")) return technique;
  return {};
}

std::string_view trimmed_text(pugi::xml_node element) {
  std::string_view text = element.text().get();
  const std::size_t begin = text.find_first_not_of(kWhiteSpace);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kWhiteSpace) - begin + 1);
}

}  // namespace etendue::collada
