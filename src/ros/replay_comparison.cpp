#include "replay_comparison.h"

#include <algorithm>
#include <cstring>
#include <sstream>
#include <utility>

#include "text.h"
#include "vibro_impact/ros/conversions.h"

namespace vibro_impact::graph
{
namespace
{
std::string digits(double value)
{
  std::ostringstream stream;
  stream.precision(17);
  stream << value;
  return stream.str();
}

std::string digits(std::uint64_t value)
{
  return std::to_string(value);
}

std::string digits(bool value)
{
  return value ? "true" : "false";
}

std::string digits(const ros::Time& value)
{
  return text(value);
}

std::uint64_t bits(double value)
{
  std::uint64_t result = 0;
  std::memcpy(&result, &value, sizeof result);
  return result;
}

bool identical(double a, double b)
{
  return bits(a) == bits(b);  // also tells zeros and NaNs apart
}

template <typename Value>
bool identical(const Value& a, const Value& b)
{
  return a == b;
}

template <typename Value>
std::optional<ReplayDifference> compare(const std::string& topic, const std::string& place, const std::string& field,
                                        const Value& recorded, const Value& recomputed)
{
  if (identical(recorded, recomputed))
  {
    return std::nullopt;
  }
  return ReplayDifference{topic, place, field, digits(recorded), digits(recomputed)};
}
}  // namespace

std::optional<ReplayDifference> compare(const std::string& topic, const std::string& field, const Samples& recorded,
                                        const Samples& recomputed)
{
  const std::string block = text("block of seq ", recorded.seq);
  auto difference = compare(topic, block, "seq", recorded.seq, recomputed.seq);
  difference =
      difference ? difference : compare(topic, block, "header.stamp", toTime(recorded.stamp), toTime(recomputed.stamp));
  difference = difference ? difference
                          : compare(topic, block, "sample_period", recorded.sample_period, recomputed.sample_period);
  difference = difference ? difference
                          : compare(topic, block, "number of samples", std::uint64_t{recorded.values.size()},
                                    std::uint64_t{recomputed.values.size()});
  for (std::size_t i = 0; i < recorded.values.size() && !difference; ++i)
  {
    if (!identical(recorded.values[i], recomputed.values[i]))
    {
      difference = compare(topic, text(block, ", sample ", recorded.seq + i), text(field, "[", i, "]"),
                           recorded.values[i], recomputed.values[i]);
    }
  }
  return difference;
}

std::optional<ReplayDifference> compare(const std::string& topic, const Impact& recorded, const Impact& recomputed)
{
  const std::string place = text("number ", recorded.number, " (seq ", recorded.seq, ")");
  std::optional<ReplayDifference> difference;
  const auto field = [&](const char* name, const auto& a, const auto& b)
  {
    if (!difference)
    {
      difference = compare(topic, place, name, a, b);
    }
  };
  field("number", recorded.number, recomputed.number);
  field("seq", recorded.seq, recomputed.seq);
  field("offset", recorded.offset, recomputed.offset);
  field("header.stamp", recorded.header.stamp, recomputed.header.stamp);
  field("duration", recorded.duration, recomputed.duration);
  field("impulse", recorded.impulse, recomputed.impulse);
  field("peak_force", recorded.peak_force, recomputed.peak_force);
  field("peak_time", recorded.peak_time, recomputed.peak_time);
  field("approach_speed", recorded.approach_speed, recomputed.approach_speed);
  field("separation_speed", recorded.separation_speed, recomputed.separation_speed);
  field("energy_lost", recorded.energy_lost, recomputed.energy_lost);
  field("cut_short", recorded.cut_short != 0, recomputed.cut_short != 0);
  field("dissipated", recorded.dissipated, recomputed.dissipated);
  field("mapping_loss", recorded.mapping_loss, recomputed.mapping_loss);
  field("base_work", recorded.base_work, recomputed.base_work);
  return difference;
}

ImpactComparison::ImpactComparison(std::string topic) : topic_(std::move(topic))
{
}

void ImpactComparison::addRecomputed(std::uint64_t run, const StampedImpact& impact, std::size_t block, bool required)
{
  Entry entry;
  toMessage(impact, entry.impact);
  entry.block = block;
  entry.required = required;
  const Key key{run, entry.impact.seq, entry.impact.offset};
  const auto recorded = recorded_.find(key);
  if (recorded == recorded_.end())
  {
    recomputed_.emplace(key, entry);
    return;
  }
  note(compare(topic_, recorded->second.impact, entry.impact), recorded->second.block);
  recorded_.erase(recorded);
}

void ImpactComparison::addRecorded(std::uint64_t run, const Impact& impact, std::size_t block)
{
  const Key key{run, impact.seq, impact.offset};
  const auto recomputed = recomputed_.find(key);
  if (recomputed == recomputed_.end())
  {
    recorded_.emplace(key, Entry{impact, block, true});
    return;
  }
  note(compare(topic_, impact, recomputed->second.impact), block);
  recomputed_.erase(recomputed);
}

void ImpactComparison::note(const std::optional<ReplayDifference>& found, std::size_t block)
{
  if (!found)
  {
    ++identical_;
  }
  else if (!difference_ || block < difference_block_)
  {
    difference_ = found;
    difference_block_ = block;
  }
}

/// One whose seq or offset is another one is told by its number.
void ImpactComparison::finishRecorded(std::uint64_t run, const Entry& entry)
{
  const auto same =
      std::find_if(recomputed_.begin(), recomputed_.end(),
                   [&](const auto& other)
                   { return std::get<0>(other.first) == run && other.second.impact.number == entry.impact.number; });
  if (same != recomputed_.end())
  {
    note(compare(topic_, entry.impact, same->second.impact), entry.block);
    recomputed_.erase(same);
    return;
  }
  note(ReplayDifference{topic_, text("number ", entry.impact.number, " (seq ", entry.impact.seq, ")"), "number",
                        digits(entry.impact.number), "no such impact"},
       entry.block);
}

void ImpactComparison::noteMissing(ReplayReport& report) const
{
  const Entry* first = nullptr;
  const Entry* last = nullptr;
  std::uint64_t count = 0;
  std::uint64_t run = 0;
  const auto flush = [&]
  {
    if (count > 0)
    {
      report.losses.push_back({first->impact.seq, last->impact.seq + 1,
                               text("topic ", topic_, ": number ", first->impact.number, " to ", last->impact.number,
                                    " (", count, count == 1 ? " impact" : " impacts", ", seq ", first->impact.seq,
                                    " to ", last->impact.seq, ") is missing")});
    }
    count = 0;
  };
  for (const auto& [key, entry] : recomputed_)
  {
    if (!entry.required)
    {
      continue;
    }
    if (count > 0 && (std::get<0>(key) != run || entry.impact.number != last->impact.number + 1))
    {
      flush();
    }
    first = count == 0 ? &entry : first;
    last = &entry;
    run = std::get<0>(key);
    ++count;
  }
  flush();
}

}  // namespace vibro_impact::graph
