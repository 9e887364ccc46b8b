#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>

#include <boost/program_options.hpp>

namespace vibro_impact::tools
{
/// A command line that cannot be meant; ends a tool with the status 2.
struct UsageError : std::runtime_error
{
  using std::runtime_error::runtime_error;
};

using Options = boost::program_options::options_description;
using Given = boost::program_options::variables_map;

/// An option's value, taken as text and called `name` in the help.
boost::program_options::typed_value<std::string>* text(const char* name);

/// The one argument that must be given besides the options, under the name `positional`. Throws UsageError, which calls
/// it `what`, if there is none or there are several.
std::string onlyFile(const Given& given, const std::string& positional, const std::string& what);

/// The number that `text`, the value of what the message calls `name`, must be. Throws UsageError if it is no such
/// number.
double number(const std::string& name, const std::string& text, double least, double greatest);
/// The value of an option that has one. Throws UsageError if it is no such number.
double number(const Given& given, const std::string& option, double least, double greatest);
std::int64_t wholeNumber(const Given& given, const std::string& option, std::int64_t least, std::int64_t greatest);

struct Tool
{
  std::string name;
  std::string usage;       // what --help says before the options
  Options options;         // besides --help
  std::string positional;  // under this name the arguments that are no options are given, all of them
};

/// What main() does: reads the command line and runs, or prints the help. Every exception becomes one message on
/// stderr; returns the status, 2 for a UsageError and 1 for others.
int runTool(const Tool& tool, int argc, char** argv, const std::function<void(const Given&)>& run);

}  // namespace vibro_impact::tools
