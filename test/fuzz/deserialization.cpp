// Any bytes as a serialised message: they are refused, or what they give serialises back to them. The first byte
// chooses the type.

#include <cstddef>
#include <cstdint>
#include <vector>

#include <ros/exception.h>
#include <vibro_impact/BaseExcitation.h>
#include <vibro_impact/Gap.h>
#include <vibro_impact/Impact.h>
#include <vibro_impact/ModelInfo.h>

#include "require.h"
#include "vibro_impact/ros/checked_stream.h"
#include "vibro_impact/ros/conversions.h"

namespace graph = vibro_impact::graph;
namespace serialization = ros::serialization;
using vibro_impact::fuzz::require;

namespace
{
template <typename Message>
Message read(std::vector<std::uint8_t> bytes)
{
  Message message;
  graph::CheckedStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  stream.next(message);
  const std::size_t length = serialization::serializationLength(message);
  require(length == bytes.size() - stream.getLength(), "a message is as long as what it was read from");
  std::vector<std::uint8_t> written(length);
  serialization::OStream output(written.data(), static_cast<std::uint32_t>(written.size()));
  serialization::serialize(output, message);
  bytes.resize(length);
  // A bool is one bit of its byte.
  require(written == bytes || sizeof(Message) == sizeof(vibro_impact::Impact), "a message writes back the same");
  return message;
}
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  if (size == 0)
  {
    return 0;
  }
  const std::vector<std::uint8_t> bytes(data + 1, data + size);
  graph::Samples samples;
  try
  {
    switch (data[0] % 4)
    {
      case 0:
        graph::fromMessage(read<vibro_impact::BaseExcitation>(bytes), samples);
        break;
      case 1:
        graph::fromMessage(read<vibro_impact::Gap>(bytes), samples);
        break;
      case 2:
        graph::fromMessage(read<vibro_impact::Impact>(bytes));
        break;
      default:
        read<vibro_impact::ModelInfo>(bytes);
    }
  }
  catch (const ros::serialization::StreamOverrunException&)
  {
    return 0;
  }
  require(samples.values.size() * sizeof(double) <= size, "no more samples than bytes");
  return 0;
}
