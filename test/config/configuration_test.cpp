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

std::string beamText(const core::BeamParameters& value)
{
  std::string text;
  for (const double number :
       {value.youngs_modulus, value.density, value.length, value.height, value.width, value.contact_location})
  {
    text += formatNumber(number) + " ";
  }
  return text;
}

void expectSame(const core::SystemParameters& a, const core::SystemParameters& b)
{
  EXPECT_EQ(beamText(a.beam1), beamText(b.beam1));
  ASSERT_EQ(a.beam2.index(), b.beam2.index());
  if (const auto* beam2 = std::get_if<core::BeamParameters>(&a.beam2))
  {
    EXPECT_EQ(beamText(*beam2), beamText(std::get<core::BeamParameters>(b.beam2)));
  }
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
  EXPECT_EQ(parameters.beam1.youngs_modulus, 1.66e9);
  EXPECT_EQ(parameters.beam1.density, 954.0);
  EXPECT_EQ(parameters.beam1.length, 0.0529);
  EXPECT_EQ(parameters.beam1.height, 0.00127);
  EXPECT_EQ(parameters.beam1.width, 0.0127);
  EXPECT_EQ(parameters.beam1.contact_location, 0.02645);
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
    EXPECT_EQ(parse(with("1.66e+9", text), "my.yaml").beam1.youngs_modulus, 1.66e9) << text;
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
  EXPECT_EQ(
      complaint(with("beam1:" + beam, "")),
      "my.yaml: beam1 is missing: must be a map of youngs_modulus, density, length, height, width, contact_location");
  EXPECT_EQ(
      complaint(with("beam2:" + beam, "")),
      "my.yaml: beam2 is missing: must be a map of youngs_modulus, density, length, height, width, contact_location");
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
  EXPECT_EQ(complaint(with("beam1:" + beam, "beam1: rigid\n")),
            "my.yaml: beam1 = \"rigid\": must be a map of youngs_modulus, density, length, height, width, "
            "contact_location");
  EXPECT_EQ(complaint(with("beam2:" + beam, "beam2: rigit\n")),
            "my.yaml: beam2 = \"rigit\": must be a map as beam1, or the word rigid");
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
  EXPECT_THAT(complaint(good + "---\n" + good), HasSubstr("my.yaml: holds 2 YAML documents: must be one"));
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
    const auto some_beam = [&]
    {
      core::BeamParameters value;
      value.youngs_modulus = std::pow(10.0, 9.0 + 3.0 * fraction(random));
      value.density = 1.0e4 * fraction(random);
      value.length = 0.1 + fraction(random);
      value.height = 0.01 + 0.01 * fraction(random);
      value.width = 0.01 * fraction(random);
      value.contact_location = value.length * fraction(random);
      return value;
    };
    core::SystemParameters parameters;
    parameters.beam1 = some_beam();
    if (round % 3 == 0)
    {
      parameters.beam2 = core::RigidSurface{};
    }
    else
    {
      parameters.beam2 = some_beam();
    }
    parameters.contact.stiffness = fraction(random) * core::referenceScales(parameters.beam1).stiffness;
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
  { return 48.0 * parameters.contact.stiffness / core::referenceScales(parameters.beam1).stiffness; };
  const core::SystemParameters limiting = loadFile(folder + "/limiting_case.yaml");
  EXPECT_NEAR(ratio(limiting), 1000.0, 1.0e-6);
  EXPECT_NEAR(core::referenceScales(limiting.beam1).frequency, 1705.6, 0.05);
  const core::SystemParameters table1 = loadFile(folder + "/table1.yaml");
  EXPECT_NEAR(ratio(table1), 73223.0, 1.0);
  EXPECT_EQ(table1.beam1.contact_location, 0.0265);
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
