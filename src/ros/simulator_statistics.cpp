#include "vibro_impact/ros/simulator_statistics.h"

#include <utility>

namespace vibro_impact::graph
{
using diagnostic_msgs::DiagnosticStatus;

SimulatorStatistics::SimulatorStatistics(const std::string& topic, double max_input_age)
    : topic_(topic), max_input_age_(max_input_age)
{
}

void SimulatorStatistics::count(const StreamSimulation::Answer& answer, double computing_time)
{
  if (answer.verdict.action == Verdict::Action::Refuse)
  {
    ++totals_.blocks_refused;
    last_refusal_ = answer.verdict.reason;
    return;
  }
  const std::uint64_t samples = answer.gap.values.size();
  const std::uint64_t missing = answer.verdict.missing;
  ++totals_.blocks_accepted;
  totals_.samples_lost += missing;
  totals_.blocks_lost += missing / samples + (missing % samples != 0 ? 1 : 0);
  totals_.stream_time += static_cast<double>(samples) * answer.gap.sample_period;
  if (answer.verdict.action == Verdict::Action::Bridge)
  {
    ++totals_.gaps_bridged;
    totals_.samples_bridged += missing;
    totals_.stream_time += static_cast<double>(missing) * answer.gap.sample_period;
  }
  if (answer.verdict.action == Verdict::Action::Restart)
  {
    ++totals_.restarts;
  }
  totals_.impacts += answer.impacts.size();
  totals_.contact_changes += answer.contact_changes.size();
  totals_.switch_limits += answer.switch_limits;
  totals_.computing_time += computing_time;
}

void SimulatorStatistics::countSecondPublisher(const std::string& source, const std::string& second)
{
  ++totals_.blocks_refused;
  ++totals_.blocks_of_second_publisher;
  publishers_ = source + " and " + second;
  last_refusal_ = "two publishers: " + publishers_;
}

void SimulatorStatistics::countReset(const StreamSimulation::Answer& answer)
{
  ++totals_.resets;
  totals_.impacts += answer.impacts.size();
}

void SimulatorStatistics::report(std::optional<double> input_age, diagnostic_updater::DiagnosticStatusWrapper& status)
{
  const double computing_time = totals_.computing_time - reported_.computing_time;
  if (computing_time > 0.0)
  {
    real_time_factor_ = (totals_.stream_time - reported_.stream_time) / computing_time;
  }

  status.summary(DiagnosticStatus::OK, "simulating");
  if (!input_age)
  {
    status.mergeSummary(DiagnosticStatus::STALE, "still waiting for data on topic " + topic_);
  }
  else if (*input_age > max_input_age_)
  {
    status.mergeSummaryf(DiagnosticStatus::STALE, "no data on topic %s for %.1f s: time stands still", topic_.c_str(),
                         *input_age);
  }
  if (totals_.blocks_of_second_publisher > reported_.blocks_of_second_publisher)
  {
    status.mergeSummary(DiagnosticStatus::ERROR, "two publishers on topic " + topic_ + ": " + publishers_);
  }
  else if (totals_.blocks_refused > reported_.blocks_refused)
  {
    status.mergeSummary(DiagnosticStatus::ERROR, "block refused: " + last_refusal_);
  }
  if (totals_.switch_limits > reported_.switch_limits)
  {
    status.mergeSummary(DiagnosticStatus::ERROR, "bound on switches in a sample interval reached");
  }
  if (totals_.restarts > reported_.restarts)
  {
    status.mergeSummary(DiagnosticStatus::WARN, "restarted from rest");
  }
  if (totals_.gaps_bridged > reported_.gaps_bridged)
  {
    status.mergeSummary(DiagnosticStatus::WARN, "missing samples bridged");
  }
  if (computing_time > 0.0 && real_time_factor_ < 1.0)
  {
    status.mergeSummary(DiagnosticStatus::WARN, "slower than real time");
  }

  status.addf("Real-time factor", "%.4g", real_time_factor_);
  status.add("Blocks accepted", totals_.blocks_accepted);
  status.add("Blocks refused", totals_.blocks_refused);
  status.add("Blocks lost", totals_.blocks_lost);
  status.add("Samples lost", totals_.samples_lost);
  status.add("Gaps bridged", totals_.gaps_bridged);
  status.add("Samples bridged", totals_.samples_bridged);
  status.add("Restarts", totals_.restarts);
  status.add("Resets", totals_.resets);
  status.add("Impacts", totals_.impacts);
  status.add("Contact changes", totals_.contact_changes);
  status.add("Switch limit reached", totals_.switch_limits);
  if (input_age)
  {
    status.addf("Input age (s)", "%.3f", *input_age);
  }
  else
  {
    status.add("Input age (s)", "none");
  }
  status.add("Last refusal", last_refusal_.empty() ? "none" : last_refusal_);
  reported_ = totals_;
}

void report(const core::EnergyAccount& account, diagnostic_updater::DiagnosticStatusWrapper& status)
{
  const std::pair<const char*, double> entries[] = {
      {"Energy at the start (J)", account.initial},
      {"Energy in structure 1 (J)", account.structure1},
      {"Energy in structure 2 (J)", account.structure2},
      {"Energy in the spring (J)", account.spring},
      {"Energy in modes left out (J)", account.left_out},
      {"Work of the base (J)", account.work},
      {"Work of changes of the contact (J)", account.contact_work},
      {"Dissipated free (J)", account.dissipated_free},
      {"Dissipated in contact (J)", account.dissipated_contact},
      {"Lost by the mapping (J)", account.mapping_loss},
      {"Energy account closes to", account.closure()},
  };
  for (const auto& [name, value] : entries)
  {
    status.addf(name, "%.9g", value);
  }
}

}  // namespace vibro_impact::graph
