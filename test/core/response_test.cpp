#include "vibro_impact/core/response.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"

using namespace vibro_impact::core;

namespace
{
constexpr double cycle = 0.01;

DriveStep stepOf(int cycles)
{
  return {two_pi / cycle, 3.0, 0.0, cycles * cycle};
}

/// `per_period` impacts in `period` cycles, with unlike impulses 1, 2, ... and unlike phases.
std::vector<TimedImpact> periodic(int cycles, int period, int per_period)
{
  std::vector<TimedImpact> impacts;
  for (int start = 0; start + period <= cycles; start += period)
  {
    for (int i = 0; i < per_period; ++i)
    {
      TimedImpact timed;
      timed.onset = cycle * (start + period * (i + 0.3 + 0.02 * i) / per_period);
      timed.impact.impulse = 1.0 + i;
      timed.impact.duration = 1e-3 * (1 + i);
      timed.impact.peak_force = 10.0 * (1 + i);
      impacts.push_back(timed);
    }
  }
  return impacts;
}

const ReferenceScales scales{100.0, 2.0, 0.5};
}  // namespace

TEST(Response, findsEveryPeriodUpToSixteen)
{
  for (int period = 1; period <= 16; ++period)
  {
    for (int per_period = 1; per_period <= 5; ++per_period)
    {
      const Response response = evaluateResponse(stepOf(320), periodic(320, period, per_period), scales);
      EXPECT_EQ(response.row.period, period) << per_period << " impacts in a period of " << period;
      EXPECT_TRUE(response.row.steady);
      EXPECT_NEAR(response.row.impacts_per_cycle, static_cast<double>(per_period) / period, 1e-12);
      EXPECT_NEAR(response.row.impulse_per_cycle, 0.5 * per_period * (per_period + 1) / period, 1e-12);
    }
  }
  EXPECT_EQ(evaluateResponse(stepOf(340), periodic(340, 17, 1), scales).row.period, 0);
}

TEST(Response, capturesTheLastFifteenImpacts)
{
  const Response response = evaluateResponse(stepOf(100), periodic(100, 1, 1), scales);
  ASSERT_EQ(response.captured.size(), 15u);
  EXPECT_EQ(response.row.impacts, 15);
  EXPECT_NEAR(response.captured.back().onset, 99.3 * cycle, 1e-12);
  EXPECT_NEAR(response.captured.front().onset, 85.3 * cycle, 1e-12);
}

TEST(Response, rowHoldsTheStatisticsOfTheCapturedImpacts)
{
  const ResponseRow row = evaluateResponse(stepOf(100), periodic(100, 1, 3), scales).row;
  EXPECT_NEAR(row.omega_star, two_pi / cycle / 100.0, 1e-12);
  EXPECT_NEAR(row.frequency_hz, 100.0, 1e-12);
  EXPECT_EQ(row.acceleration, 3.0);
  EXPECT_NEAR(row.impulse_mean, 2.0, 1e-12);
  EXPECT_EQ(row.impulse_min, 1.0);
  EXPECT_EQ(row.impulse_max, 3.0);
  EXPECT_NEAR(row.impulse_star_mean, 2.0 * 100.0 / (2.0 * 0.5), 1e-9);
  EXPECT_NEAR(row.impulse_star_min, 100.0, 1e-9);
  EXPECT_NEAR(row.impulse_star_max, 300.0, 1e-9);
  EXPECT_EQ(row.peak_force, 30.0);
  EXPECT_NEAR(row.duration_mean, 2e-3, 1e-15);
}

TEST(Response, withoutImpactsIsARowOfZerosWithPeriodOne)
{
  const Response response = evaluateResponse(stepOf(10), {}, scales);
  EXPECT_TRUE(response.captured.empty());
  EXPECT_EQ(response.row.impacts, 0);
  EXPECT_EQ(response.row.period, 1);
  EXPECT_TRUE(response.row.steady);
  EXPECT_EQ(response.row.impulse_mean, 0.0);
}

TEST(Response, doesNotCountEpisodesCutShort)
{
  std::vector<TimedImpact> impacts = periodic(100, 1, 1);
  impacts.back().impact.cut_short = true;
  impacts.back().impact.impulse = 1000.0;
  const ResponseRow row = evaluateResponse(stepOf(100), impacts, scales).row;
  EXPECT_EQ(row.impulse_max, 1.0);
}

TEST(Response, aTransientIsNotSteady)
{
  std::vector<TimedImpact> impacts = periodic(100, 1, 1);
  for (std::size_t i = 0; i < impacts.size(); ++i)
  {
    impacts[i].impact.impulse = std::exp(-0.02 * static_cast<double>(i));
  }
  const ResponseRow row = evaluateResponse(stepOf(100), impacts, scales).row;
  EXPECT_EQ(row.period, 0);
  EXPECT_FALSE(row.steady);
}

TEST(Response, aResponseThatNeverRepeatsCanBeSteadyInTheMean)
{
  std::vector<TimedImpact> impacts = periodic(400, 1, 1);
  for (std::size_t i = 0; i < impacts.size(); ++i)
  {
    impacts[i].impact.impulse = 1.0 + 0.3 * std::sin(std::sqrt(2.0) * static_cast<double>(i));
  }
  const ResponseRow row = evaluateResponse(stepOf(400), impacts, scales).row;
  EXPECT_EQ(row.period, 0);
  EXPECT_TRUE(row.steady);
  EXPECT_NEAR(row.impacts_per_cycle, 1.0, 1e-12);
  EXPECT_NEAR(row.impulse_per_cycle, 1.0, 0.01);
}

TEST(Response, aSingleImpactHasNoPeriod)
{
  std::vector<TimedImpact> impacts = periodic(1, 1, 1);
  impacts[0].onset += 60 * cycle;
  const ResponseRow row = evaluateResponse(stepOf(100), impacts, scales).row;
  EXPECT_EQ(row.period, 0);
  EXPECT_EQ(row.impacts, 1);
}

TEST(Response, impactsOfTheTransientAloneAreNoResponse)
{
  DriveStep step = stepOf(100);
  step.contact = {5.0, -0.25};
  step.contact_share = 1.0;
  const Response response = evaluateResponse(step, periodic(49, 1, 1), scales);
  EXPECT_TRUE(response.captured.empty());
  EXPECT_EQ(response.row.impacts, 0);
  EXPECT_EQ(response.row.period, 1);
  EXPECT_EQ(response.row.impulse_mean, 0.0);
  EXPECT_EQ(response.row.peak_force, 0.0);
  EXPECT_EQ(response.row.contact_share, 1.0) << "told by whoever knows";
  EXPECT_EQ(response.row.stiffness, 5.0);
  EXPECT_EQ(response.row.clearance, -0.25);
}
