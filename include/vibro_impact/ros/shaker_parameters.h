#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <xmlrpcpp/XmlRpcValue.h>

#include "vibro_impact/core/drive_signal.h"

namespace vibro_impact::graph
{
/// Everything that the private parameters of a shaker say. Times of waiting are wall time.
struct ShakerParameters
{
  core::DriveParameters signal;              ///< signal: {type, acceleration, ...}
  double sample_rate = 50000.0;              ///< Hz; of a recorded signal its own
  std::string remark;                        ///< what there is to say of a recorded signal; empty: nothing
  double block_rate = 200.0;                 ///< blocks per second of stream time, Hz; at most sample_rate if not given
  double speed = 1.0;                        ///< stream time over wall time; 0: as fast as the blocks are answered
  std::uint32_t max_blocks_ahead = 0;        ///< most blocks without an answer by the simulator; 0: no answers expected
  std::uint32_t wait_for_subscribers = 0;    ///< nothing is published before there are so many
  std::string recorder;                      ///< node that records the run; empty: none that the shaker knows of
  std::vector<std::string> recorded_topics;  ///< what it records
  double timeout = 0.0;                      ///< longest wait for another node, s; 0: for ever
  double linger = 1.0;                       ///< how long the shaker stays after its last block has arrived, s
  double progress_period = 2.0;              ///< between two lines that say how far it is, s; 0: none
  std::uint32_t queue_size = 20000;          ///< blocks kept for each subscriber that is slow; 0: no limit

  /// Samples of every block but the last.
  std::uint64_t samplesPerBlock() const;
};

/// Reads a parameter tree, as the parameter server gives it; the files of a recorded signal are relative to its
/// `signal_directory`, without which their paths must be absolute. Throws config::Error with all faults in one message,
/// `name` the name of the tree: unknown, missing, mistyped and out-of-range parameters, each with its value and what is
/// allowed.
ShakerParameters parseShakerParameters(const XmlRpc::XmlRpcValue& tree, const std::string& name);

}  // namespace vibro_impact::graph
