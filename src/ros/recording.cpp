#include "vibro_impact/ros/recording.h"

#include <algorithm>
#include <utility>

#include <xmlrpcpp/XmlRpcException.h>

#include "vibro_impact/ros/process.h"

namespace vibro_impact::graph
{
namespace
{
using XmlRpc::XmlRpcValue;

// Counters travel as 32-bit integers that wrap around.
std::uint64_t count(XmlRpcValue& value)
{
  return static_cast<std::uint32_t>(static_cast<int&>(value));
}

// The entries of one topic in one direction's statistics [[topic, [entry, ...]], ...], each of which begins with the
// number of its connection.
std::vector<XmlRpcValue> connections(XmlRpcValue& statistics, const std::string& topic)
{
  std::vector<XmlRpcValue> entries;
  for (XmlRpcValue& of_topic : elements(statistics))
  {
    if (static_cast<std::string&>(of_topic[0]) == topic)
    {
      const std::vector<XmlRpcValue> more = elements(of_topic[1]);
      entries.insert(entries.end(), more.begin(), more.end());
    }
  }
  return entries;
}

// Adds what a publisher says: its bus_info, and of each connection the statistics [connection, bytes, bytes of data,
// messages, ...].
void addSent(const XmlRpcValue& bus_info, XmlRpcValue& bus_statistics, const std::string& subscriber,
             Delivery& delivery)
{
  for (const int connection : connectionsTo(subscriber, delivery.topic, bus_info))
  {
    for (XmlRpcValue& entry : connections(bus_statistics[0], delivery.topic))
    {
      if (static_cast<int&>(entry[0]) == connection)
      {
        ++delivery.connected;
        delivery.sent += count(entry[3]);
      }
    }
  }
}

// Adds what the subscriber says: of each connection the statistics [connection, bytes, messages, drops, ...].
void addReceived(XmlRpcValue& bus_statistics, Delivery& delivery)
{
  for (XmlRpcValue& entry : connections(bus_statistics[1], delivery.topic))
  {
    delivery.received += count(entry[2]);
    delivery.dropped += count(entry[3]);
  }
}

}  // namespace

Recording::Recording(std::vector<std::string> topics, std::string recorder)
    : topics_(std::move(topics)), recorder_(std::move(recorder))
{
}

void Recording::discover()
{
  query_.forget();
  publishers_ = findPublishers(topics_);
  XmlRpcValue process = query_.request(recorder_, "getPid");
  const bool visible = process.getType() == XmlRpcValue::TypeInt && query_.isOfThisMachine(recorder_);
  process_ = visible ? static_cast<int&>(process) : 0;
}

bool Recording::isIdle() const
{
  return process_ == 0 || isAsleep(process_);
}

std::vector<Delivery> Recording::ask()
{
  std::vector<Delivery> deliveries;
  for (const std::string& topic : topics_)
  {
    deliveries.emplace_back().topic = topic;
  }
  if (publishers_.empty())
  {
    return deliveries;
  }
  try
  {
    for (const auto& [publisher, topics] : publishers_)
    {
      XmlRpcValue info = query_.request(publisher, "getBusInfo");
      XmlRpcValue statistics = info.size() > 0 ? query_.request(publisher, "getBusStats") : info;
      for (const std::size_t topic : topics)
      {
        ++deliveries[topic].publishers;
        if (statistics.size() > 0)
        {
          addSent(info, statistics, recorder_, deliveries[topic]);
        }
      }
    }
    XmlRpcValue statistics = query_.request(recorder_, "getBusStats");
    for (Delivery& delivery : deliveries)
    {
      if (statistics.size() > 1)
      {
        addReceived(statistics, delivery);
      }
    }
  }
  catch (const XmlRpc::XmlRpcException&)
  {
    // An answer in another form than roscpp's tells nothing: the deliveries stay incomplete.
  }
  return deliveries;
}

}  // namespace vibro_impact::graph
