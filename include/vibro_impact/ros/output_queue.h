#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <typeinfo>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/ros.h>
#include <ros/serialization.h>
#include <ros/topic_manager.h>
#include <boost/shared_ptr.hpp>

namespace vibro_impact::graph
{
/// Keeps count of the messages of one topic from when they are published until nobody needs their bytes any more.
///
/// roscpp does not say what it drops for a subscriber that does not read. It shows by the order in which the bytes are
/// given back: a full queue drops its oldest message while an even older one is still being written. So a message that
/// goes before one older than itself was dropped by somebody; one that goes in turn was written to all. With several
/// slow subscribers some drops go unseen: the count is a lower bound then, and exact for one. Thread-safe.
class MessageLedger
{
public:
  struct Counts
  {
    std::uint64_t published = 0;
    std::uint64_t waiting = 0;  ///< not yet written to, or dropped for, every subscriber
    std::uint64_t dropped = 0;
  };

  /// The number of a new message, from 0 on.
  std::uint64_t add();

  /// The bytes of message `number` are not needed any more.
  void release(std::uint64_t number);

  Counts counts() const;

private:
  mutable std::mutex mutex_;
  std::deque<bool> released_;  ///< of the messages from first_ on
  std::uint64_t first_ = 0;    ///< the oldest that waits
  Counts counts_;
};

/// A publisher that knows what is waiting in its queues and what they have dropped.
class OutputQueue
{
public:
  /// `queue_size`: messages that wait for each subscriber before the oldest is dropped; 0: no limit.
  template <class Message>
  void advertise(ros::NodeHandle& node, const std::string& topic, std::uint32_t queue_size)
  {
    queue_size_ = queue_size;
    publisher_ = node.advertise<Message>(topic, queue_size);
  }

  /// Subscribers in this process get the message itself, others a copy of its bytes. Nobody may change it any more.
  template <class Message>
  void publish(const boost::shared_ptr<const Message>& message)
  {
    const auto serialize = [this, &message] { return track(ros::serialization::serializeMessage(*message)); };
    // What ros::Publisher does itself, but for what becomes of the bytes.
    ros::SerializedMessage shared;
    shared.type_info = &typeid(Message);
    shared.message = message;
    ros::TopicManager::instance()->publish(publisher_.getTopic(), serialize, shared);
  }

  const ros::Publisher& publisher() const
  {
    return publisher_;
  }
  std::uint32_t queueSize() const
  {
    return queue_size_;
  }
  MessageLedger::Counts counts() const
  {
    return ledger_->counts();
  }

private:
  ros::SerializedMessage track(ros::SerializedMessage message) const;

  ros::Publisher publisher_;
  std::uint32_t queue_size_ = 0;
  // Bytes may outlive this object in roscpp's queues.
  std::shared_ptr<MessageLedger> ledger_ = std::make_shared<MessageLedger>();
};

}  // namespace vibro_impact::graph
