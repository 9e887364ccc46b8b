#pragma once

#include <cstdint>
#include <optional>

#include <vibro_impact/ModelInfo.h>

#include "vibro_impact/core/parameters.h"

namespace vibro_impact::graph
{
/// The contact that a simulator holds, as its model_info says.
class HeldContact
{
public:
  /// Whether it says anything new: a latched message may come twice. One that cannot be read is logged and left.
  bool take(const ModelInfo& info);

  /// Nothing before the first.
  const std::optional<core::ContactParameters>& contact() const
  {
    return contact_;
  }
  /// As the simulator's configuration says, and nobody has changed it since.
  bool unchanged() const
  {
    return number_ == 0;
  }
  /// How often another contact was said than before.
  std::uint64_t changes() const
  {
    return changes_;
  }

private:
  std::optional<core::ContactParameters> contact_;
  std::uint64_t number_ = 0;
  std::uint64_t changes_ = 0;
};

}  // namespace vibro_impact::graph
