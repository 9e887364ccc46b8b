#include "recorded_starts.h"

#include <algorithm>
#include <utility>

namespace vibro_impact::graph
{
namespace
{
constexpr std::size_t none = static_cast<std::size_t>(-1);

using Key = std::pair<ros::Time, std::uint64_t>;  // stamp, number of the first sample

/// Takes the block whose position is nearest out of `blocks`, which ascend; `none` if there is none left.
std::size_t takeNearest(std::vector<std::size_t>& blocks, std::uint64_t position,
                        const std::vector<PlacedBlock>& excitation)
{
  if (blocks.empty())
  {
    return none;
  }
  const auto at = [&excitation](std::size_t block) { return excitation[block].position; };
  auto nearest = std::lower_bound(blocks.begin(), blocks.end(), position,
                                  [&at](std::size_t block, std::uint64_t value) { return at(block) < value; });
  const bool before_is_nearer = nearest == blocks.end() ||
                                (nearest != blocks.begin() && position - at(*(nearest - 1)) <= at(*nearest) - position);
  nearest -= before_is_nearer ? 1 : 0;
  const std::size_t block = *nearest;
  blocks.erase(nearest);
  return block;
}

/// The block of each start, or `none`.
std::vector<std::size_t> blocksOf(const std::vector<PlacedBlock>& excitation, const std::vector<PlacedStart>& starts)
{
  std::map<Key, std::vector<std::size_t>> free;
  for (const PlacedStart& placed : starts)
  {
    free[{placed.start.header.stamp, placed.start.seq}];
  }
  for (std::size_t block = 0; block < excitation.size(); ++block)
  {
    const auto found = free.find({excitation[block].head.stamp, excitation[block].head.seq});
    if (found != free.end() && !excitation[block].repeats)
    {
      found->second.push_back(block);
    }
  }
  std::vector<std::size_t> blocks;
  blocks.reserve(starts.size());
  for (const PlacedStart& placed : starts)
  {
    blocks.push_back(takeNearest(free[{placed.start.header.stamp, placed.start.seq}], placed.position, excitation));
  }
  // A start comes before those that are told after it: one that does not was told late, and its own block is not there.
  std::size_t next = none;
  for (auto block = blocks.rbegin(); block != blocks.rend(); ++block)
  {
    *block = *block < next ? *block : none;
    next = std::min(next, *block);
  }
  return blocks;
}

bool same(const StreamStart& a, const StreamStart& b)
{
  return a.number == b.number && a.seq == b.seq && a.header.stamp == b.header.stamp;
}

}  // namespace

std::map<std::size_t, RecordedStart> placeStarts(const std::vector<PlacedBlock>& excitation,
                                                 const std::vector<PlacedStart>& starts)
{
  const std::vector<std::size_t> blocks = blocksOf(excitation, starts);
  std::map<std::size_t, RecordedStart> placed;
  const StreamStart* last = nullptr;
  RecordedStart* before = nullptr;
  bool is_another = true;
  for (std::size_t i = 0; i < starts.size(); ++i)
  {
    const StreamStart& start = starts[i].start;
    if (last != nullptr && same(start, *last) && blocks[i] == none)
    {
      continue;  // a latched message, told once more
    }
    const bool numbers_begin_anew = last != nullptr && start.number <= last->number;
    is_another = is_another || numbers_begin_anew;
    if (before != nullptr && !before->missing_next && !numbers_begin_anew && start.number > last->number + 1)
    {
      before->missing_next = last->number + 1;
    }
    last = &start;
    if (blocks[i] != none)
    {
      before = &placed.emplace(blocks[i], RecordedStart{start.cause, start.reason, is_another, {}}).first->second;
      is_another = false;
    }
  }
  return placed;
}

std::map<std::size_t, RecordedStart> recordedStarts(const RecordedRun& recording)
{
  if (recording.topics().stream_start.empty())
  {
    return {};
  }
  PlacingReader reader;
  recording.read(reader);
  return placeStarts(reader.excitation, reader.starts);
}

}  // namespace vibro_impact::graph
