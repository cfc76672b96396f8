#include "formats/collada/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>

#include "base/text.h"

namespace etendue::collada {
namespace {

constexpr std::string_view kWhiteSpace = " \t\r\n";
constexpr unsigned kParseOptions =
    pugi::parse_cdata | pugi::parse_escapes | pugi::parse_wconv_attribute | pugi::parse_embed_pcdata;

std::vector<std::size_t> find_line_starts(const std::string& text) {
  std::vector<std::size_t> starts;
  starts.reserve(1 + static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')));
  starts.push_back(0);
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', end + 1))
    starts.push_back(end + 1);
  return starts;
}

/// Says why the text cannot be XML in UTF-8 at all, if it cannot.
std::optional<std::string> foreign_content(std::string_view text) {
  if (text.find_first_not_of(kWhiteSpace) == std::string_view::npos) return "the file is empty";
  if (text.starts_with("\x1f\x8b")) return "the file is compressed with gzip: unpack it first (gunzip)";
  if (text.starts_with("PK\x03\x04")) return "the file is a zip archive: unpack it first (unzip)";
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) return "the file is UTF-16 text: save it as UTF-8";
  return std::nullopt;
}

/// The next element in document order; null after the last one below `root`.
pugi::xml_node next_element(pugi::xml_node node, pugi::xml_node root) {
  if (node.first_child()) return node.first_child();
  while (node != root && !node.next_sibling()) node = node.parent();
  return node == root ? pugi::xml_node() : node.next_sibling();
}

std::string key_of(std::string_view kind, std::string_view id) {
  return fmt::format("{}#{}", kind, percent_decoded(id));
}

/// The last node that was opened before the parser gave up.
pugi::xml_node last_opened(pugi::xml_node node) {
  while (node.last_child()) node = node.last_child();
  return node.type() == pugi::node_element ? node : node.parent();
}

}  // namespace

Document::Document(std::string text, const std::filesystem::path& path, std::uint32_t file)
    : path_(path), file_(file), text_(std::move(text)), line_starts_(find_line_starts(text_)) {
  const SourceLocation first_line{file_, 1, 0};
  if (const auto foreign = foreign_content(text_)) throw Problem(*foreign, first_line);
  const std::size_t last_tag_end = text_.rfind('>');
  if (last_tag_end == std::string::npos) throw Problem("the file is not XML: it holds no element", first_line);
  if (const std::size_t zero = text_.find('\0'); zero != std::string::npos)
    throw Problem("the file is not XML: it holds a zero byte", locate(text_.data() + zero));

  const auto result = xml_.load_buffer_inplace(text_.data(), text_.size(), kParseOptions, pugi::encoding_utf8);
  const std::string_view name = root().name();
  if (!name.empty() && name != "COLLADA")
    throw Problem(
        fmt::format("the root element is <{}>, not <COLLADA>: this is not a COLLADA file", name.substr(0, 60)),
        locate(root()));
  if (!result) reject_malformed(result, last_tag_end);
  index_elements();
}

void Document::reject_malformed(const pugi::xml_parse_result& result, std::size_t last_tag_end) const {
  const std::size_t offset = static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0));
  const SourceLocation where = locate(text_.data() + std::min(offset, text_.size()));
  if (offset < last_tag_end || !root())
    throw Problem(fmt::format("the file is not well-formed XML: {}", result.description()), where);

  const pugi::xml_node last = last_opened(root());
  const std::string_view content = last.value();
  // The parser keeps the buffer's last character for itself, so text that is cut off ends one short.
  const bool open = !content.empty() && content.data() + content.size() + 1 >= text_.data() + text_.size();
  throw Problem(fmt::format("the file is truncated: it ends in the middle of <{}>, line {}; get a complete copy",
                            open ? last.name() : root().name(), line_starts_.size()),
                where);
}

void Document::index_elements() {
  for (pugi::xml_node node = root(); node; node = next_element(node, root())) {
    if (const pugi::xml_attribute id = node.attribute("id")) by_id_.emplace(key_of(node.name(), id.value()), node);
    if (std::strcmp(node.name(), "technique") == 0 && std::strcmp(node.attribute("profile").value(), "CGL") == 0)
      uses_cgl_profile_ = true;
  }
}

SourceLocation Document::locate(const char* text) const {
  if (std::less<>()(text, text_.data()) || std::less<>()(text_.data() + text_.size(), text)) return {file_, 0, 0};
  const auto offset = static_cast<std::size_t>(text - text_.data());
  const auto line = std::upper_bound(line_starts_.begin(), line_starts_.end(), offset) - 1;
  return {file_, static_cast<std::uint32_t>(line - line_starts_.begin() + 1),
          static_cast<std::uint32_t>(offset - *line + 1)};
}

SourceLocation Document::locate(pugi::xml_node element) const {
  SourceLocation where = locate(element.name());
  if (where.column > 1) --where.column;
  return where;
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

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  return text.size() <= kLongest ? fmt::format("\"{}\"", text) : fmt::format("\"{}…\"", text.substr(0, kLongest));
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
