// What the attachment basis is for: a few modes a beam are enough.

#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "reference_system.h"
#include "vibro_impact/core/harmonic_simulation.h"

using namespace vibro_impact::core;

namespace
{
ResponseRow responseFromRest(int modes_per_beam, double omega_star)
{
  const auto model = std::make_shared<const SwitchedModel>(limitingCase(1000.0, AttachmentBasis{modes_per_beam}));
  HarmonicSimulation simulation(model);
  return harmonicResponse(simulation, omega_star * model->scales().frequency, 1.0, 400).row;
}
}  // namespace

TEST(AttachmentBasis, threeModesPerBeamGiveTheImpulseOfTwentyToTwoThousandths)
{
  for (const double omega_star : {1.2, 1.6, 2.0, 3.2})
  {
    const ResponseRow few = responseFromRest(3, omega_star);
    const ResponseRow many = responseFromRest(20, omega_star);
    ASSERT_GT(many.impulse_mean, 0.0);
    EXPECT_EQ(few.period, many.period) << "omega* " << omega_star;
    EXPECT_NEAR(few.impulse_mean / many.impulse_mean, 1.0, 2e-3) << "omega* " << omega_star;
    std::printf("omega* %.1f: impulse with 3 modes per beam off that with 20 by %.1e, period %d\n", omega_star,
                few.impulse_mean / many.impulse_mean - 1.0, many.period);
  }
}
