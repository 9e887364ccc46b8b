#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <ros/ros.h>

#include "vibro_impact/core/wear_feedback.h"
#include "vibro_impact/ros/contact_client.h"
#include "vibro_impact/ros/held_contact.h"
#include "vibro_impact/ros/monitor_parameters.h"

namespace vibro_impact::graph
{
/// Lets wear open the gap of a simulator: asks for what core::WearFeedback says, and reports what became of it.
class ContactFeedback
{
public:
  ContactFeedback(const ros::NodeHandle& node, const WearFeedbackParameters& parameters);

  /// The simulator holds another contact, or has begun anew.
  void hold(const HeldContact& held);

  /// `depth` has been worn at `time`, m.
  void wear(core::StreamTime time, double depth);

  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

private:
  core::WearFeedback feedback_;
  ContactClient client_;
  std::optional<double> clearance_;  ///< that the simulator holds, m
  double depth_ = 0.0;
  std::string refusal_;
  std::uint64_t reported_refused_ = 0;
};

}  // namespace vibro_impact::graph
