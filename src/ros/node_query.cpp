#include "vibro_impact/ros/node_query.h"

#include <algorithm>
#include <cstdint>

#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpcClient.h>
#include <xmlrpcpp/XmlRpcException.h>

namespace vibro_impact::graph
{
namespace
{
using XmlRpc::XmlRpcValue;

// More than any node takes that is well, s.
constexpr double longest_answer = 5.0;

XmlRpcValue emptyList()
{
  XmlRpcValue list;
  list.setSize(0);
  return list;
}

}  // namespace

// Asks a node, and does not wait for ever where it hangs or its machine is gone.
class NodeQuery::Client : public XmlRpc::XmlRpcClient
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

NodeQuery::NodeQuery() = default;
NodeQuery::~NodeQuery() = default;
NodeQuery::NodeQuery(NodeQuery&&) noexcept = default;
NodeQuery& NodeQuery::operator=(NodeQuery&&) noexcept = default;

XmlRpcValue NodeQuery::request(const std::string& node, const char* method)
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

bool NodeQuery::isOfThisMachine(const std::string& node) const
{
  const auto client = clients_.find(node);
  if (client == clients_.end() || !client->second)
  {
    return false;
  }
  const std::string host = client->second->getHost();
  return host == "localhost" || host == "127.0.0.1" || host == ros::network::getHost();
}

void NodeQuery::forget()
{
  clients_.clear();
}

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

std::map<std::string, std::vector<std::size_t>> findPublishers(const std::vector<std::string>& topics)
{
  std::map<std::string, std::vector<std::size_t>> publishers;
  XmlRpcValue caller;
  caller[0] = ros::this_node::getName();
  XmlRpcValue response;
  XmlRpcValue state;
  if (!ros::master::execute("getSystemState", caller, response, state, false))
  {
    return publishers;
  }
  for (XmlRpcValue& published : elements(state[0]))  // [[topic, [publisher, ...]], ...]
  {
    const auto topic = std::find(topics.begin(), topics.end(), static_cast<std::string&>(published[0]));
    if (topic == topics.end())
    {
      continue;
    }
    for (XmlRpcValue& publisher : elements(published[1]))
    {
      publishers[static_cast<std::string&>(publisher)].push_back(static_cast<std::size_t>(topic - topics.begin()));
    }
  }
  return publishers;
}

std::string findPublishedType(const std::string& topic)
{
  XmlRpcValue request;
  request[0] = ros::this_node::getName();
  request[1] = "";
  XmlRpcValue response;
  XmlRpcValue topics;
  if (ros::master::execute("getPublishedTopics", request, response, topics, false))
  {
    for (XmlRpcValue& published : elements(topics))  // [[topic, type], ...]
    {
      if (static_cast<std::string&>(published[0]) == topic)
      {
        return static_cast<std::string&>(published[1]);
      }
    }
  }
  return {};
}

std::vector<int> connectionsTo(const std::string& subscriber, const std::string& topic, const XmlRpcValue& bus_info)
{
  std::vector<int> connections;
  for (XmlRpcValue& connection : elements(bus_info))  // [[connection, destination, direction, transport, topic, ...]]
  {
    if (static_cast<std::string&>(connection[1]) == subscriber && static_cast<std::string&>(connection[2]) == "o" &&
        static_cast<std::string&>(connection[4]) == topic)
    {
      connections.push_back(static_cast<int&>(connection[0]));
    }
  }
  return connections;
}

bool isConnected(NodeQuery& query, const std::string& topic, const std::string& subscriber)
{
  const auto publishers = findPublishers({topic});
  try
  {
    return std::any_of(publishers.begin(), publishers.end(),
                       [&](const auto& publisher)
                       {
                         const XmlRpcValue info = query.request(publisher.first, "getBusInfo");
                         return !connectionsTo(subscriber, topic, info).empty();
                       });
  }
  catch (const XmlRpc::XmlRpcException&)
  {
    return false;  // an answer in another form than that of a node tells nothing
  }
}

}  // namespace vibro_impact::graph
