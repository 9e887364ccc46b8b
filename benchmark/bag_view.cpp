// The time in which rosbag's own view iterates over a recording: bag_view (iterate|instantiate) BAG TOPIC... Prints
// seconds, from before the bag is opened, those of the processor, and what it counted.

#include <chrono>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <string>
#include <vector>

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <vibro_impact/BaseExcitation.h>
#include <vibro_impact/ContactForce.h>
#include <vibro_impact/Gap.h>
#include <vibro_impact/Impact.h>
#include <vibro_impact/ModelInfo.h>
#include <vibro_impact/StreamStart.h>

namespace
{
using namespace vibro_impact;

// Samples of a message, or one.
std::size_t instantiate(const rosbag::MessageInstance& instance)
{
  if (const auto block = instance.instantiate<BaseExcitation>())
  {
    return block->acceleration.size();
  }
  if (const auto block = instance.instantiate<Gap>())
  {
    return block->gap.size();
  }
  if (const auto block = instance.instantiate<ContactForce>())
  {
    return block->force.size();
  }
  const bool known = instance.instantiate<Impact>() != nullptr || instance.instantiate<ModelInfo>() != nullptr ||
                     instance.instantiate<StreamStart>() != nullptr;
  return known ? 1 : 0;
}
}  // namespace

int main(int argc, char** argv)
{
  if (argc < 4)
  {
    std::cerr << "usage: bag_view (iterate|instantiate) BAG TOPIC...\n";
    return 2;
  }
  const bool instantiating = std::string(argv[1]) == "instantiate";
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t processor_start = std::clock();
  rosbag::Bag bag(argv[2]);
  rosbag::View view(bag, rosbag::TopicQuery(std::vector<std::string>(argv + 3, argv + argc)));
  std::size_t messages = 0;
  std::size_t counted = 0;
  for (const rosbag::MessageInstance& instance : view)
  {
    ++messages;
    counted += instantiating ? instantiate(instance) : 0;
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  const double processor = static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC;
  std::printf("%.6f %.6f %zu %zu\n", elapsed.count(), processor, messages, counted);
  return 0;
}
