// The simulator as a node of its own on a real graph. What it must answer is what a StreamSimulation in this process
// does.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/WrenchStamped.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <rosbag/bag.h>
#include <std_msgs/Float64.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <unistd.h>
#include <vibro_impact/SetContact.h>
#include <vibro_impact/StreamStart.h>
#include <vibro_impact/StructureMotion.h>

#include "spin_until.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/core/switched_model.h"
#include "vibro_impact/ros/contact_history.h"
#include "vibro_impact/ros/conversions.h"
#include "vibro_impact/ros/node_query.h"
#include "vibro_impact/ros/recorded_run.h"

namespace core = vibro_impact::core;
namespace graph = vibro_impact::graph;
using graph::Samples;
using graph::Stamp;
using vibro_impact::patience;
using vibro_impact::spinUntil;
using Action = graph::Verdict::Action;

namespace
{
constexpr double period = 2.0e-5;
constexpr Stamp nanoseconds = 20000;  // of a period
constexpr std::size_t block_size = 250;

core::SystemParameters configuration()
{
  return vibro_impact::config::loadFile(ros::param::param<std::string>("~config", ""));
}

/// The node's client: publishes excitation and keeps all that comes back.
class Client
{
public:
  Client()
  {
    excitation_ = node_.advertise<vibro_impact::BaseExcitation>("base_excitation", 0);
    subscribe<vibro_impact::Gap>("gap", gaps);
    subscribe<vibro_impact::ContactForce>("contact_force", forces);
    subscribe<vibro_impact::Impact>("impact", impacts);
    subscribe<geometry_msgs::WrenchStamped>("contact_wrench", wrenches);
    subscribe<std_msgs::Float64>("gap_now", gaps_now);
    subscribers_.push_back(node_.subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 0, [this](const diagnostic_msgs::DiagnosticArrayConstPtr& message) { take(*message); }));
    subscribe<vibro_impact::ModelInfo>("model_info", infos);
    reset_ = node_.serviceClient<std_srvs::Trigger>("simulator/reset");
    subscribe<vibro_impact::StreamStart>("stream_start", starts);
    pause_ = node_.serviceClient<std_srvs::SetBool>("simulator/pause");
    set_contact_ = node_.serviceClient<vibro_impact::SetContact>("simulator/set_contact");
  }

  bool connect()
  {
    return reset_.waitForExistence(ros::Duration(patience)) &&
           spinUntil(
               [this]
               {
                 return excitation_.getNumSubscribers() == 1 &&
                        std::all_of(
                            subscribers_.begin(), subscribers_.end(),
                            [this](const ros::Subscriber& subscriber)
                            { return graph::isConnected(query_, subscriber.getTopic(), ros::this_node::getName()); });
               });
  }

  void send(const Samples& samples)
  {
    vibro_impact::BaseExcitation message;
    graph::toMessage(samples, message);
    excitation_.publish(message);
  }

  std_srvs::Trigger::Response reset()
  {
    std_srvs::Trigger trigger;
    EXPECT_TRUE(reset_.call(trigger));
    ++resets_;
    return trigger.response;
  }

  std_srvs::SetBool::Response pause(bool paused)
  {
    std_srvs::SetBool call;
    call.request.data = paused;
    EXPECT_TRUE(pause_.call(call));
    EXPECT_TRUE(call.response.success);
    return call.response;
  }

  void setContact(const core::ContactParameters& contact, std::uint64_t seq)
  {
    vibro_impact::SetContact call;
    call.request.stiffness = contact.stiffness;
    call.request.clearance = contact.clearance;
    call.request.seq = seq;
    ASSERT_TRUE(set_contact_.call(call));
    EXPECT_TRUE(call.response.success) << call.response.message;
  }

  /// Waits for diagnostics that know of the latest reset.
  bool upToDate()
  {
    return spinUntil([this] { return count("Resets") == resets_; });
  }

  void clear()
  {
    gaps.clear();
    forces.clear();
    impacts.clear();
    wrenches.clear();
    gaps_now.clear();
    starts.clear();
  }

  /// A value of the latest diagnostics.
  std::int64_t count(const std::string& key) const
  {
    const auto found = values.find(key);
    return found == values.end() ? -1 : std::stoll(found->second);
  }

  std::vector<vibro_impact::Gap> gaps;
  std::vector<vibro_impact::ContactForce> forces;
  std::vector<vibro_impact::Impact> impacts;
  std::vector<geometry_msgs::WrenchStamped> wrenches;
  std::vector<std_msgs::Float64> gaps_now;
  std::vector<vibro_impact::ModelInfo> infos;
  std::vector<vibro_impact::StreamStart> starts;
  int level = -1;  ///< of the status of the input
  std::string summary;
  std::map<std::string, std::string> values;
  /// Summaries of all diagnostics that were not OK.
  std::vector<std::string> complaints;

private:
  template <typename Message>
  void subscribe(const std::string& topic, std::vector<Message>& messages)
  {
    subscribers_.push_back(node_.subscribe<Message>(
        topic, 0, [&messages](const typename Message::ConstPtr& message) { messages.push_back(*message); }));
  }

  void take(const diagnostic_msgs::DiagnosticArray& message)
  {
    for (const auto& status : message.status)
    {
      if (status.name.rfind("simulator: ", 0) != 0 || status.values.empty())
      {
        continue;
      }
      for (const auto& entry : status.values)
      {
        values[entry.key] = entry.value;
      }
      if (status.name == "simulator: Input")
      {
        level = status.level;
        summary = status.message;
      }
      if (status.level != diagnostic_msgs::DiagnosticStatus::OK)
      {
        complaints.push_back(status.message);
      }
    }
  }

  ros::NodeHandle node_;
  ros::Publisher excitation_;
  std::vector<ros::Subscriber> subscribers_;
  ros::ServiceClient reset_;
  graph::NodeQuery query_;
  ros::ServiceClient pause_;
  ros::ServiceClient set_contact_;
  std::int64_t resets_ = 0;
};

class SimulatorTest : public testing::Test
{
protected:
  static void TearDownTestSuite()
  {
    client_.reset();
    model_.reset();
  }

  /// One client and one model for all tests, made for the first: a failure in SetUpTestSuite() would only skip them.
  void SetUp() override
  {
    if (!client_)
    {
      model_ = std::make_shared<core::SwitchedModel>(configuration());
      client_ = std::make_unique<Client>();
    }
    ASSERT_TRUE(client_->connect());
    anew();
  }

  /// From rest, in this process and in the node.
  void anew()
  {
    const std::size_t impacts = client_->impacts.size();
    if (client_->reset().message.find("cut short") != std::string::npos)
    {
      ASSERT_TRUE(spinUntil([impacts] { return client_->impacts.size() > impacts; }));
    }
    reference_ = std::make_unique<graph::StreamSimulation>(model_, graph::StreamLimits{});
    expected_gaps_.clear();
    expected_forces_.clear();
    expected_impacts_.clear();
    client_->clear();
  }

  /// Near the resonance: an impact in every cycle of 115 samples.
  Samples block(std::uint64_t seq, std::size_t count = block_size) const
  {
    Samples samples{begin_ + static_cast<Stamp>(seq) * nanoseconds, seq, period, std::vector<double>(count)};
    for (std::size_t i = 0; i < count; ++i)
    {
      samples.values[i] = 50.0 * std::sin(1.6 * 1705.6 * static_cast<double>(seq + i) * period);
    }
    return samples;
  }

  Action send(const Samples& samples)
  {
    client_->send(samples);
    const auto& answer = reference_->advance(samples);
    expect(answer);
    return answer.verdict.action;
  }

  void sendStream(std::uint64_t first, std::uint64_t end, std::size_t cut = block_size)
  {
    for (std::uint64_t seq = first; seq < end; seq += cut)
    {
      send(block(seq, std::min<std::size_t>(cut, end - seq)));
    }
  }

  void expect(const graph::StreamSimulation::Answer& answer)
  {
    if (!answer.gap.values.empty())
    {
      expected_gaps_.push_back(answer.gap);
      expected_forces_.push_back(answer.force);
    }
    expected_impacts_.insert(expected_impacts_.end(), answer.impacts.begin(), answer.impacts.end());
  }

  /// All that was to come has come, and nothing but that.
  void expectAnswers()
  {
    ASSERT_TRUE(spinUntil(
        [this]
        {
          return client_->gaps.size() >= expected_gaps_.size() && client_->forces.size() >= expected_forces_.size() &&
                 client_->impacts.size() >= expected_impacts_.size();
        }))
        << client_->gaps.size() << " of " << expected_gaps_.size() << " gaps, " << client_->forces.size() << " forces, "
        << client_->impacts.size() << " of " << expected_impacts_.size() << " impacts";
    expectBlocks(client_->gaps, expected_gaps_);
    expectBlocks(client_->forces, expected_forces_);
    ASSERT_EQ(client_->impacts.size(), expected_impacts_.size());
    for (std::size_t i = 0; i < expected_impacts_.size(); ++i)
    {
      vibro_impact::Impact expected;
      graph::toMessage(expected_impacts_[i], expected);
      expectSame(client_->impacts[i], expected);
    }
  }

  static void expectSame(const vibro_impact::Impact& a, const vibro_impact::Impact& b)
  {
    EXPECT_EQ(a.header.stamp, b.header.stamp);
    EXPECT_EQ(a.header.frame_id, "base_frame");
    EXPECT_EQ(a.number, b.number);
    EXPECT_EQ(a.seq, b.seq);
    EXPECT_EQ(a.offset, b.offset);
    EXPECT_EQ(a.duration, b.duration);
    EXPECT_EQ(a.impulse, b.impulse);
    EXPECT_EQ(a.peak_force, b.peak_force);
    EXPECT_EQ(a.peak_time, b.peak_time);
    EXPECT_EQ(a.approach_speed, b.approach_speed);
    EXPECT_EQ(a.separation_speed, b.separation_speed);
    EXPECT_EQ(a.energy_lost, b.energy_lost);
    EXPECT_EQ(a.cut_short, b.cut_short);
  }

  template <typename Message>
  static void expectBlocks(const std::vector<Message>& messages, const std::vector<Samples>& expected)
  {
    ASSERT_EQ(messages.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
    {
      Samples samples;
      graph::fromMessage(messages[i], samples);
      EXPECT_EQ(messages[i].header.frame_id, "base_frame");
      EXPECT_EQ(samples.stamp, expected[i].stamp);
      EXPECT_EQ(samples.seq, expected[i].seq);
      EXPECT_EQ(samples.sample_period, expected[i].sample_period);
      EXPECT_EQ(samples.values, expected[i].values);
    }
  }

  /// The number of samples after which an episode is open.
  std::uint64_t openAfter(std::uint64_t at_least) const
  {
    graph::StreamSimulation simulation(model_, graph::StreamLimits{});
    for (std::uint64_t seq = 0;; ++seq)
    {
      if (simulation.advance(block(seq, 1)).force.values[0] > 0.0 && seq + 1 >= at_least)
      {
        return seq + 1;
      }
    }
  }

  static std::unique_ptr<Client> client_;
  static std::shared_ptr<const core::SwitchedModel> model_;
  std::unique_ptr<graph::StreamSimulation> reference_;
  std::vector<Samples> expected_gaps_;
  std::vector<Samples> expected_forces_;
  std::vector<graph::StampedImpact> expected_impacts_;
  Stamp begin_ = 1700000000000000000;
};

std::unique_ptr<Client> SimulatorTest::client_;
std::shared_ptr<const core::SwitchedModel> SimulatorTest::model_;

TEST_F(SimulatorTest, answersEveryBlockAndPublishesEveryImpact)
{
  sendStream(0, 50000);
  ASSERT_GT(expected_impacts_.size(), 300u);
  expectAnswers();
}

TEST_F(SimulatorTest, replaysBitForBitHoweverTheSamplesAreCut)
{
  constexpr std::uint64_t samples = 20000;
  sendStream(0, samples);
  expectAnswers();
  const std::vector<vibro_impact::Impact> first = client_->impacts;
  ASSERT_GT(first.size(), 100u);
  for (const std::size_t cut : {7u, 64u, 999u, 20000u})
  {
    anew();
    sendStream(0, samples, cut);
    expectAnswers();
    ASSERT_EQ(client_->impacts.size(), first.size());
    for (std::size_t i = 0; i < first.size(); ++i)
    {
      expectSame(client_->impacts[i], first[i]);
    }
  }
}

TEST_F(SimulatorTest, modelInfoIsLatchedAndLoadsBack)
{
  ros::NodeHandle node;
  vibro_impact::ModelInfoConstPtr info;
  const ros::Subscriber late = node.subscribe<vibro_impact::ModelInfo>(
      "model_info", 1, [&info](const vibro_impact::ModelInfoConstPtr& message) { info = message; });
  ASSERT_TRUE(spinUntil([&info] { return info != nullptr; }));
  EXPECT_TRUE(info->header.stamp.isZero());
  EXPECT_FALSE(info->version.empty());
  EXPECT_EQ(vibro_impact::config::toYaml(graph::fromMessage(*info)), vibro_impact::config::toYaml(configuration()));
  EXPECT_EQ(info->free_frequencies.size(), static_cast<std::size_t>(model_->free().size()));
  EXPECT_EQ(info->contact_frequencies.size(), static_cast<std::size_t>(model_->contact().size()));
}

TEST_F(SimulatorTest, resetCutsAnOpenImpactShortAndStartsFromRest)
{
  const std::uint64_t open = openAfter(1000);
  sendStream(0, open);
  expectAnswers();
  const std_srvs::Trigger::Response response = client_->reset();
  EXPECT_TRUE(response.success);
  EXPECT_EQ(response.message, "at rest; an open impact was cut short");
  expect(reference_->reset());
  ASSERT_TRUE(expected_impacts_.back().impact.cut_short);
  sendStream(open, open + 5000);
  expectAnswers();
  EXPECT_EQ(client_->reset().success, true);
}

TEST_F(SimulatorTest, refusesBadBlocksWholeAndCountsThem)
{
  ASSERT_TRUE(client_->upToDate());
  const std::int64_t before = client_->count("Blocks refused");
  client_->complaints.clear();
  sendStream(0, 5000);

  std::vector<Samples> bad(9, block(5000));
  bad[0].values[17] = std::numeric_limits<double>::quiet_NaN();
  bad[1].values[17] = std::numeric_limits<double>::infinity();
  bad[2].values[17] = -1.1e5;
  bad[3].values.clear();
  bad[4].sample_period = 0.0;
  bad[5].sample_period = std::numeric_limits<double>::quiet_NaN();
  bad[6] = block(4750);
  bad[7].stamp = 0;
  bad[8].seq = std::numeric_limits<std::uint64_t>::max();
  for (const Samples& samples : bad)
  {
    EXPECT_EQ(send(samples), Action::Refuse);
  }
  sendStream(5000, 10000);
  expectAnswers();
  EXPECT_TRUE(spinUntil([&] { return client_->count("Blocks refused") == before + 9; }));
  EXPECT_TRUE(std::any_of(client_->complaints.begin(), client_->complaints.end(),
                          [](const std::string& complaint)
                          { return complaint.find("block refused: ") != std::string::npos; }));
}

TEST_F(SimulatorTest, bridgesMissingSamplesAndCountsThem)
{
  ASSERT_TRUE(client_->upToDate());
  const std::int64_t samples = client_->count("Samples bridged");
  const std::int64_t blocks = client_->count("Blocks lost");
  client_->complaints.clear();
  sendStream(0, 5000);
  EXPECT_EQ(send(block(5600)), Action::Bridge);
  sendStream(5850, 10000);
  expectAnswers();
  EXPECT_TRUE(spinUntil([&] { return client_->count("Samples bridged") == samples + 600; }));
  EXPECT_EQ(client_->count("Blocks lost"), blocks + 3);
  EXPECT_TRUE(std::any_of(client_->complaints.begin(), client_->complaints.end(),
                          [](const std::string& complaint)
                          { return complaint.find("missing samples bridged") != std::string::npos; }));
}

TEST_F(SimulatorTest, restartsFromRestWhereTheStreamBreaks)
{
  ASSERT_TRUE(client_->upToDate());
  const std::int64_t before = client_->count("Restarts");
  const std::uint64_t open = openAfter(1000);

  sendStream(0, open);
  EXPECT_EQ(send(block(open + 1001)), Action::Restart) << "more is missing than may be bridged";
  ASSERT_TRUE(expected_impacts_.back().impact.cut_short || expected_impacts_.size() > 1);

  EXPECT_EQ(send(block(0)), Action::Refuse) << "goes back by less than max_step_back";
  sendStream(open + 1251, 20000);
  EXPECT_EQ(send(block(0)), Action::Restart) << "a looped bag";

  begin_ += 60000000000;
  EXPECT_EQ(send(block(0)), Action::Restart) << "a restarted publisher";
  sendStream(250, open);

  Samples slower = block(open);
  slower.sample_period = 2.0 * period;
  EXPECT_EQ(send(slower), Action::Restart) << "a new period";
  expectAnswers();
  EXPECT_TRUE(spinUntil([&] { return client_->count("Restarts") == before + 4; }));
}

TEST_F(SimulatorTest, mirrorsHoldTheExtremes)
{
  sendStream(0, 50000);  // 1 s, so that each mirror sends 50
  expectAnswers();
  ASSERT_TRUE(spinUntil([] { return client_->wrenches.size() >= 50 && client_->gaps_now.size() >= 50; }));
  EXPECT_EQ(client_->wrenches.size(), 50u);
  double greatest = 0.0;
  for (const Samples& block : expected_forces_)
  {
    greatest = std::max(greatest, *std::max_element(block.values.begin(), block.values.end()));
  }
  double mirrored = 0.0;
  for (const geometry_msgs::WrenchStamped& wrench : client_->wrenches)
  {
    EXPECT_EQ(wrench.header.frame_id, "base_frame");
    EXPECT_GE(wrench.wrench.force.z, 0.0);
    mirrored = std::max(mirrored, wrench.wrench.force.z);
  }
  EXPECT_GT(greatest, 0.0);
  EXPECT_EQ(mirrored, greatest);

  double smallest = std::numeric_limits<double>::infinity();
  for (const Samples& block : expected_gaps_)
  {
    smallest = std::min(smallest, *std::min_element(block.values.begin(), block.values.end()));
  }
  const auto least = std::min_element(client_->gaps_now.begin(), client_->gaps_now.end(),
                                      [](const auto& a, const auto& b) { return a.data < b.data; });
  EXPECT_EQ(least->data, smallest);
}

TEST_F(SimulatorTest, tellsTheMotionToWhoAsksAndAnswersAsWithout)
{
  sendStream(0, 5000);
  expectAnswers();
  {
    std::vector<vibro_impact::StructureMotion> motions;
    ros::NodeHandle node;
    const ros::Subscriber subscriber = node.subscribe<vibro_impact::StructureMotion>(
        "motion", 0, [&motions](const vibro_impact::StructureMotion::ConstPtr& motion) { motions.push_back(*motion); });
    graph::NodeQuery query;
    ASSERT_TRUE(spinUntil([&] { return graph::isConnected(query, subscriber.getTopic(), ros::this_node::getName()); }));
    // 64 rows in a period of 271.5 Hz are one every 2.9 samples.
    constexpr std::uint64_t step = 3;
    graph::StreamSimulation recorded(*reference_);
    recorded.recordMotion(step);
    std::vector<vibro_impact::StructureMotion> expected;
    for (std::uint64_t seq = 5000; seq < 10000; seq += block_size)
    {
      expected.emplace_back();
      graph::toMessage(recorded.advance(block(seq)).motion, *model_, period, expected.back());
    }
    sendStream(5000, 10000);
    expectAnswers();  // those of a simulation that records nothing
    ASSERT_TRUE(spinUntil([&] { return motions.size() >= expected.size(); })) << motions.size();
    ASSERT_EQ(motions.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
    {
      EXPECT_EQ(motions[i].header.stamp, expected[i].header.stamp);
      EXPECT_EQ(motions[i].seq, expected[i].seq);
      EXPECT_EQ(motions[i].step, step);
      EXPECT_EQ(motions[i].structure, expected[i].structure);
      EXPECT_EQ(motions[i].mode, expected[i].mode);
      EXPECT_EQ(motions[i].contact_deflection, expected[i].contact_deflection);
      EXPECT_EQ(motions[i].coordinates, expected[i].coordinates);
      EXPECT_EQ(motions[i].gap, expected[i].gap);
      EXPECT_EQ(motions[i].force, expected[i].force);
      EXPECT_EQ(motions[i].acceleration, expected[i].acceleration);
    }
  }
  // Nobody listens any more.
  sendStream(10000, 12000);
  expectAnswers();
}

TEST_F(SimulatorTest, diagnosticsCountWhatIsDoneAndSilenceIsStale)
{
  ASSERT_TRUE(client_->upToDate());
  const std::int64_t impacts = client_->count("Impacts");
  const std::int64_t blocks = client_->count("Blocks accepted");
  sendStream(0, 50000);
  expectAnswers();
  EXPECT_TRUE(spinUntil([&] { return client_->count("Blocks accepted") == blocks + 200; }));
  EXPECT_EQ(client_->count("Impacts"), impacts + static_cast<std::int64_t>(expected_impacts_.size()));
  EXPECT_GT(std::stod(client_->values.at("Real-time factor")), 0.0);  // how great it is, is the machine's
  EXPECT_TRUE(spinUntil(
      []
      {
        return client_->level == diagnostic_msgs::DiagnosticStatus::STALE &&
               client_->summary.find("no data on topic /base_excitation") != std::string::npos;
      }))
      << client_->summary;
}

TEST_F(SimulatorTest, aPauseCutsTheOpenImpactShortAndDiscardsBlocks)
{
  ASSERT_TRUE(client_->upToDate());
  const std::int64_t discarded = std::max<std::int64_t>(client_->count("Samples discarded"), 0);
  const std::uint64_t open = openAfter(20000);
  sendStream(0, open);
  expectAnswers();
  EXPECT_EQ(client_->pause(true).message, "paused; an open impact was cut short");
  EXPECT_EQ(client_->pause(true).message, "paused already");
  expect(reference_->reset());
  expectAnswers();
  EXPECT_TRUE(client_->impacts.back().cut_short);

  for (std::uint64_t seq = open; seq < open + 10 * block_size; seq += block_size)
  {
    client_->send(block(seq));
  }
  ASSERT_TRUE(spinUntil(
      [&] { return client_->count("Samples discarded") == discarded + static_cast<std::int64_t>(10 * block_size); }));
  EXPECT_NE(client_->summary.find("paused: blocks are discarded"), std::string::npos) << client_->summary;
  EXPECT_EQ(client_->pause(false).message, "goes on from rest with the next block");
  EXPECT_EQ(client_->pause(false).message, "not paused");
  const std::uint64_t next = open + 10 * block_size;
  sendStream(next, next + 5000);
  expectAnswers();
  ASSERT_TRUE(spinUntil([] { return client_->starts.size() == 2; }));
  EXPECT_EQ(client_->starts.front().seq, 0u);
  EXPECT_EQ(client_->starts.front().reason, "reset");
  EXPECT_EQ(client_->starts.back().seq, next);
  EXPECT_EQ(client_->starts.back().sample_period, period);
  EXPECT_EQ(client_->starts.back().reason, "paused until then");
}

/// What a bag holds, computed again in this process.
struct Replay : graph::RecordingSink
{
  void onExcitation(const vibro_impact::BaseExcitation& block) override
  {
    Samples samples;
    graph::fromMessage(block, samples);
    excitation.push_back(samples);
  }
  void onGap(const graph::BlockHead& /*block*/, const std::vector<double>& /*gap*/) override
  {
  }
  void onContactForce(const graph::BlockHead& /*block*/, const std::vector<double>& /*force*/) override
  {
  }
  void onImpact(const vibro_impact::Impact& impact) override
  {
    impacts.push_back(impact);
  }
  void onStreamStart(const vibro_impact::StreamStart& /*start*/) override
  {
  }
  void onModelInfo(const vibro_impact::ModelInfo& info) override
  {
    history.add(info);
  }

  std::vector<Samples> excitation;
  std::vector<vibro_impact::Impact> impacts;
  graph::ContactHistory history{"model_info"};
};

TEST_F(SimulatorTest, aRecordedChangeOfTheContactIsComputedAgainOffline)
{
  ASSERT_TRUE(spinUntil([] { return !client_->infos.empty(); }));
  const core::SystemParameters parameters = configuration();
  const core::ContactParameters contact = parameters.contact;
  const auto change = [&](const core::ContactParameters& to, std::uint64_t seq)
  {
    client_->setContact(to, seq);
    core::SystemParameters changed = parameters;
    changed.contact = to;
    reference_->setContact(std::make_shared<core::SwitchedModel>(changed), seq);
  };
  change({contact.stiffness, 4.0e-7}, 5123);
  change({2.0 * contact.stiffness, -3.0e-7}, openAfter(9000));
  sendStream(0, 12000);
  expectAnswers();  // so that the next sample is the same one here and there
  change({0.5 * contact.stiffness, 1.0e-6}, 0);
  sendStream(12000, 20000);
  expectAnswers();
  ASSERT_GT(expected_impacts_.size(), 100u);
  ASSERT_TRUE(spinUntil([] { return client_->infos.size() == 4; }));
  EXPECT_EQ(client_->infos[1].seq, 5123u);
  EXPECT_EQ(client_->infos[1].header.stamp, graph::toTime(begin_ + 5123 * nanoseconds));
  EXPECT_EQ(client_->infos[3].seq, 12000u);
  EXPECT_EQ(client_->infos[3].number, 3u);

  char name[] = "/tmp/vibro_impact_change_XXXXXX";
  const int file = mkstemp(name);
  ASSERT_GE(file, 0);
  close(file);
  {
    rosbag::Bag bag(name, rosbag::bagmode::Write);
    const ros::Time start = graph::toTime(begin_);
    const auto write = [&](const std::string& topic, const auto& messages)
    {
      for (const auto& message : messages)
      {
        bag.write(topic, start, message);
      }
    };
    write("model_info", client_->infos);
    write("gap", client_->gaps);
    write("contact_force", client_->forces);
    write("impact", client_->impacts);
    for (std::uint64_t seq = 0; seq < 20000; seq += block_size)
    {
      vibro_impact::BaseExcitation message;
      graph::toMessage(block(seq), message);
      bag.write("base_excitation", start, message);
    }
  }
  Replay replay;
  graph::RecordedRun({name}).read(replay);
  EXPECT_EQ(std::remove(name), 0);

  const auto model_of = [&](const core::ContactParameters& of)
  {
    core::SystemParameters changed = replay.history.parameters();
    changed.contact = of;
    return std::make_shared<core::SwitchedModel>(changed);
  };
  const std::vector<graph::DatedContact>& contacts = replay.history.contacts();
  ASSERT_EQ(contacts.size(), 4u);
  graph::StreamSimulation simulation(model_of(contacts[0].contact), graph::StreamLimits{});
  for (std::size_t i = 1; i < contacts.size(); ++i)
  {
    simulation.setContact(model_of(contacts[i].contact), contacts[i].seq);
  }
  std::size_t found = 0;
  for (const Samples& samples : replay.excitation)
  {
    for (const graph::StampedImpact& impact : simulation.advance(samples).impacts)
    {
      vibro_impact::Impact message;
      graph::toMessage(impact, message);
      ASSERT_LT(found, replay.impacts.size());
      expectSame(message, replay.impacts[found++]);
    }
  }
  EXPECT_EQ(found, replay.impacts.size());
}

}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "simulator_test");
  return RUN_ALL_TESTS();
}
