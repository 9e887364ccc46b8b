#include "vibro_impact/ros/simulator_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace vibro_impact::graph
{
using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;

namespace
{
/// More stretches of refused samples than this between two blocks that are taken are not told apart from lost ones.
constexpr std::size_t most_stretches = 1000;
}  // namespace

InputStatistics::InputStatistics(std::string topic, const DiagnosticThresholds& thresholds)
    : topic_(std::move(topic)), thresholds_(thresholds)
{
}

void InputStatistics::count(const Verdict& verdict, std::uint64_t seq, std::size_t samples)
{
  if (verdict.action == Verdict::Action::Refuse)
  {
    ++totals_.blocks_refused;
    totals_.samples_refused += samples;
    last_refusal_ = verdict.reason;
    noteRefused(seq, samples);
    return;
  }
  const std::uint64_t lost = verdict.missing - refusedWithin(seq - verdict.missing, seq);
  refused_.clear();
  ++totals_.blocks_accepted;
  totals_.samples_accepted += samples;
  totals_.samples_lost += lost;
  totals_.blocks_lost += lost / samples + (lost % samples != 0 ? 1 : 0);
  if (verdict.action == Verdict::Action::Bridge)
  {
    ++totals_.gaps_bridged;
    totals_.samples_bridged += verdict.missing;
  }
  if (verdict.action == Verdict::Action::Restart)
  {
    ++totals_.restarts;
  }
}

void InputStatistics::noteRefused(std::uint64_t seq, std::size_t samples)
{
  if (seq > std::numeric_limits<std::uint64_t>::max() - samples)
  {
    return;  // such numbers are never missing
  }
  if (!refused_.empty() && refused_.back().second == seq)
  {
    refused_.back().second += samples;
  }
  else if (refused_.size() < most_stretches)
  {
    refused_.emplace_back(seq, seq + samples);
  }
}

std::uint64_t InputStatistics::refusedWithin(std::uint64_t first, std::uint64_t end) const
{
  // In the order of the numbers, whatever order they came in, and each once.
  auto stretches = refused_;
  std::sort(stretches.begin(), stretches.end());
  std::uint64_t count = 0;
  for (const auto& [begin, stretch_end] : stretches)
  {
    const std::uint64_t from = std::max(begin, first);
    const std::uint64_t to = std::min(stretch_end, end);
    if (from < to)
    {
      count += to - from;
      first = to;
    }
  }
  return count;
}

void InputStatistics::countRefusal(const std::string& reason, std::uint64_t samples)
{
  totals_.blocks_refused += samples;
  totals_.samples_refused += samples;
  last_refusal_ = reason;
}

void InputStatistics::countSecondPublisher(const std::string& source, const std::string& second, std::size_t samples)
{
  ++totals_.blocks_refused;
  ++totals_.blocks_of_second_publisher;
  totals_.samples_refused += samples;
  publishers_ = source + " and " + second;
  last_refusal_ = "two publishers: " + publishers_;
}

void InputStatistics::countDiscarded(std::size_t samples)
{
  ++totals_.blocks_discarded;
  totals_.samples_discarded += samples;
}

void InputStatistics::report(std::optional<double> input_age, bool paused, DiagnosticStatusWrapper& status)
{
  status.summary(DiagnosticStatus::OK, "receiving");
  if (!input_age)
  {
    status.mergeSummary(DiagnosticStatus::STALE, "still waiting for data on topic " + topic_);
  }
  else if (*input_age > thresholds_.max_input_age)
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
  if (totals_.restarts > reported_.restarts)
  {
    status.mergeSummary(DiagnosticStatus::WARN, "restarted from rest");
  }
  const std::uint64_t lost = totals_.samples_lost - reported_.samples_lost;
  if (static_cast<double>(lost) > thresholds_.warn_lost_samples)
  {
    const bool bridged = totals_.restarts == reported_.restarts;
    status.mergeSummaryf(DiagnosticStatus::WARN, "%llu missing samples%s", static_cast<unsigned long long>(lost),
                         bridged ? " bridged" : "");
  }
  if (paused)
  {
    status.mergeSummary(DiagnosticStatus::WARN, "paused: blocks are discarded");
  }

  status.add("Blocks accepted", totals_.blocks_accepted);
  status.add("Blocks refused", totals_.blocks_refused);
  status.add("Blocks discarded", totals_.blocks_discarded);
  status.add("Blocks lost", totals_.blocks_lost);
  status.add("Samples accepted", totals_.samples_accepted);
  status.add("Samples refused", totals_.samples_refused);
  status.add("Samples discarded", totals_.samples_discarded);
  status.add("Samples lost", totals_.samples_lost);
  status.add("Samples bridged", totals_.samples_bridged);
  status.add("Gaps bridged", totals_.gaps_bridged);
  status.add("Restarts", totals_.restarts);
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

ComputingStatistics::ComputingStatistics(const DiagnosticThresholds& thresholds) : thresholds_(thresholds)
{
}

void ComputingStatistics::count(double stream_time, double computing_time)
{
  period_.stream_time += stream_time;
  period_.computing_time += computing_time;
  period_.worst_time = std::max(period_.worst_time, computing_time);
  period_.worst_load = std::max(period_.worst_load, computing_time / stream_time);
  worst_time_ = std::max(worst_time_, computing_time);
}

void ComputingStatistics::report(DiagnosticStatusWrapper& status)
{
  const bool computed = period_.computing_time > 0.0;
  if (computed)
  {
    reported_ = std::exchange(period_, {});
  }
  const double factor = reported_.computing_time > 0.0 ? reported_.stream_time / reported_.computing_time : 0.0;
  status.summary(DiagnosticStatus::OK, "faster than real time");
  if (!computed)
  {
    status.summary(DiagnosticStatus::OK, "nothing computed since the last report");
  }
  else if (factor < thresholds_.error_real_time_factor)
  {
    status.summaryf(DiagnosticStatus::ERROR, "real-time factor %.3g, below %.3g", factor,
                    thresholds_.error_real_time_factor);
  }
  else if (factor < thresholds_.warn_real_time_factor)
  {
    status.summaryf(DiagnosticStatus::WARN, "real-time factor %.3g, below %.3g", factor,
                    thresholds_.warn_real_time_factor);
  }
  if (computed && reported_.worst_load > thresholds_.warn_block_load)
  {
    status.mergeSummaryf(DiagnosticStatus::WARN, "a block took %.3g times the time it lasts", reported_.worst_load);
  }
  status.addf("Real-time factor", "%.4g", factor);
  status.addf("Worst block since last (s)", "%.3g", reported_.worst_time);
  status.addf("Worst block since last, share of its duration", "%.3g", reported_.worst_load);
  status.addf("Worst block (s)", "%.3g", worst_time_);
}

ModelStatistics::ModelStatistics(const DiagnosticThresholds& thresholds) : thresholds_(thresholds)
{
}

void ModelStatistics::count(const StreamSimulation::Answer& answer)
{
  totals_.impacts += answer.impacts.size();
  totals_.impacts_cut_short +=
      static_cast<std::uint64_t>(std::count_if(answer.impacts.begin(), answer.impacts.end(),
                                               [](const StampedImpact& impact) { return impact.impact.cut_short; }));
  totals_.contact_changes += answer.contact_changes.size();
  totals_.switch_limits += answer.switch_limits;
}

void ModelStatistics::countReset(const StreamSimulation::Answer& answer)
{
  ++totals_.resets;
  count(answer);
}

void ModelStatistics::report(const core::EnergyAccount& account, DiagnosticStatusWrapper& status)
{
  const double closure = account.closure();
  status.summary(DiagnosticStatus::OK, "simulating");
  if (totals_.switch_limits > reported_.switch_limits)
  {
    status.mergeSummary(DiagnosticStatus::ERROR, "bound on switches in a sample interval reached");
  }
  if (!(std::abs(closure) <= thresholds_.warn_energy_closure))
  {
    status.mergeSummaryf(DiagnosticStatus::WARN, "the energy account closes to %.2g only", closure);
  }
  status.add("Impacts", totals_.impacts);
  status.add("Impacts cut short", totals_.impacts_cut_short);
  status.add("Contact changes", totals_.contact_changes);
  status.add("Resets", totals_.resets);
  status.add("Switch limit reached", totals_.switch_limits);
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
      {"Energy account closes to", closure},
  };
  for (const auto& [name, value] : entries)
  {
    status.addf(name, "%.9g", value);
  }
  reported_ = totals_;
}

OutputQueueStatistics::OutputQueueStatistics(const std::vector<const OutputQueue*>& queues,
                                             const DiagnosticThresholds& thresholds)
    : thresholds_(thresholds)
{
  for (const OutputQueue* queue : queues)
  {
    queues_.emplace_back(queue, 0);
  }
}

void OutputQueueStatistics::report(DiagnosticStatusWrapper& status)
{
  status.summary(DiagnosticStatus::OK, "subscribers keep up");
  std::uint64_t dropped = 0;
  for (auto& [queue, reported] : queues_)
  {
    const std::string& topic = queue->publisher().getTopic();
    const MessageLedger::Counts counts = queue->counts();
    if (counts.dropped > reported)
    {
      status.mergeSummaryf(DiagnosticStatus::ERROR, "%llu messages on topic %s dropped for a subscriber that is slow",
                           static_cast<unsigned long long>(counts.dropped - reported), topic.c_str());
    }
    else if (queue->queueSize() > 0 &&
             static_cast<double>(counts.waiting) > thresholds_.warn_queue_share * queue->queueSize())
    {
      status.mergeSummaryf(DiagnosticStatus::WARN, "%llu messages on topic %s wait for a subscriber",
                           static_cast<unsigned long long>(counts.waiting), topic.c_str());
    }
    dropped += counts.dropped;
    reported = counts.dropped;
    status.add(topic + ": subscribers", queue->publisher().getNumSubscribers());
    status.add(topic + ": messages to other processes", counts.published);
    status.add(topic + ": messages waiting", counts.waiting);
    status.add(topic + ": messages dropped", counts.dropped);
  }
  status.add("Messages dropped", dropped);
}

}  // namespace vibro_impact::graph
