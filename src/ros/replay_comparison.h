#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>

#include <vibro_impact/Impact.h>

#include "vibro_impact/ros/replay_check.h"
#include "vibro_impact/ros/samples.h"
#include "vibro_impact/ros/stream_simulation.h"

namespace vibro_impact::graph
{
/// The first difference of two blocks, bit for bit. `field`: what the message calls its samples.
std::optional<ReplayDifference> compare(const std::string& topic, const std::string& field, const Samples& recorded,
                                        const Samples& recomputed);

/// The first difference of two impacts, bit for bit.
std::optional<ReplayDifference> compare(const std::string& topic, const Impact& recorded, const Impact& recomputed);

/// Puts the impacts of both sides together, whichever comes first. A run is the motion from one rest to the next: their
/// running numbers and those of their samples begin anew with each.
class ImpactComparison
{
public:
  explicit ImpactComparison(std::string topic);

  /// `block`: that of the release. `required`: it must be in the recording.
  void addRecomputed(std::uint64_t run, const StampedImpact& impact, std::size_t block, bool required);

  /// `block`: that of the onset.
  void addRecorded(std::uint64_t run, const Impact& impact, std::size_t block);

  /// What has found no counterpart. `judged(run, impact, block)`: whether the end of a recorded impact was recomputed.
  template <typename Judged>
  void finish(ReplayReport& report, const Judged& judged)
  {
    for (const auto& [key, entry] : recorded_)
    {
      const std::uint64_t run = std::get<0>(key);
      if (judged(run, entry.impact, entry.block))
      {
        finishRecorded(run, entry);
      }
      else
      {
        ++report.impacts_not_compared;
      }
    }
    noteMissing(report);
    report.impacts = identical_;
  }

  /// The one of the first block that has any.
  const std::optional<ReplayDifference>& difference() const
  {
    return difference_;
  }
  std::size_t differenceBlock() const
  {
    return difference_block_;
  }

private:
  struct Entry
  {
    Impact impact;
    std::size_t block = 0;
    bool required = true;
  };
  using Key = std::tuple<std::uint64_t, std::uint64_t, double>;  // run, seq, offset
  using Entries = std::multimap<Key, Entry>;

  void note(const std::optional<ReplayDifference>& found, std::size_t block);
  void finishRecorded(std::uint64_t run, const Entry& entry);
  void noteMissing(ReplayReport& report) const;

  std::string topic_;
  Entries recorded_, recomputed_;  // without a counterpart
  std::uint64_t identical_ = 0;
  std::optional<ReplayDifference> difference_;
  std::size_t difference_block_ = 0;
};

}  // namespace vibro_impact::graph
