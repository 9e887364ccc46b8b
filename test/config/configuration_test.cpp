#include "vibro_impact/config/configuration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>

#include "temporary_directory.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/config/number.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::config
{
namespace
{
using testing::HasSubstr;

const std::string beam = R"(
  youngs_modulus: 1.66e+9
  density: 954.0
  length: 0.0529
  height: 0.00127
  width: 0.0127
  contact_location: 0.02645
)";
const std::string good = "beam1:" + beam + "beam2:" + beam + R"(
contact:
  stiffness: 24309.5
  clearance: -1.0e-6
damping:
  free: 0.01
  contact: 0.05
basis:
  type: conjoined
  modes_free: 3
  modes_contact: 4
)";

const std::string kinds =
    "a map of youngs_modulus, density, length, height, width, contact_location, rectangle, tube, section, ends, "
    "rigid_body, or of modal_table, or the word rigid";

/// The text with the first `from` replaced.
std::string with(const std::string& from, const std::string& to, std::string text = good)
{
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string complaint(const std::string& yaml)
{
  try
  {
    parse(yaml, "my.yaml");
  }
  catch (const Error& error)
  {
    return error.what();
  }
  return "";
}

std::string fileComplaint(const std::string& path)
{
  try
  {
    loadFile(path);
  }
  catch (const Error& error)
  {
    return error.what();
  }
  return "";
}

std::string text(const std::vector<double>& numbers)
{
  std::string all;
  for (const double number : numbers)
  {
    all += formatNumber(number) + " ";
  }
  return all;
}

// Every member of a structure.

std::string text(const core::BeamParameters& value)
{
  std::vector<double> numbers = {value.youngs_modulus,
                                 value.density,
                                 value.length,
                                 value.contact_location,
                                 static_cast<double>(value.ends[0]),
                                 static_cast<double>(value.ends[1])};
  const struct
  {
    std::vector<double> operator()(const core::Rectangle& section) const
    {
      return {0.0, section.height, section.width};
    }
    std::vector<double> operator()(const core::Tube& section) const
    {
      return {1.0, section.outer_diameter, section.wall_thickness, section.added_mass_per_length};
    }
    std::vector<double> operator()(const core::Section& section) const
    {
      return {2.0, section.bending_stiffness, section.mass_per_length};
    }
  } members;
  const std::vector<double> section = std::visit(members, value.cross_section);
  numbers.insert(numbers.end(), section.begin(), section.end());
  if (value.rigid_body)
  {
    numbers.insert(numbers.end(),
                   {3.0, value.rigid_body->length, value.rigid_body->mass, value.rigid_body->rotary_inertia});
  }
  return "beam " + text(numbers);
}

std::string text(const core::RigidSurface& /*surface*/)
{
  return "rigid";
}

std::string text(const core::ModalTableParameters& table)
{
  return "table " + text(table.frequency_hz) + "| " + text(table.contact_deflection) + "| " +
         text(table.participation) + "| " + text(table.damping_ratio) + "| " +
         (table.static_receptance ? formatNumber(*table.static_receptance) : "none");
}

std::string text(const core::StructureParameters& structure)
{
  return std::visit([](const auto& kind) { return text(kind); }, structure);
}

void expectSame(const core::SystemParameters& a, const core::SystemParameters& b)
{
  EXPECT_EQ(text(a.beam1), text(b.beam1));
  EXPECT_EQ(text(a.beam2), text(b.beam2));
  EXPECT_EQ(a.contact.stiffness, b.contact.stiffness);
  EXPECT_EQ(a.contact.clearance, b.contact.clearance);
  EXPECT_EQ(a.damping.free, b.damping.free);
  EXPECT_EQ(a.damping.contact, b.damping.contact);
  ASSERT_EQ(a.basis.index(), b.basis.index());
  if (const auto* basis = std::get_if<core::ConjoinedBasis>(&a.basis))
  {
    EXPECT_EQ(basis->modes_free, std::get<core::ConjoinedBasis>(b.basis).modes_free);
    EXPECT_EQ(basis->modes_contact, std::get<core::ConjoinedBasis>(b.basis).modes_contact);
  }
  else
  {
    EXPECT_EQ(std::get<core::AttachmentBasis>(a.basis).modes_per_beam,
              std::get<core::AttachmentBasis>(b.basis).modes_per_beam);
  }
}

TEST(Configuration, ReadsEveryKey)
{
  const core::SystemParameters parameters = parse(good, "my.yaml");
  EXPECT_EQ(std::get<core::BeamParameters>(parameters.beam1).youngs_modulus, 1.66e9);
  EXPECT_EQ(std::get<core::BeamParameters>(parameters.beam1).density, 954.0);
  EXPECT_EQ(std::get<core::BeamParameters>(parameters.beam1).length, 0.0529);
  const auto& section = std::get<core::Rectangle>(std::get<core::BeamParameters>(parameters.beam1).cross_section);
  EXPECT_EQ(section.height, 0.00127);
  EXPECT_EQ(section.width, 0.0127);
  EXPECT_EQ(std::get<core::BeamParameters>(parameters.beam1).contact_location, 0.02645);
  EXPECT_EQ(std::get<core::BeamParameters>(parameters.beam2).youngs_modulus, 1.66e9);
  EXPECT_EQ(parameters.contact.stiffness, 24309.5);
  EXPECT_EQ(parameters.contact.clearance, -1.0e-6);
  EXPECT_EQ(parameters.damping.free, 0.01);
  EXPECT_EQ(parameters.damping.contact, 0.05);
  EXPECT_EQ(std::get<core::ConjoinedBasis>(parameters.basis).modes_free, 3);
  EXPECT_EQ(std::get<core::ConjoinedBasis>(parameters.basis).modes_contact, 4);
}

TEST(Configuration, TakesARigidSecondStructure)
{
  const core::SystemParameters parameters = parse(with("beam2:" + beam, "beam2: rigid\n"), "my.yaml");
  EXPECT_TRUE(std::holds_alternative<core::RigidSurface>(parameters.beam2));
}

TEST(Configuration, TakesTheAttachmentBasis)
{
  const std::string basis = good.substr(good.find("basis:"));
  const auto chosen = parse(with(basis, "basis: {type: attachment, modes_per_beam: 7}\n"), "my.yaml");
  EXPECT_EQ(std::get<core::AttachmentBasis>(chosen.basis).modes_per_beam, 7);
  const auto omitted = parse(with(basis, ""), "my.yaml");
  EXPECT_EQ(std::get<core::AttachmentBasis>(omitted.basis).modes_per_beam, 5);
}

TEST(Configuration, TakesATextThatIsWhollyANumber)
{
  for (const std::string text : {"1.66e9", "\"1660000000\"", "'1.66e+9'", "+1.66e9", "1660000000", "!!str 1.66e9"})
  {
    EXPECT_EQ(std::get<core::BeamParameters>(parse(with("1.66e+9", text), "my.yaml").beam1).youngs_modulus, 1.66e9)
        << text;
  }
  EXPECT_EQ(parse(with("modes_free: 3", "modes_free: '3'"), "my.yaml").basis.index(), 0u);
}

TEST(Configuration, RefusesWhatIsNoNumber)
{
  for (const std::string text : {"1.0abc", "abc", "true", "0x10", "nan", ".nan", "inf", ".inf", "-.inf", "1e999",
                                 "'1.0 '", "1,5", "1_000", "1e", "1 2", "1d5"})
  {
    const std::string message = complaint(with("1.66e+9", text));
    EXPECT_THAT(message, HasSubstr("my.yaml: beam1.youngs_modulus = ")) << text;
    EXPECT_THAT(message, HasSubstr(": must be a finite number > 0 (Pa)")) << text;
  }
  EXPECT_EQ(complaint(with("1.66e+9", "1.0abc")),
            "my.yaml: beam1.youngs_modulus = \"1.0abc\": must be a finite number > 0 (Pa)");
  EXPECT_EQ(complaint(with("1.66e+9", "")), "my.yaml: beam1.youngs_modulus is empty: must be a finite number > 0 (Pa)");
  EXPECT_THAT(complaint(with("1.66e+9", "~")), HasSubstr("beam1.youngs_modulus is empty"));
  EXPECT_THAT(complaint(with("1.66e+9", "''")), HasSubstr("beam1.youngs_modulus = \"\""));
  EXPECT_THAT(complaint(with("1.66e+9", "[1, 2]")), HasSubstr("beam1.youngs_modulus is a list"));
  EXPECT_THAT(complaint(with("1.66e+9", "{a: 1}")), HasSubstr("beam1.youngs_modulus is a map"));
}

TEST(Configuration, RefusesWhatIsOutOfRange)
{
  EXPECT_EQ(complaint(with("length: 0.0529", "length: 0")),
            "my.yaml: beam1.length = 0: must be a finite number > 0 (m)");
  EXPECT_EQ(complaint(with("contact_location: 0.02645", "contact_location: 0.0529")),
            "my.yaml: beam1.contact_location = 0.0529: must be a number > 0 and < 0.0529, the length (m), no nearer to "
            "either than 1e-06 of it");
  EXPECT_EQ(complaint(with("free: 0.01", "free: 1")),
            "my.yaml: damping.free = 1: must be a number >= 0 and < 1 (ratio of critical damping)");
  EXPECT_THAT(complaint(with("stiffness: 24309.5", "stiffness: -1")), HasSubstr("contact.stiffness = -1: must be"));
  for (const std::string text : {"0", "101", "-1", "5.0", "many", "", "99999999999999999999", "4294967298"})
  {
    const std::string message = complaint(with("modes_free: 3", "modes_free: " + text));
    EXPECT_THAT(message, HasSubstr("my.yaml: basis.modes_free ")) << text;
    EXPECT_THAT(message, HasSubstr(": must be a whole number from 1 to 100")) << text;
  }
}

TEST(Configuration, RefusesAProductThatOverflows)
{
  EXPECT_THAT(complaint(with("1.66e+9", "1e300", with("height: 0.00127", "height: 1e100"))),
              HasSubstr("beam1: bending stiffness E I = inf: must be from 1e-60 to 1e+60 (N m^2)"));
}

TEST(Configuration, NamesEveryMissingKey)
{
  for (const std::string key : {"youngs_modulus: 1.66e+9", "density: 954.0", "length: 0.0529", "height: 0.00127",
                                "width: 0.0127", "contact_location: 0.02645"})
  {
    EXPECT_THAT(complaint(with("  " + key + "\n", "")),
                HasSubstr("my.yaml: beam1." + key.substr(0, key.find(':')) + " is missing: must be a "))
        << key;
  }
  EXPECT_THAT(complaint(with("  clearance: -1.0e-6\n", "")), HasSubstr("contact.clearance is missing: must be a "));
  EXPECT_THAT(complaint(with("  contact: 0.05\n", "")), HasSubstr("damping.contact is missing: must be a number >= 0"));
  EXPECT_THAT(complaint(with("  modes_contact: 4\n", "")),
              HasSubstr("basis.modes_contact is missing: must be a whole"));
  EXPECT_EQ(complaint(with("  type: conjoined\n", "")),
            "my.yaml: basis.type is missing: must be conjoined or attachment");
  for (const std::string name : {"beam1", "beam2"})
  {
    EXPECT_EQ(complaint(with(name + ":" + beam, "")), "my.yaml: " + name + " is missing: must be " + kinds);
  }
  EXPECT_EQ(complaint(good.substr(0, good.find("basis:")) + "basis:\n"),
            "my.yaml: basis is empty: must be a map of type, modes_free, modes_contact, modes_per_beam");
}

TEST(Configuration, AsksWhetherAMisspeltKeyWasMeant)
{
  EXPECT_THAT(complaint(with("youngs_modulus", "young_modulus")),
              HasSubstr("beam1.\"young_modulus\" is unknown: did you mean youngs_modulus?"));
  EXPECT_THAT(complaint(with("length", "lenght")), HasSubstr("beam1.\"lenght\" is unknown: did you mean length?"));
  EXPECT_THAT(complaint(with("length", "Length")), HasSubstr("did you mean length?"));
  EXPECT_THAT(complaint(with("contact:\n", "contcat:\n")), HasSubstr("\"contcat\" is unknown: did you mean contact?"));
  EXPECT_THAT(complaint(with("modes_free", "modes_fre")), HasSubstr("did you mean modes_free?"));
}

TEST(Configuration, RefusesUnknownKeys)
{
  EXPECT_EQ(complaint(good + "colour: red\n"),
            "my.yaml: \"colour\" is unknown: must be one of beam1, beam2, contact, damping, basis");
  EXPECT_EQ(complaint(with("  free: 0.01\n", "  free: 0.01\n  material: wood\n")),
            "my.yaml: damping.\"material\" is unknown: must be one of free, contact");
  EXPECT_THAT(complaint(good + "  modes_per_beam: 5\n"),
              HasSubstr("basis.\"modes_per_beam\" is unknown: must be one of type, modes_free, modes_contact"));
  EXPECT_THAT(complaint(good + "[a, b]: 1\n"), HasSubstr("a key is a list: must be one of beam1"));
  EXPECT_THAT(complaint(good + "<<: {beam3: 1}\n"), HasSubstr("\"<<\" is unknown"));
}

TEST(Configuration, RefusesAKeyGivenTwice)
{
  EXPECT_EQ(complaint(with("  density: 954.0\n", "  density: 954.0\n  density: 954.0\n  density: 1.0\n")),
            "my.yaml: beam1.density is given more than once");
  EXPECT_EQ(complaint(good + "damping: {free: 0, contact: 0}\n"), "my.yaml: damping is given more than once");
}

TEST(Configuration, RefusesWrongSections)
{
  EXPECT_EQ(complaint(with("beam2:" + beam, "beam2: rigit\n")), "my.yaml: beam2 = \"rigit\": must be " + kinds);
  EXPECT_EQ(complaint(with("beam1:" + beam, "beam1: [1]\n")), "my.yaml: beam1 is a list: must be " + kinds);
  EXPECT_THAT(complaint(with("type: conjoined", "type: joined")),
              HasSubstr("basis.type = \"joined\": must be conjoined or attachment"));
  EXPECT_THAT(complaint(with("type: conjoined", "type: [conjoined]")), HasSubstr("basis.type is a list: must be"));
  EXPECT_EQ(complaint("- a\n- b\n"), "my.yaml: is a list: must be a map of beam1, beam2, contact, damping, basis");
  EXPECT_THAT(complaint("hello"), HasSubstr("my.yaml: = \"hello\": must be a map of beam1"));
}

TEST(Configuration, TellsAllFaultsAtOnce)
{
  std::string text = with("youngs_modulus", "young_modulus");
  text = with("density: 954.0", "density: heavy", text);
  text = with("free: 0.01", "free: 1.5", text);
  text = with("  modes_contact: 4\n", "", text);
  EXPECT_EQ(complaint(text),
            "my.yaml: 5 faults\n"
            "  beam1.\"young_modulus\" is unknown: did you mean youngs_modulus?\n"
            "  beam1.youngs_modulus is missing: must be a finite number > 0 (Pa)\n"
            "  beam1.density = \"heavy\": must be a finite number > 0 (kg/m^3)\n"
            "  damping.free = 1.5: must be a number >= 0 and < 1 (ratio of critical damping)\n"
            "  basis.modes_contact is missing: must be a whole number from 1 to 100");
}

TEST(Configuration, NamesThePlaceOfASyntaxError)
{
  EXPECT_THAT(complaint("beam1: {length: 1\nbeam2: rigid\n"), HasSubstr("my.yaml: line 2, column "));
  EXPECT_THAT(complaint("a: b: c\n"), HasSubstr("my.yaml: line 1, column 5: not YAML: "));
  EXPECT_THAT(complaint("beam1: *nowhere\n"), HasSubstr("my.yaml: line 1, column "));
  EXPECT_THAT(complaint("\"unfinished"), HasSubstr("my.yaml: line 1, column "));
}

TEST(Configuration, RefusesNothingAndTooMuch)
{
  for (const std::string text : {"", "\n\n", "# nothing but a comment\n", "---\n", "~\n"})
  {
    EXPECT_THAT(complaint(text), HasSubstr("my.yaml: is empty")) << text;
  }
  EXPECT_THAT(complaint(good + "---\n" + good), HasSubstr("my.yaml: holds more than one YAML document"));
}

// yaml-cpp takes these for documents without end.
TEST(Configuration, RefusesTextThatBelongsToNoDocument)
{
  for (const std::string& text : std::vector<std::string>{", a", good + "}\n", "a: b\n]"})
  {
    EXPECT_THAT(complaint(text), HasSubstr("my.yaml: ")) << text;
  }
}

TEST(Configuration, RefusesDeepNesting)
{
  EXPECT_THAT(complaint(std::string(2000, '[')), HasSubstr("not YAML: nested more than 50 deep"));
}

TEST(Configuration, SurvivesAnyDamageToTheText)
{
  std::mt19937 random(1);
  for (int round = 0; round < 2000; ++round)
  {
    std::string text = good;
    for (int change = 0; change < 3; ++change)
    {
      text[random() % text.size()] = static_cast<char>(random() % 256);
    }
    try
    {
      parse(text, "my.yaml");
    }
    catch (const Error& error)
    {
      ASSERT_THAT(error.what(), HasSubstr("my.yaml: "));
    }
  }
}

TEST(Configuration, LoadsAFile)
{
  const TemporaryDirectory directory;
  expectSame(loadFile(directory.file("system.yaml", good)), parse(good, "my.yaml"));
  const std::string bad = directory.file("bad.yaml", with("length: 0.0529", "length: -1"));
  EXPECT_EQ(fileComplaint(bad), bad + ": beam1.length = -1: must be a finite number > 0 (m)");
}

TEST(Configuration, NamesAFileThatCannotBeRead)
{
  const TemporaryDirectory directory;
  EXPECT_EQ(fileComplaint(directory.path()), directory.path() + ": cannot be read: it is a directory");
  const std::string absent = directory.path() + "/absent.yaml";
  EXPECT_EQ(fileComplaint(absent), absent + ": cannot be read: No such file or directory");
  const std::string large = directory.file("large.yaml", std::string(2 << 20, '#'));
  EXPECT_THAT(fileComplaint(large), HasSubstr("larger than"));
  const std::string empty = directory.file("empty.yaml", "");
  EXPECT_THAT(fileComplaint(empty), HasSubstr(empty + ": is empty"));
}

TEST(Configuration, WritesWhatItReads)
{
  std::mt19937 random(2);
  std::uniform_real_distribution<double> fraction(0.01, 0.99);
  for (int round = 0; round < 200; ++round)
  {
    const auto some_table = [&]
    {
      core::ModalTableParameters table;
      for (int m = 0; m < 1 + round % 4; ++m)
      {
        table.frequency_hz.push_back(1.0e3 * m * fraction(random) + (m > 0 ? 1.0 : 0.0));
        table.contact_deflection.push_back(fraction(random) - 2.0);
        table.participation.push_back(fraction(random) - 0.5);
        if (round % 5 < 2)
        {
          table.damping_ratio.push_back(fraction(random));
        }
      }
      if (round % 4 > 0)
      {
        table.static_receptance = 1.0 + fraction(random);
      }
      return table;
    };
    const auto some_beam = [&]
    {
      core::BeamParameters value;
      value.youngs_modulus = std::pow(10.0, 9.0 + 3.0 * fraction(random));
      value.density = 1.0e4 * fraction(random);
      value.length = 0.1 + fraction(random);
      switch (round % 7)
      {
        case 0:
          value.cross_section = core::Tube{0.01 + 0.01 * fraction(random), 0.005 * fraction(random), fraction(random)};
          break;
        case 1:
          value.cross_section = core::Section{fraction(random), fraction(random)};
          value.youngs_modulus = value.density = 0.0;
          break;
        default:
          value.cross_section = core::Rectangle{0.01 + 0.01 * fraction(random), 0.01 * fraction(random)};
      }
      value.contact_location = value.length * fraction(random);
      value.ends = {static_cast<core::End>(random() % 3), static_cast<core::End>(random() % 3)};
      if (round % 3 == 1)
      {
        value.rigid_body = core::RigidBody{0.1 * fraction(random), fraction(random) * core::massPerLength(value),
                                           1.0e-3 * core::massPerLength(value) * fraction(random)};
        value.contact_location = 0.5 * value.length;
      }
      return value;
    };
    core::SystemParameters parameters;
    parameters.beam1 = some_beam();
    if (round % 11 == 3)
    {
      parameters.beam1 = core::RigidSurface{};
      parameters.beam2 = some_beam();
    }
    else if (round % 3 == 0)
    {
      parameters.beam2 = core::RigidSurface{};
    }
    else if (round % 3 == 1)
    {
      parameters.beam2 = some_table();
    }
    else
    {
      parameters.beam2 = some_beam();
    }
    parameters.contact.stiffness = fraction(random) * core::referenceScales(parameters).stiffness;
    parameters.contact.clearance = 1.0e-3 * (fraction(random) - 0.5);
    parameters.damping = {fraction(random), 0.0};
    if (round % 2 == 0)
    {
      parameters.basis = core::ConjoinedBasis{1 + round % 100, 100};
    }
    else
    {
      parameters.basis = core::AttachmentBasis{1 + round % 100};
    }
    const std::string text = toYaml(parameters);
    const core::SystemParameters again = parse(text, "written");
    expectSame(again, parameters);
    EXPECT_EQ(toYaml(again), text);
  }
}

TEST(Configuration, ShippedFilesAreTheOnesOfTheirNames)
{
  const std::string folder = CONFIG_DIRECTORY;
  const auto ratio = [](const core::SystemParameters& parameters)
  { return 48.0 * parameters.contact.stiffness / core::referenceScales(parameters).stiffness; };
  const core::SystemParameters limiting = loadFile(folder + "/limiting_case.yaml");
  EXPECT_NEAR(ratio(limiting), 1000.0, 1.0e-6);
  EXPECT_NEAR(core::referenceScales(limiting).frequency, 1705.6, 0.05);
  const core::SystemParameters table1 = loadFile(folder + "/table1.yaml");
  EXPECT_NEAR(ratio(table1), 73223.0, 1.0);
  EXPECT_EQ(std::get<core::BeamParameters>(table1.beam1).contact_location, 0.0265);
}

TEST(Configuration, ShipTubeHasItsModesWhereShipsVibrate)
{
  // A clamped-pinned beam of steel and water: (3.92660^2, 7.06858^2)/(2 pi L^2) sqrt(E I/m).
  const double inner = 0.0603 - 2.0 * 0.0029;
  const double mass = 7850.0 * M_PI / 4.0 * (0.0603 * 0.0603 - inner * inner) + 2.33;
  const double stiffness = 2.06e11 * M_PI / 64.0 * (std::pow(0.0603, 4) - std::pow(inner, 4));
  const double unit = std::sqrt(stiffness / mass) / (2.0 * M_PI * 4.4 * 4.4);
  EXPECT_NEAR(2.33, 1000.0 * M_PI / 4.0 * inner * inner, 0.005);  // the water

  const core::SwitchedModel model(loadFile(std::string(CONFIG_DIRECTORY) + "/ship_tube.yaml"));
  const auto frequency = [](const core::LinearState& state, int mode) { return state.frequency[mode] / (2.0 * M_PI); };
  EXPECT_NEAR(frequency(model.free(), 0) / (unit * 3.92660 * 3.92660), 1.0, 1.0e-5);
  EXPECT_NEAR(frequency(model.free(), 1) / (unit * 7.06858 * 7.06858), 1.0, 1.0e-5);
  EXPECT_GT(frequency(model.free(), 0), 10.0);
  EXPECT_LT(frequency(model.free(), 1), 40.0);
}

/// The configuration with this in place of beam 1.
std::string withBeam1(const std::string& lines)
{
  return with("beam1:" + beam, "beam1:\n" + lines);
}

TEST(Configuration, ReadsEveryKindOfStructure)
{
  const auto structure = [](const std::string& lines) { return text(parse(withBeam1(lines), "my.yaml").beam1); };
  const std::string material = "  youngs_modulus: 2.0e+11\n  density: 7800\n  length: 2\n  contact_location: 1\n";
  EXPECT_EQ(structure(material + "  rectangle: {height: 0.01, width: 0.02}\n"),
            "beam 200000000000 7800 2 1 0 0 0 0.01 0.02 ");
  EXPECT_EQ(structure(material + "  height: 0.01\n  width: 0.02\n  ends: [clamped, free]\n"),
            "beam 200000000000 7800 2 1 1 2 0 0.01 0.02 ");
  EXPECT_EQ(structure(material + "  tube: {outer_diameter: 0.02, wall_thickness: 0.001}\n"),
            "beam 200000000000 7800 2 1 0 0 1 0.02 0.001 0 ");
  EXPECT_EQ(structure(material + "  tube: {outer_diameter: 0.02, wall_thickness: 0.001, added_mass_per_length: 0.5}\n"),
            "beam 200000000000 7800 2 1 0 0 1 0.02 0.001 0.5 ");
  const std::string section =
      "  length: 2\n  contact_location: 1\n  section: {bending_stiffness: 12.5, mass_per_length: 0.4}\n";
  EXPECT_EQ(structure(section), "beam 0 0 2 1 0 0 2 12.5 0.4 ");
  EXPECT_EQ(structure(section + "  ends: [free, pinned]\n  rigid_body: {length: 0.1, mass: 3, rotary_inertia: 0}\n"),
            "beam 0 0 2 1 2 0 2 12.5 0.4 3 0.1 3 0 ");
  EXPECT_EQ(
      structure("  modal_table: {frequency_hz: [0, 12.5], contact_deflection: [1, -2], participation: [0.5, 0]}\n"),
      "table 0 12.5 | 1 -2 | 0.5 0 | | none");
  EXPECT_EQ(
      structure("  modal_table:\n    frequency_hz: [10]\n    contact_deflection: ['1.5']\n    participation: [0.5]\n"
                "    damping_ratio: [0.02]\n    static_receptance: 1\n"),
      "table 10 | 1.5 | 0.5 | 0.02 | 1");
  EXPECT_EQ(text(parse(with("beam1:" + beam, "beam1: rigid\n"), "my.yaml").beam1), "rigid");
}

TEST(Configuration, SaysWhatIsWrongWithAStructure)
{
  const std::string material = "  youngs_modulus: 2.0e+11\n  density: 7800\n  length: 2\n  contact_location: 1\n";
  const std::string rectangle = material + "  rectangle: {height: 0.01, width: 0.02}\n";
  const std::string table =
      "  modal_table: {frequency_hz: [10, 20], contact_deflection: [1, 2], participation: [0, 1]}\n";
  const auto fault = [](const std::string& lines) { return complaint(withBeam1(lines)); };
  ASSERT_EQ(fault(rectangle), "");
  ASSERT_EQ(fault(table), "");

  EXPECT_EQ(fault(with("0.02", "-1", rectangle)),
            "my.yaml: beam1.rectangle.width = -1: must be a finite number > 0 (m)");
  EXPECT_EQ(fault(rectangle + "  tube: {outer_diameter: 1, wall_thickness: 0.1}\n"),
            "my.yaml: beam1 has rectangle, tube: must be with one cross-section: height and width, rectangle, tube or "
            "section");
  EXPECT_EQ(fault(material + "  tube: {outer_diameter: 1, wall_thickness: 0.6}\n"),
            "my.yaml: beam1.tube.wall_thickness = 0.6: must be at most half the outer diameter, 0.5 (m)");
  EXPECT_EQ(fault(material + "  tube: {outer_diameter: 1}\n"),
            "my.yaml: beam1.tube.wall_thickness is missing: must be a finite number > 0 (m)");
  EXPECT_THAT(fault(material + "  section: {bending_stiffness: 1, mass_per_length: 1}\n"),
              HasSubstr("beam1.youngs_modulus = 2.0e+11: must be left out where the section says it all"));
  EXPECT_EQ(fault(rectangle + "  ends: [clamped, fre]\n"),
            "my.yaml: beam1.ends = \"[clamped, fre]\": must be a list of two of pinned, clamped, free");
  EXPECT_EQ(fault(rectangle + "  ends: clamped\n"),
            "my.yaml: beam1.ends = \"clamped\": must be a list of two of pinned, clamped, free");
  EXPECT_EQ(fault(rectangle + "  rigid_body: {length: 2.5, mass: 1, rotary_inertia: 0}\n"),
            "my.yaml: beam1.rigid_body.length = 2.5: must be a number >= 0 and <= 1.998, which is 0.999 of the beam's "
            "length (m)");
  EXPECT_EQ(fault(with("contact_location: 1", "contact_location: 1.2",
                       rectangle + "  rigid_body: {length: 0.2, mass: 1, rotary_inertia: 0}\n")),
            "my.yaml: beam1.contact_location = 1.2: must be on the rigid body, from 0.9 to 1.1 (m)");
  EXPECT_EQ(fault(with("contact_location: 1", "contact_location: 2.5", rectangle)),
            "my.yaml: beam1.contact_location = 2.5: must be a number > 0 and < 2, the length (m), no nearer to either "
            "than 1e-06 of it");
  EXPECT_EQ(
      fault(with("contact_location: 1", "contact_location: 2.5", rectangle + "  ends: [clamped, free]\n")),
      "my.yaml: beam1.contact_location = 2.5: must be a number > 0 and <= 2, the length (m), no nearer to the first "
      "end than 0.001 of it");
  EXPECT_THAT(complaint(with("beam2:" + beam, "beam2: rigid\n", with("beam1:" + beam, "beam1: rigid\n"))),
              HasSubstr("beam2 = rigid: must be a beam or a modal table where beam1 is rigid"));

  EXPECT_EQ(fault(with("[10, 20]", "[10, -20]", table)),
            "my.yaml: beam1.modal_table.frequency_hz[2] = -20: must be 0, for a rigid-body mode, or from 1e-60 to "
            "1e+60 (Hz)");
  EXPECT_EQ(fault(with("[1, 2]", "[1, two]", table)),
            "my.yaml: beam1.modal_table.contact_deflection[2] = \"two\": must be 0 or of a size from 1e-60 to 1e+60 "
            "(kg^-1/2)");
  EXPECT_EQ(fault(with("[1, 2]", "[0, 0]", table)),
            "my.yaml: beam1.modal_table.contact_deflection = 0 in every mode: must be other than 0 in at least one: no "
            "mode moves the contact point");
  EXPECT_EQ(fault(with("[1, 2]", "[1]", table)),
            "my.yaml: beam1.modal_table.contact_deflection: number of values = 1: must be 2, as many as frequencies");
  EXPECT_EQ(
      fault(with(", participation: [0, 1]", "", table)),
      "my.yaml: beam1.modal_table.participation is missing: must be a list of numbers, or file in place of all lists");
  EXPECT_EQ(
      fault(with("}", ", static_receptance: 1.0e-9}", table)),
      "my.yaml: beam1.modal_table.static_receptance = 1.0e-9: must be a number >= 0.000506605918211689 (m/N), which "
      "its modes have by themselves");
  EXPECT_EQ(
      fault(with("}", ", damping_ratio: [0, 1]}", table)),
      "my.yaml: beam1.modal_table.damping_ratio[2] = 1: must be a number >= 0 and < 1 (ratio of critical damping)");
  EXPECT_EQ(fault(table + rectangle),
            "my.yaml: 5 faults\n  beam1.\"youngs_modulus\" is unknown: must be one of modal_table\n"
            "  beam1.\"density\" is unknown: must be one of modal_table\n"
            "  beam1.\"length\" is unknown: must be one of modal_table\n"
            "  beam1.\"contact_location\" is unknown: must be one of modal_table\n"
            "  beam1.\"rectangle\" is unknown: must be one of modal_table");
}

TEST(Configuration, ReadsAModalTableFromAFileBesideIt)
{
  const TemporaryDirectory directory;
  const std::string csv = directory.file("table.csv",
                                         "\xEF\xBB\xBF# by hand\r\nmode, participation "
                                         ",contact_deflection,frequency_hz\r\n1, 0.5, 1.5,0\r\n\r\n2,0,-2,12.5\r\n");
  const std::string yaml = withBeam1("  modal_table: {file: table.csv, static_receptance: 1}\n");
  const std::string path = directory.file("my.yaml", yaml);
  const core::SystemParameters parameters = loadFile(path);
  EXPECT_EQ(text(parameters.beam1), "table 0 12.5 | 1.5 -2 | 0.5 0 | | 1");
  const std::string absolute = with("table.csv", csv, yaml);
  expectSame(parse(absolute, "my.yaml"), parameters);
  EXPECT_EQ(toYaml(parameters).find(".csv"), std::string::npos) << "the text needs no other file";
  expectSame(parse(toYaml(parameters), "again"), parameters);

  EXPECT_EQ(
      complaint(yaml),
      "my.yaml: beam1.modal_table.file = \"table.csv\": must be an absolute path: nothing says which folder it is "
      "relative to");
  EXPECT_THAT(complaint(with("static_receptance", "frequency_hz: [1], static_receptance", absolute)),
              HasSubstr("beam1.modal_table.frequency_hz is a list: must be left out where a file is given"));
  EXPECT_EQ(complaint(withBeam1("  modal_table: {file: }\n")),
            "my.yaml: beam1.modal_table.file is empty: must be the path of a CSV file");

  const auto fault = [&](const std::string& content)
  {
    directory.file("table.csv", content);
    return complaint(absolute);
  };
  const std::string place = "my.yaml: beam1.modal_table.file: " + csv + ": ";
  const std::string header = "frequency_hz,contact_deflection,participation\n";
  EXPECT_EQ(fault("frequency_hz,participation\n1,1\n"),
            place +
                "line 1: columns are missing: contact_deflection: must have frequency_hz, contact_deflection, "
                "participation and may have damping_ratio");
  EXPECT_EQ(fault("frequency_hz,contact_deflection,participation,damping_ration\n1,1,1,1\n"),
            place + "line 1: column \"damping_ration\" is unknown: did you mean damping_ratio?");
  EXPECT_EQ(fault("frequency_hz,contact_deflection,participation,frequency_hz\n1,1,1,1\n"),
            place + "line 1: column frequency_hz is there more than once");
  EXPECT_EQ(fault(header + "1,1\n"), place + "line 2: has 2 columns: must have 3, as the first line");
  EXPECT_EQ(fault(header + "1,1,nan\n"), place + "line 2: column participation = \"nan\": must be a finite number");
  EXPECT_EQ(fault(header),
            place + "holds no modes: must be a line with the names of the columns, then one line a mode");
  EXPECT_EQ(fault(""), place + "holds no modes: must be a line with the names of the columns, then one line a mode");
  EXPECT_EQ(fault(header + "1,1,0\n-5,1,1\n"),
            "my.yaml: beam1.modal_table.frequency_hz[2] of " + csv +
                " = -5: must be 0, for a rigid-body mode, or from 1e-60 to 1e+60 (Hz)");
  EXPECT_EQ(fault(header + "1,0,0\n5,0,1\n"),
            "my.yaml: beam1.modal_table.contact_deflection of " + csv +
                " = 0 in every mode: must be other than 0 in at least one: no mode moves the contact point");
  EXPECT_EQ(complaint(with("table.csv", "nowhere.csv", absolute)),
            "my.yaml: beam1.modal_table.file: " + with("table.csv", "nowhere.csv", csv) +
                ": cannot be read: No such file or directory");
}

TEST(Number, ReadsBackExactly)
{
  for (const double value : {0.0, -0.0, 0.1, 1.0 / 3.0, 1.0e300, -2.5e-300, 5.0e-324, 1.7976931348623157e308, 1705.6})
  {
    const auto again = parseNumber(formatNumber(value));
    ASSERT_TRUE(again) << value;
    EXPECT_EQ(*again, value);
    EXPECT_EQ(std::signbit(*again), std::signbit(value));
  }
  EXPECT_EQ(formatNumber(0.1), "0.1");
}

TEST(Number, ReadsWholeNumbers)
{
  EXPECT_EQ(parseInteger("12"), 12);
  EXPECT_EQ(parseInteger("+12"), 12);
  EXPECT_EQ(parseInteger("-12"), -12);
  for (const std::string text : {"", "+", "-", "+-1", "1.0", "1e3", " 1", "1 ", "0x1", "9223372036854775808"})
  {
    EXPECT_FALSE(parseInteger(text)) << text;
  }
}

}  // namespace
}  // namespace vibro_impact::config
