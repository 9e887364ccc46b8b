#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "vibro_impact/ros/sample_clock.h"

using vibro_impact::graph::SampleClock;
using vibro_impact::graph::Stamp;

namespace
{
constexpr double period = 1.0e-3;
constexpr Stamp millisecond = 1000000;
constexpr Stamp begin = 1700000000000000000;

TEST(SampleClock, datesSamplesBeforeAndAfterItsAnchor)
{
  SampleClock clock;
  clock.start(100, begin, period);
  EXPECT_EQ(clock.at(100), begin);
  EXPECT_EQ(clock.at(107), begin + 7 * millisecond);
  EXPECT_EQ(clock.at(97), begin - 3 * millisecond);
}

TEST(SampleClock, believesTheCountWithinHalfAPeriod)
{
  SampleClock clock;
  clock.start(0, begin, period);
  clock.follow(10, begin + 10 * millisecond + millisecond / 2 - 1, false);
  EXPECT_EQ(clock.at(10), begin + 10 * millisecond);
  clock.follow(20, begin + 20 * millisecond - millisecond / 2 + 1, false);
  EXPECT_EQ(clock.at(20), begin + 20 * millisecond);
}

TEST(SampleClock, datesABlockFurtherOffByItsOwnStamp)
{
  SampleClock clock;
  clock.start(0, begin, period);
  clock.follow(10, begin + 12 * millisecond, false);
  EXPECT_EQ(clock.at(10), begin + 12 * millisecond);
  EXPECT_EQ(clock.at(13), begin + 15 * millisecond);
  EXPECT_EQ(clock.at(9), begin + 9 * millisecond) << "a sample of the block before";
}

TEST(SampleClock, keepsTheAnchorOfAnEpisodeThatIsOpenForLong)
{
  SampleClock clock;
  clock.start(0, begin, period);
  clock.follow(10, begin + 12 * millisecond, false);
  clock.follow(20, begin + 24 * millisecond, true);
  EXPECT_EQ(clock.at(5), begin + 5 * millisecond);
  EXPECT_EQ(clock.at(20), begin + 24 * millisecond);
}

TEST(SampleClock, followsADrift)
{
  // The driver's crystal is 100 ppm slow: after 1000 s the count alone would be off by 0.1 s.
  SampleClock clock;
  clock.start(0, begin, period);
  for (std::uint64_t seq = 100; seq <= 1000000; seq += 100)
  {
    const Stamp stamp = begin + static_cast<Stamp>(seq) * (millisecond + millisecond / 10000);
    EXPECT_LT(clock.deviation(seq, stamp), period);
    clock.follow(seq, stamp, false);
  }
  EXPECT_NEAR(static_cast<double>(clock.at(1000000) - begin), 1000.1e9, 0.5 * period * 1.0e9);
}

TEST(SampleClock, deviationIsSignedAndSurvivesAbsurdNumbers)
{
  SampleClock clock;
  clock.start(1000, begin, period);
  EXPECT_NEAR(clock.deviation(1010, begin + 15 * millisecond), 0.005, 1.0e-12);
  EXPECT_NEAR(clock.deviation(990, begin - 15 * millisecond), -0.005, 1.0e-12);
  EXPECT_LT(clock.deviation(std::numeric_limits<std::uint64_t>::max(), begin), -1.0e15);
}

TEST(SampleClock, neverDatesBeforeTheEpoch)
{
  SampleClock clock;
  clock.start(100, millisecond, period);
  EXPECT_EQ(clock.at(0), 0);
}

}  // namespace
