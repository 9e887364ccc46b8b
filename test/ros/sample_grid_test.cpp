#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "vibro_impact/ros/sample_grid.h"

using vibro_impact::graph::GridParameters;
using vibro_impact::graph::SampleGrid;
using vibro_impact::graph::Samples;
using vibro_impact::graph::Stamp;
using vibro_impact::graph::StreamLimits;
using vibro_impact::graph::StreamRules;
using vibro_impact::graph::Verdict;

namespace
{
constexpr Stamp millisecond = 1000000;
constexpr Stamp second = 1000 * millisecond;
constexpr Stamp begin = 1700000000 * second;
constexpr double period = 1.0e-3;
constexpr double pi = 3.141592653589793;

GridParameters declared()
{
  GridParameters parameters;
  parameters.sample_period = period;
  return parameters;
}

/// What a grid gives: its blocks, and the values of the first million numbers, NaN where it leaves some out.
class Stream
{
public:
  explicit Stream(const GridParameters& parameters, const StreamLimits& limits = StreamLimits{})
      : grid_(parameters, limits, "accel.linear.z")
  {
  }

  /// Whether the sample was taken.
  bool take(Stamp stamp, double value)
  {
    const SampleGrid::Answer& answer = grid_.take(stamp, value);
    for (const Samples& block : answer.blocks)
    {
      if (block.seq == 0)
      {
        values.clear();
      }
      blocks.push_back(block);
      if (block.seq < 1000000)
      {
        values.resize(block.seq, std::nan(""));
        values.insert(values.end(), block.values.begin(), block.values.end());
      }
    }
    refusal = answer.refusal;
    refused = answer.refused;
    return answer.refused == 0;
  }

  const SampleGrid& grid() const
  {
    return grid_;
  }

  std::vector<double> values;
  std::vector<Samples> blocks;
  std::string refusal;
  std::uint64_t refused = 0;

private:
  SampleGrid grid_;
};

void expectContains(const std::string& text, const std::vector<std::string>& parts)
{
  for (const std::string& part : parts)
  {
    EXPECT_NE(text.find(part), std::string::npos) << '"' << text << "\" lacks \"" << part << '"';
  }
}

/// Any values, none like another.
double value(std::int64_t i)
{
  return std::sin(static_cast<double>(i * i)) * 7.3;
}

TEST(SampleGrid, exactStampsPassBitForBitAndAtOnce)
{
  // 3 kHz, whose period no stamp holds exactly; rounded, and cut off to the nanosecond.
  for (const double rounding : {0.5, 0.0})
  {
    GridParameters parameters;
    parameters.sample_period = 1.0 / 3000.0;
    Stream stream(parameters);
    for (std::int64_t i = 0; i < 100000; ++i)
    {
      const Stamp stamp = begin + static_cast<Stamp>(std::floor(static_cast<double>(i) * 1.0e9 / 3000.0 + rounding));
      ASSERT_TRUE(stream.take(stamp, value(i)));
      ASSERT_EQ(stream.values.size(), static_cast<std::size_t>(i) + 1) << "an answer late, or one too many";
      ASSERT_EQ(stream.values.back(), value(i)) << i;
      ASSERT_EQ(stream.blocks.back().seq, static_cast<std::uint64_t>(i));
      ASSERT_LE(std::abs(stream.blocks.back().stamp - stamp), 1);
      ASSERT_EQ(stream.blocks.back().sample_period, 1.0 / 3000.0);
    }
  }
}

TEST(SampleGrid, aSineWithJitteredStampsIsWithinTheBoundOfLinearInterpolation)
{
  const double amplitude = 9.0;
  const double omega = 2.0 * pi * 31.0;
  const auto sine = [&](Stamp stamp)
  { return amplitude * std::sin(omega * 1.0e-9 * static_cast<double>(stamp - begin)); };
  std::mt19937 random(7);
  std::uniform_int_distribution<Stamp> jitter(-240000, 240000);
  Stream stream(declared());
  Stamp last = begin;
  double longest = 0.0;
  for (Stamp i = 0; i < 5000; ++i)
  {
    const Stamp stamp = begin + i * millisecond + (i == 0 ? 0 : jitter(random));
    longest = std::max(longest, 1.0e-9 * static_cast<double>(stamp - last));
    last = stamp;
    ASSERT_TRUE(stream.take(stamp, sine(stamp)));
  }
  const double bound = longest * longest / 8.0 * amplitude * omega * omega;
  ASSERT_GE(stream.values.size(), 4999u);
  double greatest = 0.0;
  for (std::size_t i = 0; i < stream.values.size(); ++i)
  {
    greatest = std::max(greatest, std::abs(stream.values[i] - sine(begin + static_cast<Stamp>(i) * millisecond)));
  }
  EXPECT_LE(greatest, bound);
  EXPECT_GT(greatest, 0.3 * bound) << "the bound is to be the true one";
}

TEST(SampleGrid, aStraightLineIsKeptWhateverTheStamps)
{
  std::mt19937 random(3);
  std::uniform_int_distribution<Stamp> step(1, 1500000);
  Stream stream(declared());
  Stamp stamp = begin;
  const auto line = [](Stamp at) { return 1.0 - 0.125 * 1.0e-6 * static_cast<double>(at - begin); };
  for (int i = 0; i < 10000; ++i)
  {
    ASSERT_TRUE(stream.take(stamp, line(stamp)));
    stamp += step(random);
  }
  ASSERT_GT(stream.values.size(), 7000u);
  for (std::size_t i = 0; i < stream.values.size(); ++i)
  {
    ASSERT_NEAR(stream.values[i], line(begin + static_cast<Stamp>(i) * millisecond), 1e-9) << i;
  }
}

TEST(SampleGrid, aClockThatRunsDifferentlyLosesNothing)
{
  // The sensor takes 1.001 samples a millisecond: every thousandth lies between two times of the grid.
  Stream stream(declared());
  for (Stamp i = 0; i < 10000; ++i)
  {
    ASSERT_TRUE(stream.take(begin + i * 999000, static_cast<double>(i)));
  }
  EXPECT_EQ(stream.values.size(), 9990u);
  EXPECT_NEAR(stream.values.back(), 9989.0 / 0.999, 1e-6);
}

TEST(SampleGrid, aConstantSpecificForceLessItsOffsetIsZero)
{
  GridParameters parameters = declared();
  parameters.offset = 9.81;
  Stream given(parameters);
  parameters.offset = std::nullopt;
  parameters.offset_duration = 0.5;
  Stream measured(parameters);
  for (Stamp i = 0; i < 2000; ++i)
  {
    ASSERT_TRUE(given.take(begin + i * millisecond, 9.81));
    ASSERT_TRUE(measured.take(begin + i * millisecond, 9.8125));
    EXPECT_EQ(measured.grid().measuring(), i < 500);
  }
  EXPECT_EQ(given.values, std::vector<double>(2000, 0.0));
  EXPECT_EQ(*measured.grid().offset(), 9.8125);
  EXPECT_EQ(measured.values, std::vector<double>(2000, 0.0)) << "the samples that waited are put on the grid, too";
  EXPECT_EQ(measured.blocks.front().stamp, begin);
  EXPECT_EQ(measured.blocks.front().values.size(), 501u);
}

TEST(SampleGrid, theMeanIsThatOfTheFirstSamples)
{
  GridParameters parameters = declared();
  parameters.offset = std::nullopt;
  parameters.offset_duration = 0.1;
  Stream stream(parameters);
  // Ten whole vibrations about gravity, and then something else.
  for (Stamp i = 0; i < 500; ++i)
  {
    const double vibration = 3.0 * std::sin(2.0 * pi * static_cast<double>(i) / 10.0);
    ASSERT_TRUE(stream.take(begin + i * millisecond, i < 100 ? -9.81 + vibration : 50.0));
  }
  EXPECT_NEAR(*stream.grid().offset(), -9.81, 1e-12);
  EXPECT_NEAR(stream.values[13], 3.0 * std::sin(2.0 * pi * 1.3), 1e-11);
  EXPECT_NEAR(stream.values[400], 59.81, 1e-12);
}

TEST(SampleGrid, thePeriodIsTheMedianOfTheFirstIntervals)
{
  std::mt19937 random(1);
  std::uniform_int_distribution<Stamp> jitter(-100000, 100000);
  Stream exact(GridParameters{});
  Stream jittered(GridParameters{});
  for (Stamp i = 0; i < 1000; ++i)
  {
    // Every eleventh sample is missing: that makes longer intervals, and no longer period.
    if (i % 11 != 10)
    {
      ASSERT_TRUE(exact.take(begin + i * millisecond, 0.0));
      ASSERT_TRUE(jittered.take(begin + i * millisecond + jitter(random), 0.0));
    }
    EXPECT_EQ(exact.grid().measuring(), i < static_cast<Stamp>(SampleGrid::measured_intervals) + 10);
  }
  EXPECT_EQ(*exact.grid().samplePeriod(), 1.0e-3);
  EXPECT_NEAR(*jittered.grid().samplePeriod(), 1.0e-3, 3.0e-5);
  EXPECT_EQ(exact.values.size(), 1000u);
}

TEST(SampleGrid, missingSamplesAreLeftOutForTheRulesToBridge)
{
  const StreamLimits limits;
  StreamRules rules(limits);
  Stream stream(declared(), limits);
  for (Stamp i = 0; i < 1000; ++i)
  {
    if (i < 500 || i >= 507)
    {
      ASSERT_TRUE(stream.take(begin + i * millisecond, static_cast<double>(i)));
    }
  }
  std::uint64_t missing = 0;
  for (const Samples& block : stream.blocks)
  {
    const Verdict verdict = rules.judge(block);
    ASSERT_TRUE(block.seq == 0 ||
                verdict.action == (block.seq == 507 ? Verdict::Action::Bridge : Verdict::Action::Continue))
        << block.seq << ": " << verdict.reason;
    missing += verdict.missing;
    rules.take(block, verdict.action, false);
  }
  EXPECT_EQ(missing, 7u);
  EXPECT_EQ(stream.values.size(), 1000u);
  EXPECT_EQ(stream.values[507], 507.0);
}

TEST(SampleGrid, missingSamplesBetweenTimesOfTheGridLeaveAHoleToo)
{
  Stream stream(declared());
  for (Stamp i = 0; i < 100; ++i)
  {
    if (i < 50 || i >= 53)
    {
      const Stamp off = i == 0 ? 0 : 400000;
      ASSERT_TRUE(
          stream.take(begin + i * millisecond + off, static_cast<double>(i) + 1.0e-6 * static_cast<double>(off)));
    }
  }
  // Known are 49 (between 48.4 and 49.4) and 54 (between 53.4 and 54.4), and none of those between.
  ASSERT_EQ(stream.values.size(), 100u);
  for (std::size_t i = 0; i < 100; ++i)
  {
    if (i >= 50 && i <= 53)
    {
      EXPECT_TRUE(std::isnan(stream.values[i])) << i;
    }
    else
    {
      EXPECT_NEAR(stream.values[i], static_cast<double>(i), 1e-9);
    }
  }
}

TEST(SampleGrid, wherePartOfAStreamIsMissingTheGridBeginsAnewAndTheRulesRestart)
{
  const StreamLimits limits;
  for (const Stamp gap : {30 * millisecond, second, 3600 * second, Stamp{20} * 365 * 86400 * second})
  {
    StreamRules rules(limits);
    Stream stream(declared(), limits);
    for (Stamp i = 0; i < 502; ++i)
    {
      const Stamp off = i < 500 ? 0 : gap + 123456;
      ASSERT_TRUE(stream.take(begin + i * millisecond + off, static_cast<double>(i)));
      ASSERT_EQ(stream.blocks.size(), static_cast<std::size_t>(i) + 1);
      const Samples& block = stream.blocks.back();
      const Verdict verdict = rules.judge(block);
      ASSERT_EQ(verdict.action, i == 0     ? Verdict::Action::Start
                                : i == 500 ? Verdict::Action::Restart
                                           : Verdict::Action::Continue)
          << verdict.reason;
      ASSERT_EQ(block.stamp, begin + i * millisecond + off);
      ASSERT_EQ(block.values, std::vector<double>{static_cast<double>(i)});
      rules.take(block, verdict.action, false);
      if (i == 500)
      {
        EXPECT_NEAR(static_cast<double>(verdict.missing), 1.0e-6 * static_cast<double>(gap), 2.0);
      }
    }
  }
}

TEST(SampleGrid, badSamplesAreRefusedAndChangeNothing)
{
  Stream stream(declared(), StreamLimits{100.0, 0.02, 0.1, 0.05});
  ASSERT_TRUE(stream.take(begin, 1.0));
  ASSERT_TRUE(stream.take(begin + millisecond, 2.0));
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), -100.5, 1.0e300})
  {
    EXPECT_FALSE(stream.take(begin + 2 * millisecond, bad));
    EXPECT_EQ(stream.refused, 1u);
    expectContains(stream.refusal, {"accel.linear.z is ", "max_acceleration = 100 m/s^2"});
  }
  EXPECT_FALSE(stream.take(0, 3.0));
  expectContains(stream.refusal, {"header.stamp is zero"});
  EXPECT_FALSE(stream.take(begin + millisecond, 3.0));
  expectContains(stream.refusal, {"header.stamp goes back by 0 s"});
  EXPECT_FALSE(stream.take(begin - 99 * millisecond, 3.0));
  expectContains(stream.refusal, {"header.stamp goes back by 0.1 s"});
  ASSERT_TRUE(stream.take(begin + 2 * millisecond, 3.0));
  EXPECT_EQ(stream.values, (std::vector<double>{1.0, 2.0, 3.0}));
}

TEST(SampleGrid, theOffsetIsTakenOffBeforeTheLimitHolds)
{
  GridParameters parameters = declared();
  parameters.offset = 10.0;
  Stream stream(parameters, StreamLimits{5.0, 0.02, 0.1, 0.05});
  EXPECT_TRUE(stream.take(begin, 15.0));
  EXPECT_FALSE(stream.take(begin + millisecond, 4.0));
  expectContains(stream.refusal, {"accel.linear.z is 4 m/s^2", "less the offset of 10 m/s^2", "max_acceleration = 5"});
}

TEST(SampleGrid, aLoopedBagGivesTheSameGridAgain)
{
  GridParameters parameters;
  parameters.offset = std::nullopt;
  parameters.offset_duration = 0.2;
  const StreamLimits limits;
  StreamRules rules(limits);
  Stream stream(parameters, limits);
  std::mt19937 random(1);
  std::uniform_int_distribution<Stamp> jitter(0, 200000);
  std::vector<Stamp> stamps;
  for (Stamp i = 0; i < 1000; ++i)
  {
    stamps.push_back(begin + i * millisecond + jitter(random));
  }
  std::vector<double> first;
  for (int pass = 0; pass < 3; ++pass)
  {
    for (std::size_t i = 0; i < stamps.size(); ++i)
    {
      ASSERT_TRUE(stream.take(stamps[i], value(static_cast<std::int64_t>(i)))) << stream.refusal;
    }
    ASSERT_FALSE(stream.values.empty());
    EXPECT_EQ(stream.blocks.front().seq, 0u);
    EXPECT_EQ(rules.judge(stream.blocks.front()).action, pass == 0 ? Verdict::Action::Start : Verdict::Action::Restart);
    for (const Samples& block : stream.blocks)
    {
      const Verdict::Action action = rules.judge(block).action;
      ASSERT_NE(action, Verdict::Action::Refuse);
      rules.take(block, action, false);
    }
    stream.blocks.clear();
    if (pass == 0)
    {
      first = stream.values;
    }
    EXPECT_EQ(stream.values, first);
  }
}

TEST(SampleGrid, whatIsMeasuredIsMeasuredInOnePiece)
{
  GridParameters parameters = declared();
  parameters.offset = std::nullopt;
  parameters.offset_duration = 0.5;
  for (const Stamp jump : {2 * second, -10 * second})
  {
    Stream stream(parameters);
    for (Stamp i = 0; i < 100; ++i)
    {
      ASSERT_TRUE(stream.take(begin + i * millisecond, 100.0));
    }
    EXPECT_FALSE(stream.take(begin + jump, 3.0));
    EXPECT_EQ(stream.refused, 100u) << "those that waited, not this one";
    expectContains(stream.refusal, {"header.stamp jumps by ", "100 samples are given up"});
    for (Stamp i = 1; i <= 500; ++i)
    {
      ASSERT_TRUE(stream.take(begin + jump + i * millisecond, 3.0));
    }
    EXPECT_EQ(*stream.grid().offset(), 3.0);
    EXPECT_EQ(stream.blocks.front().stamp, begin + jump);
    EXPECT_EQ(stream.values.size(), 501u);
  }
}

TEST(SampleGrid, noMoreThanSoManySamplesWait)
{
  GridParameters parameters = declared();
  parameters.offset = std::nullopt;
  parameters.offset_duration = 60.0;
  Stream stream(parameters);
  for (std::size_t i = 0; i <= SampleGrid::max_waiting_samples; ++i)
  {
    EXPECT_TRUE(stream.grid().measuring());
    stream.take(begin + static_cast<Stamp>(i), 2.0);
  }
  EXPECT_FALSE(stream.grid().measuring());
  EXPECT_EQ(*stream.grid().offset(), 2.0);
}

TEST(SampleGrid, whateverComesTheBlocksAreAStream)
{
  std::mt19937_64 random(11);
  const auto any = [&random](std::size_t count) { return static_cast<std::size_t>(random() % count); };
  const std::vector<Stamp> steps = {0,
                                    1,
                                    2,
                                    999,
                                    500000,
                                    999999,
                                    1000000,
                                    1000001,
                                    1499999,
                                    1500000,
                                    1500001,
                                    7 * millisecond,
                                    30 * millisecond,
                                    second,
                                    3600 * second,
                                    -1,
                                    -millisecond,
                                    -second,
                                    -3600 * second};
  const std::vector<double> values = {0.0,    -1.0, 2.5, std::nan(""), std::numeric_limits<double>::infinity(),
                                      -1.0e6, 99.0};
  for (int run = 0; run < 300; ++run)
  {
    GridParameters parameters;
    const std::vector<std::optional<double>> periods = {std::nullopt, 1.0e-9, 1.0e-3, 0.7e-3, 1.0e3};
    parameters.sample_period = periods[any(periods.size())];
    parameters.offset = any(2) == 0 ? std::optional<double>(1.0) : std::nullopt;
    parameters.offset_duration = 0.05;
    const StreamLimits limits;
    SampleGrid grid(parameters, limits, "accel.linear.z");
    Stamp stamp = begin;
    std::uint64_t next = 0;
    for (int i = 0; i < 1000; ++i)
    {
      stamp += any(4) == 0 ? steps[any(steps.size())] : millisecond;
      const SampleGrid::Answer& answer = grid.take(stamp, any(20) == 0 ? values[any(values.size())] : 1.0);
      ASSERT_EQ(answer.refused == 0, answer.refusal.empty());
      for (const Samples& block : answer.blocks)
      {
        ASSERT_TRUE(block.seq >= next || block.seq == 0) << block.seq << " after " << next;
        ASSERT_FALSE(block.values.empty());
        ASSERT_LE(block.stamp, stamp + 1);
        ASSERT_EQ(block.sample_period, *grid.samplePeriod());
        for (const double sample : block.values)
        {
          ASSERT_LE(std::abs(sample), 2.0 * limits.max_acceleration);
        }
        next = block.seq + block.values.size();
      }
    }
  }
}

TEST(SampleGrid, theEndOfTimeIsSurvived)
{
  Stream stream(declared());
  EXPECT_TRUE(stream.take(1, 1.0));
  EXPECT_TRUE(stream.take(4294967295 * second + second - 1, 2.0));
  EXPECT_EQ(stream.blocks.back().stamp, 4294967295 * second + second - 1);
}

}  // namespace
