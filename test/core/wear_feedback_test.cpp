#include <gtest/gtest.h>

#include "vibro_impact/core/wear_feedback.h"

using vibro_impact::core::ContactParameters;
using vibro_impact::core::WearFeedback;

namespace
{
constexpr double unworn = -1.0e-7;
constexpr double stiffness = 24309.426302924;

class WearFeedbackTest : public testing::Test
{
protected:
  WearFeedbackTest() : feedback_({1000, 1.0e-8})
  {
  }

  /// The clearance asked for; NaN: nothing was. The simulation takes it at once.
  double wear(std::int64_t time, double depth)
  {
    const auto contact = feedback_.ask(time, depth);
    if (!contact)
    {
      return std::numeric_limits<double>::quiet_NaN();
    }
    EXPECT_EQ(contact->stiffness, stiffness);
    feedback_.hold(*contact, false);
    return contact->clearance;
  }

  WearFeedback feedback_;
};

TEST_F(WearFeedbackTest, asksForNothingBeforeItKnowsTheContact)
{
  EXPECT_FALSE(feedback_.ask(0, 1.0e-9));
}

TEST_F(WearFeedbackTest, theClearanceIsThatOfTheUnwornContactAndTheDepth)
{
  feedback_.hold({stiffness, unworn}, true);
  EXPECT_FALSE(feedback_.ask(0, 0.0)) << "nothing is worn";
  double depth = 0.0;
  for (int i = 0; i < 10000; ++i)
  {
    depth += 1.234567e-13;
    // To the bit: no rounding adds up.
    ASSERT_EQ(wear(1000 * i, depth), unworn + depth);
    ASSERT_EQ(feedback_.handedOver(), depth);
  }
  EXPECT_EQ(feedback_.asked(), 10000u);
  EXPECT_EQ(feedback_.taken(), 10000u);
  EXPECT_EQ(feedback_.unworn(), unworn);
}

TEST_F(WearFeedbackTest, keepsTheIntervalAndTheGreatestStep)
{
  feedback_.hold({stiffness, unworn}, true);
  EXPECT_EQ(wear(5000, 2.5e-8), unworn + 1.0e-8);
  EXPECT_FALSE(feedback_.ask(5999, 2.5e-8));
  EXPECT_EQ(wear(6000, 2.5e-8), unworn + 2.0e-8);
  EXPECT_EQ(wear(7000, 2.5e-8), unworn + 2.5e-8);
  EXPECT_FALSE(feedback_.ask(8000, 2.5e-8)) << "all has been handed over";
  // A stream that begins anew has a time of its own.
  EXPECT_EQ(wear(100, 2.6e-8), unworn + 2.6e-8);
}

TEST_F(WearFeedbackTest, waitsUntilTheContactIsHeld)
{
  feedback_.hold({stiffness, unworn}, true);
  const auto first = feedback_.ask(0, 1.0e-9);
  ASSERT_TRUE(first);
  EXPECT_FALSE(feedback_.ask(1000000, 5.0e-9));
  EXPECT_EQ(feedback_.handedOver(), 0.0);
  feedback_.hold(*first, false);
  EXPECT_EQ(feedback_.handedOver(), 1.0e-9);
  EXPECT_EQ(wear(2000000, 5.0e-9), unworn + 5.0e-9);
}

TEST_F(WearFeedbackTest, asksAgainForWhatWasRefused)
{
  feedback_.hold({stiffness, unworn}, true);
  ASSERT_TRUE(feedback_.ask(0, 1.0e-9));
  feedback_.refuse();
  EXPECT_EQ(feedback_.refused(), 1u);
  EXPECT_EQ(feedback_.handedOver(), 0.0);
  EXPECT_FALSE(feedback_.ask(999, 1.0e-9));
  EXPECT_EQ(wear(1000, 2.0e-9), unworn + 2.0e-9);
}

TEST_F(WearFeedbackTest, anAnswerThatWasLostDoesNotCountTwice)
{
  feedback_.hold({stiffness, unworn}, true);
  const auto contact = feedback_.ask(0, 1.0e-9);
  feedback_.refuse();  // the connection broke after the simulation had taken it
  feedback_.hold(*contact, false);
  EXPECT_EQ(feedback_.handedOver(), 1.0e-9);
  EXPECT_FALSE(feedback_.ask(1000, 1.0e-9));
}

TEST_F(WearFeedbackTest, somebodyElsesContactIsKept)
{
  feedback_.hold({stiffness, unworn}, true);
  EXPECT_EQ(wear(0, 1.0e-9), unworn + 1.0e-9);
  feedback_.hold({2.0 * stiffness, 3.0e-7}, false);
  EXPECT_FALSE(feedback_.ask(1000, 1.0e-9)) << "what was worn before is in it";
  const auto contact = feedback_.ask(2000, 3.0e-9);
  ASSERT_TRUE(contact);
  EXPECT_EQ(contact->stiffness, 2.0 * stiffness);
  EXPECT_DOUBLE_EQ(contact->clearance, 3.0e-7 + 2.0e-9);
}

TEST_F(WearFeedbackTest, aSimulationThatBeginsAnewIsGivenAllOfIt)
{
  feedback_.hold({stiffness, unworn}, true);
  EXPECT_EQ(wear(0, 5.0e-9), unworn + 5.0e-9);
  feedback_.hold({stiffness, unworn}, true);
  EXPECT_EQ(feedback_.handedOver(), 0.0);
  EXPECT_EQ(wear(1000, 6.0e-9), unworn + 6.0e-9);
}

}  // namespace
