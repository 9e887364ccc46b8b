#pragma once

#include <cstdint>
#include <string>

namespace vibro_impact::graph
{
/// Lets the blocks of one publisher through: those of two make no stream.
///
/// The first to send is the source. Another takes its place once the source is gone, that is when it is the only
/// publisher connected, or when the source has been silent for `max_age` (a publisher that was killed stays connected
/// for a while).
class SourceGuard
{
public:
  /// s, > 0
  explicit SourceGuard(double max_age);

  /// Whether a block that `publisher` sent may pass, received at `wall_time` (s, any steady clock) with `connected`
  /// publishers on the topic.
  bool admit(const std::string& publisher, std::uint32_t connected, double wall_time);

  /// The block that passed has been dealt with by `wall_time`: until then nobody listened, so nobody was silent.
  void listenAgain(double wall_time)
  {
    last_time_ = wall_time;
  }

  /// Name of the publisher whose blocks pass; empty before the first.
  const std::string& source() const
  {
    return source_;
  }

private:
  double max_age_;
  std::string source_;
  double last_time_ = 0.0;
};

}  // namespace vibro_impact::graph
