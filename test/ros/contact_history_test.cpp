#include "vibro_impact/ros/contact_history.h"

#include <cstdint>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/error.h"

namespace vibro_impact::graph
{
namespace
{
core::SystemParameters parametersWith(double clearance)
{
  core::SystemParameters parameters;
  parameters.beam1 = core::BeamParameters{1.66e9, 954.0, 0.0529, core::Rectangle{0.00127, 0.0127}, 0.02645};
  parameters.beam2 = core::RigidSurface{};
  parameters.contact = {2.0e4, clearance};
  parameters.damping = {0.01, 0.05};
  return parameters;
}

ModelInfo info(double clearance, std::uint64_t seq, std::uint64_t number)
{
  ModelInfo message;
  message.configuration = config::toYaml(parametersWith(clearance));
  message.seq = seq;
  message.number = number;
  return message;
}

class History : public testing::Test
{
protected:
  void expectError(const ModelInfo& message, const std::string& reason)
  {
    try
    {
      history_.add(message);
      ADD_FAILURE() << "no error";
    }
    catch (const config::Error& error)
    {
      EXPECT_THAT(error.what(), testing::HasSubstr(reason));
    }
  }

  ContactHistory history_{"/model_info"};
};

TEST_F(History, holdsEveryChange)
{
  history_.add(info(0.0, 0, 0));
  history_.add(info(1.0e-6, 100, 1));
  history_.add(info(1.0e-6, 100, 1));  // latched, and recorded twice
  history_.add(info(2.0e-6, 300, 2));
  ASSERT_EQ(history_.contacts().size(), 3u);
  EXPECT_EQ(history_.at(0).contact.clearance, 0.0);
  EXPECT_EQ(history_.at(99).contact.clearance, 0.0);
  EXPECT_EQ(history_.at(100).contact.clearance, 1.0e-6);
  EXPECT_EQ(history_.at(299).seq, 100u);
  EXPECT_EQ(history_.at(1u << 30).contact.clearance, 2.0e-6);
  EXPECT_EQ(history_.parameters().contact.clearance, 0.0);
  EXPECT_TRUE(history_.losses(0).empty());
}

TEST_F(History, aChangeBeforeTheFirstSampleTakesThePlaceOfTheFirstContact)
{
  history_.add(info(0.0, 0, 0));
  history_.add(info(1.0e-6, 0, 1));
  ASSERT_EQ(history_.contacts().size(), 1u);
  EXPECT_EQ(history_.at(0).contact.clearance, 1.0e-6);
}

TEST_F(History, aRecordingMayBeginAfterAChange)
{
  history_.add(info(1.0e-6, 5000, 3));
  history_.add(info(2.0e-6, 9000, 4));
  EXPECT_TRUE(history_.losses(6000).empty());
  ASSERT_EQ(history_.losses(4000).size(), 1u);
  EXPECT_EQ(history_.losses(4000)[0].first, 4000u);
  EXPECT_EQ(history_.losses(4000)[0].last, 5000u);
}

TEST_F(History, knowsWhatIsMissing)
{
  history_.add(info(0.0, 0, 0));
  history_.add(info(1.0e-6, 100, 1));
  history_.add(info(4.0e-6, 800, 4));
  ASSERT_EQ(history_.losses(0).size(), 1u);
  EXPECT_EQ(history_.losses(0)[0].first, 100u);
  EXPECT_EQ(history_.losses(0)[0].last, 800u);
  EXPECT_EQ(history_.losses(0)[0].reason,
            "topic /model_info: number 2 to 3 (2 changes of the contact before seq 800) is missing");
}

TEST_F(History, refusesAnotherModel)
{
  history_.add(info(0.0, 0, 0));
  ModelInfo other = info(1.0e-6, 100, 1);
  core::SystemParameters parameters = parametersWith(1.0e-6);
  parameters.damping.free = 0.02;
  other.configuration = config::toYaml(parameters);
  expectError(other, "topic /model_info: the configuration changes within the recording, and not by a change of the");
  expectError(info(1.0e-6, 0, 0), "the configuration changes within the recording");
  other.configuration = "beam1: 3";
  expectError(other, "beam1");
}

TEST_F(History, needsAMessage)
{
  EXPECT_THROW(history_.parameters(), config::Error);
}

}  // namespace
}  // namespace vibro_impact::graph
