#include "vibro_impact/core/parameters.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>

#include "reference_system.h"

namespace vibro_impact::core
{
namespace
{
SystemParameters goodParameters()
{
  SystemParameters parameters;
  parameters.beam1 = BeamParameters{1.66e9, 954.0, 0.0529, Rectangle{0.00127, 0.0127}, 0.02645};
  parameters.beam2 = BeamParameters{1.66e12, 954.0, 0.0529, Rectangle{0.00127, 0.0127}, 0.02645};
  parameters.contact = {24309.4, 0.0};
  parameters.damping = {0.01, 0.05};
  return parameters;
}

std::string complaint(const SystemParameters& parameters)
{
  try
  {
    validate(parameters);
  }
  catch (const std::invalid_argument& error)
  {
    return error.what();
  }
  return "";
}

TEST(Parameters, GoodOnesPass)
{
  SystemParameters parameters = goodParameters();
  EXPECT_EQ(complaint(parameters), "");
  parameters.beam2 = RigidSurface{};
  parameters.damping = {0.0, 0.0};
  parameters.contact.clearance = -1.0e-5;
  parameters.basis = ConjoinedBasis{1, 100};
  EXPECT_EQ(complaint(parameters), "");
  for (const double ratio : {1.0e-3, 1.0e9})
  {
    parameters.contact.stiffness = ratio * referenceScales(parameters).stiffness / 48.0;
    EXPECT_EQ(complaint(parameters), "") << ratio;
  }
}

TEST(Parameters, EveryRangeIsChecked)
{
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const struct
  {
    double BeamParameters::*member;
    std::string name;
  } lengths[] = {{&BeamParameters::youngs_modulus, "youngs_modulus"},
                 {&BeamParameters::density, "density"},
                 {&BeamParameters::length, "length"},
                 {&BeamParameters::contact_location, "contact_location"}};
  for (const auto& length : lengths)
  {
    for (const double value : {0.0, -1.0, infinity, -infinity, nan})
    {
      SystemParameters parameters = goodParameters();
      std::get<BeamParameters>(parameters.beam1).*length.member = value;
      EXPECT_EQ(complaint(parameters).find("beam1." + length.name + " = "), 0u) << value;
      parameters = goodParameters();
      std::get<BeamParameters>(parameters.beam2).*length.member = value;
      EXPECT_EQ(complaint(parameters).find("beam2." + length.name + " = "), 0u) << value;
    }
  }
  for (const double value : {-1.0e-9, 1.0, infinity, nan})
  {
    SystemParameters parameters = goodParameters();
    parameters.damping.free = value;
    EXPECT_EQ(complaint(parameters).find("damping.free = "), 0u) << value;
    parameters = goodParameters();
    parameters.damping.contact = value;
    EXPECT_EQ(complaint(parameters).find("damping.contact = "), 0u) << value;
  }
  for (const double value : {0.0, -1.0, infinity, nan})
  {
    SystemParameters parameters = goodParameters();
    parameters.contact.stiffness = value;
    EXPECT_EQ(complaint(parameters).find("contact.stiffness = "), 0u) << value;
  }
  for (const double value : {infinity, -infinity, nan})
  {
    SystemParameters parameters = goodParameters();
    parameters.contact.clearance = value;
    EXPECT_EQ(complaint(parameters).find("contact.clearance = "), 0u) << value;
  }
  for (const int modes : {0, -1, 101})
  {
    SystemParameters parameters = goodParameters();
    parameters.basis = AttachmentBasis{modes};
    EXPECT_EQ(complaint(parameters),
              "basis.modes_per_beam = " + std::to_string(modes) + ": must be a whole number from 1 to 100");
    parameters.basis = ConjoinedBasis{modes, 2};
    EXPECT_EQ(complaint(parameters).find("basis.modes_free = "), 0u);
    parameters.basis = ConjoinedBasis{2, modes};
    EXPECT_EQ(complaint(parameters).find("basis.modes_contact = "), 0u);
  }
}

TEST(Parameters, TheContactKeepsAwayFromTheSupports)
{
  SystemParameters parameters = goodParameters();
  for (const double share : {1.0e-7, 1.0 - 1.0e-7, 1.0, 1.5})
  {
    beamOf(parameters.beam1).contact_location = share * beamOf(parameters.beam1).length;
    EXPECT_EQ(complaint(parameters).find("beam1.contact_location = "), 0u) << share;
  }
  for (const double share : {1.0e-5, 1.0 - 1.0e-5})
  {
    beamOf(parameters.beam1).contact_location = share * beamOf(parameters.beam1).length;
    EXPECT_EQ(complaint(parameters), "") << share;
  }
}

TEST(Parameters, AllFaultsAreInOneMessage)
{
  SystemParameters parameters = goodParameters();
  beamOf(parameters.beam1).contact_location = 0.06;
  parameters.contact.stiffness = -1.0;
  parameters.damping.free = 2.0;
  EXPECT_EQ(complaint(parameters),
            "beam1.contact_location = 0.06: must be a number > 0 and < 0.0529, the length (m), no nearer to either "
            "than 1e-06 of it; "
            "contact.stiffness = -1: must be a finite number > 0 (N/m); "
            "damping.free = 2: must be a number >= 0 and < 1 (ratio of critical damping)");
}

TEST(Parameters, ProductsThatOverflowOrVanishAreRefused)
{
  const auto key = [](const SystemParameters& parameters)
  {
    const std::string message = complaint(parameters);
    return message.substr(0, message.find(" = "));
  };
  SystemParameters parameters = goodParameters();
  beamOf(parameters.beam1).youngs_modulus = 1.0e308;
  beamOf(parameters.beam1).cross_section = Rectangle{1.0e10, 0.0127};
  EXPECT_EQ(key(parameters), "beam1: bending stiffness E I");
  parameters = goodParameters();
  beamOf(parameters.beam1).density = 1.0e-320;
  EXPECT_EQ(key(parameters), "beam1: mass per length rho A");
  parameters = goodParameters();
  beamOf(parameters.beam1).length = 1.0e200;
  beamOf(parameters.beam1).contact_location = 0.5e200;
  EXPECT_EQ(key(parameters), "beam1: mass");
  parameters = goodParameters();
  beamOf(parameters.beam1).length = 1.0e-40;
  beamOf(parameters.beam1).contact_location = 0.5e-40;
  EXPECT_EQ(key(parameters), "beam1: lowest natural frequency");
  parameters = goodParameters();
  parameters.contact.clearance = 1.0e300;
  EXPECT_EQ(key(parameters), "contact: stiffness times clearance, without sign");
  for (const double stiffness : {1.0e-30, 1.0e30})
  {
    parameters = goodParameters();
    parameters.contact.stiffness = stiffness;
    EXPECT_EQ(key(parameters), "contact: stiffness over that of the more flexible beam, k L^3/(E I)");
  }
}

TEST(Parameters, ReferenceScalesAreThoseOfBeam1)
{
  // E = 12, b h^3 = 1, so E I = 1; rho A = 4; L = 2.
  SystemParameters parameters;
  parameters.beam1 = BeamParameters{12.0, 4.0, 2.0, Rectangle{1.0, 1.0}, 1.0};
  const ReferenceScales scales = referenceScales(parameters);
  EXPECT_DOUBLE_EQ(scales.frequency, 9.869604401089358 / 4.0 / 2.0);
  EXPECT_DOUBLE_EQ(scales.stiffness, 6.0);
  EXPECT_DOUBLE_EQ(scales.length, 2.0);
  EXPECT_DOUBLE_EQ(scales.impulseStar(3.0), 3.0 * scales.frequency / 12.0);
}

}  // namespace
}  // namespace vibro_impact::core
