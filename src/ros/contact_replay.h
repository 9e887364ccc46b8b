#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vibro_impact/ros/recording_simulation.h"
#include "vibro_impact/ros/samples.h"

namespace vibro_impact::graph
{
/// The contact in the course of a recording: tells the changes of it as their samples come, since a stream that begins
/// anew may count the same numbers again.
class ContactReplay
{
public:
  /// `recorded` must outlive this.
  explicit ContactReplay(const RecordedModel& recorded);

  /// The changes that come with a block, in their order, with the `seq` that StreamSimulation::setContact() takes.
  /// `max_stamp_jitter`: how far the block's stamp may be off, s.
  std::vector<RecordedChange> comeWith(const Samples& block, double max_stamp_jitter);

  /// The block was taken.
  void take(const Samples& block);

  const RecordedModel& recorded() const
  {
    return *recorded_;
  }
  /// After all changes told.
  const core::ContactParameters& contact() const
  {
    return contact_;
  }
  /// How many changes have been told.
  std::size_t told() const
  {
    return told_;
  }

private:
  const RecordedModel* recorded_;
  core::ContactParameters contact_;
  std::size_t told_ = 0;
  std::uint64_t end_ = 0;  // of the block taken last
};

}  // namespace vibro_impact::graph
