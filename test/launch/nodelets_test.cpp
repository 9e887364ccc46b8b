// Shaker, simulator and monitor in one nodelet manager: this process. What is published is what arrives.

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <vibro_impact/BaseExcitation.h>
#include <vibro_impact/Gap.h>
#include <vibro_impact/Impact.h>

#include "spin_until.h"

using vibro_impact::spinUntil;
#include <boost/make_shared.hpp>

namespace
{
constexpr double period = 2.0e-5;
constexpr std::size_t block_size = 250;

/// Near the resonance: an impact in every cycle of 115 samples.
vibro_impact::BaseExcitationPtr block(std::uint64_t seq)
{
  auto message = boost::make_shared<vibro_impact::BaseExcitation>();
  message->header.stamp.fromNSec(1800000000000000000ull + seq * 20000);
  message->seq = seq;
  message->sample_period = period;
  for (std::size_t i = 0; i < block_size; ++i)
  {
    message->acceleration.push_back(50.0 * std::sin(1.6 * 1705.6 * static_cast<double>(seq + i) * period));
  }
  return message;
}

class NodeletsTest : public testing::Test
{
protected:
  NodeletsTest() : loader_(false)
  {
    diagnostics_ = node_.subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 0,
        [this](const diagnostic_msgs::DiagnosticArrayConstPtr& message)
        {
          for (const auto& status : message->status)
          {
            for (const auto& entry : status.values)
            {
              values_[status.name + ": " + entry.key] = entry.value;
            }
          }
        });
  }

  bool load(const std::string& name, const std::string& type)
  {
    return loader_.load("/rig/" + name, "vibro_impact/" + type, {}, {});
  }

  ros::NodeHandle node_;
  ros::Subscriber diagnostics_;
  std::map<std::string, std::string> values_;  ///< latest of each status and key
  nodelet::Loader loader_;
};

TEST_F(NodeletsTest, messagesAreNotCopied)
{
  ASSERT_TRUE(load("simulator", "Simulator"));
  std::vector<vibro_impact::BaseExcitationConstPtr> heard;
  std::vector<vibro_impact::GapConstPtr> gaps;
  const ros::Subscriber excitation_listener = node_.subscribe<vibro_impact::BaseExcitation>(
      "/rig/base_excitation", 0,
      [&](const vibro_impact::BaseExcitationConstPtr& message) { heard.push_back(message); });
  const ros::Subscriber gap_listener = node_.subscribe<vibro_impact::Gap>(
      "/rig/gap", 0, [&](const vibro_impact::GapConstPtr& message) { gaps.push_back(message); });
  ros::Publisher publisher = node_.advertise<vibro_impact::BaseExcitation>("/rig/base_excitation", 0);
  ASSERT_TRUE(spinUntil([&] { return publisher.getNumSubscribers() >= 1 && gap_listener.getNumPublishers() == 1; }));
  const vibro_impact::BaseExcitationPtr sent = block(0);
  publisher.publish(sent);
  ASSERT_TRUE(spinUntil([&] { return !gaps.empty() && !heard.empty(); }));
  EXPECT_EQ(heard.front().get(), sent.get());
  EXPECT_EQ(gaps.front()->gap.size(), block_size);
  // roscpp has made bytes of nothing that the simulator published.
  ASSERT_TRUE(spinUntil([this] { return values_["rig/simulator: Input: Blocks accepted"] == "1"; }));
  EXPECT_EQ(values_["rig/simulator: Output queues: /rig/gap: messages to other processes"], "0");
  EXPECT_TRUE(loader_.unload("/rig/simulator"));
}

TEST_F(NodeletsTest, unloadingEndsTheStream)
{
  ASSERT_TRUE(load("simulator", "Simulator"));
  std::vector<vibro_impact::ImpactConstPtr> impacts;
  std::vector<vibro_impact::GapConstPtr> gaps;
  const ros::Subscriber impact_listener = node_.subscribe<vibro_impact::Impact>(
      "/rig/impact", 0, [&](const vibro_impact::ImpactConstPtr& message) { impacts.push_back(message); });
  const ros::Subscriber gap_listener = node_.subscribe<vibro_impact::Gap>(
      "/rig/gap", 0, [&](const vibro_impact::GapConstPtr& message) { gaps.push_back(message); });
  ros::Publisher publisher = node_.advertise<vibro_impact::BaseExcitation>("/rig/base_excitation", 0);
  ASSERT_TRUE(spinUntil([&] { return publisher.getNumSubscribers() == 1 && gap_listener.getNumPublishers() == 1; }));
  // Until a block at whose end the spring is compressed.
  std::uint64_t blocks = 0;
  for (bool open = false; !open && blocks < 200;)
  {
    publisher.publish(block(block_size * blocks));
    ++blocks;
    ASSERT_TRUE(spinUntil([&] { return gaps.size() == blocks; }));
    open = gaps.back()->gap.back() < 0.0;
  }
  ASSERT_LT(gaps.back()->gap.back(), 0.0);
  EXPECT_TRUE(loader_.unload("/rig/simulator"));
  ASSERT_TRUE(spinUntil([&] { return !impacts.empty() && impacts.back()->cut_short; }));
}

TEST_F(NodeletsTest, aFaultyOneIsRefusedAndDisturbsNobody)
{
  EXPECT_FALSE(load("faulty", "Simulator"));
  ASSERT_TRUE(load("simulator", "Simulator"));
  EXPECT_EQ(loader_.listLoadedNodelets(), std::vector<std::string>{"/rig/simulator"});
  EXPECT_TRUE(loader_.unload("/rig/simulator"));
}

TEST_F(NodeletsTest, shakerSimulatorAndMonitorRunTogether)
{
  ASSERT_TRUE(load("simulator", "Simulator"));
  ASSERT_TRUE(load("monitor", "Monitor"));
  std::uint64_t samples = 0;
  const ros::Subscriber listener = node_.subscribe<vibro_impact::BaseExcitation>(
      "/rig/base_excitation", 0,
      [&](const vibro_impact::BaseExcitationConstPtr& message) { samples += message->acceleration.size(); });
  ASSERT_TRUE(load("shaker", "Shaker"));
  const auto value = [this](const std::string& key) { return values_["rig/" + key]; };
  EXPECT_TRUE(spinUntil([&] { return value("monitor: Response: Samples of gap") == "50000"; }));
  EXPECT_TRUE(spinUntil([&] { return value("simulator: Input: Samples accepted") == "50000"; }));
  EXPECT_TRUE(spinUntil([&] { return value("simulator: Model: Impacts") == value("monitor: Response: Impacts"); }));
  EXPECT_GT(std::stoi(value("monitor: Response: Impacts")), 100);
  EXPECT_EQ(value("monitor: Response: Samples of gap missing"), "0");
  EXPECT_EQ(value("monitor: Response: Impacts missing"), "0");
  EXPECT_TRUE(loader_.clear());
}

}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "nodelets_test");
  const ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
