#include "vibro_impact/ros/stream_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "text.h"

namespace vibro_impact::graph
{
namespace
{
Verdict refuse(const std::string& reason)
{
  return {Verdict::Action::Refuse, 0, reason};
}

Verdict restart(const std::string& reason, std::uint64_t missing = 0)
{
  return {Verdict::Action::Restart, missing, reason};
}
}  // namespace

StreamRules::StreamRules(const StreamLimits& limits) : limits_(limits)
{
}

std::string StreamRules::fault(const Samples& block) const
{
  if (block.values.empty())
  {
    return "acceleration is empty, must hold at least one sample";
  }
  if (block.values.size() > max_block_samples)
  {
    return text("acceleration holds ", block.values.size(), " samples, must hold at most ", max_block_samples);
  }
  // Written so that NaN fails, too.
  if (!(block.sample_period >= min_sample_period && block.sample_period <= max_sample_period))
  {
    return text("sample_period is ", block.sample_period, " s, must be in [", min_sample_period, ", ",
                max_sample_period, "] s");
  }
  if (block.stamp <= 0)
  {
    return "header.stamp is zero, must be the time of the first sample";
  }
  if (1.0e-9 * static_cast<double>(block.stamp) + static_cast<double>(block.values.size()) * block.sample_period >=
      core::end_of_time)
  {
    return text("header.stamp is ", 1.0e-9 * static_cast<double>(block.stamp), " s, so that the block of ",
                block.values.size(), " samples ends beyond the range of time stamps");
  }
  if (block.seq > std::numeric_limits<std::uint64_t>::max() - block.values.size())
  {
    return text("seq is ", block.seq, ", so that the count of samples overflows");
  }
  const auto bad = std::find_if(block.values.begin(), block.values.end(),
                                [this](double value) { return !(std::abs(value) <= limits_.max_acceleration); });
  if (bad != block.values.end())
  {
    return text("acceleration[", bad - block.values.begin(), "] is ", *bad,
                " m/s^2, must be finite and at most max_acceleration = ", limits_.max_acceleration,
                " m/s^2 in magnitude");
  }
  return {};
}

Verdict StreamRules::judge(const Samples& block) const
{
  const std::string found = fault(block);
  if (!found.empty())
  {
    return refuse(found);
  }
  if (!started_)
  {
    return {};
  }
  if (block.sample_period != sample_period_)
  {
    return restart(text("sample_period changed from ", sample_period_, " s to ", block.sample_period, " s"));
  }
  if (block.seq == 0 && block.stamp > last_stamp_)
  {
    return restart(text("seq is 0 and header.stamp went on: the publisher restarted (expected seq ", next_seq_, ")"));
  }

  const double deviation = clock_.deviation(block.seq, block.stamp);
  const double stamp_back = 1.0e-9 * static_cast<double>(last_stamp_ - block.stamp);
  const auto refuse_stamp = [&]
  {
    return refuse(
        text("header.stamp goes back by ", stamp_back, " s (at seq ", block.seq, ", expected ", next_seq_, ")"));
  };
  if (std::abs(deviation) > limits_.max_stamp_jitter)
  {
    if (stamp_back >= 0.0 && stamp_back <= limits_.max_step_back)
    {
      return refuse_stamp();
    }
    return restart(text("header.stamp jumped: it is ", deviation, " s off what seq ", block.seq,
                        " says, more than max_stamp_jitter = ", limits_.max_stamp_jitter, " s"));
  }
  if (block.seq < next_seq_)
  {
    const double back = static_cast<double>(next_seq_ - block.seq) * sample_period_;
    const std::string reason =
        text("seq is ", block.seq, " where ", next_seq_, " was expected: it goes back by ", back);
    return back <= limits_.max_step_back
               ? refuse(text(reason, " s"))
               : restart(text(reason, " s, more than max_step_back = ", limits_.max_step_back, " s"));
  }
  if (stamp_back >= 0.0)  // the count goes on, and jitter alone turns no stamps round
  {
    return refuse_stamp();
  }
  if (block.seq > next_seq_)
  {
    const std::uint64_t missing = block.seq - next_seq_;
    const double gap = static_cast<double>(missing) * sample_period_;
    const std::string reason = text(missing, " samples (", gap, " s) are missing before seq ", block.seq);
    return gap <= limits_.max_bridged_gap
               ? Verdict{Verdict::Action::Bridge, missing, reason}
               : restart(text(reason, ", more than max_bridged_gap = ", limits_.max_bridged_gap, " s"), missing);
  }
  return {Verdict::Action::Continue, 0, {}};
}

void StreamRules::take(const Samples& block, Verdict::Action action, bool episode_carried_over)
{
  if (action == Verdict::Action::Start || action == Verdict::Action::Restart)
  {
    clock_.start(block.seq, block.stamp, block.sample_period);
  }
  else
  {
    clock_.follow(block.seq, block.stamp, episode_carried_over);
  }
  started_ = true;
  sample_period_ = block.sample_period;
  next_seq_ = block.seq + block.values.size();
  last_stamp_ = block.stamp;
  last_sample_ = block.values.back();
}

void StreamRules::forget()
{
  started_ = false;
}

}  // namespace vibro_impact::graph
