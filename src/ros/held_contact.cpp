#include "vibro_impact/ros/held_contact.h"

#include <ros/console.h>

#include "vibro_impact/config/error.h"
#include "vibro_impact/ros/conversions.h"

namespace vibro_impact::graph
{
bool HeldContact::take(const ModelInfo& info)
{
  try
  {
    const core::ContactParameters contact = fromMessage(info).contact;
    const bool same = contact_ && *contact_ == contact;
    const bool repeated = same && number_ == info.number;
    changes_ += contact_ && !same ? 1 : 0;
    contact_ = contact;
    number_ = info.number;
    return !repeated;
  }
  catch (const config::Error& error)
  {
    ROS_ERROR("model_info is left: %s", error.what());
    return false;
  }
}

}  // namespace vibro_impact::graph
