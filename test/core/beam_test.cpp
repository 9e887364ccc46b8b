#include "vibro_impact/core/beam.h"

#include <cmath>

#include <gtest/gtest.h>

#include "reference_system.h"

using namespace vibro_impact::core;

namespace
{
constexpr double pi = 3.14159265358979323846;

BeamParameters beamWithContactAt(double share)
{
  BeamParameters parameters = paperBeam();
  parameters.contact_location = share * parameters.length;
  return parameters;
}

/// sum_m phi_m^2/(omega_m^2 - omega^2) by brute force, small terms first.
double receptanceBySummation(const Beam& beam, double omega, int modes)
{
  double sum = 0.0;
  for (int m = modes; m >= 1; --m)
  {
    const Mode mode = beam.mode(m);
    sum += mode.contact_deflection * mode.contact_deflection / (mode.frequency * mode.frequency - omega * omega);
  }
  return sum;
}
}  // namespace

TEST(Beam, hasThePapersLowestFrequency)
{
  EXPECT_NEAR(Beam(paperBeam()).mode(1).frequency, 1705.6, 0.05);
  EXPECT_NEAR(Beam(paperBeam()).mode(1).frequency / (2.0 * pi), 271.5, 0.05);
}

TEST(Beam, participationsSumToTheMassOfTheBeam)
{
  // sum Gamma^2 = m L: the whole beam takes part in base motion. The rest above M falls as 8 m L/(pi^2 2 M).
  const Beam beam(paperBeam());
  double sum = 0.0;
  for (int m = 1; m <= 20000; ++m)
  {
    sum += std::pow(beam.mode(m).participation, 2);
  }
  const double mass = massPerLength(paperBeam()) * paperBeam().length;
  EXPECT_NEAR(sum / mass, 1.0, 4.0 / (pi * pi * 20000.0) * 1.01);
}

TEST(Beam, contactAtANodeMovesNothing)
{
  EXPECT_EQ(Beam(beamWithContactAt(0.5)).mode(2).contact_deflection, 0.0);
  EXPECT_EQ(Beam(beamWithContactAt(0.5)).mode(100).contact_deflection, 0.0);
  EXPECT_EQ(Beam(beamWithContactAt(1.0 / 3.0)).mode(3).contact_deflection, 0.0);
  EXPECT_NE(Beam(beamWithContactAt(0.501)).mode(2).contact_deflection, 0.0);
}

TEST(Beam, staticDeflectionsEqualTheirModalSums)
{
  for (const double share : {0.5, 0.3, 0.05, 0.9})
  {
    const Beam beam(beamWithContactAt(share));
    double response = 0.0;
    for (int m = 2001; m >= 1; --m)
    {
      const Mode mode = beam.mode(m);
      response += mode.contact_deflection * mode.participation / (mode.frequency * mode.frequency);
    }
    EXPECT_NEAR(beam.staticBaseResponse(0) / response, 1.0, 1e-12) << "contact at " << share;
    EXPECT_NEAR(beam.staticReceptance(0) / receptanceBySummation(beam, 0.0, 5000), 1.0, 1e-9) << "contact at " << share;
  }
}

TEST(Beam, staticDeflectionsWithoutTheKeptModesEqualTheSumsOfTheOthers)
{
  for (const double share : {0.5, 0.3, 0.05})
  {
    const Beam beam(beamWithContactAt(share));
    for (const int kept : {1, 2, 5, 20, 100})
    {
      double receptance = 0.0;
      double response = 0.0;
      for (int m = 200000; m > kept; --m)
      {
        const Mode mode = beam.mode(m);
        const double compliance = mode.contact_deflection / (mode.frequency * mode.frequency);
        receptance += compliance * mode.contact_deflection;
        response += compliance * mode.participation;
      }
      EXPECT_NEAR(beam.staticReceptance(kept) / receptance, 1.0, 1e-8) << share << ", without " << kept;
      EXPECT_NEAR(beam.staticBaseResponse(kept) / response, 1.0, 1e-8) << share << ", without " << kept;
    }
  }
}

TEST(Beam, midspanStiffnessIs48EIOverL3)
{
  const Beam beam(paperBeam());
  EXPECT_NEAR(beam.staticReceptance(0) * 48.0 * bendingStiffness(paperBeam()) / std::pow(paperBeam().length, 3), 1.0,
              1e-14);
}

TEST(Beam, receptanceEqualsItsModalSumAtAnyFrequency)
{
  for (const double share : {0.5, 0.3, 0.07})
  {
    const Beam beam(beamWithContactAt(share));
    const double lowest = beam.mode(1).frequency;
    for (const double relative : {0.0, 1e-6, 0.003, 0.00406, 0.0041, 0.1, 0.7, 1.3, 3.1, 7.7, 15.0, 47.3})
    {
      const double omega = relative * lowest;
      const double closed = beam.receptance(omega);
      const double summed = receptanceBySummation(beam, omega, 20000);
      EXPECT_NEAR(closed, summed, 1e-10 * (std::abs(summed) + beam.staticReceptance(0) * 1e-3))
          << "contact at " << share << ", omega* " << relative;
    }
  }
}

TEST(Beam, receptanceDoesNotOverflowFarAbove)
{
  const Beam beam(beamWithContactAt(0.37));
  const double omega = 1e7 * beam.mode(1).frequency;  // sinh would be of 1e4 here
  EXPECT_TRUE(std::isfinite(beam.receptance(omega)));
}

TEST(Beam, receptanceHasALimitWhereAModeHasItsNodeAtTheContact)
{
  const Beam beam(beamWithContactAt(0.5));
  const double omega = beam.mode(2).frequency;
  EXPECT_NEAR(beam.receptance(omega), receptanceBySummation(beam, omega * (1.0 + 1e-9), 20000),
              1e-6 * beam.staticReceptance(0));
}
