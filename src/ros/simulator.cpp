#include "vibro_impact/ros/simulator.h"

#include <exception>

#include <geometry_msgs/WrenchStamped.h>
#include <std_msgs/Float64.h>

#include "text.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/ros/conversions.h"

namespace vibro_impact::graph
{
namespace
{
/// Seconds between two words about a topic on which nothing comes.
constexpr double waiting_period = 5.0;

/// An impact is small and must not be lost: this holds minutes of them for a subscriber that hangs.
constexpr std::uint32_t impact_queue = 100000;
constexpr std::uint32_t mirror_queue = 100;

SimulatorParameters readParameters(const ros::NodeHandle& private_node)
{
  XmlRpc::XmlRpcValue tree;
  private_node.getParam(private_node.getNamespace(), tree);
  return parseSimulatorParameters(tree, private_node.getNamespace());
}
}  // namespace

Simulator::Simulator(ros::NodeHandle node, ros::NodeHandle private_node)
    : parameters_(readParameters(private_node)),
      simulation_(std::make_shared<const core::SwitchedModel>(parameters_.system), parameters_.limits),
      extremes_(parameters_.mirror_rate),
      guard_(parameters_.max_input_age),
      statistics_(node.resolveName("base_excitation"), parameters_.max_input_age),
      diagnostics_(node, private_node, private_node.getNamespace())
{
  const std::uint32_t queue_size = parameters_.queue_size;
  gap_publisher_ = node.advertise<Gap>("gap", queue_size);
  force_publisher_ = node.advertise<ContactForce>("contact_force", queue_size);
  impact_publisher_ = node.advertise<Impact>("impact", impact_queue);
  wrench_publisher_ = node.advertise<geometry_msgs::WrenchStamped>("contact_wrench", mirror_queue);
  gap_now_publisher_ = node.advertise<std_msgs::Float64>("gap_now", mirror_queue);
  model_info_publisher_ = node.advertise<ModelInfo>("model_info", StreamSimulation::max_waiting_changes, true);

  // The updater's own timing follows ros::Time, which stands still while a bag that gives the time is paused.
  diagnostics_.setHardwareID("none");
  diagnostics_.add("Simulation",
                   [this](diagnostic_updater::DiagnosticStatusWrapper& status)
                   {
                     const std::optional<double> age =
                         last_input_ ? std::optional<double>((ros::SteadyTime::now() - *last_input_).toSec())
                                     : std::nullopt;
                     statistics_.report(age, status);
                     report(simulation_.energyAccount(), status);
                   });
  diagnostic_timer_ = node.createWallTimer(ros::WallDuration(parameters_.diagnostic_period),
                                           [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });
  waiting_timer_ = node.createWallTimer(ros::WallDuration(waiting_period), &Simulator::onWaiting, this);

  reset_server_ = private_node.advertiseService("reset", &Simulator::onReset, this);
  set_contact_server_ = private_node.advertiseService("set_contact", &Simulator::onSetContact, this);
  excitation_subscriber_ =
      node.subscribe("base_excitation", queue_size, &Simulator::onExcitation, this, ros::TransportHints().tcpNoDelay());
  // The last of all: who has heard it finds the services and is heard.
  publishModelInfo(simulation_.model(), 0, ros::Time());
  // Also because roscpp's first line of the log registers the node anew: were it the last one, said to a newer node of
  // the same name that takes over, the master would have that one end as well.
  ROS_INFO("simulating what comes on topic %s", excitation_subscriber_.getTopic().c_str());
}

void Simulator::finish()
{
  publish(simulation_.reset());
}

void Simulator::onExcitation(const ros::MessageEvent<const BaseExcitation>& event)
{
  const ros::SteadyTime start = ros::SteadyTime::now();
  waiting_timer_.stop();
  last_input_ = start;
  const std::string& publisher = event.getPublisherName();
  try
  {
    if (!guard_.admit(publisher, excitation_subscriber_.getNumPublishers(), start.toSec()))
    {
      statistics_.countSecondPublisher(guard_.source(), publisher);
      ROS_ERROR_COND(publishers_.due(), "two publishers on topic %s: %s and %s; blocks of the second are refused",
                     excitation_subscriber_.getTopic().c_str(), guard_.source().c_str(), publisher.c_str());
      return;
    }
    fromMessage(*event.getConstMessage(), excitation_);
    const StreamSimulation::Answer& answer = simulation_.advance(excitation_);
    statistics_.count(answer, (ros::SteadyTime::now() - start).toSec());
    log(answer.verdict);
    publish(answer);
    // A node that computes hears nothing; that is no silence of the publisher's.
    last_input_ = ros::SteadyTime::now();
    guard_.listenAgain(last_input_->toSec());
  }
  catch (const std::exception& error)
  {
    ROS_ERROR_COND(losses_.due(), "a block of %s was lost: %s", publisher.c_str(), error.what());
  }
}

bool Simulator::onReset(std_srvs::Trigger::Request& /*request*/, std_srvs::Trigger::Response& response)
{
  const StreamSimulation::Answer& answer = simulation_.reset();
  statistics_.countReset(answer);
  publish(answer);
  response.success = true;
  response.message = answer.impacts.empty() ? "at rest" : "at rest; an open impact was cut short";
  return true;
}

bool Simulator::onSetContact(SetContact::Request& request, SetContact::Response& response)
{
  try
  {
    core::SystemParameters changed = parameters_.system;
    changed.contact = {request.stiffness, request.clearance};
    simulation_.setContact(std::make_shared<const core::SwitchedModel>(changed), request.seq);
    response.success = true;
    response.message =
        request.seq == 0 ? "holds from the next sample on" : text("holds from sample ", request.seq, " on");
  }
  catch (const std::exception& error)
  {
    response.success = false;
    response.message = error.what();
    ROS_ERROR_COND(contact_refusals_.due(), "contact not changed: %s", error.what());
  }
  return true;
}

void Simulator::onWaiting(const ros::WallTimerEvent& /*event*/)
{
  ROS_WARN("still waiting for data on topic %s ...", excitation_subscriber_.getTopic().c_str());
}

void Simulator::publish(const StreamSimulation::Answer& answer)
{
  for (const StreamSimulation::ContactChange& change : answer.contact_changes)
  {
    ++contact_changes_;
    publishModelInfo(*change.model, change.seq, toTime(change.stamp));
  }
  for (const StampedImpact& impact : answer.impacts)
  {
    toMessage(impact, impact_);
    impact_publisher_.publish(impact_);
  }
  if (answer.gap.values.empty())
  {
    return;
  }
  toMessage(answer.force, force_);
  force_publisher_.publish(force_);
  // The gap comes last: who has it knows that all of the block's answer is on its way.
  toMessage(answer.gap, gap_);
  gap_publisher_.publish(gap_);
  for (const Extremes& extremes : extremes_.take(answer.gap, answer.force))
  {
    geometry_msgs::WrenchStamped wrench;
    wrench.header.stamp = toTime(extremes.stamp);
    wrench.header.frame_id = base_frame;
    wrench.wrench.force.z = extremes.force;
    wrench_publisher_.publish(wrench);
    std_msgs::Float64 gap_now;
    gap_now.data = extremes.gap;
    gap_now_publisher_.publish(gap_now);
  }
}

void Simulator::publishModelInfo(const core::SwitchedModel& model, std::uint64_t seq, const ros::Time& stamp)
{
  core::SystemParameters system = parameters_.system;
  system.contact = {model.stiffness(), model.clearance()};
  ModelInfo info;
  toMessage(model, config::toYaml(system), VIBRO_IMPACT_VERSION, info);
  info.header.stamp = stamp;
  info.seq = seq;
  info.number = contact_changes_;
  model_info_publisher_.publish(info);
}

void Simulator::log(const Verdict& verdict)
{
  switch (verdict.action)
  {
    case Verdict::Action::Refuse:
      ROS_ERROR_COND(refusals_.due(), "block refused: %s", verdict.reason.c_str());
      break;
    case Verdict::Action::Bridge:
      ROS_WARN_COND(bridges_.due(), "bridged by a straight line: %s", verdict.reason.c_str());
      break;
    case Verdict::Action::Restart:
      ROS_WARN_COND(restarts_.due(), "restarted from rest: %s", verdict.reason.c_str());
      break;
    case Verdict::Action::Start:
    case Verdict::Action::Continue:
      break;
  }
}

}  // namespace vibro_impact::graph
