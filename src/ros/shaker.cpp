#include "vibro_impact/ros/shaker.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <boost/make_shared.hpp>

#include "vibro_impact/core/quotient.h"
#include "vibro_impact/ros/conversions.h"
#include "vibro_impact/ros/progress.h"

namespace vibro_impact::graph
{
namespace
{
using Seconds = std::chrono::duration<double>;

// How long a call may wait before it looks whether it is to end, s.
constexpr double longest_wait = 0.1;
// Between two lines that say what is waited for, s.
constexpr double report_period = 5.0;
// A recorder takes in the messages of each topic by a queue of 100, from which it drops the oldest. So many on their
// way at once leave room for the next block.
constexpr std::uint64_t messages_on_their_way = 50;
// Between two looks whether they have arrived, s.
constexpr double arrival_period = 0.0005;
// A recorder that is never seen asleep is not waited for any longer than this, s.
constexpr double longest_recorder_wait = 5.0;

double since(std::chrono::steady_clock::time_point start)
{
  return Seconds(std::chrono::steady_clock::now() - start).count();
}

void append(std::string& list, const std::string& item)
{
  list += (list.empty() ? "" : ", ") + item;
}

ShakerParameters readParameters(const ros::NodeHandle& private_node)
{
  XmlRpc::XmlRpcValue tree;
  private_node.getParam(private_node.getNamespace(), tree);
  return parseShakerParameters(tree, private_node.getNamespace());
}

}  // namespace

Stamp sampleTime(Stamp start, std::uint64_t seq, double sample_rate)
{
  const core::Quotient seconds = core::divide(static_cast<double>(seq), sample_rate);
  return start + static_cast<Stamp>(seconds.whole) * 1000000000 + std::llround(1.0e9 * seconds.fraction);
}

Shaker::Shaker(ros::NodeHandle node, const ros::NodeHandle& private_node, const std::atomic<bool>& stop)
    : stop_(stop),
      parameters_(readParameters(private_node)),
      signal_(core::makeDriveSignal(parameters_.signal, parameters_.sample_rate)),
      reference_frequency_(core::referenceFrequency(parameters_.signal))
{
  if (!parameters_.remark.empty())
  {
    ROS_WARN_STREAM(parameters_.remark);
  }
  node.setCallbackQueue(&queue_);
  if (!parameters_.recorder.empty())
  {
    std::vector<std::string> topics;
    for (const std::string& topic : parameters_.recorded_topics)
    {
      topics.push_back(node.resolveName(topic));
    }
    recording_ = std::make_unique<Recording>(topics, node.resolveName(parameters_.recorder));
  }
  publisher_ = node.advertise<BaseExcitation>("base_excitation", parameters_.queue_size);
  if (parameters_.max_blocks_ahead > 0)
  {
    subscriber_ = node.subscribe("gap", 0, &Shaker::onGap, this, ros::TransportHints().tcpNoDelay());
  }
}

void Shaker::run()
{
  ROS_INFO_STREAM("shaking for " << toClock(static_cast<double>(signal_->samples()) / signal_->sampleRate())
                                 << " of stream time on " << publisher_.getTopic());
  waitWhile([this] { return missing(); }, longest_wait);
  if (!goesOn())
  {
    return;
  }
  stream();
  waitForArrival();
  pause(parameters_.linger);
  if (goesOn())
  {
    checkRecording();
    ROS_INFO_STREAM("published " << published_ << " samples" << (subscriber_ ? ", all of them answered" : "")
                                 << (recording_ ? ", all of them recorded by " + recording_->recorder() : ""));
  }
  else
  {
    ROS_INFO_STREAM("ended after " << published_ << " of " << signal_->samples() << " samples");
  }
}

bool Shaker::goesOn() const
{
  return !stop_ && ros::ok();
}

void Shaker::wait(double seconds)
{
  queue_.callAvailable(ros::WallDuration(std::min(seconds, longest_wait)));
}

void Shaker::pause(double seconds)
{
  const Clock::time_point start = Clock::now();
  for (double left = seconds; goesOn() && left > 0.0; left = seconds - since(start))
  {
    wait(left);
  }
}

std::string Shaker::missing()
{
  std::string list;
  if (!ros::Time::isValid())
  {
    append(list, "a clock (use_sim_time is set)");
  }
  const std::uint32_t subscribers = publisher_.getNumSubscribers();
  if (subscribers < parameters_.wait_for_subscribers)
  {
    append(list, "subscribers of " + publisher_.getTopic() + " (" + std::to_string(subscribers) + " of " +
                     std::to_string(parameters_.wait_for_subscribers) + " are there)");
  }
  if (subscriber_ && !isConnected(query_, subscriber_.getTopic(), ros::this_node::getName()))
  {
    append(list, "a publisher of " + subscriber_.getTopic());
  }
  if (recording_)
  {
    recording_->discover();
    deliveries_ = recording_->ask();
    for (const Delivery& delivery : deliveries_)
    {
      if (!delivery.ready())
      {
        append(list, recording_->recorder() + " to record " + delivery.topic);
      }
    }
  }
  return list;
}

std::string Shaker::pending()
{
  std::string list;
  if (unanswered() > 0)
  {
    append(list, "the answers to the last " + std::to_string(unanswered()) + " samples on " + subscriber_.getTopic());
  }
  else if (recording_)
  {
    deliveries_ = recording_->ask();
    for (const Delivery& delivery : deliveries_)
    {
      // A block counts as sent only when roscpp's own thread has taken it from the one that publishes.
      const bool sent = delivery.topic != publisher_.getTopic() || delivery.sent >= blocks_;
      if (!sent || !delivery.complete())
      {
        append(list, recording_->recorder() + " to receive " + delivery.topic);
      }
    }
  }
  return list;
}

void Shaker::waitWhile(const std::function<std::string()>& what, double period)
{
  const Clock::time_point start = Clock::now();
  double next_report = 1.0;
  for (std::string list = what(); goesOn() && !list.empty(); list = what())
  {
    const double waited = since(start);
    if (parameters_.timeout > 0.0 && waited > parameters_.timeout)
    {
      throw std::runtime_error("waited " + toClock(waited) + " in vain for " + list);
    }
    if (waited > next_report)
    {
      ROS_INFO_STREAM("waiting for " << list);
      next_report = waited + report_period;
    }
    wait(period);
  }
}

void Shaker::stream()
{
  block_.sample_period = signal_->samplePeriod();
  const std::uint64_t samples = signal_->samples();
  const Stamp start = fromTime(ros::Time::now());
  const Clock::time_point wall_start = Clock::now();
  last_answer_ = wall_start;
  earlier_deliveries_ = deliveries_;
  double next_report = parameters_.progress_period;
  while (published_ < samples)
  {
    const std::uint64_t count = std::min(parameters_.samplesPerBlock(), samples - published_);
    if (recording_ && published_ - round_start_ >= round_blocks_ * parameters_.samplesPerBlock())
    {
      waitForArrival();
      planRound();
    }
    waitForTurn(published_ + count, wall_start);
    if (!goesOn())
    {
      return;
    }
    publishBlock(count, start);
    if (parameters_.progress_period > 0.0 && (since(wall_start) >= next_report || published_ == samples))
    {
      const double wall_time = since(wall_start);
      ROS_INFO_STREAM(toText({static_cast<double>(published_) / signal_->sampleRate(),
                              static_cast<double>(samples) / signal_->sampleRate(), wall_time,
                              signal_->frequency(published_ - 1), reference_frequency_}));
      next_report = wall_time + parameters_.progress_period;
    }
  }
}

void Shaker::waitForTurn(std::uint64_t end, Clock::time_point start)
{
  const std::uint64_t window = parameters_.max_blocks_ahead * parameters_.samplesPerBlock();
  // Once without waiting, so that answers are heard however late the stream is.
  for (wait(0.0); goesOn();)
  {
    if (subscriber_ && end > answered_ + window)
    {
      if (parameters_.timeout > 0.0 && since(last_answer_) > parameters_.timeout)
      {
        throw std::runtime_error("no answer on " + subscriber_.getTopic() + " for " + toClock(since(last_answer_)) +
                                 ": " + std::to_string(published_) + " samples published, " +
                                 std::to_string(answered_) + " answered");
      }
      wait(longest_wait);
      continue;
    }
    const double due =
        parameters_.speed > 0.0 ? static_cast<double>(end) / (signal_->sampleRate() * parameters_.speed) : 0.0;
    const double early = due - since(start);
    if (early <= 0.0)
    {
      return;
    }
    wait(early);
  }
}

void Shaker::publishBlock(std::uint64_t count, Stamp start)
{
  block_.stamp = sampleTime(start, published_, signal_->sampleRate());
  block_.seq = published_;
  block_.values.resize(count);
  signal_->generate(published_, count, block_.values.data());
  // A new one each time: subscribers in this process keep the one that they were given.
  const auto message = boost::make_shared<BaseExcitation>();
  toMessage(block_, *message);
  publisher_.publish(message);
  published_ += count;
  ++blocks_;
}

void Shaker::onGap(const Gap& gap)
{
  const std::uint64_t end = gap.seq + gap.gap.size();
  if (gap.seq != answered_ || end > published_)
  {
    throw std::runtime_error("the answer on " + subscriber_.getTopic() + " is to samples " + std::to_string(gap.seq) +
                             " to " + std::to_string(end) + ": must be to those from " + std::to_string(answered_) +
                             " on, of " + std::to_string(published_) + " published");
  }
  answered_ = end;
  last_answer_ = Clock::now();
}

void Shaker::waitForArrival()
{
  waitWhile([this] { return pending(); }, arrival_period);
  const Clock::time_point start = Clock::now();
  while (goesOn() && recording_ && !recording_->isIdle() && since(start) < longest_recorder_wait)
  {
    wait(arrival_period);
  }
}

void Shaker::planRound()
{
  std::uint64_t most = 1;
  for (std::size_t i = 0; i < deliveries_.size(); ++i)
  {
    most = std::max(most, deliveries_[i].sent - std::min(deliveries_[i].sent, earlier_deliveries_[i].sent));
  }
  // As many blocks as the busiest topic allows, if it goes on like this; and not many more than just now, lest it does
  // not.
  round_blocks_ = std::clamp<std::uint64_t>(messages_on_their_way * round_blocks_ / most, 1, 2 * round_blocks_);
  round_start_ = published_;
  earlier_deliveries_ = deliveries_;
}

void Shaker::checkRecording()
{
  if (!recording_)
  {
    return;
  }
  std::string lost;
  deliveries_ = recording_->ask();
  for (const Delivery& delivery : deliveries_)
  {
    if (delivery.dropped > 0)
    {
      append(lost, std::to_string(delivery.dropped) + " messages on " + delivery.topic);
    }
    else if (!delivery.complete())
    {
      append(lost, "its connection to " + delivery.topic);
    }
  }
  if (!lost.empty())
  {
    throw std::runtime_error(recording_->recorder() + " has lost " + lost);
  }
}

std::uint64_t Shaker::unanswered() const
{
  return subscriber_ ? published_ - answered_ : 0;
}

}  // namespace vibro_impact::graph
