#include "vibro_impact/ros/recording.h"

#include <algorithm>
#include <utility>

#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpcClient.h>
#include <xmlrpcpp/XmlRpcException.h>

#include "vibro_impact/ros/process.h"

namespace vibro_impact::graph
{
namespace
{
using XmlRpc::XmlRpcValue;

// More than any node takes that is well, s.
constexpr double longest_answer = 5.0;

bool isOfThisMachine(const std::string& host)
{
  return host == "localhost" || host == "127.0.0.1" || host == ros::network::getHost();
}

XmlRpcValue emptyList()
{
  XmlRpcValue list;
  list.setSize(0);
  return list;
}

// The elements of an array, which XmlRpcValue itself cannot iterate over: its begin() is that of a struct.
std::vector<XmlRpcValue> elements(const XmlRpcValue& array)
{
  std::vector<XmlRpcValue> values;
  values.reserve(static_cast<std::size_t>(array.size()));
  for (int i = 0; i < array.size(); ++i)  // NOLINT(modernize-loop-convert): for the same reason
  {
    values.push_back(array[i]);
  }
  return values;
}

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

// Adds what a publisher says: bus_info [[connection, destination, direction, transport, topic, ...], ...], and of each
// connection the statistics [connection, bytes, bytes of data, messages, ...].
void addSent(XmlRpcValue& bus_info, XmlRpcValue& bus_statistics, const std::string& subscriber, Delivery& delivery)
{
  for (XmlRpcValue& connection : elements(bus_info))
  {
    if (static_cast<std::string&>(connection[1]) != subscriber || static_cast<std::string&>(connection[2]) != "o" ||
        static_cast<std::string&>(connection[4]) != delivery.topic)
    {
      continue;
    }
    for (XmlRpcValue& entry : connections(bus_statistics[0], delivery.topic))
    {
      if (static_cast<int&>(entry[0]) == static_cast<int&>(connection[0]))
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

// Asks a node, and does not wait for ever where it hangs or its machine is gone.
class Recording::Client : public XmlRpc::XmlRpcClient
{
public:
  using XmlRpcClient::XmlRpcClient;

  bool ask(const char* method, const XmlRpcValue& parameters, XmlRpcValue& answer)
  {
    if (!executeNonBlock(method, parameters))
    {
      return false;
    }
    _disp.work(longest_answer);
    return executeCheckDone(answer) && !isFault();
  }
};

Recording::~Recording() = default;
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;

Recording::Recording(std::vector<std::string> topics, std::string recorder)
    : topics_(std::move(topics)), recorder_(std::move(recorder))
{
}

void Recording::discover()
{
  publishers_.clear();
  clients_.clear();
  process_ = 0;
  XmlRpcValue caller;
  caller[0] = ros::this_node::getName();
  XmlRpcValue response;
  XmlRpcValue state;
  if (!ros::master::execute("getSystemState", caller, response, state, false))
  {
    return;
  }
  for (XmlRpcValue& published : elements(state[0]))  // [[topic, [publisher, ...]], ...]
  {
    const auto topic = std::find(topics_.begin(), topics_.end(), static_cast<std::string&>(published[0]));
    if (topic == topics_.end())
    {
      continue;
    }
    for (XmlRpcValue& publisher : elements(published[1]))
    {
      publishers_[static_cast<std::string&>(publisher)].push_back(static_cast<std::size_t>(topic - topics_.begin()));
    }
  }
  XmlRpcValue process = request(recorder_, "getPid");
  if (process.getType() == XmlRpcValue::TypeInt && isOfThisMachine(clients_[recorder_]->getHost()))
  {
    process_ = static_cast<int&>(process);
  }
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
  try
  {
    for (const auto& [publisher, topics] : publishers_)
    {
      XmlRpcValue info = request(publisher, "getBusInfo");
      XmlRpcValue statistics = info.size() > 0 ? request(publisher, "getBusStats") : emptyList();
      for (const std::size_t topic : topics)
      {
        ++deliveries[topic].publishers;
        if (statistics.size() > 0)
        {
          addSent(info, statistics, recorder_, deliveries[topic]);
        }
      }
    }
    XmlRpcValue statistics = publishers_.empty() ? emptyList() : request(recorder_, "getBusStats");
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

XmlRpcValue Recording::request(const std::string& node, const char* method)
{
  XmlRpcValue parameters;
  parameters[0] = ros::this_node::getName();
  std::unique_ptr<Client>& client = clients_[node];
  if (!client)
  {
    XmlRpcValue look_up;
    look_up[0] = ros::this_node::getName();
    look_up[1] = node;
    XmlRpcValue response;
    XmlRpcValue uri;
    std::string host;
    std::uint32_t port = 0;
    if (!ros::master::execute("lookupNode", look_up, response, uri, false) ||
        !ros::network::splitURI(static_cast<std::string&>(uri), host, port))
    {
      return emptyList();
    }
    client = std::make_unique<Client>(host.c_str(), static_cast<int>(port), "/");
  }
  XmlRpcValue answer;
  if (!client->ask(method, parameters, answer) || answer.getType() != XmlRpcValue::TypeArray)
  {
    client.reset();
    return emptyList();
  }
  // [code, status, value]; roscpp answers getBusStats by the value alone.
  const bool wrapped = answer.size() == 3 && answer[0].getType() == XmlRpcValue::TypeInt;
  return wrapped ? answer[2] : answer;
}

}  // namespace vibro_impact::graph
