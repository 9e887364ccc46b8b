#pragma once

#include <deque>

#include "vibro_impact/core/stream_time.h"

namespace vibro_impact::core
{
/// Stretches of time, half-open and apart from one another, that arrive in order.
class TimeIntervals
{
public:
  /// [from, to), or what of it is not before the end of the last one; one that begins where the last one ends goes on
  /// with it.
  void add(StreamTime from, StreamTime to);

  /// Time of [from, to) that lies in them, ns.
  StreamTime covered(StreamTime from, StreamTime to) const;

  /// What ends at `time` or before will not be asked for any more.
  void forget(StreamTime time);

  void clear()
  {
    intervals_.clear();
  }

private:
  struct Interval
  {
    StreamTime from;
    StreamTime to;
  };

  std::deque<Interval> intervals_;
};

}  // namespace vibro_impact::core
