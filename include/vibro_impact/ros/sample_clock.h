#pragma once

#include <cstdint>

#include "vibro_impact/ros/samples.h"

namespace vibro_impact::graph
{
/// The time of every sample of a stream, whose samples are counted by `seq` and dated by the stamps of its blocks.
///
/// Stamps of a real driver jitter and drift. As long as a block's stamp is within half a sample period of what the
/// count says, the count is believed: so the times of exactly stamped samples do not depend on how these were cut into
/// blocks. A block further off dates its own samples from then on.
class SampleClock
{
public:
  /// The stream begins with sample `seq` at `stamp`.
  void start(std::uint64_t seq, Stamp stamp, double sample_period);

  /// The next block begins with sample `seq` at `stamp`. `keep_anchor`: the times of samples before it are still asked
  /// for as the anchor before the last one dated them (an episode that has been open since then); otherwise as the last
  /// one did.
  void follow(std::uint64_t seq, Stamp stamp, bool keep_anchor);

  /// Time of sample `seq`; samples before the present anchor are dated by the one before it.
  Stamp at(std::uint64_t seq) const;

  /// Time that the present anchor gives to a sample that is yet to come, s after (or before) `stamp`: stamp - expected.
  double deviation(std::uint64_t seq, Stamp stamp) const;

private:
  struct Anchor
  {
    std::uint64_t seq = 0;
    Stamp stamp = 0;
  };

  Stamp date(const Anchor& anchor, std::uint64_t seq) const;

  double sample_period_ = 0.0;
  Anchor earlier_;
  Anchor present_;
};

}  // namespace vibro_impact::graph
