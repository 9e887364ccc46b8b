#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <vibro_impact/BaseExcitation.h>
#include <vibro_impact/Gap.h>

#include "vibro_impact/core/drive_signal.h"
#include "vibro_impact/ros/node_query.h"
#include "vibro_impact/ros/recording.h"
#include "vibro_impact/ros/samples.h"
#include "vibro_impact/ros/shaker_parameters.h"

namespace vibro_impact::graph
{
/// Publishes a drive signal on `base_excitation`, in blocks, paced by the clock, by the simulator's answers, or by
/// both.
///
/// Stream time is the number of the sample over the sample rate, from the time at which the first block goes out. A
/// block is published when the stream, `speed` times faster than the clock, has passed its last sample; one that is
/// late follows at once. None is left out.
class Shaker
{
public:
  /// Reads the private parameters, which throws config::Error, and advertises. `stop` ends run().
  Shaker(ros::NodeHandle node, const ros::NodeHandle& private_node, const std::atomic<bool>& stop);

  /// Waits for whom it has been told to wait for, publishes the whole signal, waits until it has arrived. Throws
  /// std::runtime_error if another node is not there in time, leaves something out of its answers, or has lost
  /// something of what it records.
  void run();

private:
  using Clock = std::chrono::steady_clock;

  bool goesOn() const;
  /// Serves callbacks; returns early where there are some, or to look for the end.
  void wait(double seconds);
  /// Serves callbacks for `seconds` or until `stop`.
  void pause(double seconds);
  /// What must still happen before the first block can go out; empty: nothing.
  std::string missing();
  /// Whom the stream must still reach; empty: nobody.
  std::string pending();
  /// Waits, for at most `timeout`, until `what` says nothing any more; asks every `period`, s.
  void waitWhile(const std::function<std::string()>& what, double period);

  void stream();
  /// Returns when the next block, which ends before sample `end`, may go out.
  void waitForTurn(std::uint64_t end, Clock::time_point start);
  void publishBlock(std::uint64_t count, Stamp start);
  void onGap(const Gap& gap);
  /// Waits until everything published so far is answered and recorded, where that is asked for.
  void waitForArrival();
  /// How many blocks may go out before the recorder must have taken in all of them.
  void planRound();
  void checkRecording();
  std::uint64_t unanswered() const;

  const std::atomic<bool>& stop_;
  ros::CallbackQueue queue_;  // its own, so that run() serves them on whatever thread it is called
  ShakerParameters parameters_;
  std::unique_ptr<const core::DriveSignal> signal_;
  double reference_frequency_;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
  NodeQuery query_;
  Samples block_;
  std::uint64_t published_ = 0;  // samples
  std::uint64_t blocks_ = 0;
  std::uint64_t answered_ = 0;  // samples
  Clock::time_point last_answer_;
  std::unique_ptr<Recording> recording_;      // null without a recorder
  std::vector<Delivery> deliveries_;          // as of when it was asked last
  std::vector<Delivery> earlier_deliveries_;  // as of the begin of the round
  std::uint64_t round_blocks_ = 1;
  std::uint64_t round_start_ = 0;  // sample
};

/// Time of sample `seq` of a stream of `sample_rate` (Hz) that began at `start`: to the nearest nanosecond, however
/// long it is.
Stamp sampleTime(Stamp start, std::uint64_t seq, double sample_rate);

}  // namespace vibro_impact::graph
