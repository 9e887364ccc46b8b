#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "vibro_impact/ros/node_query.h"

namespace vibro_impact::graph
{
/// How the messages of one topic arrive at a recording node, as the nodes at both ends tell it.
struct Delivery
{
  std::string topic;
  std::size_t publishers = 0;  ///< nodes that advertise the topic
  std::size_t connected = 0;   ///< those of them that have a connection to the recorder
  std::uint64_t sent = 0;      ///< messages put into the queues of these connections
  std::uint64_t received = 0;  ///< messages that have come out of them, asked for after `sent`
  std::uint64_t dropped = 0;   ///< received ones that the recorder lost because its own queue was full

  bool ready() const
  {
    return publishers > 0 && connected == publishers;
  }
  /// What was published before the question has arrived.
  bool complete() const
  {
    return ready() && received >= sent;
  }
};

/// What a recording node (or any other subscriber) has received of its topics.
///
/// roscpp counts on every connection, and tells whoever asks. Nothing else shows what a recorder loses: it takes
/// messages in a queue of 100 a topic and drops the oldest without a word.
class Recording
{
public:
  /// Resolved names.
  Recording(std::vector<std::string> topics, std::string recorder);

  /// Asks the master who publishes the topics, and the recorder for its process. Blocks for about a millisecond.
  void discover();

  /// Asks the publishers found and then the recorder, about every topic in turn. A node that does not answer
  /// within seconds counts as not connected. Blocks for about a millisecond if all answer.
  std::vector<Delivery> ask();

  /// Whether the recorder has taken in all that it has received: all its threads sleep. Also true where that cannot be
  /// seen, as it runs on another machine.
  bool isIdle() const;

  const std::string& recorder() const
  {
    return recorder_;
  }

private:
  std::vector<std::string> topics_;
  std::string recorder_;
  int process_ = 0;                                             // of the recorder; 0: not of this machine, or not known
  std::map<std::string, std::vector<std::size_t>> publishers_;  // names, and which topics they publish
  NodeQuery query_;
};

}  // namespace vibro_impact::graph
