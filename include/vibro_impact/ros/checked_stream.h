#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include <ros/serialization.h>

namespace vibro_impact::graph
{
/// Reads a serialised message, no longer than it is. The stream of roscpp makes room for as many elements as the length
/// field of an array claims, up to 32 GB of them, before it looks whether they are there.
class CheckedStream : public ros::serialization::IStream
{
public:
  CheckedStream(std::uint8_t* data, std::uint32_t length) : IStream(data, length)
  {
  }

  // All throw ros::serialization::StreamOverrunException if the stream ends before.

  std::uint8_t* advance(std::uint32_t bytes)
  {
    if (bytes > getLength())
    {
      ros::serialization::throwStreamOverrun();
    }
    return IStream::advance(bytes);
  }

  template <typename T>
  void next(T& value)
  {
    ros::serialization::deserialize(*this, value);
  }

  void next(std::vector<double>& values)
  {
    std::uint32_t count = 0;
    next(count);
    if (count > getLength() / sizeof(double))
    {
      ros::serialization::throwStreamOverrun();
    }
    values.resize(count);
    if (count > 0)
    {
      const auto bytes = static_cast<std::uint32_t>(count * sizeof(double));
      std::memcpy(values.data(), advance(bytes), bytes);
    }
  }
};

}  // namespace vibro_impact::graph
