#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vibro_impact/ros/recorded_run.h"
#include "vibro_impact/ros/recording_check.h"
#include "vibro_impact/ros/stream_rules.h"

namespace vibro_impact::graph
{
/// The first place where a recording and what is recomputed from it differ.
struct ReplayDifference
{
  std::string topic;
  std::string place;       ///< numbers of the block and the sample, or of the impact
  std::string field;       ///< as the message calls it
  std::string recorded;    ///< numbers with the 17 digits that tell any two apart
  std::string recomputed;  ///< likewise
};

/// What came of recomputing a recording.
struct ReplayReport
{
  std::optional<ReplayDifference> difference;  ///< nothing behind it has been compared

  // What is identical, bit for bit.
  std::uint64_t blocks = 0;   ///< of gap and contact force
  std::uint64_t samples = 0;  ///< of each
  std::uint64_t impacts = 0;

  std::uint64_t starts = 0;       ///< from rest
  std::uint64_t unannounced = 0;  ///< those of them aside from the rules of time: a reset, a pause, another simulator
  std::uint64_t bridged = 0;      ///< gaps of the excitation
  std::uint64_t refused = 0;      ///< blocks that the rules of the stream refuse
  std::uint64_t not_taken = 0;    ///< blocks that others show the simulator never had
  std::uint64_t contact_changes = 0;

  // What could not be compared.
  std::vector<Loss> losses;
  std::uint64_t impacts_not_compared = 0;

  bool complete() const
  {
    return losses.empty() && impacts_not_compared == 0;
  }
};

/// Recomputes gap, contact force and impacts from the excitation and the model_info of a recording, as a simulator with
/// these limits does, and compares every bit. Where the recording does not tell the motion (it begins in the middle of
/// a stream, something is lost) it goes on from the next start from rest. Where a motion began aside from the rules of
/// time (~reset, ~pause, a simulator that was started anew) stream_start says; in a recording without that topic, a
/// start from rest is tried where the answers do not fit. Throws config::Error if the recording is damaged or holds no
/// configuration.
ReplayReport checkReplay(const RecordedRun& recording, const StreamLimits& limits,
                         const RecordedRun::Progress& progress = {});

}  // namespace vibro_impact::graph
