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
  batches_.push_back(std::make_unique<Batch>());
}

StepSearch::~StepSearch() = default;

void StepSearch::add(std::uint64_t first, const double* samples, std::size_t count)
{
  Batch& batch = *batches_.back();
  if (batch.samples.empty())
  {
    batch.samples.reserve(batch_samples + count);
  }
  batch.blocks.push_back({first, count});
  batch.samples.insert(batch.samples.end(), samples, samples + count);
  samples_ += count;
  if (batch.samples.size() >= batch_samples)
  {
    handOver();
  }
}

void StepSearch::handOver()
{
  if (work_.valid())
  {
    work_.get();
  }
  kept_ = kept_ && samples_ <= most_kept_samples;
  if (!kept_)
  {
    batches_.erase(batches_.begin(), std::prev(batches_.end()));
  }
  work_ = std::async(std::launch::async, [this, batch = batches_.back().get()] { batch->giveTo(finder_); });
  batches_.push_back(std::make_unique<Batch>());
}

std::vector<core::FoundStep> StepSearch::finish()
{
  handOver();
  work_.get();
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
                                    for (const auto& batch : batches_)
                                    {
                                      batch->giveTo(meter);
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
