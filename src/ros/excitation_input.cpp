#include "vibro_impact/ros/excitation_input.h"

#include <exception>

#include <ros/message_traits.h>

#include "text.h"
#include "vibro_impact/ros/checked_subscription.h"
#include "vibro_impact/ros/conversions.h"
#include "vibro_impact/ros/node_query.h"

namespace vibro_impact::graph
{
namespace
{
/// Between two looks at the topic's type while nothing comes, s.
constexpr double waiting_period = 1.0;
/// Between two words about that, waiting periods.
constexpr int waiting_periods_per_line = 5;

std::size_t samplesIn(const BaseExcitation& message)
{
  return message.acceleration.size();
}

template <typename Message>
std::size_t samplesIn(const Message& /*message*/)
{
  return 1;
}

const char* typeOf(InputKind kind)
{
  switch (kind)
  {
    case InputKind::accel:
      return ros::message_traits::datatype<geometry_msgs::AccelStamped>();
    case InputKind::imu:
      return ros::message_traits::datatype<sensor_msgs::Imu>();
    default:
      return ros::message_traits::datatype<BaseExcitation>();
  }
}

}  // namespace

ExcitationInput::ExcitationInput(const SimulatorParameters& parameters, ExcitationSink& sink)
    : parameters_(parameters.input),
      queue_size_(parameters.queue_size),
      max_input_age_(parameters.thresholds.max_input_age),
      sink_(sink),
      guard_(parameters.thresholds.max_input_age),
      samples_(parameters.input, parameters.limits),
      type_(typeOf(parameters.input.kind))
{
}

template <typename Message>
void ExcitationInput::subscribeTo(ros::NodeHandle& node)
{
  ros::SubscribeOptions options = checkedSubscription<Message>(
      "base_excitation", queue_size_, [this](const ros::MessageEvent<const Message>& event) { onMessage(event); });
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  subscriber_ = node.subscribe(options);
}

void ExcitationInput::subscribe(ros::NodeHandle& node)
{
  topic_ = node.resolveName("base_excitation");
  checkType();
  switch (parameters_.kind)
  {
    case InputKind::block:
      subscribeTo<BaseExcitation>(node);
      break;
    case InputKind::accel:
      subscribeTo<geometry_msgs::AccelStamped>(node);
      break;
    case InputKind::imu:
      subscribeTo<sensor_msgs::Imu>(node);
      break;
  }
  waiting_timer_ = node.createWallTimer(ros::WallDuration(waiting_period), &ExcitationInput::onWaiting, this);
}

void ExcitationInput::shutdown()
{
  subscriber_.shutdown();
  waiting_timer_.stop();
}

std::optional<double> ExcitationInput::age() const
{
  return last_message_ ? std::optional<double>((ros::SteadyTime::now() - *last_message_).toSec()) : std::nullopt;
}

template <typename Message>
void ExcitationInput::onMessage(const ros::MessageEvent<const Message>& event)
{
  last_message_ = ros::SteadyTime::now();
  type_fault_.clear();
  ++received_;
  const std::string& publisher = event.getPublisherName();
  try
  {
    if (!guard_.admit(publisher, subscriber_.getNumPublishers(), last_message_->toSec()))
    {
      sink_.onSecondPublisher(guard_.source(), publisher, samplesIn(*event.getConstMessage()));
      return;
    }
    pass(*event.getConstMessage());
    // A node that computes hears nothing; that is no silence of the publisher's.
    last_message_ = ros::SteadyTime::now();
    guard_.listenAgain(last_message_->toSec());
  }
  catch (const std::exception& error)
  {
    ROS_ERROR_COND(losses_.due(), "a message of %s was lost: %s", publisher.c_str(), error.what());
  }
}

void ExcitationInput::pass(const BaseExcitation& message)
{
  fromMessage(message, excitation_);
  sink_.onExcitation(excitation_);
}

template <typename Message>
void ExcitationInput::pass(const Message& message)
{
  const SampleGrid& grid = samples_.grid();
  const bool was_measuring = grid.measuring();
  const SampleGrid::Answer& answer = samples_.take(message);
  if (answer.refused != 0)
  {
    sink_.onRefusal(answer.refusal, answer.refused);
  }
  if (was_measuring && !grid.measuring())
  {
    ROS_INFO("sample period %.9g s, offset %.9g m/s^2", *grid.samplePeriod(), *grid.offset());
  }
  for (const Samples& block : answer.blocks)
  {
    sink_.onExcitation(block);
  }
}

void ExcitationInput::onWaiting(const ros::WallTimerEvent& /*event*/)
{
  const std::optional<double> silence = age();
  if (silence && *silence <= max_input_age_)
  {
    return;
  }
  checkType();
  if (silence || ++times_waited_ % waiting_periods_per_line != 0)
  {
    return;
  }
  if (type_fault_.empty())
  {
    ROS_WARN("still waiting for data on topic %s ...", topic_.c_str());
  }
  else
  {
    ROS_ERROR("still waiting for data: %s", type_fault_.c_str());
  }
}

void ExcitationInput::checkType()
{
  const std::string found = findPublishedType(topic_);
  std::string fault;
  if (!found.empty() && found != "*" && found != type_)
  {
    std::string cure = text("remap base_excitation to a topic of type ", type_, " or choose another ~input");
    for (const InputKind kind : {InputKind::block, InputKind::accel, InputKind::imu})
    {
      if (found == typeOf(kind))
      {
        cure = text("set ~input to ", nameOf(kind));
      }
    }
    fault = text("topic ", topic_, " has type ", found, ", ~input is ", nameOf(parameters_.kind), ": ", cure);
  }
  if (!fault.empty() && fault != type_fault_)
  {
    ROS_ERROR("%s", fault.c_str());
  }
  type_fault_ = fault;
}

void ExcitationInput::report(diagnostic_updater::DiagnosticStatusWrapper& status) const
{
  using diagnostic_msgs::DiagnosticStatus;
  if (!type_fault_.empty())
  {
    status.summary(DiagnosticStatus::ERROR, type_fault_);  // says more than that nothing comes
  }
  status.add("Input", nameOf(parameters_.kind));
  status.add("Messages received", received_);
  if (parameters_.kind != InputKind::block)
  {
    const auto measured = [&status](const char* key, const std::optional<double>& value)
    {
      if (value)
      {
        status.addf(key, "%.9g", *value);
      }
      else
      {
        status.add(key, "being measured");
      }
    };
    measured("Sample period (s)", samples_.grid().samplePeriod());
    measured("Offset (m/s^2)", samples_.grid().offset());
    status.add("Frame", samples_.frameId().value_or("not known yet"));
  }
}

}  // namespace vibro_impact::graph
