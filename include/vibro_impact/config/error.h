#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace vibro_impact::config
{
/// What is wrong with a file, a directory or a set of parameters: what() is a whole message for the user, which names
/// it.
class Error : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;

  /// All faults (at least one) of the thing called `name`: one on its line, several below it.
  Error(const std::string& name, const std::vector<std::string>& faults);
};

}  // namespace vibro_impact::config
