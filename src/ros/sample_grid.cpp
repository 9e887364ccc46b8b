#include "vibro_impact/ros/sample_grid.h"

#include <algorithm>
#include <cmath>

#include "text.h"

namespace vibro_impact::graph
{
namespace
{
/// Two samples further apart than this lack some between them, sample periods.
constexpr double longest_interval = 1.5;
/// Stamps resolve a nanosecond, and the grid's times are rounded to it, ns.
constexpr Stamp resolution = 1;

double seconds(Stamp difference)
{
  return static_cast<double>(difference) / 1.0e9;
}
}  // namespace

SampleGrid::SampleGrid(const GridParameters& parameters, const StreamLimits& limits, const std::string& quantity)
    : parameters_(parameters), limits_(limits), quantity_(quantity)
{
  forget();
}

const SampleGrid::Answer& SampleGrid::take(Stamp stamp, double value)
{
  answer_.blocks.clear();
  answer_.refusal = fault(stamp, value);
  answer_.refused = answer_.refusal.empty() ? 0 : 1;
  if (answer_.refused != 0)
  {
    return answer_;
  }
  const double step = last_ ? seconds(stamp - last_->stamp) : 0.0;
  const double pause = std::max(max_pause, limits_.max_bridged_gap);
  if (!waiting_.empty() && (step < 0.0 || step > pause))
  {
    answer_.refusal =
        text("header.stamp jumps by ", step, " s while offset or sample_period are measured, may go on by ", pause,
             " s at most: ", waiting_.size(), " samples are given up");
    answer_.refused = waiting_.size();
    waiting_.clear();
  }
  if (step < 0.0)
  {
    forget();
  }
  last_ = {stamp, value};
  if (measuring())
  {
    measure();
  }
  else
  {
    place(*last_);
  }
  return answer_;
}

/// What is wrong with a sample; empty: nothing.
std::string SampleGrid::fault(Stamp stamp, double value) const
{
  // Written so that NaN fails, too.
  if (!(std::abs(value - offset_.value_or(0.0)) <= limits_.max_acceleration))
  {
    const std::string less = offset_.value_or(0.0) == 0.0 ? "" : text(", less the offset of ", *offset_, " m/s^2,");
    return text(quantity_, " is ", value, " m/s^2, must be finite and", less,
                " at most max_acceleration = ", limits_.max_acceleration, " m/s^2 in magnitude");
  }
  if (stamp <= 0)
  {
    return "header.stamp is zero, must be the time of the sample";
  }
  if (last_ && stamp <= last_->stamp && seconds(last_->stamp - stamp) <= limits_.max_step_back)
  {
    return text("header.stamp goes back by ", seconds(last_->stamp - stamp), " s, must go on");
  }
  return {};
}

/// The next sample begins the grid.
void SampleGrid::forget()
{
  period_ = parameters_.sample_period;
  offset_ = parameters_.offset;
  last_.reset();
  placed_.reset();
}

/// Lets the sample that was taken last wait, or puts all that wait on the grid.
void SampleGrid::measure()
{
  const bool full = waiting_.size() >= max_waiting_samples;
  const bool long_enough =
      offset_ || full ||
      (!waiting_.empty() && seconds(last_->stamp - waiting_.front().stamp) >= parameters_.offset_duration);
  const bool enough = period_ || waiting_.size() >= measured_intervals;
  if (!long_enough || !enough)
  {
    waiting_.push_back(*last_);
    return;
  }
  if (!offset_)
  {
    double sum = 0.0;
    for (const Sample& sample : waiting_)
    {
      sum += sample.value;
    }
    offset_ = sum / static_cast<double>(waiting_.size());
  }
  waiting_.push_back(*last_);
  if (!period_)
  {
    std::vector<Stamp> intervals(measured_intervals);
    for (std::size_t i = 0; i < measured_intervals; ++i)
    {
      intervals[i] = waiting_[i + 1].stamp - waiting_[i].stamp;
    }
    const auto median = intervals.begin() + measured_intervals / 2;
    std::nth_element(intervals.begin(), median, intervals.end());
    period_ = seconds(*median);
  }
  for (const Sample& sample : waiting_)
  {
    place(sample);
  }
  waiting_ = {};
}

/// Puts a sample on the grid, as far as the grid is known by it.
void SampleGrid::place(const Sample& sample)
{
  const Sample present{sample.stamp, sample.value - *offset_};
  if (!placed_)
  {
    anchor_ = present.stamp;
    anchor_seq_ = 0;
    next_ = 0;
  }
  else if (seconds(present.stamp - placed_->stamp) > longest_interval * *period_)
  {
    // Numbers in a double: exact for longer than a stream lasts. The first that is not before this sample:
    const double passed = std::ceil(seconds(present.stamp - resolution - anchor_) / *period_);
    const std::uint64_t first = std::max(next_, anchor_seq_ + static_cast<std::uint64_t>(std::max(0.0, passed)));
    if (static_cast<double>(first - next_) * *period_ > limits_.max_bridged_gap)
    {
      anchor_ = present.stamp;
      anchor_seq_ = first;
    }
    next_ = first;
    if (at(next_) - present.stamp <= resolution)
    {
      add(at(next_), present.value);
    }
    placed_ = present;
    return;
  }
  for (Stamp time = at(next_); time - present.stamp <= resolution; time = at(next_))
  {
    if (!placed_ || std::abs(time - present.stamp) <= resolution)
    {
      add(time, present.value);
      continue;
    }
    const double part =
        static_cast<double>(time - placed_->stamp) / static_cast<double>(present.stamp - placed_->stamp);
    add(time, placed_->value + part * (present.value - placed_->value));
  }
  placed_ = present;
}

/// The grid's next sample.
void SampleGrid::add(Stamp stamp, double value)
{
  if (answer_.blocks.empty() || answer_.blocks.back().seq + answer_.blocks.back().values.size() != next_)
  {
    answer_.blocks.push_back({stamp, next_, *period_, {}});
  }
  answer_.blocks.back().values.push_back(value);
  ++next_;
}

Stamp SampleGrid::at(std::uint64_t index) const
{
  return anchor_ + std::llround(static_cast<double>(index - anchor_seq_) * *period_ * 1.0e9);
}

}  // namespace vibro_impact::graph
