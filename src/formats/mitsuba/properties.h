#pragma once

#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "formats/mitsuba/document.h"
#include "math/transform.h"
#include "math/vec.h"

namespace etendue::mitsuba {

/// What an object says of itself, by name. Whoever reads it asks for all that it understands; what nobody asked for is
/// an error, so that no misspelt word is passed over. Everything throws Problem where a value is not of the kind that
/// is asked for.
class Properties {
 public:
  Properties(const Document& document, const Element& object, Report& report);

  const Document& document() const { return document_; }
  Report& report() const { return report_; }
  const Element& object() const { return object_; }
  std::string_view type() const { return object_.type(); }
  SourceLocation where() const { return object_.where; }
  /// The object's id, or its type.
  std::string name() const;

  /// The property's element, the one that a <ref> names; null if there is none.
  const Element* find(std::string_view name);
  bool has(std::string_view name) { return find(name) != nullptr; }

  std::optional<float> number(std::string_view name);
  float number(std::string_view name, float missing) { return number(name).value_or(missing); }
  /// Within [least, most].
  float number(std::string_view name, float missing, float least, float most);
  std::optional<int> integer(std::string_view name);
  int integer(std::string_view name, int missing, int least, int most);
  bool boolean(std::string_view name, bool missing);
  std::optional<std::string> text(std::string_view name);
  std::string required_text(std::string_view name);
  /// Which of `known` the property says, whatever the case; the first of them if there is no such property.
  std::size_t choice(std::string_view name, std::initializer_list<std::string_view> known);
  std::optional<Vec3> vector(std::string_view name);
  Vec3 vector(std::string_view name, const Vec3& missing) { return vector(name).value_or(missing); }
  Transform transform(std::string_view name);
  /// The file that the property names.
  std::filesystem::path file(std::string_view name);

  /// All nested objects with that tag, in their order, whatever they are called.
  std::vector<const Element*> objects(std::string_view tag);
  /// The only one, or null.
  const Element* object(std::string_view tag);

  /// Properties that change nothing here.
  void ignore(std::initializer_list<std::string_view> names);
  /// Reports all that was not asked for.
  void reject_unread();

 private:
  struct Child {
    const Element *element, *target;  ///< the child, and what it refers to if it is a <ref>
    bool read = false;
  };

  const Element* value(std::string_view name, std::initializer_list<std::string_view> tags);
  [[noreturn]] void reject(const Element& element, const std::string& what) const;

  const Document& document_;
  const Element& object_;
  Report& report_;
  std::vector<Child> children_;
  std::set<std::string, std::less<>> asked_;
};

}  // namespace etendue::mitsuba
