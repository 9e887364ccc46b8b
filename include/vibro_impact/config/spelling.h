#pragma once

#include <optional>
#include <string>
#include <vector>

namespace vibro_impact::config
{
/// The word, in lower case all of them, that a misspelt one was meant to be: at most a third of it is wrong.
std::optional<std::string> nearest(const std::string& misspelt, const std::vector<std::string>& words);

}  // namespace vibro_impact::config
