#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <vibro_impact/BaseExcitation.h>
#include <vibro_impact/Impact.h>
#include <vibro_impact/ModelInfo.h>
#include <vibro_impact/StreamStart.h>

#include "vibro_impact/ros/recorded_run.h"

namespace vibro_impact::graph
{
/// A block, and its place in a recording.
struct PlacedBlock
{
  BlockHead head;
  std::uint64_t position = 0;  ///< among all messages
  bool repeats = false;        ///< the block before it, sample for sample
};

/// A stream_start, and its place in a recording.
struct PlacedStart
{
  StreamStart start;
  std::uint64_t position = 0;  ///< among all messages
};

/// Collects all blocks and starts of a recording with their places.
class PlacingReader : public RecordingSink
{
public:
  void onExcitation(const BaseExcitation& block) override
  {
    const bool repeats =
        block.seq == last_.seq && block.header.stamp == last_.header.stamp && block.acceleration == last_.acceleration;
    excitation.push_back(
        {{block.seq, block.acceleration.size(), block.header.stamp, block.sample_period}, next_++, repeats});
    last_ = block;
  }
  void onGap(const BlockHead& block, const std::vector<double>& /*gap*/) override
  {
    gaps.push_back({block, next_++, false});
  }
  void onContactForce(const BlockHead& block, const std::vector<double>& /*force*/) override
  {
    forces.push_back({block, next_++, false});
  }
  void onImpact(const Impact& /*impact*/) override
  {
    ++next_;
  }
  void onModelInfo(const ModelInfo& /*info*/) override
  {
    ++next_;
  }

  void onStreamStart(const StreamStart& start) override
  {
    starts.push_back({start, next_++});
  }

  std::vector<PlacedBlock> excitation, gaps, forces;
  std::vector<PlacedStart> starts;

private:
  BaseExcitation last_;
  std::uint64_t next_ = 0;
};

/// A start from rest, as stream_start tells it.
struct RecordedStart
{
  std::uint8_t cause = StreamStart::RULE;
  std::string reason;
  bool of_another_simulator = false;          ///< than the start before; that of the first one is not known, either
  std::optional<std::uint64_t> missing_next;  ///< running number of the start that should have followed
};

/// The starts by their blocks of excitation. A looped bag repeats numbers and times: each start goes to the block of
/// its own that is nearest in the order of recording. One that a latched topic has told late may have no block.
std::map<std::size_t, RecordedStart> placeStarts(const std::vector<PlacedBlock>& excitation,
                                                 const std::vector<PlacedStart>& starts);

/// The same, read from a recording whose answers are not looked for; none without that topic.
std::map<std::size_t, RecordedStart> recordedStarts(const RecordedRun& recording);

}  // namespace vibro_impact::graph
