#include "vibro_impact/ros/contact_feedback.h"

namespace vibro_impact::graph
{
using diagnostic_msgs::DiagnosticStatus;

ContactFeedback::ContactFeedback(const ros::NodeHandle& node, const WearFeedbackParameters& parameters)
    : feedback_(parameters.limits), client_(node, parameters.simulator + "/set_contact")
{
}

void ContactFeedback::hold(const HeldContact& held)
{
  clearance_ = held.contact()->clearance;
  feedback_.hold(*held.contact(), held.unchanged());
}

void ContactFeedback::wear(core::StreamTime time, double depth)
{
  depth_ = depth;
  const auto answer = client_.take();
  if (answer && !answer->success)
  {
    feedback_.refuse();
    refusal_ = answer->message;
  }
  if (const auto contact = feedback_.ask(time, depth))
  {
    client_.ask(*contact);
  }
}

void ContactFeedback::report(diagnostic_updater::DiagnosticStatusWrapper& status)
{
  status.summary(DiagnosticStatus::OK, clearance_ ? "wear opens the gap" : "no model_info yet");
  if (feedback_.refused() > reported_refused_)
  {
    status.mergeSummary(DiagnosticStatus::WARN, "a change of the contact was refused");
  }
  reported_refused_ = feedback_.refused();
  status.add("Changes asked for", feedback_.asked());
  status.add("Changes taken", feedback_.taken());
  status.add("Changes refused", feedback_.refused());
  status.add("Last refusal", refusal_.empty() ? "none" : refusal_);
  status.addf("Clearance unworn (m)", "%.17g", feedback_.unworn());
  status.addf("Clearance (m)", "%.17g", clearance_.value_or(0.0));
  status.addf("Depth handed over (m)", "%.17g", feedback_.handedOver());
  status.addf("Depth to hand over (m)", "%.17g", depth_ - feedback_.handedOver());
}

}  // namespace vibro_impact::graph
