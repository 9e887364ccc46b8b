#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include <geometry_msgs/AccelStamped.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Imu.h>

#include "../config/temporary_directory.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/conversions.h"
#include "vibro_impact/ros/recorded_acceleration.h"

namespace vibro_impact::graph
{
namespace
{
using testing::HasSubstr;

constexpr Stamp start = 100'000'000'000;

double value(std::uint64_t sample)
{
  return 3.0 * std::sin(0.05 * static_cast<double>(sample));
}

/// Blocks of ten samples at 1 kHz.
BaseExcitation block(std::uint64_t number)
{
  Samples samples;
  samples.seq = 10 * number;
  samples.stamp = start + static_cast<Stamp>(samples.seq) * 1'000'000;
  samples.sample_period = 1.0e-3;
  for (std::uint64_t i = 0; i < 10; ++i)
  {
    samples.values.push_back(value(samples.seq + i));
  }
  BaseExcitation message;
  toMessage(samples, message);
  return message;
}

template <typename Message>
Message sensorMessage(std::uint64_t sample)
{
  Message message;
  message.header.stamp = toTime(start + static_cast<Stamp>(sample) * 5'000'000);
  message.header.frame_id = "imu_link";
  return message;
}

class RecordedAccelerationOf : public testing::Test
{
protected:
  template <typename Message>
  std::string write(const std::string& name, const std::string& topic, const std::vector<Message>& messages) const
  {
    const std::string path = directory_.path() + "/" + name;
    rosbag::Bag bag(path, rosbag::bagmode::Write);
    for (const Message& message : messages)
    {
      bag.write(topic, message.header.stamp, message);
    }
    return path;
  }

  std::string writeBlocks(const std::vector<std::uint64_t>& numbers) const
  {
    std::vector<BaseExcitation> blocks;
    for (const std::uint64_t number : numbers)
    {
      blocks.push_back(block(number));
    }
    return write("blocks.bag", "/rig/base_excitation", blocks);
  }

  std::string complaint(const std::string& bag, const std::string& topic, const InputParameters& input = {}) const
  {
    try
    {
      readRecordedAcceleration({bag}, topic, input, {});
    }
    catch (const config::Error& error)
    {
      return error.what();
    }
    return "";
  }

  TemporaryDirectory directory_;
};

TEST_F(RecordedAccelerationOf, blocksIsThatOfTheRecordingBitForBit)
{
  const std::string bag = writeBlocks({0, 1, 2, 3});
  const RecordedAcceleration recording = readRecordedAcceleration({bag}, "rig/base_excitation", {}, {});
  EXPECT_EQ(recording.sample_period, 1.0e-3);
  ASSERT_EQ(recording.acceleration.size(), 40u);
  for (std::size_t i = 0; i < 40; ++i)
  {
    EXPECT_EQ(recording.acceleration[i], value(i));
  }
  EXPECT_EQ(recording.first_irregularity, "");
}

TEST_F(RecordedAccelerationOf, aSplitRecordingIsOne)
{
  const std::string first = write<BaseExcitation>("first.bag", "/a", {block(0), block(1)});
  const std::string second = write<BaseExcitation>("second.bag", "/a", {block(2)});
  EXPECT_EQ(readRecordedAcceleration({first, second}, "/a", {}, {}).acceleration.size(), 30u);
}

TEST_F(RecordedAccelerationOf, blocksIsBridgedWhereOneIsMissing)
{
  const RecordedAcceleration recording =
      readRecordedAcceleration({writeBlocks({0, 2, 2, 3})}, "/rig/base_excitation", {}, {});
  ASSERT_EQ(recording.acceleration.size(), 40u);
  EXPECT_EQ(recording.bridged, 10u);
  EXPECT_EQ(recording.refused, 10u);
  EXPECT_NE(recording.first_irregularity, "");
  EXPECT_EQ(recording.acceleration[20], value(20));
  for (std::size_t i = 0; i < 10; ++i)
  {
    EXPECT_NEAR(recording.acceleration[10 + i], value(9) + (value(20) - value(9)) * static_cast<double>(i + 1) / 11.0,
                1.0e-12);
  }
}

TEST_F(RecordedAccelerationOf, aStreamThatStartsAnewIsRefused)
{
  const std::string message = complaint(writeBlocks({0, 1, 50}), "/rig/base_excitation");
  EXPECT_THAT(message, HasSubstr("topic /rig/base_excitation: "));
  EXPECT_THAT(message, HasSubstr(": must be one stretch"));
}

TEST_F(RecordedAccelerationOf, aTopicThatIsNotThereIsRefused)
{
  const std::string bag = writeBlocks({0});
  EXPECT_EQ(complaint(bag, "/gap"),
            bag + ": holds no topic /gap of type vibro_impact/BaseExcitation (but /rig/base_excitation)");
  InputParameters imu;
  imu.kind = InputKind::imu;
  EXPECT_EQ(complaint(bag, "/rig/base_excitation", imu),
            bag + ": holds no topic /rig/base_excitation of type sensor_msgs/Imu");
  BaseExcitation bad = block(0);
  bad.acceleration[3] = NAN;
  EXPECT_THAT(complaint(write<BaseExcitation>("bad.bag", "/a", {bad}), "/a"),
              HasSubstr("topic /a: holds no sample that can be taken, the first because acceleration[3]"));
  EXPECT_THAT(complaint(directory_.file("text", "no bag"), "/a"), HasSubstr("is not a bag"));
}

TEST_F(RecordedAccelerationOf, anImuIsThatAlongItsAxisWithoutGravity)
{
  std::vector<sensor_msgs::Imu> messages;
  for (std::uint64_t i = 0; i < 800; ++i)
  {
    messages.push_back(sensorMessage<sensor_msgs::Imu>(i));
    messages.back().linear_acceleration.y = -9.81 - (i < 400 ? 0.0 : value(i));
  }
  InputParameters input;
  input.kind = InputKind::imu;
  input.axis = {1, -1.0};
  input.grid.offset.reset();
  const std::string bag = write("imu.bag", "/imu/data_raw", messages);
  const RecordedAcceleration recording = readRecordedAcceleration({bag}, "/imu/data_raw", input, {});
  EXPECT_EQ(recording.sample_period, 5.0e-3);
  ASSERT_EQ(recording.acceleration.size(), 800u);
  for (std::size_t i = 0; i < 800; ++i)
  {
    EXPECT_NEAR(recording.acceleration[i], i < 400 ? 0.0 : value(i), 1.0e-12) << i;
  }

  messages.resize(90);
  EXPECT_THAT(complaint(write("short.bag", "/imu/data_raw", messages), "/imu/data_raw", input),
              HasSubstr("topic /imu/data_raw: is too short for sample_period and offset to be measured"));
}

TEST_F(RecordedAccelerationOf, anAccelerometerIsTakenAsItIs)
{
  std::vector<geometry_msgs::AccelStamped> messages;
  for (std::uint64_t i = 0; i < 200; ++i)
  {
    messages.push_back(sensorMessage<geometry_msgs::AccelStamped>(i));
    messages.back().accel.linear.z = value(i);
  }
  messages[50].header.frame_id = "elsewhere";  // refused, and bridged over
  InputParameters input;
  input.kind = InputKind::accel;
  const std::string bag = write("accel.bag", "/accel", messages);
  const RecordedAcceleration recording = readRecordedAcceleration({bag}, "/accel", input, {});
  ASSERT_EQ(recording.acceleration.size(), 200u);
  EXPECT_EQ(recording.refused, 1u);
  EXPECT_THAT(recording.first_irregularity, HasSubstr("header.frame_id is \"elsewhere\""));
  EXPECT_EQ(recording.acceleration[49], value(49));
  EXPECT_NEAR(recording.acceleration[50], 0.5 * (value(49) + value(51)), 1.0e-12);
  EXPECT_EQ(recording.acceleration[199], value(199));
}

}  // namespace
}  // namespace vibro_impact::graph
