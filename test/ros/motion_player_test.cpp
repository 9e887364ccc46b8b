#include "vibro_impact/ros/motion_player.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "vibro_impact/ros/round_scale.h"

using vibro_impact::StructureMotion;
using vibro_impact::graph::MotionPlayer;
using vibro_impact::graph::RoundScale;

namespace
{
constexpr double sample_period = 2.0e-5;
constexpr std::uint64_t step = 4;
constexpr double row_period = static_cast<double>(step) * sample_period;
constexpr double frequency = 434.0;
constexpr double two_pi = 6.283185307179586;

/// Two coordinates; a force every hundredth row.
StructureMotion motion(std::uint64_t seq, std::size_t rows, double drive = frequency)
{
  StructureMotion message;
  message.seq = seq;
  message.sample_period = sample_period;
  message.step = step;
  message.structure = {1, 2};
  message.mode = {1, 1};
  message.contact_deflection = {1.0, 1.0};
  for (std::size_t row = 0; row < rows; ++row)
  {
    const double sample = static_cast<double>(seq + step * row);
    const double phase = two_pi * drive * sample * sample_period;
    message.coordinates.insert(message.coordinates.end(), {sample, std::cos(phase)});
    message.gap.push_back(0.5 * sample);
    message.force.push_back((seq / step + row) % 100 == 0 ? 7.0 : 0.0);
    message.acceleration.push_back(10.0 * std::sin(phase));
  }
  return message;
}

TEST(RoundScale, isRoundAndStays)
{
  RoundScale scale(0.0);
  EXPECT_EQ(scale.value(), 0.0);
  EXPECT_DOUBLE_EQ(scale.update(1890.0), 2000.0);
  EXPECT_DOUBLE_EQ(scale.update(3900.0), 2000.0);
  EXPECT_DOUBLE_EQ(scale.update(900.0), 2000.0);
  EXPECT_DOUBLE_EQ(scale.update(6000.0), 5000.0);
  EXPECT_DOUBLE_EQ(scale.update(0.012), 0.01);
  EXPECT_DOUBLE_EQ(scale.update(0.0), 0.01);
  EXPECT_DOUBLE_EQ(scale.update(std::nan("")), 0.01);
  EXPECT_DOUBLE_EQ(scale.update(INFINITY), 0.01);
  EXPECT_DOUBLE_EQ(RoundScale(0.0).update(0.08), 0.1);
  RoundScale fixed(3.3);
  EXPECT_EQ(fixed.update(1e6), 3.3);
}

TEST(MotionPlayer, playsAStretchOfWholeCyclesSlowedAndThenTheNewest)
{
  MotionPlayer player(0.0, 6.0);
  EXPECT_FALSE(player.advance(0.04));
  EXPECT_FALSE(player.playing());
  std::uint64_t seq = 0;
  const auto hear = [&](std::size_t rows)
  {
    EXPECT_TRUE(player.add(motion(seq, rows)));
    seq += step * rows;
  };
  hear(1000);
  ASSERT_TRUE(player.advance(0.04));
  EXPECT_NEAR(player.driveFrequency(), frequency, 0.1);
  EXPECT_DOUBLE_EQ(player.slowMotion(), 1000.0);  // 868 made a cycle 2 s long
  EXPECT_NEAR(player.duration(), 3.0 / frequency, row_period);
  EXPECT_DOUBLE_EQ(player.row().coordinates[0], 0.0 + player.stretch()[0].coordinates[0]);

  // It begins where the drive rises, and is what was heard, at every time on the way.
  EXPECT_LE(player.stretch()[0].acceleration, 0.0);
  EXPECT_GT(player.stretch()[1].acceleration, 0.0);
  const double first = player.stretch()[0].coordinates[0];
  double shown = 0.0;
  while (!player.advance(0.04))
  {
    shown += 0.04;
    hear(50);
    ASSERT_LT(shown, 10.0);
    const double at = std::min(shown / 1000.0, player.duration());
    EXPECT_NEAR(player.position(), at, 1e-12);
    EXPECT_NEAR(player.row().coordinates[0], first + at / sample_period, 1e-6);
    EXPECT_NEAR(player.row().gap, 0.5 * (first + at / sample_period), 1e-6);
    EXPECT_NEAR(player.time(static_cast<std::uint64_t>(first) + 10, 3e-6), 10.0 * sample_period + 3e-6, 1e-12);
    EXPECT_NEAR(player.time(static_cast<std::uint64_t>(first) - 10, 0.0), -10.0 * sample_period, 1e-12);
  }
  EXPECT_NEAR(shown, 1000.0 * 3.0 / frequency, 0.2);
  // The newest whole cycles: they end less than a cycle before what came last.
  const double end = player.stretch().back().coordinates[0];
  EXPECT_LE(end, static_cast<double>(seq));
  EXPECT_GT(end, static_cast<double>(seq) - 1.0 / frequency / sample_period - 2.0 * step);
  EXPECT_LE(player.stretch()[0].acceleration, 0.0);
  EXPECT_GT(player.stretch()[1].acceleration, 0.0);
}

TEST(MotionPlayer, losesNoForceBetweenFrames)
{
  MotionPlayer player(10.0, 6.0);  // many rows a frame
  player.add(motion(0, 8000));
  ASSERT_TRUE(player.advance(0.04));
  int seen = 0;
  int expected = 0;
  for (std::size_t i = 1; i < player.stretch().size(); ++i)
  {
    expected += player.stretch()[i].force > 0.0 ? 1 : 0;
  }
  const double duration = player.duration();
  while (player.position() < duration)
  {
    player.advance(0.04);
    seen += player.row().force > 0.0 ? 1 : 0;
  }
  EXPECT_GT(expected, 20);
  EXPECT_NEAR(seen, expected, 2);
}

TEST(MotionPlayer, holdsTheEndWhereNothingNewComes)
{
  MotionPlayer player(100.0, 1.0);
  player.add(motion(0, 500));
  player.advance(0.04);
  const double end = player.stretch().back().coordinates[0];
  for (int i = 0; i < 100; ++i)
  {
    EXPECT_FALSE(player.advance(0.04));
  }
  EXPECT_DOUBLE_EQ(player.row().coordinates[0], end);
  player.add(motion(step * 500, 500));
  EXPECT_TRUE(player.advance(0.04));
}

TEST(MotionPlayer, aHoleOrANewStreamBeginsAnew)
{
  MotionPlayer player(1000.0, 1000.0);  // as long as there is
  player.add(motion(0, 300));
  player.add(motion(step * 301, 200));  // a row is missing
  player.advance(0.04);
  EXPECT_LE(player.stretch().size(), 200u);
  EXPECT_GE(player.stretch()[0].coordinates[0], static_cast<double>(step * 301));
}

TEST(MotionPlayer, takesTheNaturalFrequencyWhereNoDriveIsSeen)
{
  MotionPlayer player(0.0, 6.0);
  player.setNaturalFrequency(10.0);
  player.add(motion(0, 500, 0.0));
  EXPECT_TRUE(player.advance(0.04));
  EXPECT_DOUBLE_EQ(player.slowMotion(), 20.0);
}

TEST(MotionPlayer, refusesWhatDoesNotFit)
{
  MotionPlayer player(0.0, 6.0);
  StructureMotion bad = motion(0, 10);
  bad.coordinates.pop_back();
  EXPECT_FALSE(player.add(bad));
  bad = motion(0, 10);
  bad.force.pop_back();
  EXPECT_FALSE(player.add(bad));
  bad = motion(0, 10);
  bad.acceleration.push_back(0.0);
  EXPECT_FALSE(player.add(bad));
  bad = motion(0, 10);
  bad.step = 0;
  EXPECT_FALSE(player.add(bad));
  bad = motion(0, 10);
  bad.sample_period = std::nan("");
  EXPECT_FALSE(player.add(bad));
  EXPECT_FALSE(player.advance(0.04));
}
}  // namespace
