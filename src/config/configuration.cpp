#include "vibro_impact/config/configuration.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "vibro_impact/config/error.h"
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
    {"height", &core::BeamParameters::height},
    {"width", &core::BeamParameters::width},
    {"contact_location", &core::BeamParameters::contact_location},
};
constexpr Field<core::ContactParameters> contact_fields[] = {
    {"stiffness", &core::ContactParameters::stiffness},
    {"clearance", &core::ContactParameters::clearance},
};
constexpr Field<core::DampingParameters> damping_fields[] = {
    {"free", &core::DampingParameters::free},
    {"contact", &core::DampingParameters::contact},
};

// A configuration takes a kilobyte; whatever is larger than this is some other file.
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
  explicit Reader(const YAML::Node& root)
  {
    const std::optional<Section> top = section(root, "", {"beam1", "beam2", "contact", "damping", "basis"});
    if (!top)
    {
      return;
    }
    readSection(*top, "beam1", beam_fields, parameters_.beam1);
    readBeam2(*top);
    readSection(*top, "contact", contact_fields, parameters_.contact);
    readSection(*top, "damping", damping_fields, parameters_.damping);
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

  template <typename Structure, std::size_t Count>
  void readSection(const Section& top, const std::string& name, const Field<Structure> (&fields)[Count],
                   Structure& values)
  {
    Keys keys;
    for (const auto& field : fields)
    {
      keys.emplace_back(field.key);
    }
    const auto found = top.find(name);
    if (found == top.end())
    {
      reject(name, "is missing", "a map of " + join(keys));
      return;
    }
    if (const std::optional<Section> entries = section(found->second, name, keys))
    {
      for (const auto& field : fields)
      {
        // What is no number becomes one that is out of range, so that one place knows what is allowed.
        values.*field.member =
            parseNumber(scalar(*entries, name, field.key)).value_or(std::numeric_limits<double>::quiet_NaN());
      }
    }
  }

  void readBeam2(const Section& top)
  {
    const auto found = top.find("beam2");
    if (found != top.end() && found->second.IsScalar())
    {
      parameters_.beam2 = core::RigidSurface{};
      if (found->second.Scalar() != "rigid")
      {
        reject("beam2", shown(found->second), "a map as beam1, or the word rigid");
      }
      return;
    }
    readSection(top, "beam2", beam_fields, parameters_.beam2.emplace<core::BeamParameters>());
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
      if (rejected_.count(fault.key.substr(0, fault.key.find('.'))) == 0)
      {
        const auto found = shown_.find(fault.key);
        reject(fault.key, found == shown_.end() ? "= " + fault.value : found->second, fault.allowed);
      }
    }
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

  core::SystemParameters parameters_;
  std::vector<std::string> faults_;
  std::set<std::string> rejected_;            // keys with a fault; what lies below them is not looked at
  std::map<std::string, std::string> shown_;  // how each value stands in the text
};

std::vector<YAML::Node> documents(const std::string& yaml, const std::string& name)
{
  try
  {
    return YAML::LoadAll(yaml);
  }
  catch (const YAML::Exception& error)
  {
    throw Error(name + ": line " + std::to_string(error.mark.line + 1) + ", column " +
                std::to_string(error.mark.column + 1) + ": not YAML: " + error.msg);
  }
}

template <typename Structure, std::size_t Count>
void writeSection(std::ostream& stream, const char* name, const Field<Structure> (&fields)[Count],
                  const Structure& values)
{
  stream << name << ":\n";
  for (const auto& field : fields)
  {
    stream << "  " << field.key << ": " << formatNumber(values.*field.member) << '\n';
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

core::SystemParameters parse(const std::string& yaml, const std::string& name)
{
  const std::vector<YAML::Node> nodes = documents(yaml, name);
  if (nodes.empty() || (nodes.size() == 1 && nodes[0].IsNull()))
  {
    throw Error(name + ": is empty: must be a configuration with beam1, beam2, contact, damping, basis");
  }
  if (nodes.size() > 1)
  {
    throw Error(name + ": holds " + std::to_string(nodes.size()) + " YAML documents: must be one");
  }
  const Reader reader(nodes[0]);
  const std::vector<std::string>& faults = reader.faults();
  if (!faults.empty())
  {
    throw Error(name, faults);
  }
  return reader.parameters();
}

core::SystemParameters loadFile(const std::string& path)
{
  const auto fail = [&path](const std::string& reason) { throw Error(path + ": cannot be read: " + reason); };
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
  {
    fail("it is a directory");
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file)
  {
    fail(std::strerror(errno));
  }
  std::string text(largest_file + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad())
  {
    fail(std::strerror(errno));
  }
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > largest_file)
  {
    fail("it is larger than " + std::to_string(largest_file) + " bytes, which no configuration is");
  }
  return parse(text, path);
}

std::string toYaml(const core::SystemParameters& parameters)
{
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  writeSection(stream, "beam1", beam_fields, parameters.beam1);
  if (const auto* beam2 = std::get_if<core::BeamParameters>(&parameters.beam2))
  {
    writeSection(stream, "beam2", beam_fields, *beam2);
  }
  else
  {
    stream << "beam2: rigid\n";
  }
  writeSection(stream, "contact", contact_fields, parameters.contact);
  writeSection(stream, "damping", damping_fields, parameters.damping);
  std::visit([&stream](const auto& basis) { writeBasis(stream, basis); }, parameters.basis);
  return stream.str();
}

}  // namespace vibro_impact::config
