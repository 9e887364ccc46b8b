// A live run at real time: nothing is lost between shaker, simulator and bag, the impulses are the integral of the
// force, and what the bag holds is computed again from its excitation bit for bit, however that is cut into blocks.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <stdlib.h>

#include "vibro_impact/core/switched_model.h"
#include "vibro_impact/ros/conversions.h"
#include "vibro_impact/ros/stream_simulation.h"

namespace vibro_impact::graph
{
namespace
{
struct Recording
{
  std::vector<Samples> excitation, gap, force;
  std::vector<Impact> impacts;
  std::shared_ptr<const core::SwitchedModel> model;
};

template <typename Message>
void append(const rosbag::MessageInstance& instance, std::vector<Samples>& blocks)
{
  if (const auto message = instance.instantiate<Message>())
  {
    Samples samples;
    fromMessage(*message, samples);
    blocks.push_back(samples);
  }
}

Recording read(const std::string& path)
{
  Recording recording;
  rosbag::Bag bag(path);
  for (const rosbag::MessageInstance& instance : rosbag::View(bag))
  {
    append<BaseExcitation>(instance, recording.excitation);
    append<Gap>(instance, recording.gap);
    append<ContactForce>(instance, recording.force);
    if (const auto impact = instance.instantiate<Impact>())
    {
      recording.impacts.push_back(*impact);
    }
    if (const auto info = instance.instantiate<ModelInfo>())
    {
      recording.model = std::make_shared<const core::SwitchedModel>(fromMessage(*info));
    }
  }
  return recording;
}

void expectUnbroken(const std::vector<Samples>& blocks, const std::string& topic)
{
  std::uint64_t expected = 0;
  for (const Samples& block : blocks)
  {
    ASSERT_EQ(block.seq, expected) << topic;
    expected += block.values.size();
  }
}

void expectSameImpact(const Impact& found, const Impact& recorded)
{
  EXPECT_EQ(found.header.stamp, recorded.header.stamp);
  EXPECT_EQ(found.number, recorded.number);
  EXPECT_EQ(found.seq, recorded.seq);
  EXPECT_EQ(found.offset, recorded.offset);
  EXPECT_EQ(found.duration, recorded.duration);
  EXPECT_EQ(found.impulse, recorded.impulse);
  EXPECT_EQ(found.peak_force, recorded.peak_force);
  EXPECT_EQ(found.peak_time, recorded.peak_time);
  EXPECT_EQ(found.approach_speed, recorded.approach_speed);
  EXPECT_EQ(found.separation_speed, recorded.separation_speed);
  EXPECT_EQ(found.energy_lost, recorded.energy_lost);
}

/// One run for all tests. It is made in SetUp() of the first: a failure before that would only skip the tests.
class LiveRun : public testing::Test
{
protected:
  void SetUp() override
  {
    if (recording_.excitation.empty())
    {
      std::string launch_file;
      std::string signal;
      ASSERT_TRUE(ros::param::get("~launch_file", launch_file));
      ASSERT_TRUE(ros::param::get("~signal", signal));
      char pattern[] = "/tmp/vibro_impact_live_XXXXXX";
      ASSERT_NE(mkdtemp(pattern), nullptr);
      const std::string directory = pattern;
      const std::string bag = directory + "/live.bag";
      const std::string command =
          "roslaunch '" + launch_file + "' speed:=1.0 block_rate:=200.0 signal:='" + signal + "' bag:='" + bag + "'";
      const int status = std::system(command.c_str());
      if (status == 0)
      {
        recording_ = read(bag);
      }
      EXPECT_EQ(std::system(("rm -r " + directory).c_str()), 0);
      ASSERT_EQ(status, 0) << command;
    }
    ASSERT_TRUE(recording_.model) << "no model_info";
  }

  static Recording recording_;
};

Recording LiveRun::recording_;
}  // namespace

TEST_F(LiveRun, losesNoBlock)
{
  ASSERT_GT(recording_.excitation.size(), 1000u);
  EXPECT_EQ(recording_.gap.size(), recording_.excitation.size());
  EXPECT_EQ(recording_.force.size(), recording_.excitation.size());
  expectUnbroken(recording_.excitation, "base_excitation");
  expectUnbroken(recording_.gap, "gap");
  expectUnbroken(recording_.force, "contact_force");
  for (std::size_t i = 0; i < recording_.impacts.size(); ++i)
  {
    ASSERT_EQ(recording_.impacts[i].number, i);
  }
}

TEST_F(LiveRun, impulsesSumToTheIntegralOfTheForce)
{
  double integral = 0.0;
  for (const Samples& block : recording_.force)
  {
    for (const double force : block.values)
    {
      integral += force * block.sample_period;
    }
  }
  double sum = 0.0;
  for (const Impact& impact : recording_.impacts)
  {
    sum += impact.impulse;
  }
  ASSERT_GT(recording_.impacts.size(), 1000u);
  EXPECT_NEAR(integral / sum, 1.0, 1e-3);
  std::printf(
      "%zu blocks, %zu impacts, sum of impulses %.9g N s, integral of the force %.9g N s, relative difference %.2g\n",
      recording_.excitation.size(), recording_.impacts.size(), sum, integral, integral / sum - 1.0);
}

TEST_F(LiveRun, isComputedAgainBitForBitHoweverItIsCut)
{
  Samples whole = recording_.excitation.front();
  std::vector<double> gap;
  std::vector<double> force;
  for (std::size_t i = 0; i < recording_.excitation.size(); ++i)
  {
    const auto append_values = [](std::vector<double>& to, const std::vector<double>& from)
    { to.insert(to.end(), from.begin(), from.end()); };
    if (i > 0)
    {
      append_values(whole.values, recording_.excitation[i].values);
    }
    append_values(gap, recording_.gap[i].values);
    append_values(force, recording_.force[i].values);
  }
  for (const std::size_t cut : {std::size_t{1}, std::size_t{7}, std::size_t{250}, std::size_t{9973}})
  {
    SCOPED_TRACE(cut);
    StreamSimulation simulation(recording_.model, StreamLimits{});
    std::vector<Impact> impacts;
    for (std::size_t i = 0; i < whole.values.size(); i += cut)
    {
      const std::size_t end = std::min(i + cut, whole.values.size());
      Samples block;
      block.sample_period = whole.sample_period;
      block.values.assign(whole.values.begin() + static_cast<std::ptrdiff_t>(i),
                          whole.values.begin() + static_cast<std::ptrdiff_t>(end));
      block.seq = whole.seq + i;
      block.stamp = whole.stamp + std::llround(static_cast<double>(i) * whole.sample_period * 1e9);
      const StreamSimulation::Answer& answer = simulation.advance(block);
      ASSERT_EQ(answer.gap.values.size(), end - i);
      for (std::size_t j = i; j < end; ++j)
      {
        ASSERT_EQ(answer.gap.values[j - i], gap[j]) << "sample " << j;
        ASSERT_EQ(answer.force.values[j - i], force[j]) << "sample " << j;
      }
      for (const StampedImpact& impact : answer.impacts)
      {
        impacts.emplace_back();
        toMessage(impact, impacts.back());
      }
    }
    // the recording may end with the episode that the end of the run cut short
    ASSERT_GE(recording_.impacts.size(), impacts.size());
    ASSERT_LE(recording_.impacts.size(), impacts.size() + 1);
    for (std::size_t i = 0; i < impacts.size(); ++i)
    {
      expectSameImpact(impacts[i], recording_.impacts[i]);
    }
  }
}

}  // namespace vibro_impact::graph

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "live_run_test");
  return RUN_ALL_TESTS();
}
