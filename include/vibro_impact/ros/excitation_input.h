#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <geometry_msgs/AccelStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/Imu.h>
#include <vibro_impact/BaseExcitation.h>

#include "vibro_impact/ros/log_throttle.h"
#include "vibro_impact/ros/sensor_samples.h"
#include "vibro_impact/ros/simulator_parameters.h"
#include "vibro_impact/ros/source_guard.h"

namespace vibro_impact::graph
{
/// Who is told what comes in.
class ExcitationSink
{
public:
  virtual ~ExcitationSink() = default;
  /// A block that came, or that single samples make; not judged yet.
  virtual void onExcitation(const Samples& block) = 0;
  /// So many single samples were refused, and why.
  virtual void onRefusal(const std::string& reason, std::uint64_t samples) = 0;
  /// A message of `second` with so many samples was refused: `source` is there.
  virtual void onSecondPublisher(const std::string& source, const std::string& second, std::size_t samples) = 0;
};

/// The excitation from the graph: subscribes to `base_excitation` with the type of the source chosen, and passes on
/// blocks of base acceleration, whatever that is.
///
/// While nothing comes it says what it waits for, and looks whether the topic has another type.
class ExcitationInput
{
public:
  /// `sink` must outlive it.
  ExcitationInput(const SimulatorParameters& parameters, ExcitationSink& sink);

  /// From now on the sink is told.
  void subscribe(ros::NodeHandle& node);

  /// The sink is told nothing any more, once a callback that is running on another thread has ended.
  void shutdown();

  /// Resolved name.
  const std::string& topic() const
  {
    return topic_;
  }
  /// Wall time since the last message, s; nothing before the first.
  std::optional<double> age() const;

  /// How many messages have come, what is known of them, and whether the topic has another type.
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) const;

private:
  template <typename Message>
  void subscribeTo(ros::NodeHandle& node);
  template <typename Message>
  void onMessage(const ros::MessageEvent<const Message>& event);
  void pass(const BaseExcitation& message);
  template <typename Message>
  void pass(const Message& message);
  void onWaiting(const ros::WallTimerEvent& event);
  void checkType();

  InputParameters parameters_;
  std::uint32_t queue_size_;
  double max_input_age_;
  ExcitationSink& sink_;
  SourceGuard guard_;
  SensorSamples samples_;
  std::string topic_;
  std::string type_;        ///< of the messages subscribed to
  std::string type_fault_;  ///< of the topic, as long as nothing comes
  std::uint64_t received_ = 0;
  int times_waited_ = 0;
  std::optional<ros::SteadyTime> last_message_;
  LogThrottle losses_;
  Samples excitation_;  ///< a buffer, so that a block allocates nothing once the largest has been seen
  ros::Subscriber subscriber_;
  ros::WallTimer waiting_timer_;
};

}  // namespace vibro_impact::graph
