#pragma once

namespace vibro_impact::graph
{
/// A scale that is 1, 2 or 5 times a power of ten, and stays while it is not far off, so that a picture does not jump.
class RoundScale
{
public:
  /// `fixed`: the value that it always has; 0: none.
  explicit RoundScale(double fixed) : fixed_(fixed), value_(fixed)
  {
  }

  /// Towards `wanted`; anything but a positive number changes nothing.
  double update(double wanted);

  /// 0 before the first update().
  double value() const
  {
    return value_;
  }

private:
  double fixed_;
  double value_;
};

}  // namespace vibro_impact::graph
