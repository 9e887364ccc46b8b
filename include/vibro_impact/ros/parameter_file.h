#pragma once

#include <string>

#include <xmlrpcpp/XmlRpcValue.h>

#include "vibro_impact/ros/shaker_parameters.h"

namespace vibro_impact::graph
{
/// A parameter tree from a YAML file, as rosparam would put it on the parameter server. Throws config::Error, naming
/// the path, if the file cannot be read or is no map of parameters.
XmlRpc::XmlRpcValue readParameterFile(const std::string& path);

/// The parameters of a shaker from a file, whose folder is their `signal_directory`. Throws as
/// parseShakerParameters().
ShakerParameters loadShakerParameters(const std::string& path);

}  // namespace vibro_impact::graph
