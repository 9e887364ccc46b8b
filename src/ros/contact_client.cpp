#include "vibro_impact/ros/contact_client.h"

#include <utility>

#include <vibro_impact/SetContact.h>

namespace vibro_impact::graph
{
ContactClient::ContactClient(const ros::NodeHandle& node, std::string service)
    : node_(node), service_(std::move(service)), thread_([this] { work(); })
{
}

ContactClient::~ContactClient()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_ = true;
    client_.shutdown();  // ends a call that waits for its answer
  }
  change_.notify_one();
  thread_.join();
}

void ContactClient::ask(const core::ContactParameters& contact)
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    request_ = contact;
    answer_.reset();
  }
  change_.notify_one();
}

std::optional<ContactClient::Answer> ContactClient::take()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(answer_, std::nullopt);
}

void ContactClient::work()
{
  std::unique_lock<std::mutex> lock(mutex_);
  while (true)
  {
    change_.wait(lock, [this] { return end_ || request_; });
    if (end_)
    {
      return;
    }
    const core::ContactParameters contact = *request_;
    request_.reset();
    lock.unlock();
    Answer answer = call(contact);
    lock.lock();
    answer_ = std::move(answer);
  }
}

ContactClient::Answer ContactClient::call(const core::ContactParameters& contact)
{
  // A connection that is kept can be ended while it waits; one whose simulator has gone is of no use any more.
  ros::ServiceClient client = node_.serviceClient<SetContact>(service_, true);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (end_)
    {
      client.shutdown();
    }
    client_ = client;
  }
  SetContact service;
  service.request.stiffness = contact.stiffness;
  service.request.clearance = contact.clearance;
  service.request.seq = 0;
  if (!client.isValid() || !client.call(service))
  {
    return {false, "no answer from " + node_.resolveName(service_)};
  }
  return {service.response.success != 0, service.response.message};
}

}  // namespace vibro_impact::graph
