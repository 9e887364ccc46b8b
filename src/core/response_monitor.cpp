#include "vibro_impact/core/response_monitor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "vibro_impact/core/response.h"

namespace vibro_impact::core
{
namespace
{
bool isSound(const ReleasedImpact& impact)
{
  return std::isfinite(impact.impulse) && std::isfinite(impact.peak_force) && std::isfinite(impact.energy_lost) &&
         impact.duration >= 0.0 && impact.duration <= ResponseMonitor::longest;
}

// Written so that NaN fails, too.
bool isSound(const SampleBlock& block)
{
  const double duration = block.sample_period * static_cast<double>(block.count);
  return block.sample_period >= min_sample_period && block.sample_period <= max_sample_period &&
         seconds(block.stamp) + duration < end_of_time &&
         block.seq <= std::numeric_limits<std::uint64_t>::max() - block.count &&
         std::all_of(block.values, block.values + block.count, [](double value) { return std::isfinite(value); });
}

StreamTime distance(StreamTime one, StreamTime other)
{
  return one < other ? other - one : one - other;
}
}  // namespace

ResponseMonitor::ResponseMonitor(const MonitorOptions& options) : options_(options), histogram_(options.histogram)
{
  statistics_.histogram = histogram_.counts();
}

void ResponseMonitor::addImpact(const ReleasedImpact& impact)
{
  if (!isSound(impact))
  {
    ++refused_;
    return;
  }
  impact_counter_.take(impact.number, 1);
  peak_force_ = std::max(peak_force_, impact.peak_force);
  const bool left_behind = isLeftBehind(impact);
  const bool goes_back = last_impact_ && impact.release < last_impact_->release - max_step_back;
  if (!left_behind && goes_back && !impacts_behind_)
  {
    if (started_ && impact.release < end_ - max_step_back)
    {
      ahead_.emplace_back();
    }
    else
    {
      leaveImpacts();  // the time of the force does not go back with it: it is what came before that was out of order
    }
  }
  last_impact_ = impact;
  if (left_behind)
  {
    ++late_impacts_;
    total_.add(impact);
    return;
  }
  impacts_behind_ = false;
  if (!ahead_.empty())
  {
    ahead_.back().push_back(impact);
    return;
  }
  late_impacts_ += reported_ && impact.release <= *reported_ ? 1 : 0;
  impacts_.push_back(impact);
  newest_release_ = impact.release;
  fresh_ = true;
}

bool ResponseMonitor::isLeftBehind(const ReleasedImpact& impact) const
{
  return impacts_behind_ && impact.number > last_impact_->number &&
         impact.release >= last_impact_->release - max_step_back &&
         distance(impact.release, left_end_) < distance(impact.release, end_);
}

void ResponseMonitor::addGap(const SampleBlock& gap)
{
  if (!isSound(gap))
  {
    ++refused_;
    return;
  }
  gap_samples_.take(gap.seq, gap.count);
  for (std::size_t i = 0; i < gap.count; ++i)
  {
    smallest_gap_ = std::min(smallest_gap_, gap.values[i]);
  }
}

void ResponseMonitor::addExcitation(const SampleBlock& acceleration)
{
  if (!isSound(acceleration))
  {
    ++refused_;
    return;
  }
  excitation_.add(acceleration);
}

void ResponseMonitor::addForce(const SampleBlock& force)
{
  const double report_periods =
      force.sample_period * static_cast<double>(force.count) / seconds(options_.report_period);
  if (!isSound(force) || report_periods > most_reports_per_block)
  {
    ++refused_;
    return;
  }
  const bool another_stretch = started_ && (force.stamp < end_ - max_step_back || force.stamp > end_ + options_.window);
  while (another_stretch && fresh_)
  {
    closing_.push_back(report(std::min(next_report_, end_)));
  }
  if (!started_ || another_stretch)
  {
    beginStretch(force.stamp);
  }
  force_samples_.take(force.seq, force.count);
  takeForce(force);
  fresh_ = true;
}

void ResponseMonitor::takeForce(const SampleBlock& force)
{
  // Nothing is counted twice: what is before the end of the last block has been heard.
  const auto instant = [&](std::size_t sample)
  { return std::max(end_, force.stamp + nanoseconds(static_cast<double>(sample) * force.sample_period)); };
  heard_.add(instant(0), instant(force.count));
  total_heard_ += instant(force.count) - instant(0);
  for (std::size_t i = 0; i < force.count; ++i)
  {
    // A conjoined basis can pull: that is a contact, too.
    if (force.values[i] != 0.0)
    {
      contact_.add(instant(i), instant(i + 1));
      total_contact_ += instant(i + 1) - instant(i);
      peak_force_ = std::max(peak_force_, force.values[i]);
    }
  }
  end_ = instant(force.count);
}

const ResponseStatistics* ResponseMonitor::next(bool silent)
{
  if (!closing_.empty())
  {
    statistics_ = std::move(closing_.front());
    closing_.pop_front();
    return &statistics_;
  }
  if (silent && fresh_ && started_)
  {
    return &report(std::min(next_report_, end_));
  }
  // Impacts are in order: when those of the next stretch come, all of this one have.
  const bool complete = !ahead_.empty() || (newest_release_ && *newest_release_ > next_report_) ||
                        end_ - next_report_ >= options_.settling_time;
  return started_ && next_report_ <= end_ && complete ? &report(next_report_) : nullptr;
}

const ResponseStatistics& ResponseMonitor::report(StreamTime time)
{
  statistics_.time = time;
  statistics_.stretch = stretch_;
  for (; counted_ < impacts_.size() && impacts_[counted_].release <= time; ++counted_)
  {
    total_.add(impacts_[counted_]);
  }
  sumUp(time - options_.window);
  statistics_.drive_frequency = options_.drive_frequency > 0.0 ? options_.drive_frequency : excitation_.at(time);
  statistics_.period = period();

  const ArchardWear& wear = options_.wear;
  statistics_.total = total_;
  statistics_.total_time = seconds(total_heard_ - heard_.covered(time, end_));
  statistics_.total_contact_time = seconds(total_contact_ - contact_.covered(time, end_));
  statistics_.total_normal_work = wear.normalWork(total_);
  statistics_.wear_volume = wear.volume(total_);
  statistics_.wear_depth = wear.depth(total_);
  next_report_ += time == next_report_ ? options_.report_period : 0;
  reported_ = time;
  fresh_ = time < end_;
  return statistics_;
}

void ResponseMonitor::sumUp(StreamTime from)
{
  while (counted_ > 0 && impacts_.front().release <= from)
  {
    impacts_.pop_front();
    --counted_;
  }
  heard_.forget(from);
  contact_.forget(from);
  // Anew each time: what is added and taken off again leaves rounding errors behind.
  histogram_.clear();
  ImpactSums& sums = statistics_.sums;
  sums = {};
  for (std::size_t i = 0; i < counted_; ++i)
  {
    sums.add(impacts_[i]);
    if (!impacts_[i].cut_short)
    {
      histogram_.add(impacts_[i].impulse);
    }
  }
  statistics_.histogram = histogram_.counts();
  const StreamTime heard = heard_.covered(from, statistics_.time);
  statistics_.window = seconds(heard);
  statistics_.contact_duty = heard > 0 ? seconds(contact_.covered(from, statistics_.time)) / statistics_.window : 0.0;
  // Impacts are heard of also where samples of the force are missing: their sums are over all of the window.
  const StreamTime length = statistics_.time - std::max(from, stretch_begin_);
  const auto by_time = [length](double sum) { return length > 0 ? sum / seconds(length) : 0.0; };
  statistics_.impact_rate = by_time(static_cast<double>(sums.whole));
  statistics_.mean_force = by_time(sums.impulse);
  statistics_.impact_power = by_time(sums.energy_lost);
  statistics_.normal_work_rate = by_time(options_.wear.normalWork(sums));
  statistics_.wear_rate = by_time(options_.wear.volume(sums));
}

int ResponseMonitor::period() const
{
  if (!(statistics_.drive_frequency > 0.0))
  {
    return 0;
  }
  std::vector<TimedImpact> last;
  for (std::size_t i = counted_; i > 0 && last.size() < period_impacts; --i)
  {
    const ReleasedImpact& impact = impacts_[i - 1];
    if (impact.cut_short || (i < counted_ && impact.number + 1 != impacts_[i].number))
    {
      break;  // the motion began there, or something is missing
    }
    TimedImpact timed;
    timed.onset = seconds(impact.onset - statistics_.time);
    timed.impact.impulse = impact.impulse;
    last.push_back(timed);
  }
  std::reverse(last.begin(), last.end());
  ResponseOptions options;
  options.tolerance = options_.period_tolerance;
  return repetitionPeriod(last, 1.0 / statistics_.drive_frequency, options);
}

void ResponseMonitor::leaveImpacts()
{
  for (; counted_ < impacts_.size(); ++counted_)
  {
    total_.add(impacts_[counted_]);
  }
  impacts_.clear();
  counted_ = 0;
}

void ResponseMonitor::beginStretch(StreamTime stamp)
{
  if (started_ && stamp < end_)
  {
    ++steps_back_;
    leaveImpacts();
    newest_release_.reset();
    left_end_ = end_;
    impacts_behind_ = ahead_.empty() && last_impact_;
    if (!ahead_.empty())
    {
      impacts_ = std::move(ahead_.front());
      ahead_.pop_front();
      newest_release_ = impacts_.back().release;
    }
    heard_.clear();
    contact_.clear();
    reported_.reset();
  }
  started_ = true;
  ++stretch_;
  stretch_begin_ = stamp;
  end_ = stamp;
  next_report_ = stamp + options_.report_period;
}

}  // namespace vibro_impact::core
