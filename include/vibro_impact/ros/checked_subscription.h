#pragma once

#include <cstdint>
#include <string>

#include <ros/message_event.h>
#include <ros/subscribe_options.h>
#include <ros/subscription_callback_helper.h>
#include <boost/make_shared.hpp>

#include "vibro_impact/ros/checked_stream.h"

namespace vibro_impact::graph
{
/// Has messages read by a CheckedStream. What is shorter than it says is dropped by roscpp, with an error in the log.
/// Messages from a publisher in the same process are passed on as they are.
template <typename Message>
class CheckedCallbackHelper : public ros::SubscriptionCallbackHelperT<const ros::MessageEvent<const Message>&>
{
public:
  using ros::SubscriptionCallbackHelperT<const ros::MessageEvent<const Message>&>::SubscriptionCallbackHelperT;

  ros::VoidConstPtr deserialize(const ros::SubscriptionCallbackHelperDeserializeParams& parameters) override
  {
    const auto message = boost::make_shared<Message>();
    CheckedStream stream(parameters.buffer, parameters.length);
    stream.next(*message);
    return message;
  }
};

/// To subscribe to a topic with such a helper.
template <typename Message>
ros::SubscribeOptions checkedSubscription(
    const std::string& topic, std::uint32_t queue_size,
    const boost::function<void(const ros::MessageEvent<const Message>&)>& callback)
{
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const ros::MessageEvent<const Message>&>(topic, queue_size, callback);
  options.helper = boost::make_shared<CheckedCallbackHelper<Message>>(callback);
  return options;
}

}  // namespace vibro_impact::graph
