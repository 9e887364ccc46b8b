#include "vibro_impact/ros/simulator.h"

#include <cmath>
#include <exception>

#include <geometry_msgs/WrenchStamped.h>
#include <std_msgs/Float64.h>
#include <boost/make_shared.hpp>

#include "text.h"
#include "vibro_impact/config/configuration.h"
#include "vibro_impact/ros/conversions.h"

namespace vibro_impact::graph
{
namespace
{
/// roscpp sends in the background and drops at its end what it has not sent yet, s.
constexpr double linger = 0.3;

/// An impact is small and must not be lost: this holds minutes of them for a subscriber that hangs.
constexpr std::uint32_t impact_queue = 100000;
constexpr std::uint32_t mirror_queue = 100;

/// A picture of the motion may lose some of it.
constexpr std::uint32_t motion_queue = 100;

/// Rows of `motion` in a period of the lowest natural frequency: a drive at 1.5 to 4 times that, where the structures
/// knock against each other, has 16 to 43 in a cycle.
constexpr double rows_per_period = 64.0;

/// Rows per second that show all there is to see, Hz.
double automaticMotionRate(const core::SwitchedModel& model)
{
  constexpr double two_pi = 6.283185307179586;
  const Eigen::ArrayXd frequencies(model.free().frequency);
  for (const double frequency : frequencies)
  {
    if (frequency > 0.0)
    {
      return rows_per_period * frequency / two_pi;
    }
  }
  return rows_per_period * model.contact().frequency.maxCoeff() / two_pi;
}

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
      input_statistics_(node.resolveName("base_excitation"), parameters_.thresholds),
      computing_statistics_(parameters_.thresholds),
      queue_statistics_(queues(), parameters_.thresholds),
      model_statistics_(parameters_.thresholds),
      diagnostics_(node, private_node, private_node.getNamespace()),
      input_(parameters_, *this)
{
  const std::uint32_t queue_size = parameters_.queue_size;
  if (parameters_.input.kind != InputKind::block)
  {
    excitation_used_.advertise<BaseExcitation>(node, "excitation_used", queue_size);
  }
  gap_.advertise<Gap>(node, "gap", queue_size);
  force_.advertise<ContactForce>(node, "contact_force", queue_size);
  impact_.advertise<Impact>(node, "impact", impact_queue);
  motion_publisher_ = node.advertise<StructureMotion>("motion", motion_queue);
  wrench_publisher_ = node.advertise<geometry_msgs::WrenchStamped>("contact_wrench", mirror_queue);
  gap_now_publisher_ = node.advertise<std_msgs::Float64>("gap_now", mirror_queue);
  model_info_publisher_ = node.advertise<ModelInfo>("model_info", StreamSimulation::max_waiting_changes, true);
  stream_start_publisher_ = node.advertise<StreamStart>("stream_start", queue_size, true);

  addDiagnostics();
  diagnostic_timer_ = node.createWallTimer(ros::WallDuration(parameters_.diagnostic_period),
                                           [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });

  reset_server_ = private_node.advertiseService("reset", &Simulator::onReset, this);
  pause_server_ = private_node.advertiseService("pause", &Simulator::onPause, this);
  set_contact_server_ = private_node.advertiseService("set_contact", &Simulator::onSetContact, this);
  input_.subscribe(node);
  // The last of all: who has heard it finds the services and is heard.
  publishModelInfo(simulation_.model(), 0, ros::Time());
  // Also because roscpp's first line of the log registers the node anew: were it the last one, said to a newer node of
  // the same name that takes over, the master would have that one end as well.
  ROS_INFO("simulating what comes on topic %s", input_.topic().c_str());
}

void Simulator::addDiagnostics()
{
  using Status = diagnostic_updater::DiagnosticStatusWrapper;
  // The updater's own timing follows ros::Time, which stands still while a bag that gives the time is paused.
  diagnostics_.setHardwareID("none");
  diagnostics_.add("Input",
                   [this](Status& status)
                   {
                     input_statistics_.report(input_.age(), paused_, status);
                     input_.report(status);
                   });
  diagnostics_.add("Real-time factor", [this](Status& status) { computing_statistics_.report(status); });
  diagnostics_.add("Output queues", [this](Status& status) { queue_statistics_.report(status); });
  diagnostics_.add("Model", [this](Status& status) { model_statistics_.report(simulation_.energyAccount(), status); });
}

std::vector<const OutputQueue*> Simulator::queues() const
{
  std::vector<const OutputQueue*> queues = {&gap_, &force_, &impact_};
  if (parameters_.input.kind != InputKind::block)
  {
    queues.push_back(&excitation_used_);
  }
  return queues;
}

void Simulator::finish()
{
  // A callback that is running on another thread (a nodelet's) ends first.
  input_.shutdown();
  for (ros::ServiceServer* server : {&reset_server_, &pause_server_, &set_contact_server_})
  {
    server->shutdown();
  }
  publish(rest(StreamStart::RESET, "the stream ended"));
  ros::WallDuration(linger).sleep();
}

void Simulator::onExcitation(const Samples& excitation)
{
  const ros::SteadyTime start = ros::SteadyTime::now();
  const std::size_t samples = excitation.values.size();
  if (paused_)
  {
    input_statistics_.countDiscarded(samples);
    return;
  }
  simulation_.recordMotion(motionStep(excitation.sample_period));
  const StreamSimulation::Answer& answer = simulation_.advance(excitation);
  input_statistics_.count(answer.verdict, excitation.seq, samples);
  log(answer.verdict);
  if (answer.verdict.action == Verdict::Action::Refuse)
  {
    return;
  }
  model_statistics_.count(answer);
  if (parameters_.input.kind != InputKind::block)
  {
    const auto used = boost::make_shared<BaseExcitation>();
    toMessage(excitation, *used);
    excitation_used_.publish<BaseExcitation>(used);
  }
  publish(answer);
  const std::uint64_t bridged = answer.verdict.action == Verdict::Action::Bridge ? answer.verdict.missing : 0;
  computing_statistics_.count(static_cast<double>(bridged + samples) * excitation.sample_period,
                              (ros::SteadyTime::now() - start).toSec());
}

void Simulator::onRefusal(const std::string& reason, std::uint64_t samples)
{
  input_statistics_.countRefusal(reason, samples);
  ROS_ERROR_COND(refusals_.due(), "sample refused: %s", reason.c_str());
}

void Simulator::onSecondPublisher(const std::string& source, const std::string& second, std::size_t samples)
{
  input_statistics_.countSecondPublisher(source, second, samples);
  ROS_ERROR_COND(publishers_.due(), "two publishers on topic %s: %s and %s; blocks of the second are refused",
                 input_.topic().c_str(), source.c_str(), second.c_str());
}

const StreamSimulation::Answer& Simulator::rest(std::uint8_t cause, const std::string& reason)
{
  start_cause_ = cause;
  start_reason_ = reason;
  return simulation_.reset();
}

bool Simulator::onReset(std_srvs::Trigger::Request& /*request*/, std_srvs::Trigger::Response& response)
{
  const StreamSimulation::Answer& answer = rest(StreamStart::RESET, "reset");
  model_statistics_.countReset(answer);
  publish(answer);
  response.success = true;
  response.message = answer.impacts.empty() ? "at rest" : "at rest; an open impact was cut short";
  return true;
}

bool Simulator::onPause(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response)
{
  response.success = true;
  if (paused_ == (request.data != 0))
  {
    response.message = paused_ ? "paused already" : "not paused";
    return true;
  }
  paused_ = request.data != 0;
  response.message = "goes on from rest with the next block";
  if (paused_)
  {
    const StreamSimulation::Answer& answer = rest(StreamStart::PAUSE, "paused until then");
    model_statistics_.count(answer);
    publish(answer);
    response.message = answer.impacts.empty() ? "paused" : "paused; an open impact was cut short";
  }
  ROS_INFO("%s", response.message.c_str());
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

void Simulator::publish(const StreamSimulation::Answer& answer)
{
  for (const StreamSimulation::ContactChange& change : answer.contact_changes)
  {
    ++contact_changes_;
    publishModelInfo(*change.model, change.seq, toTime(change.stamp));
  }
  for (const StampedImpact& impact : answer.impacts)
  {
    const auto message = boost::make_shared<Impact>();
    toMessage(impact, *message);
    impact_.publish<Impact>(message);
  }
  if (answer.gap.values.empty())
  {
    return;
  }
  if (answer.verdict.action == Verdict::Action::Start || answer.verdict.action == Verdict::Action::Restart)
  {
    publishStart(answer);
  }
  publishMotion(answer);
  // New messages each time: subscribers in this process keep the ones that they were given.
  const auto force = boost::make_shared<ContactForce>();
  toMessage(answer.force, *force);
  force_.publish<ContactForce>(force);
  // The gap comes last: who has it knows that all of the block's answer is on its way.
  const auto gap = boost::make_shared<Gap>();
  toMessage(answer.gap, *gap);
  gap_.publish<Gap>(gap);
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

std::uint64_t Simulator::motionStep(double sample_period) const
{
  if (motion_publisher_.getNumSubscribers() == 0)
  {
    return 0;
  }
  const double rate =
      parameters_.motion_rate > 0.0 ? parameters_.motion_rate : automaticMotionRate(simulation_.model());
  // A period that makes no sense is refused with its block.
  const double step = 1.0 / (rate * sample_period);
  return step > 1.5 && step < 1.0e9 ? static_cast<std::uint64_t>(std::llround(step)) : 1;
}

void Simulator::publishMotion(const StreamSimulation::Answer& answer)
{
  if (!answer.motion.gap.empty())
  {
    const auto motion = boost::make_shared<StructureMotion>();
    toMessage(answer.motion, simulation_.model(), answer.gap.sample_period, *motion);
    motion_publisher_.publish(motion);
  }
}

void Simulator::publishStart(const StreamSimulation::Answer& answer)
{
  const bool restarted = answer.verdict.action == Verdict::Action::Restart;
  StreamStart start;
  start.header.stamp = toTime(answer.gap.stamp);
  start.header.frame_id = base_frame;
  start.seq = answer.gap.seq;
  start.sample_period = answer.gap.sample_period;
  start.number = starts_++;
  start.cause = restarted ? std::uint8_t{StreamStart::RULE} : start_cause_;
  start.reason = restarted ? answer.verdict.reason : start_reason_;
  stream_start_publisher_.publish(start);
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
