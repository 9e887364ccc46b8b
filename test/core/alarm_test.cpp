#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "vibro_impact/core/alarm.h"

using vibro_impact::core::Alarm;
using vibro_impact::core::AlarmLimits;

namespace
{
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Whether the alarm is active after each of the values, which come one nanosecond apart.
std::vector<bool> follow(const AlarmLimits& limits, const std::vector<double>& values)
{
  Alarm alarm(limits);
  std::vector<bool> states;
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    const bool before = alarm.active();
    const bool changed = alarm.update(static_cast<std::int64_t>(i), values[i]);
    EXPECT_EQ(changed, before != alarm.active());
    states.push_back(alarm.active());
  }
  return states;
}

TEST(Alarm, isRaisedAboveOneLimitAndClearedBelowTheOther)
{
  EXPECT_EQ(follow({10.0, 5.0}, {0.0, 10.0, 10.1, 7.0, 5.0, 4.9, 7.0, 10.0, 11.0}),
            (std::vector<bool>{false, false, true, true, true, false, false, false, true}));
}

TEST(Alarm, isRaisedBelowOneLimitAndClearedAboveTheOther)
{
  EXPECT_EQ(follow({5.0, 10.0}, {11.0, 7.0, 5.0, 4.9, 7.0, 10.0, 10.1, 7.0, 4.0}),
            (std::vector<bool>{false, false, false, true, true, true, false, false, true}));
}

TEST(Alarm, doesNotChatterWithinTheLimits)
{
  Alarm alarm({10.0, 5.0});
  int changes = 0;
  for (int i = 0; i < 10000; ++i)
  {
    // Noise of a third of the deadband about the limit that raises it.
    changes += alarm.update(i, 10.0 + 1.5 * std::sin(0.7 * i)) ? 1 : 0;
  }
  EXPECT_EQ(changes, 1);
  EXPECT_TRUE(alarm.active());
}

TEST(Alarm, waitsForTheDelaysWithoutABreak)
{
  EXPECT_EQ(follow({10.0, 5.0, 2, 1}, {11.0, 11.0, 9.0, 11.0, 11.0, 11.0, 4.0, 6.0, 4.0, 4.0}),
            (std::vector<bool>{false, false, false, false, false, true, true, true, true, false}));
}

TEST(Alarm, aDelayBeginsAnewWhereTimeGoesBack)
{
  Alarm alarm({10.0, 5.0, 100, 0});
  EXPECT_FALSE(alarm.update(1000, 11.0));
  EXPECT_FALSE(alarm.update(50, 11.0));
  EXPECT_FALSE(alarm.update(149, 11.0));
  EXPECT_TRUE(alarm.update(150, 11.0));
}

TEST(Alarm, aDelayBeginsAnewWithAnotherStretchOfTime)
{
  Alarm alarm({10.0, 5.0, 100, 100});
  EXPECT_FALSE(alarm.update(0, 11.0));
  alarm.beginStretch();
  EXPECT_FALSE(alarm.update(3600, 11.0));
  EXPECT_FALSE(alarm.update(3699, 11.0));
  EXPECT_TRUE(alarm.update(3700, 11.0));
  EXPECT_FALSE(alarm.update(3800, 4.0));
  alarm.beginStretch();
  EXPECT_TRUE(alarm.active());
  EXPECT_FALSE(alarm.update(7200, 4.0));
  EXPECT_TRUE(alarm.update(7300, 4.0));
}

TEST(Alarm, whatIsNoNumberIsBeyondNoLimit)
{
  EXPECT_EQ(follow({10.0, 5.0}, {nan, 11.0, nan, 4.0}), (std::vector<bool>{false, true, true, false}));
}

}  // namespace
