#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <vector>

#include "vibro_impact/core/drive_steps.h"

namespace vibro_impact::graph
{
/// Finds the steps of a drive in a thread of its own while its blocks are being read, and keeps the samples for the
/// exact measurement as long as there are not too many. What comes out is the same, bit for bit, as without threads.
class StepSearch
{
public:
  /// More samples than this are not kept: 256 MiB, eleven minutes at 50 kHz.
  static constexpr std::size_t most_kept_samples = std::size_t{1} << 25;

  /// Throws std::invalid_argument as core::DriveStepFinder does.
  StepSearch(double sample_period, const core::StepSearchOptions& options);
  ~StepSearch();
  StepSearch(const StepSearch&) = delete;
  StepSearch& operator=(const StepSearch&) = delete;

  /// The next block, as core::DriveStepFinder::add() takes it.
  void add(std::uint64_t first, const double* samples, std::size_t count);

  /// The steps in all blocks. Once.
  std::vector<core::FoundStep> finish();

  /// Hands one block after the other to core::DriveStepMeter::add().
  using Blocks = std::function<void(core::DriveStepMeter&)>;

  /// Measures the steps in the samples kept, in as many threads as there are processors, or in those that
  /// `read_again` gives. After finish().
  std::vector<core::MeasuredStep> measure(const std::vector<core::FoundStep>& steps, const Blocks& read_again) const;

private:
  struct Block
  {
    std::uint64_t first;
    std::size_t count;
  };
  /// Blocks one behind the other.
  struct Batch
  {
    std::vector<Block> blocks;
    std::vector<double> samples;

    template <typename Taker>
    void giveTo(Taker& taker) const
    {
      const double* from = samples.data();
      for (const Block& block : blocks)
      {
        taker.add(block.first, from, block.count);
        from += block.count;
      }
    }
  };

  /// No more than so many wait where the samples are not kept: 16 MiB.
  static constexpr std::size_t most_waiting = 8;

  void handOver();
  void work();
  void end();

  double sample_period_;
  core::DriveStepFinder finder_;  // of the thread, until it has ended
  Batch filling_;

  // What the thread has to do; the first `done_` of the batches handed over have been searched. Where they are not
  // kept, these are taken away.
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Batch> batches_;
  std::size_t done_ = 0;
  bool ended_ = false;
  bool failed_ = false;  // the thread is gone
  std::size_t samples_ = 0;
  bool kept_ = true;  // all batches

  std::future<void> thread_;
};

}  // namespace vibro_impact::graph
