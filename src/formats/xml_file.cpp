#include "formats/xml_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>

namespace etendue {
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

/// The last node that was opened before the parser gave up.
pugi::xml_node last_opened(pugi::xml_node node) {
  while (node.last_child()) node = node.last_child();
  return node.type() == pugi::node_element ? node : node.parent();
}

}  // namespace

XmlFile::XmlFile(std::string text, std::uint32_t file, const XmlKind& kind)
    : file_(file), text_(std::move(text)), line_starts_(find_line_starts(text_)) {
  const SourceLocation first_line{file_, 1, 0};
  if (const auto foreign = foreign_content(text_)) throw Problem(*foreign, first_line);
  const std::size_t last_tag_end = text_.rfind('>');
  if (last_tag_end == std::string::npos) throw Problem("the file is not XML: it holds no element", first_line);
  if (const std::size_t zero = text_.find('\0'); zero != std::string::npos)
    throw Problem("the file is not XML: it holds a zero byte", locate(text_.data() + zero));

  const auto result = xml_.load_buffer_inplace(text_.data(), text_.size(), kParseOptions, pugi::encoding_utf8);
  const std::string_view name = root().name();
  if (!name.empty() && !kind.root.empty() && name != kind.root)
    throw Problem(fmt::format("the root element is <{}>, not <{}>: this is not a {} file", name.substr(0, 60),
                              kind.root, kind.format),
                  locate(root()));
  if (!result) reject_malformed(result, last_tag_end);
}

void XmlFile::reject_malformed(const pugi::xml_parse_result& result, std::size_t last_tag_end) const {
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

SourceLocation XmlFile::locate(const char* text) const {
  if (std::less<>()(text, text_.data()) || std::less<>()(text_.data() + text_.size(), text)) return {file_, 0, 0};
  const auto offset = static_cast<std::size_t>(text - text_.data());
  const auto line = std::upper_bound(line_starts_.begin(), line_starts_.end(), offset) - 1;
  return {file_, static_cast<std::uint32_t>(line - line_starts_.begin() + 1),
          static_cast<std::uint32_t>(offset - *line + 1)};
}

SourceLocation XmlFile::locate(pugi::xml_node element) const {
  SourceLocation where = locate(element.name());
  if (where.column > 1) --where.column;
  return where;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  return text.size() <= kLongest ? fmt::format("\"{}\"", text) : fmt::format("\"{}…\"", text.substr(0, kLongest));
}

}  // namespace etendue
