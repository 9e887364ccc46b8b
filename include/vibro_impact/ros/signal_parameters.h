#pragma once

#include <string>
#include <vector>

#include <xmlrpcpp/XmlRpcValue.h>

#include "vibro_impact/core/drive_signal.h"

namespace vibro_impact::graph
{
/// What the map `signal` of a shaker's parameters says.
struct SignalParameters
{
  core::DriveParameters drive;
  double sample_rate = 0.0;         ///< Hz: that which was given, or that of the recording
  bool recorded = false;            ///< whether it comes from a table or a bag
  std::string remark;               ///< what there is to say of the recording; empty: nothing
  std::vector<std::string> faults;  ///< one line each, with key, value and what is allowed; empty: all is good
};

/// Reads and checks the map. The files of a recorded signal are read; they are relative to `directory`, without which
/// their paths must be absolute.
SignalParameters readSignal(const XmlRpc::XmlRpcValue& map, double sample_rate, const std::string& directory);

}  // namespace vibro_impact::graph
