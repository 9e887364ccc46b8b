#include "vibro_impact/ros/recording_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "vibro_impact/config/error.h"

namespace vibro_impact::graph
{
namespace
{
using testing::AllOf;
using testing::HasSubstr;

constexpr double period = 1.0e-3;
const std::vector<double> none(100, 0.0);

BlockHead block(std::uint64_t seq, std::uint64_t samples = 100)
{
  return {seq, samples, ros::Time(50.0) + ros::Duration(static_cast<double>(seq) * period), period};
}

Impact impact(std::uint64_t number, std::uint64_t seq)
{
  Impact message;
  message.number = number;
  message.seq = seq;
  return message;
}

class Check : public testing::Test
{
protected:
  // Ten blocks of excitation.
  void takeExcitation(std::uint64_t without = 1000)
  {
    for (std::uint64_t seq = 0; seq < 1000; seq += 100)
    {
      if (seq != without)
      {
        EXPECT_TRUE(check_.takeExcitation(block(seq)));
      }
    }
  }

  // Of contact over the samples [from, to).
  void takeAnswers(std::uint64_t from = 0, std::uint64_t to = 0)
  {
    for (std::uint64_t seq = 0; seq < 1000; seq += 100)
    {
      std::vector<double> force(100, 0.0);
      for (std::uint64_t i = std::max(from, seq); i < std::min(to, seq + 100); ++i)
      {
        force[i - seq] = 2.5;
      }
      check_.takeGap(block(seq), none);
      check_.takeContactForce(block(seq), force);
    }
  }

  void expectLoss(std::uint64_t first, std::uint64_t last, const std::string& reason)
  {
    const auto losses = check_.finish().losses;
    ASSERT_EQ(losses.size(), 1u);
    EXPECT_EQ(losses[0].first, first);
    EXPECT_EQ(losses[0].last, last);
    EXPECT_EQ(losses[0].reason, reason);
  }

  template <typename Action>
  void expectError(Action action, const std::string& reason)
  {
    try
    {
      action();
      ADD_FAILURE() << "no error";
    }
    catch (const config::Error& error)
    {
      EXPECT_THAT(error.what(), HasSubstr(reason));
    }
  }

  RecordingCheck check_{{"/base_excitation", "/gap", "/contact_force", "/impact", "/model_info", ""}};
};

TEST_F(Check, completeRecordingHasNoLoss)
{
  takeExcitation();
  takeAnswers();
  EXPECT_TRUE(check_.takeImpact(impact(0, 10)));
  EXPECT_TRUE(check_.takeImpact(impact(1, 20)));
  const RecordingSummary summary = check_.finish();
  EXPECT_TRUE(summary.losses.empty());
  EXPECT_EQ(summary.blocks, 10u);
  EXPECT_EQ(summary.samples, 1000u);
  EXPECT_EQ(summary.impacts, 2u);
  EXPECT_EQ(summary.restarts, 0u);
  EXPECT_EQ(summary.sample_period, period);
}

TEST_F(Check, answersMayComeFirstAndInAnyOrder)
{
  takeAnswers();
  takeExcitation();
  EXPECT_TRUE(check_.finish().losses.empty());
}

TEST_F(Check, missingExcitationIsALoss)
{
  takeExcitation(400);
  takeAnswers();
  expectLoss(400, 500, "topic /base_excitation: seq 400 to 499 (100 samples) is missing");
}

TEST_F(Check, answersWithoutTheirExcitationAreALoss)
{
  for (std::uint64_t seq = 200; seq < 900; seq += 100)
  {
    check_.takeExcitation(block(seq));
  }
  takeAnswers();
  const auto losses = check_.finish().losses;
  ASSERT_EQ(losses.size(), 2u);
  EXPECT_EQ(losses[0].first, 0u);
  EXPECT_EQ(losses[0].last, 200u);
  EXPECT_EQ(losses[0].reason, "topic /base_excitation: seq 0 to 199 (2 blocks, answered) is missing");
  EXPECT_EQ(losses[1].first, 900u);
  EXPECT_EQ(losses[1].last, 1000u);
  EXPECT_EQ(losses[1].reason, "topic /base_excitation: seq 900 to 999 (1 block, answered) is missing");
}

TEST_F(Check, missingAnswersInARowAreOneLoss)
{
  takeExcitation();
  for (std::uint64_t seq = 0; seq < 1000; seq += 100)
  {
    check_.takeContactForce(block(seq), none);
    if (seq != 300 && seq != 400)
    {
      check_.takeGap(block(seq), none);
    }
  }
  expectLoss(300, 500, "topic /gap: seq 300 to 499 (2 blocks) is missing");
}

TEST_F(Check, missingForceIsALossAtTheEndToo)
{
  takeExcitation();
  for (std::uint64_t seq = 0; seq < 1000; seq += 100)
  {
    check_.takeGap(block(seq), none);
    if (seq != 900)
    {
      check_.takeContactForce(block(seq), none);
    }
  }
  expectLoss(900, 1000, "topic /contact_force: seq 900 to 999 (1 block) is missing");
}

TEST_F(Check, answersMustHaveSamplesPeriodAndStampOfTheBlock)
{
  takeExcitation();
  for (std::uint64_t seq = 0; seq < 1000; seq += 100)
  {
    BlockHead gap = block(seq);
    BlockHead force = block(seq);
    gap.samples = seq == 100 ? 99 : gap.samples;
    gap.sample_period = seq == 200 ? 2.0 * period : gap.sample_period;
    force.stamp += ros::Duration(seq == 300 ? 1.0e-9 : 0.0);
    check_.takeGap(gap, none);
    check_.takeContactForce(force, none);
  }
  const auto losses = check_.finish().losses;
  ASSERT_EQ(losses.size(), 3u);
  EXPECT_THAT(losses[0].reason, AllOf(HasSubstr("seq 100"), HasSubstr("99 samples instead of 100")));
  EXPECT_THAT(losses[1].reason, AllOf(HasSubstr("seq 200"), HasSubstr("sample_period 0.002")));
  EXPECT_THAT(losses[2].reason, AllOf(HasSubstr("seq 300"), HasSubstr("header.stamp")));
}

TEST_F(Check, answersMustBeFinite)
{
  takeExcitation();
  for (std::uint64_t seq = 0; seq < 1000; seq += 100)
  {
    std::vector<double> gap(100, 1.0e-4);
    std::vector<double> force(100, 0.0);
    if (seq == 200)
    {
      gap[99] = std::nan("");
    }
    if (seq == 500)
    {
      // Neither a contact that ends here, nor one that goes on to the next block.
      force[98] = std::nan("");
      force[99] = std::numeric_limits<double>::infinity();
    }
    EXPECT_EQ(check_.takeGap(block(seq), gap), seq != 200);
    EXPECT_EQ(check_.takeContactForce(block(seq), force), seq != 500);
  }
  const auto losses = check_.finish().losses;
  ASSERT_EQ(losses.size(), 2u);
  EXPECT_EQ(losses[0].first, 200u);
  EXPECT_EQ(losses[0].last, 300u);
  EXPECT_EQ(losses[0].reason, "topic /gap: the block of seq 200 holds a sample that is not finite");
  EXPECT_EQ(losses[1].first, 500u);
  EXPECT_EQ(losses[1].last, 600u);
  EXPECT_EQ(losses[1].reason, "topic /contact_force: the block of seq 500 holds a sample that is not finite");
}

TEST_F(Check, impactsAreCounted)
{
  takeExcitation();
  takeAnswers();
  check_.takeImpact(impact(0, 10));
  check_.takeImpact(impact(3, 50));
  expectLoss(10, 51, "topic /impact: number 1 to 2 (2 impacts before seq 50) is missing");
}

TEST_F(Check, firstImpactIsNumberZeroOfARunRecordedFromItsBeginning)
{
  takeExcitation();
  takeAnswers();
  check_.takeImpact(impact(1, 10));
  expectLoss(0, 11, "topic /impact: number 0 to 0 (1 impact before seq 10) is missing");
}

TEST_F(Check, contactThatHasEndedIsAnImpact)
{
  takeExcitation();
  takeAnswers(580, 800);  // over several blocks, up to the end of one
  check_.takeImpact(impact(0, 10));
  check_.takeImpact(impact(1, 50));
  expectLoss(50, 801, "topic /impact: what follows number 1 (contact up to seq 799) is missing");

  Impact last = impact(2, 579);
  last.offset = 0.5 * period;
  last.duration = 220.0 * period;
  check_.takeImpact(last);
  EXPECT_TRUE(check_.finish().losses.empty());
}

TEST_F(Check, contactWithoutAnyImpactIsALoss)
{
  takeExcitation();
  takeAnswers(580, 590);
  expectLoss(0, 591, "topic /impact: every impact (contact up to seq 589) is missing");
}

TEST_F(Check, contactThatHasNotEndedIsNoImpactYet)
{
  takeExcitation();
  takeAnswers(980, 1000);
  check_.takeImpact(impact(0, 10));
  EXPECT_TRUE(check_.finish().losses.empty());
}

TEST_F(Check, recordingMayBeginInTheMiddleOfTheStream)
{
  for (const std::uint64_t seq : {500, 600})
  {
    check_.takeExcitation(block(seq));
    check_.takeGap(block(seq), none);
    check_.takeContactForce(block(seq), none);
  }
  check_.takeGap(block(400), none);  // the recorder hears of this topic first
  check_.takeImpact(impact(17, 510));
  const RecordingSummary summary = check_.finish();
  EXPECT_TRUE(summary.losses.empty());
  EXPECT_EQ(summary.first, 500u);
}

TEST_F(Check, simulationThatStartsAnewIsNoLoss)
{
  takeExcitation();
  takeAnswers();
  check_.takeImpact(impact(0, 10));
  check_.takeImpact(impact(1, 50));
  check_.takeImpact(impact(0, 70));
  EXPECT_TRUE(check_.finish().losses.empty());
  EXPECT_EQ(check_.finish().restarts, 1u);
}

TEST_F(Check, repetitionsAreLeft)
{
  takeExcitation();
  takeAnswers();
  EXPECT_FALSE(check_.takeExcitation(block(900)));
  EXPECT_TRUE(check_.takeImpact(impact(0, 10)));
  EXPECT_FALSE(check_.takeImpact(impact(0, 10)));
  const RecordingSummary summary = check_.finish();
  EXPECT_TRUE(summary.losses.empty());
  EXPECT_EQ(summary.blocks, 10u);
  EXPECT_EQ(summary.repeated, 1u);
  EXPECT_EQ(summary.impacts, 1u);
}

TEST_F(Check, refusesARestartOfTheStream)
{
  takeExcitation();
  BlockHead restarted = block(0);
  restarted.stamp = ros::Time(80.0);
  expectError([&] { check_.takeExcitation(restarted); }, "/base_excitation, seq 0: the stream restarts, seq 1000");
}

TEST_F(Check, refusesANewPeriod)
{
  takeExcitation();
  BlockHead next = block(1000);
  next.sample_period = 2.0e-3;
  expectError([&] { check_.takeExcitation(next); }, "sample_period changes from 0.001 s to 0.002 s");
}

TEST_F(Check, refusesAJumpInTime)
{
  takeExcitation();
  BlockHead next = block(1000);
  next.stamp += ros::Duration(0.02);
  EXPECT_TRUE(check_.takeExcitation(next));  // stamps of a real driver jitter
  next = block(1100);
  next.stamp += ros::Duration(5.0);
  expectError([&] { check_.takeExcitation(next); }, "header.stamp jumps");
  next.stamp = ros::Time(4.0e9);
  expectError([&] { check_.takeExcitation(next); }, "header.stamp jumps");
}

TEST_F(Check, refusesAPeriodThatIsNone)
{
  for (const double bad : {0.0, -1.0e-3, std::nan("")})
  {
    BlockHead first = block(0);
    first.sample_period = bad;
    expectError([&] { check_.takeExcitation(first); }, "must be in [1e-09, 1000] s");
  }
}

TEST_F(Check, refusesANumberThatIsTooGreat)
{
  BlockHead late = block(0);
  late.seq = (std::uint64_t{1} << 53) - 99;
  expectError([&] { check_.takeExcitation(late); }, "seq 9007199254740893: the number is too great");
  late.seq = ~std::uint64_t{0};
  expectError([&] { check_.takeExcitation(late); }, "must be at most 9007199254740992");
  late.seq = (std::uint64_t{1} << 53) - 100;
  EXPECT_TRUE(check_.takeExcitation(late));
}

TEST_F(Check, refusesAnImpactThatIsNotFinite)
{
  Impact bad = impact(3, 10);
  bad.impulse = std::nan("");
  expectError([&] { check_.takeImpact(bad); }, "topic /impact, number 3: impulse is nan, must be finite");
}

TEST_F(Check, refusesAStreamWithoutBlocks)
{
  expectError([&] { check_.finish(); }, "holds no block of excitation");
}

TEST(CheckWithoutImpacts, isRefusedIfAContactHasEnded)
{
  RecordingCheck silent({"/base_excitation", "/gap", "/contact_force", "", "/model_info", ""});
  silent.takeExcitation(block(0));
  silent.takeGap(block(0), none);
  silent.takeContactForce(block(0), none);
  EXPECT_TRUE(silent.finish().losses.empty());
  silent.takeContactForce(block(0), {0.0, 1.0});
  EXPECT_TRUE(silent.finish().losses.empty()) << "the episode is still open";
  silent.takeContactForce(block(0), {0.0, 1.0, 0.0});
  EXPECT_THROW(silent.finish(), config::Error);
}
}  // namespace
}  // namespace vibro_impact::graph
