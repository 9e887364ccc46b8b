#include "vibro_impact/core/beam.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "finite_element_beam.h"
#include "reference_system.h"

using namespace vibro_impact::core;

namespace
{
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
constexpr End all_ends[] = {End::pinned, End::clamped, End::free};

std::string name(const BeamParameters& beam)
{
  const char* names[] = {"pinned", "clamped", "free"};
  return std::string(names[static_cast<int>(beam.ends[0])]) + "-" + names[static_cast<int>(beam.ends[1])] +
         (beam.rigid_body ? " with body" : "") + ", contact at " + std::to_string(beam.contact_location / beam.length);
}

/// A beam of every pair of ends, of which no number is 1.
std::vector<BeamParameters> allPairs(double share)
{
  std::vector<BeamParameters> beams;
  for (const End first : all_ends)
  {
    for (const End last : all_ends)
    {
      BeamParameters beam;
      beam.length = 1.7;
      beam.cross_section = Section{23.0, 0.6};
      beam.contact_location = share * beam.length;
      beam.ends = {first, last};
      beams.push_back(beam);
    }
  }
  return beams;
}

/// The same with a body, the contact off its middle by a share of half its length.
std::vector<BeamParameters> allPairsWithBody(const RigidBody& body, double share)
{
  std::vector<BeamParameters> beams = allPairs(0.5);
  for (BeamParameters& beam : beams)
  {
    beam.rigid_body = body;
    beam.contact_location += 0.5 * share * body.length;
  }
  return beams;
}

std::vector<BeamParameters> manyBeams()
{
  std::vector<BeamParameters> beams = allPairs(0.5);
  for (const auto& more : {allPairs(0.27), allPairs(0.93), allPairsWithBody({0.2, 0.5, 0.01}, 0.0),
                           allPairsWithBody({0.6, 0.1, 0.002}, 0.7), allPairsWithBody({0.0, 3.0, 0.2}, 0.0),
                           allPairsWithBody({0.4, 0.0, 0.0}, -0.4), allPairsWithBody({0.3, 40.0, 3.0}, 0.5)})
  {
    beams.insert(beams.end(), more.begin(), more.end());
  }
  return beams;
}

double massOf(const BeamParameters& beam)
{
  return beam.rigid_body ? massPerLength(beam) * (beam.length - beam.rigid_body->length) + beam.rigid_body->mass
                         : massPerLength(beam) * beam.length;
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
    double receptance = 0.0;
    double response = 0.0;
    for (int m = 60000; m > 1; --m)
    {
      const Mode mode = beam.mode(m);
      const double compliance = mode.contact_deflection / (mode.frequency * mode.frequency);
      receptance += compliance * mode.contact_deflection;
      response += compliance * mode.participation;
      for (const int kept : {1, 2, 5, 20, 100})
      {
        if (m == kept + 1)
        {
          EXPECT_NEAR(beam.staticReceptance(kept) / receptance, 1.0, 1e-8) << share << ", without " << kept;
          EXPECT_NEAR(beam.staticBaseResponse(kept) / response, 1.0, 1e-8) << share << ", without " << kept;
        }
      }
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

TEST(Beam, eigenvaluesAreThoseOfTheTextbook)
{
  // R. D. Blevins, Formulas for Natural Frequency and Mode Shape, table 8-1.
  const std::vector<double> clamped = {4.73004074, 7.85320462, 10.9956079, 14.1371655, 17.2787597};
  const std::vector<double> cantilever = {1.87510407, 4.69409113, 7.85475744, 10.99554073, 14.13716839};
  const std::vector<double> propped = {3.92660231, 7.06858275, 10.21017612, 13.35176878, 16.49336143};
  const std::vector<double> pinned = {pi, 2.0 * pi, 3.0 * pi, 4.0 * pi, 5.0 * pi};
  for (const BeamParameters& parameters : allPairs(0.3))
  {
    const Beam beam(parameters);
    const End a = parameters.ends[0];
    const End b = parameters.ends[1];
    const bool has_pin = a == End::pinned || b == End::pinned;
    const std::vector<double>& expected = a == b ? (has_pin ? pinned : clamped) : (has_pin ? propped : cantilever);
    const double unit =
        std::sqrt(bendingStiffness(parameters) / massPerLength(parameters)) / std::pow(parameters.length, 2);
    const int rigid = (a == End::free ? 1 : 0) + (b == End::free ? 1 : 0);
    EXPECT_EQ(beam.rigidBodyModeCount(), a == End::clamped || b == End::clamped ? 0 : rigid) << name(parameters);
    for (int m = 1; m <= beam.rigidBodyModeCount(); ++m)
    {
      EXPECT_EQ(beam.mode(m).frequency, 0.0) << name(parameters);
    }
    for (int m = 1; m <= 5; ++m)
    {
      const double lambda = std::sqrt(beam.mode(m + beam.rigidBodyModeCount()).frequency / unit);
      EXPECT_NEAR(lambda, expected[static_cast<std::size_t>(m - 1)], 1e-7) << name(parameters) << ", mode " << m;
    }
  }
}

TEST(Beam, shapesAreOrthogonalAndMassNormalised)
{
  // Gauss's rule of four points in each of 400 intervals; a shape is what the contact deflection is of its place.
  const double points[] = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263};
  const double weights[] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731, 0.1739274225687269};
  constexpr int intervals = 400;
  const std::vector<int> modes = {1, 2, 3, 4, 5, 8, 30, 31};
  const auto count = static_cast<Eigen::Index>(modes.size());
  for (const BeamParameters& pair : allPairs(0.5))
  {
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd areas = Eigen::VectorXd::Zero(count);
    for (int i = 0; i < intervals; ++i)
    {
      for (int j = 0; j < 4; ++j)
      {
        BeamParameters parameters = pair;
        parameters.contact_location = (i + points[j]) / intervals * pair.length;
        const Beam beam(parameters);
        Eigen::VectorXd shape(count);
        for (Eigen::Index n = 0; n < count; ++n)
        {
          shape(n) = beam.mode(modes[static_cast<std::size_t>(n)]).contact_deflection;
        }
        const double mass = weights[j] / intervals * massOf(pair);
        products += mass * shape * shape.transpose();
        areas += mass * shape;
      }
    }
    EXPECT_LT((products - Eigen::MatrixXd::Identity(count, count)).cwiseAbs().maxCoeff(), 1e-11) << name(pair);
    const Beam beam(pair);
    for (Eigen::Index n = 0; n < count; ++n)
    {
      EXPECT_NEAR(beam.mode(modes[static_cast<std::size_t>(n)]).participation, areas(n),
                  1e-11 * std::sqrt(massOf(pair)))
          << name(pair);
    }
  }
}

TEST(Beam, participationsSumToTheMassThatMoves)
{
  // The rest falls as 1/M: none of it where no support has to be dragged along, as 2/(lambda_M) or so at each other
  // end.
  for (const BeamParameters& parameters : manyBeams())
  {
    const Beam beam(parameters);
    const int modes = parameters.rigid_body ? 60 : 1000;
    double sum = 0.0;
    for (int m = 1; m <= modes; ++m)
    {
      sum += std::pow(beam.mode(m).participation, 2);
    }
    const double share = sum / massOf(parameters);
    EXPECT_LT(share, 1.0 + 1e-12) << name(parameters);
    EXPECT_GT(share, 1.0 - 3.0 / modes) << name(parameters);
  }
}

TEST(Beam, highModesKeepTheirDigits)
{
  for (const BeamParameters& parameters : allPairs(0.5))
  {
    for (const double share : {0.1, 0.5})
    {
      BeamParameters placed = parameters;
      placed.contact_location = share * placed.length;
      const Beam beam(placed);
      for (const int m : {50, 1000, 20000})
      {
        // Away from the ends a shape is a sine of amplitude sqrt(2/mass) whose phase at an end is that end's alone.
        const double q =
            (parameters.ends[0] == End::pinned ? 0.0 : 0.25) + (parameters.ends[1] == End::pinned ? 0.0 : 0.25);
        const int free = (parameters.ends[0] == End::free ? 1 : 0) + (parameters.ends[1] == End::free ? 1 : 0);
        // a free end takes one half wave: with motions as a rigid body these come first
        const double beta = (m - free + q) * pi;
        const double unit = std::sqrt(bendingStiffness(placed) / massPerLength(placed)) / std::pow(placed.length, 2);
        const Mode mode = beam.mode(m);
        EXPECT_NEAR(std::sqrt(mode.frequency / unit) / beta, 1.0, 1e-14) << name(placed) << ", mode " << m;
        const double phase = parameters.ends[0] == End::pinned ? 0.0 : -0.25;
        const double expected = std::sqrt(2.0 / massOf(placed)) * std::abs(std::sin(beta * share + phase * pi));
        EXPECT_NEAR(std::abs(mode.contact_deflection), expected,
                    1e-10 * std::sqrt(2.0 / massOf(placed)) + std::exp(-beta * share))
            << name(placed) << ", mode " << m;
      }
    }
  }
}

TEST(Beam, everyKindAgreesWithFiniteElements)
{
  for (const BeamParameters& parameters : manyBeams())
  {
    const Beam beam(parameters);
    const constexpr int elements = 24;
    const FiniteElementBeam reference(parameters, elements);
    const double longest =
        std::max(parameters.contact_location, parameters.length - parameters.contact_location) / elements;
    const int rigid = beam.rigidBodyModeCount();
    const double scale = beam.mode(rigid + 1).frequency;
    double deflection = 0.0;
    double participation = 0.0;
    double product = 0.0;
    for (int m = 1; m <= rigid; ++m)
    {
      EXPECT_LT(reference.frequencies(m - 1), 1e-2 * scale) << name(parameters);
      deflection += std::pow(beam.mode(m).contact_deflection, 2) - std::pow(reference.deflections(m - 1), 2);
      participation += std::pow(beam.mode(m).participation, 2) - std::pow(reference.participations(m - 1), 2);
      product += beam.mode(m).contact_deflection * beam.mode(m).participation -
                 reference.deflections(m - 1) * reference.participations(m - 1);
    }
    EXPECT_NEAR(deflection * massOf(parameters), 0.0, 1e-4) << name(parameters);
    EXPECT_NEAR(participation / massOf(parameters), 0.0, 1e-4) << name(parameters);
    EXPECT_NEAR(product, 0.0, 1e-4) << name(parameters);
    for (int m = rigid + 1; m <= rigid + 6; ++m)
    {
      const Mode mode = beam.mode(m);
      const double wave_number =
          std::sqrt(mode.frequency * std::sqrt(massPerLength(parameters) / bendingStiffness(parameters)));
      EXPECT_NEAR(reference.frequencies(m - 1) / mode.frequency, 1.0,
                  std::pow(wave_number * longest, 4) / 1000.0 + 5e-5)
          << name(parameters) << ", mode " << m;
      const double size = std::sqrt(2.0 / massOf(parameters));
      EXPECT_NEAR(std::abs(reference.deflections(m - 1)), std::abs(mode.contact_deflection), 2e-3 * size)
          << name(parameters) << ", mode " << m;
      EXPECT_NEAR(reference.deflections(m - 1) * reference.participations(m - 1),
                  mode.contact_deflection * mode.participation, 2e-3)
          << name(parameters) << ", mode " << m;
    }
    double receptance = 0.0;
    double response = 0.0;
    for (Eigen::Index m = reference.frequencies.size() - 1; m >= rigid; --m)
    {
      const double compliance = reference.deflections(m) / std::pow(reference.frequencies(m), 2);
      receptance += compliance * reference.deflections(m);
      response += compliance * reference.participations(m);
    }
    EXPECT_NEAR(beam.staticReceptance(rigid) / receptance, 1.0, 3e-5) << name(parameters);
    EXPECT_NEAR(beam.staticBaseResponse(rigid), response,
                1e-4 * (std::abs(response) + beam.staticReceptance(rigid) * massOf(parameters)))
        << name(parameters);
    for (const double relative : {0.4, 1.3, 2.9, 7.1})
    {
      const double omega = relative * scale;
      EXPECT_NEAR(beam.receptance(omega), reference.receptance(omega),
                  1e-3 * (std::abs(beam.receptance(omega)) + beam.staticReceptance(rigid)))
          << name(parameters) << ", omega* " << relative;
    }
  }
}

TEST(Beam, staticDeflectionsAndReceptanceOfEveryKindAreTheirModalSums)
{
  for (const BeamParameters& parameters : manyBeams())
  {
    const Beam beam(parameters);
    const int rigid = beam.rigidBodyModeCount();
    const int modes = parameters.rigid_body ? 120 : 1000;
    std::vector<Mode> all;
    for (int m = 1; m <= modes; ++m)
    {
      all.push_back(beam.mode(m));
    }
    // near a clamped end that of the point says little of the size of the sum
    const double static_receptance =
        std::max(beam.staticReceptance(rigid), std::pow(parameters.length, 3) / (200.0 * bendingStiffness(parameters)));
    const double static_response = massOf(parameters) * static_receptance;
    for (const int kept : {rigid, rigid + 1, rigid + 7, rigid + 40})
    {
      double receptance = 0.0;
      double response = 0.0;
      for (int m = modes; m > kept; --m)
      {
        const Mode& mode = all[static_cast<std::size_t>(m - 1)];
        const double compliance = mode.contact_deflection / (mode.frequency * mode.frequency);
        receptance += compliance * mode.contact_deflection;
        response += compliance * mode.participation;
      }
      // What is left falls as 1/M^3 and 1/M^4.
      const double rest = parameters.rigid_body ? 1e-5 : 2e-8;
      EXPECT_NEAR(beam.staticReceptance(kept), receptance, rest * static_receptance)
          << name(parameters) << ", " << kept;
      EXPECT_NEAR(beam.staticBaseResponse(kept), response, 0.1 * rest * static_response)
          << name(parameters) << ", " << kept;
    }
    const double lowest = beam.mode(rigid + 1).frequency;
    for (const double relative : {1e-4, 0.003, 0.02, 0.05, 0.7, 1.3, 3.1, 17.3})
    {
      const double omega = relative * lowest;
      double sum = 0.0;
      double size = 0.0;
      for (int m = modes; m >= 1; --m)
      {
        const Mode& mode = all[static_cast<std::size_t>(m - 1)];
        const double term =
            mode.contact_deflection * mode.contact_deflection / ((mode.frequency - omega) * (mode.frequency + omega));
        sum += term;
        size += std::abs(term);
      }
      EXPECT_NEAR(beam.receptance(omega), sum, (parameters.rigid_body ? 1e-5 : 5e-8) * (size + static_receptance))
          << name(parameters) << ", omega* " << relative;
    }
  }
}

TEST(Beam, aBodyOfNothingLeavesThePlainBeam)
{
  const std::vector<BeamParameters> plain = allPairs(0.5);
  const std::vector<BeamParameters> with_body = allPairsWithBody({0.0, 0.0, 0.0}, 0.0);
  for (std::size_t i = 0; i < plain.size(); ++i)
  {
    const Beam beam(plain[i]);
    const Beam limit(with_body[i]);
    ASSERT_EQ(limit.rigidBodyModeCount(), beam.rigidBodyModeCount());
    const double size = std::sqrt(2.0 / massOf(plain[i]));
    for (int m = 1; m <= 60; ++m)
    {
      const Mode a = beam.mode(m);
      const Mode b = limit.mode(m);
      EXPECT_NEAR(b.frequency, a.frequency, 1e-14 * a.frequency) << name(plain[i]) << ", mode " << m;
      EXPECT_NEAR(std::abs(b.contact_deflection), std::abs(a.contact_deflection), 1e-11 * size)
          << name(plain[i]) << ", mode " << m;
      EXPECT_NEAR(std::abs(b.participation), std::abs(a.participation), 1e-11 / size)
          << name(plain[i]) << ", mode " << m;
      EXPECT_NEAR(b.contact_deflection * b.participation, a.contact_deflection * a.participation, 1e-11)
          << name(plain[i]) << ", mode " << m;
    }
    const int rigid = beam.rigidBodyModeCount();
    for (const int kept : {rigid, rigid + 5, rigid + 20})
    {
      EXPECT_NEAR(limit.staticReceptance(kept) / beam.staticReceptance(kept), 1.0, 1e-11)
          << name(plain[i]) << ", " << kept;
      EXPECT_NEAR(limit.staticBaseResponse(kept), beam.staticBaseResponse(kept),
                  1e-11 * std::abs(beam.staticBaseResponse(rigid)) + 1e-18)
          << name(plain[i]) << ", " << kept;
    }
  }
}

TEST(Beam, aSmallBodyChangesFrequenciesInProportion)
{
  for (std::size_t i = 0; i < 9; ++i)
  {
    const BeamParameters pair = allPairs(0.5)[i];
    const Beam plain(pair);
    const int elastic = plain.rigidBodyModeCount() + 1;
    double last = 0.0;
    for (const double size : {1e-3, 1e-4, 1e-5, 1e-6})
    {
      BeamParameters small = pair;
      small.rigid_body =
          RigidBody{size * pair.length, 3.0 * size * massOf(pair), size * massOf(pair) * std::pow(pair.length, 2)};
      const double change = Beam(small).mode(elastic).frequency / plain.mode(elastic).frequency - 1.0;
      EXPECT_LT(std::abs(change), 20.0 * size) << name(small);
      if (last != 0.0 && std::abs(change) > 1e-9)
      {
        EXPECT_NEAR(last / change, 10.0, 1.5) << name(small) << ", " << size;
      }
      last = change;
    }
  }
}

TEST(Beam, aPointMassLowersFrequenciesAsTheReceptanceOfThePlainBeamSays)
{
  // The mass M at the contact: 1 = M omega^2 alpha(omega), with the receptance of the beam without it.
  for (const double ratio : {0.1, 1.0, 30.0})
  {
    const std::vector<BeamParameters> plain = allPairs(0.5);
    for (const BeamParameters& pair : plain)
    {
      const double mass = ratio * massOf(pair);
      BeamParameters loaded = pair;
      loaded.rigid_body = RigidBody{0.0, mass, 0.0};
      const Beam without(pair);
      const Beam with(loaded);
      for (int m = with.rigidBodyModeCount() + 1; m <= 12; ++m)
      {
        const Mode mode = with.mode(m);
        if (std::abs(mode.contact_deflection) < 1e-3 / std::sqrt(mass))
        {
          continue;  // a node at the mass, which it does not feel
        }
        const double omega = mode.frequency;
        // relative to the slope: how far off the frequency is
        const double step = 1e-6 * omega;
        const auto residual = [&](double at) { return mass * at * at * without.receptance(at) - 1.0; };
        const double slope = (residual(omega + step) - residual(omega - step)) / (2.0 * step);
        EXPECT_NEAR(residual(omega) / slope / omega, 0.0, 1e-10) << name(loaded) << ", mode " << m;
      }
    }
  }
}

TEST(Beam, aHeavyBodyMovesOnTheStiffnessOfItsSides)
{
  // Clamped ends: 12 E I/s^3 each against deflection; 4 E I/s (1 + 3 r + 3 r^2) against rotation, with r = arm/s.
  BeamParameters beam = allPairs(0.5)[4];
  ASSERT_EQ(beam.ends[0], End::clamped);
  const double bending = bendingStiffness(beam);
  const double length = 0.5;
  const double side = 0.5 * (beam.length - length);
  const double r = 0.5 * length / side;
  beam.rigid_body = RigidBody{length, 1e5 * massOf(beam), 1e4 * massOf(beam)};
  const double deflection = std::sqrt(24.0 * bending / std::pow(side, 3) / beam.rigid_body->mass);
  const double rotation =
      std::sqrt(8.0 * bending / side * (1.0 + 3.0 * r + 3.0 * r * r) / beam.rigid_body->rotary_inertia);
  const Beam heavy(beam);
  EXPECT_NEAR(heavy.mode(1).frequency / std::min(deflection, rotation), 1.0, 1e-4);
  EXPECT_NEAR(heavy.mode(2).frequency / std::max(deflection, rotation), 1.0, 1e-4);
  // Above, both sides vibrate as if clamped at the body, in phase and in antiphase.
  const double clamped = std::pow(4.730040744862704 / side, 2) * std::sqrt(bending / massPerLength(beam));
  EXPECT_NEAR(heavy.mode(3).frequency / clamped, 1.0, 1e-3);
  EXPECT_NEAR(heavy.mode(4).frequency / clamped, 1.0, 1e-3);
}

TEST(Beam, crossSectionsGiveStiffnessAndMass)
{
  BeamParameters beam;
  beam.youngs_modulus = 2.0e11;
  beam.density = 7800.0;
  beam.length = 2.0;
  beam.cross_section = Tube{0.02, 0.001, 0.3};
  EXPECT_NEAR(bendingStiffness(beam), 2.0e11 * pi / 64.0 * (std::pow(0.02, 4) - std::pow(0.018, 4)),
              1e-9 * bendingStiffness(beam));
  EXPECT_NEAR(massPerLength(beam), 7800.0 * pi / 4.0 * (std::pow(0.02, 2) - std::pow(0.018, 2)) + 0.3, 1e-12);
  beam.cross_section = Tube{0.02, 0.01, 0.0};  // a full bar
  EXPECT_NEAR(bendingStiffness(beam), 2.0e11 * pi / 64.0 * std::pow(0.02, 4), 1e-9 * bendingStiffness(beam));
  beam.cross_section = Rectangle{0.01, 0.03};
  EXPECT_NEAR(bendingStiffness(beam), 2.0e11 * 0.03 * 1e-6 / 12.0, 1e-9 * bendingStiffness(beam));
  EXPECT_NEAR(massPerLength(beam), 7800.0 * 3e-4, 1e-12);
  beam.cross_section = Section{12.5, 0.4};
  EXPECT_EQ(bendingStiffness(beam), 12.5);
  EXPECT_EQ(massPerLength(beam), 0.4);
}

TEST(Beam, shapesAlongTheBeamAreThoseOfTheContactPointThere)
{
  for (const BeamParameters& parameters : manyBeams())
  {
    const Beam beam(parameters);
    const std::vector<double> contact = {parameters.contact_location};
    const int rigid = beam.rigidBodyModeCount();
    const double unit = 1.0 / std::sqrt(massOf(parameters));
    for (int m = 1; m <= 12; ++m)
    {
      EXPECT_NEAR(beam.modeShape(m, contact)[0], beam.mode(m).contact_deflection, 1e-12 * unit)
          << name(parameters) << ", mode " << m;
    }
    for (const int kept : {rigid, rigid + 1, rigid + 5})
    {
      EXPECT_NEAR(beam.staticShape(kept, contact)[0] / beam.staticReceptance(kept), 1.0, 1e-9)
          << name(parameters) << ", kept " << kept;
    }
    // Elsewhere: of a beam with its contact there. The sign of a mode belongs to the beam, not to its contact.
    BeamParameters moved = parameters;
    if (parameters.rigid_body)
    {
      moved.contact_location = 0.5 * parameters.length - 0.25 * parameters.rigid_body->length;
    }
    else
    {
      moved.contact_location += 0.05 * parameters.length;
    }
    for (int m = 1; m <= 12; ++m)
    {
      EXPECT_NEAR(beam.modeShape(m, {moved.contact_location})[0], Beam(moved).mode(m).contact_deflection, 1e-12 * unit)
          << name(parameters) << ", mode " << m;
    }
    // What a force here does there, a force there does here (Maxwell).
    EXPECT_NEAR(beam.staticShape(rigid, {moved.contact_location})[0] /
                    Beam(moved).staticShape(rigid, {parameters.contact_location})[0],
                1.0, 1e-9)
        << name(parameters);
  }
}

TEST(Beam, shapesAlongTheBeamAreOrthogonalInItsMass)
{
  // Gauss's rule of four points in 100 intervals of each side of the body, and the body's own mass and inertia. What is
  // left of a static deflection by the kept modes has no part in them.
  const double points[] = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281, 0.9305681557970263};
  const double weights[] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731, 0.1739274225687269};
  constexpr int intervals = 100;
  constexpr int modes = 8;
  for (const BeamParameters& parameters : manyBeams())
  {
    const Beam beam(parameters);
    const RigidBody body = parameters.rigid_body.value_or(RigidBody{});
    const double middle = parameters.rigid_body ? 0.5 * parameters.length : parameters.contact_location;
    std::vector<double> x;
    std::vector<double> mass;
    const double ends[][2] = {{0.0, middle - 0.5 * body.length}, {middle + 0.5 * body.length, parameters.length}};
    for (const auto& [from, to] : ends)
    {
      for (int i = 0; i < 4 * intervals; ++i)
      {
        x.push_back(from + (to - from) * (i / 4 + points[i % 4]) / intervals);
        mass.push_back((to - from) / intervals * weights[i % 4] * massPerLength(parameters));
      }
    }
    const double step = std::max(0.25 * body.length, 1e-8 * parameters.length);
    x.insert(x.end(), {middle, middle - step, middle + step});
    const auto size = static_cast<Eigen::Index>(mass.size());
    const auto deflection = [&](const std::vector<double>& shape)
    { return Eigen::Map<const Eigen::VectorXd>(shape.data(), size); };
    const auto product = [&](const std::vector<double>& a, const std::vector<double>& b)
    {
      const auto at = static_cast<std::size_t>(size);
      const double run = x[at + 2] - x[at + 1];
      return (deflection(a).array() * deflection(b).array() * deflection(mass).array()).sum() +
             body.mass * a[at] * b[at] +
             body.rotary_inertia * (a[at + 2] - a[at + 1]) / run * (b[at + 2] - b[at + 1]) / run;
    };
    std::vector<std::vector<double>> shapes;
    for (int m = 1; m <= modes; ++m)
    {
      shapes.push_back(beam.modeShape(m, x));
    }
    const std::vector<double> rest = beam.staticShape(modes, x);
    const double norm = std::sqrt(product(rest, rest));
    for (int i = 0; i < modes; ++i)
    {
      for (int j = 0; j <= i; ++j)
      {
        EXPECT_NEAR(product(shapes[static_cast<std::size_t>(i)], shapes[static_cast<std::size_t>(j)]),
                    i == j ? 1.0 : 0.0, 1e-5)
            << name(parameters) << ", modes " << i + 1 << " and " << j + 1;
      }
      EXPECT_NEAR(product(shapes[static_cast<std::size_t>(i)], rest) / norm, 0.0, 1e-4) << name(parameters);
    }
  }
}

TEST(Beam, hasNoShapeBesideItself)
{
  const Beam beam(paperBeam());
  EXPECT_THROW(beam.modeShape(1, {-1e-9}), std::invalid_argument);
  EXPECT_THROW(beam.modeShape(1, {0.0, 0.053}), std::invalid_argument);
  EXPECT_THROW(beam.staticShape(3, {std::nan("")}), std::invalid_argument);
  EXPECT_EQ(beam.modeShape(1, {0.0, 0.02645}).size(), 2u);
}
