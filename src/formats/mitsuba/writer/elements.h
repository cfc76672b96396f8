#pragma once

#include <map>
#include <pugixml.hpp>
#include <set>
#include <string>
#include <string_view>

#include "math/spectrum.h"
#include "math/transform.h"

/// Elements of a Mitsuba scene, added to XML. Numbers have as many digits as bring back the same float.
namespace etendue::mitsuba {

/// <TAG type="TYPE">, with an id if it is not empty.
pugi::xml_node add_object(pugi::xml_node parent, const char* tag, const std::string& type, const std::string& id = {});
/// <ref id="ID"/>, with a name if it is not empty.
void add_reference(pugi::xml_node parent, const std::string& name, const std::string& id);

void add_number(pugi::xml_node parent, const std::string& name, float value);
void add_integer(pugi::xml_node parent, const std::string& name, int value);
/// Nothing if it is as if it were `missing`.
void add_flag(pugi::xml_node parent, const std::string& name, bool value, bool missing = false);
void add_text(pugi::xml_node parent, const std::string& name, const std::string& value);
void add_color(pugi::xml_node parent, const std::string& name, const Spectrum& value);
/// A colour of a surface: one above 1 is written so that it stays so.
void add_reflectance(pugi::xml_node parent, const std::string& name, const Spectrum& value);
void add_point(pugi::xml_node parent, const std::string& name, const Point3& value);
/// Nothing if it is the identity.
void add_transform(pugi::xml_node parent, const std::string& name, const Transform& value);

/// Names that no two objects share.
class Ids {
 public:
  /// An id like `name`, or like `kind` where that is empty: letters, digits, "_" and "-" only.
  std::string unique(std::string_view name, std::string_view kind);
  /// The same for an object that nothing refers to; empty if `name` says no more than its type.
  std::string telling(std::string_view name, std::string_view type);

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> last_;  ///< number given to a name
};

}  // namespace etendue::mitsuba
