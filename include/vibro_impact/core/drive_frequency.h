#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "vibro_impact/core/sample_block.h"

namespace vibro_impact::core
{
/// Frequency of a periodic drive, from the instants at which its acceleration rises through zero.
class DriveFrequency
{
public:
  /// The last cycles from which the frequency is taken: twice the longest period that is looked for.
  static constexpr std::size_t cycles = 32;
  /// Cycles that differ by more than this share from their mean are of no steady periodic drive.
  static constexpr double steadiness = 0.01;

  /// The next samples; those that do not follow the last ones (`seq`) begin anew.
  void add(const SampleBlock& acceleration);

  /// Of the last cycles that end at `time` or before; 0 for fewer than 3 and for cycles that differ, Hz.
  double at(StreamTime time) const;

private:
  std::uint64_t next_seq_ = 0;
  double last_ = 0.0;
  std::deque<StreamTime> crossings_;
};

}  // namespace vibro_impact::core
