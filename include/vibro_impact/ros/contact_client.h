#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <ros/ros.h>

#include "vibro_impact/core/parameters.h"

namespace vibro_impact::graph
{
/// Asks a simulator for another contact, on a thread of its own: a simulator that is busy, hangs or is not there holds
/// nobody up.
class ContactClient
{
public:
  struct Answer
  {
    bool success = false;
    std::string message;  ///< the simulator's, or why there is none
  };

  /// `service`: name of the simulator's set_contact.
  ContactClient(const ros::NodeHandle& node, std::string service);
  ContactClient(const ContactClient&) = delete;
  ContactClient& operator=(const ContactClient&) = delete;
  ~ContactClient();

  /// For a contact from the next sample on. Not before the last request has its answer.
  void ask(const core::ContactParameters& contact);

  /// The answer to the last request; once, and nothing before it is there.
  std::optional<Answer> take();

private:
  void work();
  Answer call(const core::ContactParameters& contact);

  ros::NodeHandle node_;
  std::string service_;
  std::mutex mutex_;  ///< of all below but the thread
  std::condition_variable change_;
  bool end_ = false;
  std::optional<core::ContactParameters> request_;
  std::optional<Answer> answer_;
  ros::ServiceClient client_;
  std::thread thread_;
};

}  // namespace vibro_impact::graph
