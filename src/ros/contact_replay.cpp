#include "contact_replay.h"

namespace vibro_impact::graph
{
ContactReplay::ContactReplay(const RecordedModel& recorded)
    : recorded_(&recorded), contact_(recorded.parameters.contact)
{
}

std::vector<RecordedChange> ContactReplay::comeWith(const Samples& block, double max_stamp_jitter)
{
  std::vector<RecordedChange> coming;
  const std::uint64_t end = block.seq + block.values.size();
  const double duration = static_cast<double>(block.values.size()) * block.sample_period + max_stamp_jitter;
  for (; told_ < recorded_->changes.size(); ++told_)
  {
    RecordedChange change = recorded_->changes[told_];
    const double later = 1.0e-9 * static_cast<double>(change.stamp - block.stamp);
    if (change.seq >= end || !(later < duration))
    {
      break;
    }
    contact_ = change.contact;
    // The first sample of a stream that begins anew has no number for the simulation before it comes.
    const bool anew = change.seq == block.seq && change.seq < end_;
    change.seq = anew ? 0 : change.seq;
    coming.push_back(change);
  }
  return coming;
}

void ContactReplay::take(const Samples& block)
{
  end_ = block.seq + block.values.size();
}

}  // namespace vibro_impact::graph
