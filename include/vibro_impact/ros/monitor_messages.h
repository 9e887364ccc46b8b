#pragma once

#include <cstdint>
#include <vector>

#include <vibro_impact/AlarmArray.h>
#include <vibro_impact/BaseExcitation.h>
#include <vibro_impact/ContactForce.h>
#include <vibro_impact/Gap.h>
#include <vibro_impact/Impact.h>
#include <vibro_impact/ImpactStatistics.h>

#include "vibro_impact/core/response_monitor.h"
#include "vibro_impact/ros/monitor_parameters.h"

namespace vibro_impact::graph
{
/// `message` as a monitor keeps it; the release to the nearest nanosecond.
core::ReleasedImpact toReleasedImpact(const Impact& message);

// Blocks whose samples stay in the message.
core::SampleBlock toBlock(const BaseExcitation& message);
core::SampleBlock toBlock(const Gap& message);
core::SampleBlock toBlock(const ContactForce& message);

/// The last statistics of `monitor`, and its counts; `contact_changes` it does not know.
void toMessage(const core::ResponseMonitor& monitor, std::uint64_t contact_changes, ImpactStatistics& message);

/// The alarms of a monitor, and what is published of them.
class AlarmPanel
{
public:
  explicit AlarmPanel(const std::vector<AlarmParameters>& parameters);

  /// Whether one of them was raised or cleared.
  bool update(const core::ResponseStatistics& statistics);

  /// The present state of all.
  const AlarmArray& message() const
  {
    return message_;
  }

private:
  struct Watched
  {
    const core::Quantity* quantity;
    core::Alarm alarm;
  };

  std::uint64_t stretch_ = 0;     ///< of the last statistics
  std::vector<Watched> watched_;  ///< in the order of the message
  AlarmArray message_;
};

}  // namespace vibro_impact::graph
