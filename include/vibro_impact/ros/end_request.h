#pragma once

#include <atomic>

namespace vibro_impact::graph
{
/// Lets a node end in its own time, with all its connections: from now on SIGINT, SIGTERM and a request over the graph
/// (`rosnode kill`, a new node of the same name) only set the flag that is returned.
///
/// To be called between ros::init(), told to leave SIGINT alone, and the first handle. roscpp's own answer to a request
/// over the graph is to close all connections at once.
const std::atomic<bool>& catchEndRequests();

}  // namespace vibro_impact::graph
