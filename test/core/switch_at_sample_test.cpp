// Switches on the very time of a sample: whichever side of it they fall on, the sample makes sense.

#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "common.h"
#include "reference_system.h"
#include "vibro_impact/core/simulation.h"

namespace vibro_impact::core
{
namespace
{
struct Answer
{
  std::vector<double> gap, force;
  std::vector<Impact> impacts;
};

/// The base starts to accelerate at time zero and keeps it up, so that the motion does not depend on the samples'
/// times.
Answer answer(const std::shared_ptr<const SwitchedModel>& model, double period, std::size_t count)
{
  const std::vector<double> acceleration(count, 1.0);
  Answer result;
  result.gap.resize(count);
  result.force.resize(count);
  Recorder recorder;
  SampledSimulation simulation(model, period);
  simulation.advance(acceleration.data(), count, result.gap.data(), result.force.data(), recorder);
  result.impacts = recorder.impacts;
  return result;
}

double onset(const Impact& impact, double period)
{
  return static_cast<double>(impact.interval) * period + impact.offset;
}

TEST(SwitchAtSample, ForceAndGapOfTheSampleAgree)
{
  SystemParameters parameters = limitingCase(1000.0, AttachmentBasis{3});
  parameters.contact.clearance = 3.0e-7;  // most of the static deflection
  const auto model = std::make_shared<const SwitchedModel>(parameters);
  const double coarse = 2.0e-5;
  const Answer reference = answer(model, coarse, 1000);
  ASSERT_GT(reference.impacts.size(), 3u);
  const Impact& impact = reference.impacts[2];
  const double times[] = {onset(impact, coarse), onset(impact, coarse) + impact.duration};
  const double greatest = impact.peak_force / model->stiffness();
  for (const double time : times)
  {
    for (int shift = -300; shift <= 300; ++shift)
    {
      // 40 intervals up to a sample this much after the switch, from far less to far more than rounding can tell.
      const double late = std::copysign(1.0e-18 * std::pow(10.0, std::abs(shift) / 30.0), shift);
      const double period = (time + late) / 40.0;
      const Answer result = answer(model, period, 60);
      const double gap = result.gap[40];
      const double force = result.force[40];
      EXPECT_NEAR(gap, 0.0, 1.0e-3 * greatest) << late;
      EXPECT_GE(force, 0.0) << late;
      if (force > 0.0)
      {
        EXPECT_EQ(force, -model->stiffness() * gap) << late;
      }
      else
      {
        EXPECT_GE(gap, -1.0e-12 * greatest) << late;
      }
      ASSERT_GE(result.impacts.size(), 3u) << late;
      const Impact& same = result.impacts[2];
      EXPECT_NEAR(onset(same, period), onset(impact, coarse), 1.0e-12) << late;
      EXPECT_NEAR(same.duration, impact.duration, 1.0e-12) << late;
      EXPECT_NEAR(same.impulse, impact.impulse, 1.0e-10 * impact.impulse) << late;
      EXPECT_NEAR(same.peak_force, impact.peak_force, 1.0e-9 * impact.peak_force) << late;
    }
  }
}

}  // namespace
}  // namespace vibro_impact::core
