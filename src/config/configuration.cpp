#include "vibro_impact/config/configuration.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "text_file.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/config/modal_table_file.h"
#include "vibro_impact/config/number.h"
#include "vibro_impact/config/spelling.h"

namespace vibro_impact::config
{
namespace
{
using Keys = std::vector<std::string>;

// The names of numeric keys and what they set, for reading and writing alike.
template <typename Structure>
struct Field
{
  const char* key;
  double Structure::*member;
};

constexpr Field<core::BeamParameters> beam_fields[] = {
    {"youngs_modulus", &core::BeamParameters::youngs_modulus},
    {"density", &core::BeamParameters::density},
    {"length", &core::BeamParameters::length},
    {"contact_location", &core::BeamParameters::contact_location},
};
constexpr Field<core::Rectangle> rectangle_fields[] = {
    {"height", &core::Rectangle::height},
    {"width", &core::Rectangle::width},
};
constexpr Field<core::Tube> tube_fields[] = {
    {"outer_diameter", &core::Tube::outer_diameter},
    {"wall_thickness", &core::Tube::wall_thickness},
    {"added_mass_per_length", &core::Tube::added_mass_per_length},
};
constexpr Field<core::Section> section_fields[] = {
    {"bending_stiffness", &core::Section::bending_stiffness},
    {"mass_per_length", &core::Section::mass_per_length},
};
constexpr Field<core::RigidBody> body_fields[] = {
    {"length", &core::RigidBody::length},
    {"mass", &core::RigidBody::mass},
    {"rotary_inertia", &core::RigidBody::rotary_inertia},
};
constexpr Field<core::ContactParameters> contact_fields[] = {
    {"stiffness", &core::ContactParameters::stiffness},
    {"clearance", &core::ContactParameters::clearance},
};
constexpr Field<core::DampingParameters> damping_fields[] = {
    {"free", &core::DampingParameters::free},
    {"contact", &core::DampingParameters::contact},
};

// The columns of a modal table; all but the last are required.
struct ListField
{
  const char* key;
  std::vector<double> core::ModalTableParameters::*member;
};
constexpr ListField list_fields[] = {
    {"frequency_hz", &core::ModalTableParameters::frequency_hz},
    {"contact_deflection", &core::ModalTableParameters::contact_deflection},
    {"participation", &core::ModalTableParameters::participation},
    {"damping_ratio", &core::ModalTableParameters::damping_ratio},
};

struct EndName
{
  const char* name;
  core::End end;
};
constexpr EndName end_names[] = {
    {"pinned", core::End::pinned}, {"clamped", core::End::clamped}, {"free", core::End::free}};

const Keys beam_keys = {"youngs_modulus", "density", "length",  "height", "width",     "contact_location",
                        "rectangle",      "tube",    "section", "ends",   "rigid_body"};

// A configuration takes a kilobyte, with a long modal table in it a hundred; whatever is larger is some other file.
constexpr std::size_t largest_file = 1 << 20;

std::string join(const Keys& keys)
{
  std::string text;
  for (const std::string& key : keys)
  {
    text += (text.empty() ? "" : ", ") + key;
  }
  return text;
}

// A piece of the user's text as a message shows it: on one line and not too long.
std::string quoted(const std::string& text)
{
  constexpr std::size_t longest = 60;
  std::string shown = text.substr(0, longest);
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
  return '"' + shown + (text.size() > longest ? "..." : "") + '"';
}

// How a node that is not what it must be stands in the text.
std::string shown(const YAML::Node& node)
{
  switch (node.Type())
  {
    case YAML::NodeType::Scalar:
      return "= " + (parseNumber(node.Scalar()) ? node.Scalar() : quoted(node.Scalar()));
    case YAML::NodeType::Sequence:
      return "is a list";
    case YAML::NodeType::Map:
      return "is a map";
    default:
      return "is empty";
  }
}

class Reader
{
public:
  Reader(const YAML::Node& root, std::string directory) : directory_(std::move(directory))
  {
    const std::optional<Section> top = section(root, "", {"beam1", "beam2", "contact", "damping", "basis"});
    if (!top)
    {
      return;
    }
    readStructure(*top, "beam1", parameters_.beam1);
    readStructure(*top, "beam2", parameters_.beam2);
    readSection(*top, "", "contact", contact_fields, parameters_.contact);
    readSection(*top, "", "damping", damping_fields, parameters_.damping);
    readBasis(*top);
    collectRangeFaults();
  }

  const std::vector<std::string>& faults() const
  {
    return faults_;
  }

  const core::SystemParameters& parameters() const
  {
    return parameters_;
  }

private:
  using Section = std::map<std::string, YAML::Node>;

  // The entries of a map with none but these keys, each once; nothing if it is no map.
  std::optional<Section> section(const YAML::Node& node, const std::string& path, const Keys& keys)
  {
    if (!node.IsMap())
    {
      reject(path, shown(node), "a map of " + join(keys));
      return std::nullopt;
    }
    Section entries;
    std::set<std::string> twice;
    for (const auto& entry : node)
    {
      if (!entry.first.IsScalar())
      {
        faults_.push_back((path.empty() ? "a key" : "a key of " + path) + " " + shown(entry.first) +
                          ": must be one of " + join(keys));
        continue;
      }
      const std::string& key = entry.first.Scalar();
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
      {
        const auto meant = nearest(key, keys);
        faults_.push_back(below(path, quoted(key)) + " is unknown" +
                          (meant ? ": did you mean " + *meant + "?" : ": must be one of " + join(keys)));
      }
      else if (!entries.emplace(key, entry.second).second && twice.insert(key).second)
      {
        faults_.push_back(below(path, key) + " is given more than once");
      }
    }
    return entries;
  }

  // The numbers of the map `name` below `path`.
  template <typename Structure, std::size_t Count>
  void readSection(const Section& above, const std::string& path, const std::string& name,
                   const Field<Structure> (&fields)[Count], Structure& values)
  {
    Keys keys;
    for (const auto& field : fields)
    {
      keys.emplace_back(field.key);
    }
    const std::string place = below(path, name);
    const auto found = above.find(name);
    if (found == above.end())
    {
      reject(place, "is missing", "a map of " + join(keys));
      return;
    }
    if (const std::optional<Section> entries = section(found->second, place, keys))
    {
      readNumbers(*entries, place, fields, values);
    }
  }

  // What is no number becomes one that is out of range, so that one place knows what is allowed.
  template <typename Structure, std::size_t Count>
  void readNumbers(const Section& entries, const std::string& place, const Field<Structure> (&fields)[Count],
                   Structure& values)
  {
    for (const auto& field : fields)
    {
      values.*field.member =
          parseNumber(scalar(entries, place, field.key)).value_or(std::numeric_limits<double>::quiet_NaN());
    }
  }

  void readStructure(const Section& top, const std::string& name, core::StructureParameters& structure)
  {
    const std::string kinds = "a map of " + join(beam_keys) + ", or of modal_table, or the word rigid";
    const auto found = top.find(name);
    if (found == top.end())
    {
      reject(name, "is missing", kinds);
      return;
    }
    const YAML::Node& node = found->second;
    if (node.IsScalar() && node.Scalar() == "rigid")
    {
      structure = core::RigidSurface{};
    }
    else if (!node.IsMap())
    {
      reject(name, shown(node), kinds);
    }
    else if (node["modal_table"].IsDefined())
    {
      if (const std::optional<Section> entries = section(node, name, {"modal_table"}))
      {
        readModalTable(entries->at("modal_table"), name + ".modal_table",
                       structure.emplace<core::ModalTableParameters>());
      }
    }
    else if (const std::optional<Section> entries = section(node, name, beam_keys))
    {
      readBeam(*entries, name, structure.emplace<core::BeamParameters>());
    }
  }

  void readBeam(const Section& entries, const std::string& name, core::BeamParameters& beam)
  {
    std::vector<std::string> kinds;
    if (entries.count("height") + entries.count("width") > 0)
    {
      kinds.emplace_back("height and width");
    }
    for (const char* kind : {"rectangle", "tube", "section"})
    {
      if (entries.count(kind) > 0)
      {
        kinds.emplace_back(kind);
      }
    }
    if (kinds.size() > 1)
    {
      reject(name, "has " + join(kinds), "with one cross-section: height and width, rectangle, tube or section");
      return;
    }
    const std::string kind = kinds.empty() ? "height and width" : kinds.front();

    readNumbers(entries, name, beam_fields, beam);
    if (kind == "section")
    {
      readSection(entries, name, "section", section_fields, beam.cross_section.emplace<core::Section>());
      for (const auto& [key, member] : {beam_fields[0], beam_fields[1]})
      {
        beam.*member = 0.0;
        if (entries.count(key) > 0)
        {
          reject(below(name, key), shown(entries.at(key)), "left out where the section says it all");
        }
      }
    }
    else if (kind == "tube")
    {
      readTube(entries, name, beam.cross_section.emplace<core::Tube>());
    }
    else if (kind == "rectangle")
    {
      renamed_[name + ".height"] = name + ".rectangle.height";
      renamed_[name + ".width"] = name + ".rectangle.width";
      readSection(entries, name, "rectangle", rectangle_fields, beam.cross_section.emplace<core::Rectangle>());
    }
    else
    {
      readNumbers(entries, name, rectangle_fields, beam.cross_section.emplace<core::Rectangle>());
    }
    readEnds(entries, name, beam);
    if (entries.count("rigid_body") > 0)
    {
      readSection(entries, name, "rigid_body", body_fields, beam.rigid_body.emplace());
    }
  }

  // The added mass may be left out.
  void readTube(const Section& above, const std::string& name, core::Tube& tube)
  {
    if (auto entries =
            section(above.at("tube"), name + ".tube", {"outer_diameter", "wall_thickness", "added_mass_per_length"}))
    {
      entries->emplace("added_mass_per_length", YAML::Node("0"));
      readNumbers(*entries, name + ".tube", tube_fields, tube);
    }
  }

  void readEnds(const Section& entries, const std::string& name, core::BeamParameters& beam)
  {
    const auto found = entries.find("ends");
    if (found == entries.end())
    {
      return;
    }
    const YAML::Node& node = found->second;
    bool good = node.IsSequence() && node.size() == beam.ends.size();
    std::string words;
    for (std::size_t i = 0; node.IsSequence() && i < node.size(); ++i)
    {
      const std::string word = node[i].IsScalar() ? node[i].Scalar() : "";
      words += (words.empty() ? "" : ", ") + word;
      const auto* known = std::find_if(std::begin(end_names), std::end(end_names),
                                       [&word](const EndName& name_of_end) { return name_of_end.name == word; });
      good &= known != std::end(end_names);
      if (good)
      {
        beam.ends[i] = known->end;
      }
    }
    if (!good)
    {
      reject(name + ".ends", node.IsSequence() ? "= " + quoted("[" + words + "]") : shown(node),
             "a list of two of pinned, clamped, free");
    }
  }

  void readModalTable(const YAML::Node& node, const std::string& place, core::ModalTableParameters& table)
  {
    Keys keys = {"file"};
    for (const ListField& field : list_fields)
    {
      keys.emplace_back(field.key);
    }
    keys.emplace_back("static_receptance");
    const std::optional<Section> entries = section(node, place, keys);
    if (!entries)
    {
      return;
    }
    if (entries->count("file") > 0)
    {
      for (const ListField& field : list_fields)
      {
        if (entries->count(field.key) > 0)
        {
          reject(below(place, field.key), shown(entries->at(field.key)), "left out where a file is given");
        }
      }
      readTableFile(entries->at("file"), place, table);
    }
    else
    {
      for (const ListField& field : list_fields)
      {
        readList(*entries, place, field, table.*field.member);
      }
    }
    if (entries->count("static_receptance") > 0)
    {
      table.static_receptance =
          parseNumber(scalar(*entries, place, "static_receptance")).value_or(std::numeric_limits<double>::quiet_NaN());
    }
  }

  void readTableFile(const YAML::Node& node, const std::string& place, core::ModalTableParameters& table)
  {
    const std::string key = place + ".file";
    const std::filesystem::path file = node.IsScalar() ? node.Scalar() : "";
    if (file.empty())
    {
      reject(key, shown(node), "the path of a CSV file");
      rejected_.insert(place);
    }
    else if (file.is_relative() && directory_.empty())
    {
      reject(key, shown(node), "an absolute path: nothing says which folder it is relative to");
      rejected_.insert(place);
    }
    else
    {
      const std::string path = file.is_relative() ? (directory_ / file).string() : file.string();
      try
      {
        table = config::readModalTable(path);
        table_files_[place] = path;
      }
      catch (const Error& error)
      {
        faults_.push_back(key + ": " + error.what());
        rejected_.insert(place);
      }
    }
  }

  void readList(const Section& entries, const std::string& place, const ListField& field, std::vector<double>& list)
  {
    const std::string key = below(place, field.key);
    const auto found = entries.find(field.key);
    if (found == entries.end())
    {
      if (field.member != &core::ModalTableParameters::damping_ratio)
      {
        reject(key, "is missing", "a list of numbers, or file in place of all lists");
        rejected_.insert(place);
      }
      return;
    }
    if (!found->second.IsSequence())
    {
      reject(key, shown(found->second), "a list of numbers");
      rejected_.insert(place);
      return;
    }
    for (const auto& entry : found->second)
    {
      const std::optional<double> value = entry.IsScalar() ? parseNumber(entry.Scalar()) : std::nullopt;
      list.push_back(value.value_or(std::numeric_limits<double>::quiet_NaN()));
      shown_[key + "[" + std::to_string(list.size()) + "]"] = shown(entry);
    }
  }

  void readBasis(const Section& top)
  {
    const auto found = top.find("basis");
    if (found == top.end())
    {
      return;
    }
    const YAML::Node type = found->second.IsMap() ? found->second["type"] : YAML::Node();
    if (type.IsDefined() && type.IsScalar() && type.Scalar() == "conjoined")
    {
      core::ConjoinedBasis basis;
      if (const auto entries = section(found->second, "basis", {"type", "modes_free", "modes_contact"}))
      {
        basis.modes_free = modes(*entries, "modes_free");
        basis.modes_contact = modes(*entries, "modes_contact");
      }
      parameters_.basis = basis;
    }
    else if (type.IsDefined() && type.IsScalar() && type.Scalar() == "attachment")
    {
      core::AttachmentBasis basis;
      if (const auto entries = section(found->second, "basis", {"type", "modes_per_beam"}))
      {
        basis.modes_per_beam = modes(*entries, "modes_per_beam");
      }
      parameters_.basis = basis;
    }
    else if (section(found->second, "basis", {"type", "modes_free", "modes_contact", "modes_per_beam"}))
    {
      reject("basis.type", type.IsDefined() ? shown(type) : "is missing", "conjoined or attachment");
    }
  }

  int modes(const Section& entries, const std::string& key)
  {
    const std::optional<std::int64_t> value = parseInteger(scalar(entries, "basis", key));
    return value && *value > 0 && *value <= std::numeric_limits<int>::max() ? static_cast<int>(*value) : 0;
  }

  // The text of a value, empty if there is none; remembers how it stands there for the message.
  std::string scalar(const Section& entries, const std::string& path, const std::string& key)
  {
    const auto found = entries.find(key);
    if (found == entries.end())
    {
      shown_[below(path, key)] = "is missing";
      return "";
    }
    shown_[below(path, key)] = shown(found->second);
    return found->second.IsScalar() ? found->second.Scalar() : "";
  }

  void collectRangeFaults()
  {
    for (const core::ParameterFault& fault : core::findFaults(parameters_))
    {
      const auto renamed = renamed_.find(fault.key);
      std::string key = renamed == renamed_.end() ? fault.key : renamed->second;
      if (isRejected(key))
      {
        continue;
      }
      const auto found = shown_.find(key);
      const std::string state = found == shown_.end() ? "= " + fault.value : found->second;
      for (const auto& [place, file] : table_files_)
      {
        key += key.compare(0, place.size(), place) == 0 ? " of " + file : "";
      }
      reject(key, state, fault.allowed);
    }
  }

  // Whether the key has a fault already, or what it lies below.
  bool isRejected(const std::string& key) const
  {
    for (std::size_t end = key.find_first_of(".:["); end != std::string::npos; end = key.find_first_of(".:[", end + 1))
    {
      if (rejected_.count(key.substr(0, end)) > 0)
      {
        return true;
      }
    }
    return rejected_.count(key) > 0;
  }

  void reject(const std::string& key, const std::string& state, const std::string& allowed)
  {
    faults_.push_back((key.empty() ? "" : key + " ") + state + ": must be " + allowed);
    rejected_.insert(key);
  }

  static std::string below(const std::string& path, const std::string& key)
  {
    return path.empty() ? key : path + "." + key;
  }

  std::filesystem::path directory_;  // of files with a relative path; may be empty
  core::SystemParameters parameters_;
  std::vector<std::string> faults_;
  std::set<std::string> rejected_;                  // keys with a fault; what lies below them is not looked at
  std::map<std::string, std::string> shown_;        // how each value stands in the text
  std::map<std::string, std::string> renamed_;      // keys that the text gives another name than core::findFaults()
  std::map<std::string, std::string> table_files_;  // where the modal table of a key comes from
};

// Counts what a text holds before nodes are made of it. yaml-cpp takes what belongs to no document, such as a comma at
// the beginning, for one empty document after the other without end, and its older versions have no bound on nesting.
class Outline : public YAML::EventHandler
{
public:
  explicit Outline(const std::string& yaml)
  {
    std::istringstream stream(yaml);
    YAML::Parser parser(stream);
    while (documents_ < 2 && parser.HandleNextDocument(*this))
    {
      ++documents_;
    }
  }

  // Two stand for any number above one.
  int documents() const
  {
    return documents_;
  }

private:
  void OnDocumentStart(const YAML::Mark& /*mark*/) override
  {
  }
  void OnDocumentEnd() override
  {
  }
  void OnNull(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override
  {
  }
  void OnAlias(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override
  {
  }
  void OnScalar(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& /*value*/) override
  {
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value /*style*/) override
  {
    enter(mark);
  }
  void OnSequenceEnd() override
  {
    --depth_;
  }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override
  {
    enter(mark);
  }
  void OnMapEnd() override
  {
    --depth_;
  }

  void enter(const YAML::Mark& mark)
  {
    constexpr int deepest = 50;
    if (++depth_ > deepest)
    {
      throw YAML::ParserException(mark, "nested more than " + std::to_string(deepest) + " deep");
    }
  }

  int documents_ = 0;
  int depth_ = 0;
};

// The one document of a text; a null node if there is none.
YAML::Node document(const std::string& yaml, const std::string& name)
{
  try
  {
    if (Outline(yaml).documents() > 1)
    {
      throw Error(name + ": holds more than one YAML document, or text that belongs to none: must be one");
    }
    return YAML::Load(yaml);
  }
  catch (const YAML::Exception& error)
  {
    throw Error(name + ": line " + std::to_string(error.mark.line + 1) + ", column " +
                std::to_string(error.mark.column + 1) + ": not YAML: " + error.msg);
  }
}

template <typename Structure, std::size_t Count>
void writeNumbers(std::ostream& stream, const std::string& indent, const Field<Structure> (&fields)[Count],
                  const Structure& values)
{
  for (const auto& field : fields)
  {
    stream << indent << field.key << ": " << formatNumber(values.*field.member) << '\n';
  }
}

template <typename Structure, std::size_t Count>
void writeSection(std::ostream& stream, const std::string& indent, const char* name,
                  const Field<Structure> (&fields)[Count], const Structure& values)
{
  stream << indent << name << ":\n";
  writeNumbers(stream, indent + "  ", fields, values);
}

void writeCrossSection(std::ostream& stream, const core::Rectangle& section)
{
  writeNumbers(stream, "  ", rectangle_fields, section);
}

void writeCrossSection(std::ostream& stream, const core::Tube& section)
{
  writeSection(stream, "  ", "tube", tube_fields, section);
}

void writeCrossSection(std::ostream& stream, const core::Section& section)
{
  writeSection(stream, "  ", "section", section_fields, section);
}

const char* nameOf(core::End end)
{
  return std::find_if(std::begin(end_names), std::end(end_names),
                      [end](const EndName& name_of_end) { return name_of_end.end == end; })
      ->name;
}

void writeStructure(std::ostream& stream, const char* name, const core::BeamParameters& beam)
{
  stream << name << ":\n";
  const bool material = !std::holds_alternative<core::Section>(beam.cross_section);
  for (const auto& field : beam_fields)
  {
    if (material ||
        (field.member != &core::BeamParameters::youngs_modulus && field.member != &core::BeamParameters::density))
    {
      stream << "  " << field.key << ": " << formatNumber(beam.*field.member) << '\n';
    }
  }
  std::visit([&stream](const auto& section) { writeCrossSection(stream, section); }, beam.cross_section);
  if (beam.ends[0] != core::End::pinned || beam.ends[1] != core::End::pinned)
  {
    stream << "  ends: [" << nameOf(beam.ends[0]) << ", " << nameOf(beam.ends[1]) << "]\n";
  }
  if (beam.rigid_body)
  {
    writeSection(stream, "  ", "rigid_body", body_fields, *beam.rigid_body);
  }
}

void writeStructure(std::ostream& stream, const char* name, const core::RigidSurface& /*surface*/)
{
  stream << name << ": rigid\n";
}

void writeStructure(std::ostream& stream, const char* name, const core::ModalTableParameters& table)
{
  stream << name << ":\n  modal_table:\n";
  for (const ListField& field : list_fields)
  {
    const std::vector<double>& list = table.*field.member;
    for (std::size_t m = 0; m < list.size(); ++m)
    {
      stream << (m == 0 ? "    " + std::string(field.key) + ": [" : ", ") << formatNumber(list[m]);
    }
    stream << (list.empty() ? "" : "]\n");
  }
  if (table.static_receptance)
  {
    stream << "    static_receptance: " << formatNumber(*table.static_receptance) << '\n';
  }
}

void writeBasis(std::ostream& stream, const core::ConjoinedBasis& basis)
{
  stream << "basis:\n  type: conjoined\n  modes_free: " << basis.modes_free
         << "\n  modes_contact: " << basis.modes_contact << '\n';
}

void writeBasis(std::ostream& stream, const core::AttachmentBasis& basis)
{
  stream << "basis:\n  type: attachment\n  modes_per_beam: " << basis.modes_per_beam << '\n';
}

}  // namespace

core::SystemParameters parse(const std::string& yaml, const std::string& name, const std::string& directory)
{
  const YAML::Node node = document(yaml, name);
  if (node.IsNull())
  {
    throw Error(name + ": is empty: must be a configuration with beam1, beam2, contact, damping, basis");
  }
  const Reader reader(node, directory);
  const std::vector<std::string>& faults = reader.faults();
  if (!faults.empty())
  {
    throw Error(name, faults);
  }
  return reader.parameters();
}

core::SystemParameters loadFile(const std::string& path)
{
  const std::string text = readTextFile(path, largest_file, "no configuration is");
  const std::filesystem::path directory = std::filesystem::path(path).parent_path();
  return parse(text, path, directory.empty() ? "." : directory.string());
}

std::string toYaml(const core::SystemParameters& parameters)
{
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  std::visit([&stream](const auto& structure) { writeStructure(stream, "beam1", structure); }, parameters.beam1);
  std::visit([&stream](const auto& structure) { writeStructure(stream, "beam2", structure); }, parameters.beam2);
  writeSection(stream, "", "contact", contact_fields, parameters.contact);
  writeSection(stream, "", "damping", damping_fields, parameters.damping);
  std::visit([&stream](const auto& basis) { writeBasis(stream, basis); }, parameters.basis);
  return stream.str();
}

}  // namespace vibro_impact::config
