#include "vibro_impact/ros/output_queue.h"

namespace vibro_impact::graph
{
std::uint64_t MessageLedger::add()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  released_.push_back(false);
  ++counts_.waiting;
  return counts_.published++;
}

void MessageLedger::release(std::uint64_t number)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  released_[static_cast<std::size_t>(number - first_)] = true;
  --counts_.waiting;
  if (number != first_)
  {
    ++counts_.dropped;
  }
  while (!released_.empty() && released_.front())
  {
    released_.pop_front();
    ++first_;
  }
}

MessageLedger::Counts MessageLedger::counts() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return counts_;
}

ros::SerializedMessage OutputQueue::track(ros::SerializedMessage message) const
{
  // The same bytes, with another to tell when the last one lets go of them.
  message.buf.reset(message.buf.get(), [bytes = message.buf, ledger = ledger_, number = ledger_->add()](
                                           std::uint8_t* /*released*/) { ledger->release(number); });
  return message;
}

}  // namespace vibro_impact::graph
