#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <xmlrpcpp/XmlRpcValue.h>

namespace vibro_impact::graph
{
/// Asks other nodes what they know of their connections.
class NodeQuery
{
public:
  NodeQuery();
  ~NodeQuery();
  NodeQuery(NodeQuery&&) noexcept;
  NodeQuery& operator=(NodeQuery&&) noexcept;

  /// What `node` answers to a request that takes only the caller's name; an empty list if it does not answer within
  /// seconds.
  XmlRpc::XmlRpcValue request(const std::string& node, const char* method);

  /// Whether the node, if it has answered, runs on this machine.
  bool isOfThisMachine(const std::string& node) const;

  /// Looks all nodes up anew from now on: one of the same name may be another.
  void forget();

private:
  class Client;
  std::map<std::string, std::unique_ptr<Client>> clients_;
};

/// The elements of an array, which XmlRpcValue itself cannot iterate over: its begin() is that of a struct.
std::vector<XmlRpc::XmlRpcValue> elements(const XmlRpc::XmlRpcValue& array);

/// The nodes that publish `topics` (resolved names), as the master knows them, and of each the indices of its topics.
std::map<std::string, std::vector<std::size_t>> findPublishers(const std::vector<std::string>& topics);

/// The type of the messages on `topic` (a resolved name), as its publishers have told the master; empty if there are
/// none or the master does not answer.
std::string findPublishedType(const std::string& topic);

/// The numbers of the connections by which a publisher, as its `bus_info` tells, sends `topic` to `subscriber`.
std::vector<int> connectionsTo(const std::string& subscriber, const std::string& topic,
                               const XmlRpc::XmlRpcValue& bus_info);

/// Whether a publisher sends `topic` to `subscriber`. roscpp and rospy count a subscriber's connection from when it
/// asks for it; what is published before the other end has taken it up is lost.
bool isConnected(NodeQuery& query, const std::string& topic, const std::string& subscriber);

}  // namespace vibro_impact::graph
