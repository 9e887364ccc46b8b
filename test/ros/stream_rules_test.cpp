#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "vibro_impact/ros/stream_rules.h"

using vibro_impact::graph::Samples;
using vibro_impact::graph::Stamp;
using vibro_impact::graph::StreamLimits;
using vibro_impact::graph::StreamRules;
using vibro_impact::graph::Verdict;
using Action = vibro_impact::graph::Verdict::Action;

namespace
{
constexpr double period = 1.0e-3;
constexpr Stamp millisecond = 1000000;
constexpr Stamp second = 1000 * millisecond;
constexpr Stamp begin = 1700000000 * second;
constexpr std::size_t count = 10;

/// A block of the stream whose sample 0 is at `begin`.
Samples block(std::uint64_t seq, std::size_t samples = count)
{
  return {begin + static_cast<Stamp>(seq) * millisecond, seq, period, std::vector<double>(samples, 1.0)};
}

Samples shifted(Samples samples, Stamp by)
{
  samples.stamp += by;
  return samples;
}

/// Takes what is not refused.
Verdict feed(StreamRules& rules, const Samples& samples)
{
  const Verdict verdict = rules.judge(samples);
  if (verdict.action != Action::Refuse)
  {
    rules.take(samples, verdict.action, false);
  }
  return verdict;
}

void expectReason(const Verdict& verdict, const std::vector<std::string>& parts)
{
  for (const std::string& part : parts)
  {
    EXPECT_NE(verdict.reason.find(part), std::string::npos) << '"' << verdict.reason << "\" lacks \"" << part << '"';
  }
}

class StreamRulesTest : public testing::Test
{
protected:
  /// A stream that has run over samples 0 ... 999.
  void SetUp() override
  {
    ASSERT_EQ(feed(rules_, block(0)).action, Action::Start);
    for (std::uint64_t seq = count; seq < 1000; seq += count)
    {
      ASSERT_EQ(feed(rules_, block(seq)).action, Action::Continue);
    }
  }

  /// The block is refused for this reason, and the stream goes on as if it had not been there.
  void expectRefused(const Samples& samples, const std::vector<std::string>& reason)
  {
    const Verdict verdict = feed(rules_, samples);
    EXPECT_EQ(verdict.action, Action::Refuse) << verdict.reason;
    EXPECT_EQ(verdict.missing, 0u);
    expectReason(verdict, reason);
    EXPECT_EQ(rules_.nextSeq(), 1000u);
    EXPECT_EQ(rules_.judge(block(1000)).action, Action::Continue);
  }

  /// The block starts the stream anew, and the next one follows it.
  void expectRestart(const Samples& samples, const std::vector<std::string>& reason)
  {
    const Verdict verdict = feed(rules_, samples);
    EXPECT_EQ(verdict.action, Action::Restart) << verdict.reason;
    expectReason(verdict, reason);
    Samples next = samples;
    next.seq += samples.values.size();
    next.stamp +=
        static_cast<Stamp>(std::llround(static_cast<double>(samples.values.size()) * samples.sample_period * 1e9));
    EXPECT_EQ(rules_.judge(next).action, Action::Continue);
  }

  StreamRules rules_{StreamLimits{100.0, 0.02, 0.1, 0.05}};
};

TEST_F(StreamRulesTest, goodBlocksOfAnyLengthFollowOneAnother)
{
  EXPECT_EQ(feed(rules_, block(1000, 1)).action, Action::Continue);
  EXPECT_EQ(feed(rules_, block(1001, 500)).action, Action::Continue);
  EXPECT_EQ(feed(rules_, block(1501)).action, Action::Continue);
  EXPECT_EQ(rules_.nextSeq(), 1511u);
}

TEST_F(StreamRulesTest, badSamplesAreRefused)
{
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity(), 100.5, -100.5, 1.0e300})
  {
    for (const std::size_t index : {std::size_t{0}, std::size_t{4}, count - 1})
    {
      Samples samples = block(1000);
      samples.values[index] = bad;
      expectRefused(samples, {"acceleration[" + std::to_string(index) + "]", "max_acceleration = 100 m/s^2"});
    }
  }
  Samples samples = block(1000);
  samples.values = {100.0, -100.0, -0.0, std::numeric_limits<double>::denorm_min()};
  EXPECT_EQ(rules_.judge(samples).action, Action::Continue);
}

TEST_F(StreamRulesTest, theReasonShowsTheValue)
{
  Samples samples = block(1000);
  samples.values[3] = -123.25;
  expectRefused(samples, {"acceleration[3] is -123.25 m/s^2"});
  samples.values[3] = std::nan("");
  expectRefused(samples, {"acceleration[3] is nan m/s^2"});
}

TEST_F(StreamRulesTest, emptyBlockIsRefused)
{
  expectRefused(block(1000, 0), {"acceleration is empty"});
}

TEST_F(StreamRulesTest, absurdNumberOfSamplesIsRefused)
{
  expectRefused(block(1000, StreamRules::max_block_samples + 1), {"acceleration holds 10000001 samples"});
}

TEST_F(StreamRulesTest, badPeriodIsRefused)
{
  for (const double bad : {0.0, -0.0, -1.0e-3, std::nan(""), std::numeric_limits<double>::infinity(), 1.0e-10, 1.0e4,
                           std::numeric_limits<double>::denorm_min()})
  {
    Samples samples = block(1000);
    samples.sample_period = bad;
    expectRefused(samples, {"sample_period is ", "must be in [1e-09, 1000] s"});
  }
}

TEST_F(StreamRulesTest, zeroStampIsRefused)
{
  Samples samples = block(1000);
  samples.stamp = 0;
  expectRefused(samples, {"header.stamp is zero"});
}

TEST_F(StreamRulesTest, aBlockThatEndsBeyondTheRangeOfTimeIsRefused)
{
  Samples samples = block(1000);
  samples.stamp = 4294967294 * second + 999 * millisecond;
  expectRefused(samples, {"header.stamp", "beyond the range"});
  StreamRules fresh{StreamLimits{}};
  EXPECT_EQ(fresh.judge(samples).action, Action::Refuse);
}

TEST_F(StreamRulesTest, overflowOfTheCountIsRefused)
{
  Samples samples = block(1000);
  samples.seq = std::numeric_limits<std::uint64_t>::max() - count + 1;
  expectRefused(samples, {"seq is 18446744073709551606", "overflows"});
}

TEST_F(StreamRulesTest, repeatedBlockIsRefused)
{
  expectRefused(block(990), {"seq is 990 where 1000 was expected", "goes back by 0.01 s"});
}

TEST_F(StreamRulesTest, overlappingBlockIsRefused)
{
  expectRefused(block(995), {"seq is 995 where 1000 was expected"});
}

TEST_F(StreamRulesTest, goingBackByALittleIsRefusedUpToTheLimit)
{
  expectRefused(block(900), {"goes back by 0.1 s"});
}

TEST_F(StreamRulesTest, stampThatGoesBackByALittleIsRefused)
{
  expectRefused(shifted(block(1000), -60 * millisecond), {"header.stamp goes back by 0.05 s"});
}

TEST_F(StreamRulesTest, blockZeroAgainIsRefused)
{
  StreamRules rules{StreamLimits{}};
  feed(rules, block(0));
  EXPECT_EQ(feed(rules, block(0)).action, Action::Refuse);
  EXPECT_EQ(feed(rules, block(10)).action, Action::Continue);
}

TEST_F(StreamRulesTest, loopedBagRestarts)
{
  expectRestart(block(0), {"seq is 0 where 1000 was expected", "more than max_step_back = 0.1 s"});
}

TEST_F(StreamRulesTest, bagLoopedFromTheMiddleOfAStreamRestarts)
{
  expectRestart(block(500), {"seq is 500 where 1000 was expected", "0.5 s"});
}

TEST_F(StreamRulesTest, bagLoopedAfterALongDriftRestarts)
{
  // After an hour of drift the count no longer dates the bag's beginning, but the stamp is far back all the same.
  expectRestart(shifted(block(0), -400 * millisecond), {"header.stamp jumped"});
}

TEST_F(StreamRulesTest, restartedPublisherRestarts)
{
  expectRestart(shifted(block(0), 5 * second), {"the publisher restarted"});
}

TEST_F(StreamRulesTest, publisherRestartedAtOnceRestarts)
{
  StreamRules rules{StreamLimits{}};
  feed(rules, block(0));
  EXPECT_EQ(feed(rules, shifted(block(0), 10 * millisecond)).action, Action::Restart);
}

TEST_F(StreamRulesTest, restartedPublisherWhoseFirstBlocksWereMissedRestarts)
{
  expectRestart(shifted(block(950), 2 * second), {"header.stamp jumped", "seq 950"});
}

TEST_F(StreamRulesTest, missingSamplesAreBridgedUpToTheLimit)
{
  const Verdict one = feed(rules_, block(1001));
  EXPECT_EQ(one.action, Action::Bridge);
  EXPECT_EQ(one.missing, 1u);
  expectReason(one, {"1 samples (0.001 s) are missing before seq 1001"});
  const Verdict twenty = feed(rules_, block(1031));
  EXPECT_EQ(twenty.action, Action::Bridge);
  EXPECT_EQ(twenty.missing, 20u);
  EXPECT_EQ(rules_.nextSeq(), 1041u);
}

TEST_F(StreamRulesTest, moreMissingRestarts)
{
  EXPECT_EQ(rules_.judge(block(1021)).missing, 21u);
  expectRestart(block(1021), {"21 samples (0.021 s) are missing", "more than max_bridged_gap = 0.02 s"});
}

TEST_F(StreamRulesTest, bridgingCanBeForbidden)
{
  StreamRules rules{StreamLimits{100.0, 0.0, 0.1, 0.05}};
  feed(rules, block(0));
  EXPECT_EQ(feed(rules, block(11)).action, Action::Restart);
}

TEST_F(StreamRulesTest, hourLongJumpRestarts)
{
  expectRestart(shifted(block(1000), 3600 * second), {"header.stamp jumped: it is 3600 s off"});
}

TEST_F(StreamRulesTest, jumpBackInTimeRestarts)
{
  expectRestart(shifted(block(1000), -10 * second), {"header.stamp jumped: it is -10 s off"});
}

TEST_F(StreamRulesTest, absurdCountRestarts)
{
  Samples samples = block(1000);
  samples.seq = std::numeric_limits<std::uint64_t>::max() / 2;
  EXPECT_EQ(feed(rules_, samples).action, Action::Restart);
}

TEST_F(StreamRulesTest, newPeriodRestarts)
{
  Samples samples = block(1000);
  samples.sample_period = 2.0e-3;
  expectRestart(samples, {"sample_period changed from 0.001 s to 0.002 s"});
}

TEST_F(StreamRulesTest, stampThatRepeatsIsRefusedThoughTheCountGoesOn)
{
  expectRefused(shifted(block(1000), -10 * millisecond), {"header.stamp goes back by 0 s"});
  expectRefused(shifted(block(1000), -30 * millisecond), {"header.stamp goes back by 0.02 s"});
}

TEST_F(StreamRulesTest, jitterOfStampsIsTolerated)
{
  Stamp jitter = 8 * millisecond;
  for (std::uint64_t seq = 1000; seq < 2000; seq += count)
  {
    ASSERT_EQ(feed(rules_, shifted(block(seq), jitter)).action, Action::Continue) << seq;
    jitter = jitter == 0 ? 8 * millisecond : 0;
  }
}

TEST_F(StreamRulesTest, blocksThatComeLateAndAllAtOnceAreTolerated)
{
  // A driver that stamps on receipt was held up for 45 ms.
  const Stamp late = begin + (1000 + 45) * millisecond;
  for (int i = 0; i < 5; ++i)
  {
    Samples samples = block(1000 + count * static_cast<std::uint64_t>(i));
    samples.stamp = late + i * 1000;
    ASSERT_EQ(feed(rules_, samples).action, Action::Continue) << i;
  }
  EXPECT_EQ(feed(rules_, block(1050)).action, Action::Continue);
}

TEST_F(StreamRulesTest, driftOfStampsIsTolerated)
{
  for (std::uint64_t seq = 1000; seq < 1000000; seq += count)
  {
    ASSERT_EQ(feed(rules_, shifted(block(seq), static_cast<Stamp>(seq) * 1000)).action, Action::Continue) << seq;
  }
}

TEST_F(StreamRulesTest, whatComesAfterForgettingStarts)
{
  rules_.forget();
  EXPECT_EQ(feed(rules_, block(50)).action, Action::Start);
  EXPECT_EQ(feed(rules_, block(60)).action, Action::Continue);
}

TEST(StreamRules, badFirstBlockIsRefused)
{
  StreamRules rules{StreamLimits{}};
  EXPECT_EQ(feed(rules, block(0, 0)).action, Action::Refuse);
  EXPECT_EQ(feed(rules, block(5)).action, Action::Start);
}

}  // namespace
