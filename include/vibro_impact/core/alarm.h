#pragma once

#include <optional>

#include "vibro_impact/core/stream_time.h"

namespace vibro_impact::core
{
/// When an alarm is raised and when it is cleared. Between the two limits it stays as it is (hysteresis, or deadband);
/// raise_at - clear_at tells the direction. The delays are those of ANSI/ISA-18.2 and IEC 62682.
struct AlarmLimits
{
  double raise_at = 0.0;     ///< raised above it if it is greater than `clear_at`, below it if it is less
  double clear_at = 0.0;     ///< cleared below it, or above it; unlike `raise_at`
  StreamTime on_delay = 0;   ///< how long the value must be beyond `raise_at` without a break before it is raised, ns
  StreamTime off_delay = 0;  ///< the same for `clear_at`, ns
};

/// An alarm that follows a value in the stream's time.
class Alarm
{
public:
  explicit Alarm(const AlarmLimits& limits) : limits_(limits)
  {
  }

  /// The value at `time`; whether this raised or cleared the alarm. NaN is beyond no limit. Where time goes back, a
  /// delay begins anew.
  bool update(StreamTime time, double value);

  /// Another stretch of time begins, and nobody has heard what was before it: so do the delays. The state stays.
  void beginStretch()
  {
    beyond_since_.reset();
  }

  bool active() const
  {
    return active_;
  }

private:
  bool beyond(double value) const;

  AlarmLimits limits_;
  bool active_ = false;
  std::optional<StreamTime> beyond_since_;  ///< of the limit that would change the state
};

}  // namespace vibro_impact::core
