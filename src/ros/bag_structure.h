#pragma once

#include <string>

namespace vibro_impact::graph
{
/// Reads a bag of format 2.0 once and checks that all lengths, offsets and numbers in it hold together. rosbag believes
/// them: where one is wrong, it reads beyond its memory or asks for all there is. A bag without an index passes, since
/// rosbag refuses it. Throws config::Error that names the path and what is wrong.
void requireSoundBag(const std::string& path);

/// One line of whatever there was to say of a damaged bag.
std::string damaged(const std::string& path, std::string reason);

}  // namespace vibro_impact::graph
