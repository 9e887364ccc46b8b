#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "../config/temporary_directory.h"
#include "synthetic_run.h"
#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/recorded_run.h"

namespace core = vibro_impact::core;
namespace graph = vibro_impact::graph;

namespace
{
class Counter : public graph::RecordingSink
{
public:
  void onExcitation(const vibro_impact::BaseExcitation& /*block*/) override
  {
    ++messages;
  }
  void onGap(const graph::BlockHead& /*block*/, const std::vector<double>& /*gap*/) override
  {
    ++messages;
  }
  void onContactForce(const graph::BlockHead& /*block*/, const std::vector<double>& /*force*/) override
  {
    ++messages;
  }
  void onImpact(const vibro_impact::Impact& /*impact*/) override
  {
    ++messages;
  }
  void onStreamStart(const vibro_impact::StreamStart& /*start*/) override
  {
    ++messages;
  }
  void onModelInfo(const vibro_impact::ModelInfo& /*info*/) override
  {
    ++messages;
  }

  std::size_t messages = 0;
};

std::size_t messagesIn(const std::string& path)
{
  Counter counter;
  graph::RecordedRun({path}).read(counter);
  return counter.messages;
}

class DamagedBag : public testing::Test
{
protected:
  void SetUp() override
  {
    core::SystemParameters parameters;
    parameters.beam1 = core::ModalTableParameters{{9.0}, {1.0}, {1.0}, {}, {}};
    parameters.beam2 = core::RigidSurface{};
    parameters.contact = {9.0, 0.0};
    parameters.basis = core::AttachmentBasis{1};
    std::vector<double> samples;
    for (int i = 0; i < 200; ++i)
    {
      samples.push_back(std::sin(0.05 * i));
    }
    graph::SyntheticRun(parameters, samples, 1.0e-3, 50).write(path_);
    std::ifstream file(path_, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
    messages_ = messagesIn(path_);
  }

  /// Reads the recording with other bytes: all of it, or a clear error.
  void readAs(const std::string& bytes) const
  {
    std::ofstream(path_, std::ios::binary) << bytes;
    try
    {
      EXPECT_LE(messagesIn(path_), messages_);
    }
    catch (const vibro_impact::config::Error& error)
    {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }

  TemporaryDirectory directory_;
  std::string path_ = directory_.path() + "/run.bag";
  std::string bytes_;
  std::size_t messages_ = 0;
};

TEST_F(DamagedBag, IsReadOrRefusedWhateverByteIsWrong)
{
  std::mt19937 random(1);
  for (int round = 0; round < 300; ++round)
  {
    std::string bytes = bytes_;
    bytes[random() % bytes.size()] = static_cast<char>(random());
    readAs(bytes);
  }
}

TEST_F(DamagedBag, IsReadOrRefusedWhateverNumberIsHuge)
{
  for (std::size_t place = 13; place + 4 < bytes_.size(); place += 101)
  {
    readAs(std::string(bytes_).replace(place, 4, "\xff\xff\xff\x7f"));
  }
}

TEST_F(DamagedBag, IsRefusedWhereverItIsCutOff)
{
  for (std::size_t length = 0; length < bytes_.size(); length += 61)
  {
    std::ofstream(path_, std::ios::binary) << bytes_.substr(0, length);
    EXPECT_THROW(messagesIn(path_), vibro_impact::config::Error) << length;
  }
}

}  // namespace
