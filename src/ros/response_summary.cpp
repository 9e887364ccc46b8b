#include "vibro_impact/ros/response_summary.h"

#include <algorithm>

namespace vibro_impact::graph
{
using diagnostic_msgs::DiagnosticStatus;

void ResponseSummary::Counter::take(std::uint64_t number, std::uint64_t count)
{
  if (started_ && number > next_)
  {
    missing_ += number - next_;
  }
  started_ = true;
  next_ = number + count;
  taken_ += count;
}

void ResponseSummary::add(const Gap& gap)
{
  gap_samples_.take(gap.seq, gap.gap.size());
  for (const double value : gap.gap)
  {
    smallest_gap_ = std::min(smallest_gap_, value);
  }
}

void ResponseSummary::add(const ContactForce& force)
{
  force_samples_.take(force.seq, force.force.size());
  for (const double value : force.force)
  {
    peak_force_ = std::max(peak_force_, value);
    samples_in_contact_ += value > 0.0 ? 1 : 0;
  }
}

void ResponseSummary::add(const Impact& impact)
{
  impacts_.take(impact.number, 1);
  impulse_ += impact.impulse;
  greatest_impulse_ = std::max(greatest_impulse_, impact.impulse);
  peak_force_ = std::max(peak_force_, impact.peak_force);
}

void ResponseSummary::report(diagnostic_updater::DiagnosticStatusWrapper& status)
{
  status.summary(DiagnosticStatus::OK, "listening");
  if (missing() > reported_missing_)
  {
    status.mergeSummary(DiagnosticStatus::WARN, "answers are missing");
  }
  reported_missing_ = missing();
  status.add("Samples of gap", gap_samples_.taken());
  status.add("Samples of gap missing", gap_samples_.missing());
  status.add("Samples of force", force_samples_.taken());
  status.add("Samples of force missing", force_samples_.missing());
  status.add("Impacts", impacts_.taken());
  status.add("Impacts missing", impacts_.missing());
  status.addf("Smallest gap (m)", "%.9g", smallest_gap_);
  status.addf("Share of samples in contact", "%.6f",
              force_samples_.taken() > 0
                  ? static_cast<double>(samples_in_contact_) / static_cast<double>(force_samples_.taken())
                  : 0.0);
  status.addf("Greatest force (N)", "%.9g", peak_force_);
  status.addf("Impulse of all impacts (N s)", "%.9g", impulse_);
  status.addf("Greatest impulse (N s)", "%.9g", greatest_impulse_);
}

}  // namespace vibro_impact::graph
