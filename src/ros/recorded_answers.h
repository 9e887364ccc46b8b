#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "recorded_starts.h"
#include "vibro_impact/ros/recorded_run.h"
#include "vibro_impact/ros/recording_check.h"

namespace vibro_impact::graph
{
/// The heads of all blocks of a recording, and which answer belongs to which block of excitation: the numbers of
/// samples alone do not tell, as a stream that begins anew counts the same ones again.
class RecordedAnswers
{
public:
  /// What a block of excitation without an answer has for one.
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  /// Reads the recording.
  RecordedAnswers(const RecordedRun& recording, const RecordedRun::Progress& progress);

  /// Of excitation, in the order of recording.
  const std::vector<BlockHead>& excitation() const
  {
    return excitation_;
  }
  /// The block of excitation that the n-th gap answers, or `none`.
  std::size_t ofGap(std::size_t n) const
  {
    return of_gap_[n];
  }
  std::size_t ofForce(std::size_t n) const
  {
    return of_force_[n];
  }
  bool hasGap(std::size_t block) const
  {
    return has_gap_[block];
  }
  bool hasForce(std::size_t block) const
  {
    return has_force_[block];
  }

  /// The start from rest with a block, or nothing.
  const RecordedStart* startOf(std::size_t block) const
  {
    const auto found = starts_.find(block);
    return found == starts_.end() ? nullptr : &found->second;
  }

  /// The block of excitation in which, or after which, sample `seq` of this time lies, as near to block `hint` as
  /// possible; `none` if the recording has no such stretch.
  std::size_t blockOf(std::uint64_t seq, const ros::Time& stamp, std::size_t hint) const;
  /// The block that follows `block` in its stretch and holds sample `seq` or is the first after it, or `none`.
  std::size_t blockAfter(std::size_t block, std::uint64_t seq) const;

  /// Answers without their block of excitation.
  const std::vector<Loss>& unasked() const
  {
    return unasked_;
  }
  /// Whether the recording's last answers are such ones.
  bool endsUnasked() const
  {
    return ends_unasked_;
  }

private:
  std::vector<std::size_t> match(const std::vector<PlacedBlock>& questions, const std::vector<PlacedBlock>& answers,
                                 std::vector<bool>& answered) const;
  void findUnasked(const std::vector<PlacedBlock>& gaps, const std::vector<PlacedBlock>& forces);
  void findStretches();

  std::vector<BlockHead> excitation_;
  std::vector<std::size_t> of_gap_, of_force_;
  std::vector<bool> has_gap_, has_force_;
  std::map<std::size_t, RecordedStart> starts_;
  std::vector<std::size_t> stretches_;  // first blocks of stretches in which the numbers ascend
  std::vector<Loss> unasked_;
  bool ends_unasked_ = false;
};

}  // namespace vibro_impact::graph
