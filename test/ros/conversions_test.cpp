#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "vibro_impact/config/configuration.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/core/switched_model.h"
#include "vibro_impact/ros/checked_subscription.h"
#include "vibro_impact/ros/conversions.h"

namespace graph = vibro_impact::graph;
namespace core = vibro_impact::core;

namespace
{
constexpr graph::Stamp stamp = 1700000000123456789;

template <typename Message>
const std::vector<double>& values(const Message& message);
template <>
const std::vector<double>& values(const vibro_impact::BaseExcitation& message)
{
  return message.acceleration;
}
template <>
const std::vector<double>& values(const vibro_impact::Gap& message)
{
  return message.gap;
}
template <>
const std::vector<double>& values(const vibro_impact::ContactForce& message)
{
  return message.force;
}

template <typename Message>
class BlockConversion : public testing::Test
{
};

using BlockMessages = testing::Types<vibro_impact::BaseExcitation, vibro_impact::Gap, vibro_impact::ContactForce>;
TYPED_TEST_SUITE(BlockConversion, BlockMessages);

TYPED_TEST(BlockConversion, writesEveryField)
{
  const graph::Samples samples{stamp, 12345678901234567ull, 2.0e-5, {1.0, -0.1, 1.0e-300}};
  TypeParam message;
  message.header.seq = 7;
  message.header.frame_id = "elsewhere";
  graph::toMessage(samples, message);
  EXPECT_EQ(message.header.stamp, ros::Time(1700000000, 123456789));
  EXPECT_EQ(message.header.frame_id, "base_frame");
  EXPECT_EQ(message.header.seq, 0u);
  EXPECT_EQ(message.seq, samples.seq);
  EXPECT_EQ(message.sample_period, samples.sample_period);
  EXPECT_EQ(values(message), samples.values);
}

TYPED_TEST(BlockConversion, comesBackUnchanged)
{
  const graph::Samples samples{stamp, 42, 1.0 / 44100.0, {1.0 / 3.0, 0.0}};
  TypeParam message;
  graph::toMessage(samples, message);
  graph::Samples back;
  back.values.assign(100, 1.0);
  graph::fromMessage(message, back);
  EXPECT_EQ(back.stamp, samples.stamp);
  EXPECT_EQ(back.seq, samples.seq);
  EXPECT_EQ(back.sample_period, samples.sample_period);
  EXPECT_EQ(back.values, samples.values);
}

TEST(TimeConversion, wholeRangeComesBack)
{
  for (const ros::Time& time : {ros::Time(0, 0), ros::Time(0, 1), ros::Time(4294967295u, 999999999)})
  {
    EXPECT_EQ(graph::toTime(graph::fromTime(time)), time);
  }
}

TEST(ImpactConversion, comesBackUnchanged)
{
  graph::StampedImpact impact;
  impact.stamp = stamp;
  impact.impact = {3,    1000000000007ull, 1.1e-5, 2.2e-4, 3.3e-3, 4.4,    5.5e-5, 0.66,
                   0.77, 8.8e-6,           true,   5.5e-6, 3.3e-6, -1.1e-6};
  vibro_impact::Impact message;
  graph::toMessage(impact, message);
  EXPECT_EQ(message.header.stamp, ros::Time(1700000000, 123456789));
  EXPECT_EQ(message.header.frame_id, "base_frame");
  EXPECT_EQ(message.number, 3u);
  EXPECT_EQ(message.seq, 1000000000007ull);
  EXPECT_EQ(message.offset, 1.1e-5);
  EXPECT_EQ(message.duration, 2.2e-4);
  EXPECT_EQ(message.impulse, 3.3e-3);
  EXPECT_EQ(message.peak_force, 4.4);
  EXPECT_EQ(message.peak_time, 5.5e-5);
  EXPECT_EQ(message.approach_speed, 0.66);
  EXPECT_EQ(message.separation_speed, 0.77);
  EXPECT_EQ(message.energy_lost, 8.8e-6);
  EXPECT_EQ(message.dissipated, 5.5e-6);
  EXPECT_EQ(message.mapping_loss, 3.3e-6);
  EXPECT_EQ(message.base_work, -1.1e-6);
  EXPECT_TRUE(message.cut_short);

  const graph::StampedImpact back = graph::fromMessage(message);
  EXPECT_EQ(back.stamp, impact.stamp);
  EXPECT_EQ(back.impact.number, impact.impact.number);
  EXPECT_EQ(back.impact.interval, impact.impact.interval);
  EXPECT_EQ(back.impact.offset, impact.impact.offset);
  EXPECT_EQ(back.impact.duration, impact.impact.duration);
  EXPECT_EQ(back.impact.impulse, impact.impact.impulse);
  EXPECT_EQ(back.impact.peak_force, impact.impact.peak_force);
  EXPECT_EQ(back.impact.peak_time, impact.impact.peak_time);
  EXPECT_EQ(back.impact.approach_speed, impact.impact.approach_speed);
  EXPECT_EQ(back.impact.separation_speed, impact.impact.separation_speed);
  EXPECT_EQ(back.impact.energy_lost, impact.impact.energy_lost);
  EXPECT_EQ(back.impact.cut_short, impact.impact.cut_short);
  EXPECT_EQ(back.impact.dissipated, impact.impact.dissipated);
  EXPECT_EQ(back.impact.mapping_loss, impact.impact.mapping_loss);
  EXPECT_EQ(back.impact.base_work, impact.impact.base_work);
}

core::SystemParameters limitingCase()
{
  core::SystemParameters parameters;
  parameters.beam1 = core::BeamParameters{1.66e9, 954.0, 0.0529, core::Rectangle{0.00127, 0.0127}, 0.02645};
  parameters.beam2 = core::RigidSurface{};
  parameters.contact = {24309.426302924, 0.0};
  parameters.damping = {0.01, 0.05};
  parameters.basis = core::ConjoinedBasis{2, 3};
  return parameters;
}

TEST(StructureMotionConversion, saysWhatEachNumberIs)
{
  core::SystemParameters parameters = limitingCase();
  parameters.basis = core::AttachmentBasis{2};
  const core::SwitchedModel model(parameters);
  vibro_impact::StructureMotion message;
  graph::toMessage(
      graph::StreamSimulation::Motion{
          4, 1000000000008ull, stamp, {1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, {0.5, 0.6}, {0.0, 7.0}, {9.0, 8.0}},
      model, 2.0e-5, message);
  EXPECT_EQ(message.header.stamp, ros::Time(1700000000, 123456789));
  EXPECT_EQ(message.header.frame_id, "base_frame");
  EXPECT_EQ(message.seq, 1000000000008ull);
  EXPECT_EQ(message.sample_period, 2.0e-5);
  EXPECT_EQ(message.step, 4u);
  EXPECT_EQ(message.structure, (std::vector<std::uint8_t>{1, 1, 1}));
  EXPECT_EQ(message.mode, (std::vector<std::uint32_t>{1, 2, 0}));
  ASSERT_EQ(message.contact_deflection.size(), 3u);
  EXPECT_NEAR(message.contact_deflection[0], std::sqrt(2.0 / (954.0 * 0.00127 * 0.0127 * 0.0529)), 1e-9);
  EXPECT_EQ(message.contact_deflection[1], 0.0);
  EXPECT_EQ(message.coordinates, (std::vector<double>{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}));
  EXPECT_EQ(message.gap, (std::vector<double>{0.5, 0.6}));
  EXPECT_EQ(message.force, (std::vector<double>{0.0, 7.0}));
  EXPECT_EQ(message.acceleration, (std::vector<double>{9.0, 8.0}));
}

TEST(ModelInfoConversion, saysWhatIsComputed)
{
  const core::SwitchedModel model(limitingCase());
  vibro_impact::ModelInfo message;
  graph::toMessage(model, "the text", "1.2.3", message);
  EXPECT_TRUE(message.header.stamp.isZero());
  EXPECT_EQ(message.header.frame_id, "base_frame");
  EXPECT_EQ(message.version, "1.2.3");
  EXPECT_EQ(message.configuration, "the text");
  ASSERT_EQ(message.free_frequencies.size(), 2u);
  EXPECT_NEAR(message.free_frequencies[0], 271.5, 0.1);
  EXPECT_NEAR(message.free_frequencies[1], 4.0 * message.free_frequencies[0], 1.0e-9 * message.free_frequencies[1]);
  ASSERT_EQ(message.contact_frequencies.size(), 3u);
  ASSERT_EQ(message.mapping_loss.size(), 2u);
  EXPECT_EQ(message.mapping_loss[0], model.mappingLoss()[0]);
  EXPECT_EQ(message.mapping_loss[1], model.mappingLoss()[1]);
}

TEST(ModelInfoConversion, configurationLoadsBack)
{
  const core::SystemParameters parameters = limitingCase();
  vibro_impact::ModelInfo message;
  graph::toMessage(core::SwitchedModel(parameters), vibro_impact::config::toYaml(parameters), "1.2.3", message);
  const core::SystemParameters back = graph::fromMessage(message);
  EXPECT_EQ(std::get<core::BeamParameters>(back.beam1).length, std::get<core::BeamParameters>(parameters.beam1).length);
  EXPECT_EQ(back.contact.stiffness, parameters.contact.stiffness);
  EXPECT_TRUE(std::holds_alternative<core::RigidSurface>(back.beam2));
  EXPECT_EQ(std::get<core::ConjoinedBasis>(back.basis).modes_contact, 3);

  message.configuration = "beam1: 3";
  EXPECT_THROW(graph::fromMessage(message), vibro_impact::config::Error);
}

// roscpp's own stream would make room for 32 GB.
TEST(CheckedSubscription, ReadsNoLongerArrayThanThereIs)
{
  using vibro_impact::BaseExcitation;
  BaseExcitation message;
  message.acceleration = {1.0, 2.0};
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream output(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(output, message);

  graph::CheckedCallbackHelper<BaseExcitation> helper([](const ros::MessageEvent<const BaseExcitation>&) {});
  ros::SubscriptionCallbackHelperDeserializeParams parameters;
  parameters.buffer = bytes.data();
  parameters.length = static_cast<std::uint32_t>(bytes.size());
  const auto read = boost::static_pointer_cast<const BaseExcitation>(helper.deserialize(parameters));
  EXPECT_EQ(read->acceleration, message.acceleration);

  const std::size_t place_of_length = bytes.size() - 2 * sizeof(double) - sizeof(std::uint32_t);
  for (const std::uint32_t length : {3U, 0x20000000U, 0xffffffffU})
  {
    std::memcpy(bytes.data() + place_of_length, &length, sizeof(length));
    EXPECT_THROW(helper.deserialize(parameters), ros::serialization::StreamOverrunException) << length;
  }
}

}  // namespace
