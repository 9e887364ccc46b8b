#pragma once

#include <stdexcept>

namespace vibro_impact::config
{
/// What is wrong with a file or a directory: what() is a whole message for the user, which names it.
class Error : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

}  // namespace vibro_impact::config
