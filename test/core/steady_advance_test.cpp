// The quick way between samples (advanceSteadily) against the one that looks into every interval.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "reference_system.h"
#include "switched_motion.h"
#include "vibro_impact/core/simulation.h"

using namespace vibro_impact::core;

namespace
{
constexpr double sample_period = 2.0e-5;

struct Case
{
  std::string name;
  SystemParameters parameters;
  double amplitude;  // m/s^2
  bool impacts;      // whether there are any
};

void PrintTo(const Case& c, std::ostream* out)
{
  *out << c.name;
}

SystemParameters withClearance(SystemParameters parameters, double clearance)
{
  parameters.contact.clearance = clearance;
  return parameters;
}

SystemParameters freeBeam(SystemParameters parameters)
{
  beamOf(parameters.beam1).ends = {End::free, End::free};
  return parameters;
}

class SteadyAdvance : public ::testing::TestWithParam<Case>
{
};
}  // namespace

TEST_P(SteadyAdvance, agreesWithLookingIntoEveryInterval)
{
  const Case& c = GetParam();
  const auto model = std::make_shared<const SwitchedModel>(c.parameters);
  // Near a resonance, not smooth, and quiet in the end.
  const std::size_t count = 6000;
  std::mt19937 generator(7);
  std::normal_distribution<double> noise(0.0, 0.05);
  std::vector<double> drive(count, 0.0);
  for (std::size_t i = 0; i < 4000; ++i)
  {
    const double phase = 1.6 * model->scales().frequency * sample_period * static_cast<double>(i);
    drive[i] = c.amplitude * (std::sin(phase) + noise(generator));
  }

  SampledSimulation simulation(model, sample_period);
  Recorder recorder;
  std::vector<double> gap(count);
  std::vector<double> force(count);
  simulation.advance(drive.data(), count, gap.data(), force.data(), recorder);

  SwitchedMotion motion(model, false);
  motion.setInterval(sample_period);
  Recorder expected;
  std::vector<double> expected_gap(count);
  std::vector<double> expected_force(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    if (i > 0)
    {
      motion.advanceLinear(drive[i - 1], drive[i], expected);
    }
    expected_gap[i] = motion.gap();
    expected_force[i] = motion.force();
  }

  const auto size = [](const std::vector<double>& values)
  {
    double greatest = 0.0;
    for (const double value : values)
    {
      greatest = std::max(greatest, std::abs(value));
    }
    return greatest;
  };
  constexpr double tolerance = 1.0e-8;
  const double gap_tolerance = tolerance * size(expected_gap);
  const double force_tolerance = tolerance * size(expected_force);
  for (std::size_t i = 0; i < count; ++i)
  {
    ASSERT_NEAR(gap[i], expected_gap[i], gap_tolerance) << i;
    ASSERT_NEAR(force[i], expected_force[i], force_tolerance) << i;
  }
  EXPECT_EQ(simulation.inContact(), motion.inContact());

  ASSERT_EQ(recorder.impacts.size(), expected.impacts.size());
  EXPECT_EQ(recorder.impacts.size() > 5, c.impacts);
  double greatest_impulse = 0.0;
  for (const Impact& impact : expected.impacts)
  {
    greatest_impulse = std::max(greatest_impulse, impact.impulse);
  }
  for (std::size_t i = 0; i < expected.impacts.size(); ++i)
  {
    const Impact& ours = recorder.impacts[i];
    const Impact& theirs = expected.impacts[i];
    EXPECT_EQ(ours.interval, theirs.interval) << i;
    EXPECT_NEAR(ours.offset, theirs.offset, tolerance * sample_period) << i;
    EXPECT_NEAR(ours.duration, theirs.duration, tolerance * std::max(theirs.duration, sample_period)) << i;
    EXPECT_NEAR(ours.impulse, theirs.impulse, tolerance * greatest_impulse) << i;
    EXPECT_NEAR(ours.peak_force, theirs.peak_force, force_tolerance) << i;
    EXPECT_NEAR(ours.peak_time, theirs.peak_time, 1.0e-4 * std::max(theirs.duration, sample_period)) << i;
    EXPECT_EQ(ours.cut_short, theirs.cut_short) << i;
  }

  const EnergyAccount account = simulation.energyAccount();
  const EnergyAccount expected_account = motion.sample().energy;
  EXPECT_NEAR(account.work, expected_account.work, tolerance * expected_account.turnover);
  EXPECT_NEAR(account.dissipated_free, expected_account.dissipated_free, tolerance * expected_account.turnover);
  EXPECT_NEAR(account.dissipated_contact, expected_account.dissipated_contact, tolerance * expected_account.turnover);
  EXPECT_LT(std::abs(account.closure()), 1.0e-9);
}

INSTANTIATE_TEST_SUITE_P(
    Systems, SteadyAdvance,
    ::testing::Values(Case{"two_beams", limitingCase(1000.0, AttachmentBasis{5}), 1.0, true},
                      Case{"rigid_surface", rigidCase(300.0, AttachmentBasis{3}), 1.0, true},
                      Case{"conjoined_basis", limitingCase(1000.0, ConjoinedBasis{2, 2}), 1.0, true},
                      Case{"always_pressed", withClearance(rigidCase(100.0, AttachmentBasis{3}), -2.0e-5), 1.0, false},
                      Case{"pressed_but_torn_open", withClearance(rigidCase(100.0, AttachmentBasis{3}), -1.0e-7), 5.0,
                           true},
                      Case{"never_reached", withClearance(rigidCase(100.0, AttachmentBasis{3}), 1.0e-3), 1.0, false},
                      Case{"free_beam", freeBeam(rigidCase(100.0, AttachmentBasis{3})), 1.0, false}),
    [](const auto& instance) { return instance.param.name; });
