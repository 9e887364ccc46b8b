#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace vibro_impact::core
{
/// How many impulses fall into each class; classes are equally wide on a logarithmic axis, as impulses go over decades.
class ImpulseHistogram
{
public:
  /// `classes` >= 1 from `from` to `to`, 0 < from < to, N s.
  ImpulseHistogram(double from, double to, std::size_t classes);

  void clear();
  void add(double impulse);

  /// classes + 1 of them, the first and the last exactly as given, N s.
  const std::vector<double>& edges() const
  {
    return edges_;
  }
  /// classes + 2 of them: below the first edge, [edge, next edge) each, from the last edge on.
  const std::vector<std::uint64_t>& counts() const
  {
    return counts_;
  }

private:
  std::vector<double> edges_;
  std::vector<std::uint64_t> counts_;
};

}  // namespace vibro_impact::core
