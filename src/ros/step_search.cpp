#include "step_search.h"

#include <algorithm>
#include <thread>

namespace vibro_impact::graph
{
namespace
{
// Worth the start of a thread, and soon full.
constexpr std::size_t batch_samples = std::size_t{1} << 18;
}  // namespace

StepSearch::StepSearch(double sample_period, const core::StepSearchOptions& options)
    : sample_period_(sample_period), finder_(sample_period, options)
{
  thread_ = std::async(std::launch::async, [this] { work(); });
}

StepSearch::~StepSearch()
{
  end();  // for which the future then waits
}

void StepSearch::add(std::uint64_t first, const double* samples, std::size_t count)
{
  if (filling_.samples.empty())
  {
    filling_.samples.reserve(batch_samples + count);
  }
  filling_.blocks.push_back({first, count});
  filling_.samples.insert(filling_.samples.end(), samples, samples + count);
  if (filling_.samples.size() >= batch_samples)
  {
    handOver();
  }
}

void StepSearch::handOver()
{
  std::unique_lock<std::mutex> lock(mutex_);
  samples_ += filling_.samples.size();
  batches_.push_back(std::move(filling_));
  filling_ = {};
  kept_ = kept_ && samples_ <= most_kept_samples;
  changed_.notify_all();
  if (!kept_)
  {
    changed_.wait(lock, [this] { return failed_ || batches_.size() - done_ < most_waiting; });
  }
  if (failed_)
  {
    lock.unlock();
    thread_.get();  // throws what the thread has thrown
    return;
  }
  if (!kept_)
  {
    batches_.erase(batches_.begin(), batches_.begin() + static_cast<std::ptrdiff_t>(done_));
    done_ = 0;
  }
}

void StepSearch::work()
{
  std::unique_lock<std::mutex> lock(mutex_);
  while (true)
  {
    changed_.wait(lock, [this] { return done_ < batches_.size() || ended_; });
    if (done_ == batches_.size())
    {
      return;
    }
    const Batch& batch = batches_[done_];  // stays where it is until it is done
    lock.unlock();
    try
    {
      batch.giveTo(finder_);
    }
    catch (...)  // whoever waits must not wait for ever
    {
      lock.lock();
      failed_ = true;
      changed_.notify_all();
      throw;
    }
    lock.lock();
    ++done_;
    changed_.notify_all();
  }
}

void StepSearch::end()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
}

std::vector<core::FoundStep> StepSearch::finish()
{
  handOver();
  end();
  thread_.get();
  return finder_.finish();
}

std::vector<core::MeasuredStep> StepSearch::measure(const std::vector<core::FoundStep>& steps,
                                                    const Blocks& read_again) const
{
  if (!kept_)
  {
    core::DriveStepMeter meter(steps, sample_period_);
    read_again(meter);
    return meter.finish();
  }
  // Each thread measures a share of the steps of about as many samples as the others have.
  std::uint64_t total = 0;
  for (const core::FoundStep& step : steps)
  {
    total += step.last - step.first;
  }
  const std::size_t threads = std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::vector<core::FoundStep>> shares(threads);
  std::uint64_t before = 0;
  for (const core::FoundStep& step : steps)
  {
    shares[static_cast<std::size_t>(before * threads / std::max<std::uint64_t>(total, 1))].push_back(step);
    before += step.last - step.first;
  }
  std::vector<std::future<std::vector<core::MeasuredStep>>> measured;
  measured.reserve(threads);
  for (const auto& share : shares)
  {
    measured.push_back(std::async(std::launch::async,
                                  [this, &share]
                                  {
                                    core::DriveStepMeter meter(share, sample_period_);
                                    for (const Batch& batch : batches_)
                                    {
                                      batch.giveTo(meter);
                                    }
                                    return meter.finish();
                                  }));
  }
  std::vector<core::MeasuredStep> all;
  for (auto& share : measured)
  {
    const std::vector<core::MeasuredStep> part = share.get();
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

}  // namespace vibro_impact::graph
