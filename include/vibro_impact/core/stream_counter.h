#pragma once

#include <cstdint>

namespace vibro_impact::core
{
/// Follows a count of things that arrive in order, leaves something out, or begins anew.
class StreamCounter
{
public:
  /// The next `count` things are from `number` on. Less than what was expected is a new beginning, and no loss.
  void take(std::uint64_t number, std::uint64_t count)
  {
    if (started_ && number > next_)
    {
      missing_ += number - next_;
    }
    restarts_ += started_ && number < next_ ? 1 : 0;
    started_ = true;
    next_ = number + count;
    taken_ += count;
  }

  std::uint64_t taken() const
  {
    return taken_;
  }
  std::uint64_t missing() const
  {
    return missing_;
  }
  std::uint64_t restarts() const
  {
    return restarts_;
  }

private:
  bool started_ = false;
  std::uint64_t next_ = 0;
  std::uint64_t taken_ = 0;
  std::uint64_t missing_ = 0;
  std::uint64_t restarts_ = 0;
};

}  // namespace vibro_impact::core
