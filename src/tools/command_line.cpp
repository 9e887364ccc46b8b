#include "command_line.h"

#include <iostream>
#include <vector>

#include "vibro_impact/config/number.h"

namespace vibro_impact::tools
{
namespace po = boost::program_options;

namespace
{
Given parse(const Options& visible, const std::string& positional_name, int argc, char** argv)
{
  Options all = visible;
  all.add_options()(positional_name.c_str(), po::value<std::vector<std::string>>());
  po::positional_options_description positional;
  positional.add(positional_name.c_str(), -1);
  Given given;
  try
  {
    // Long options only in full, so that a misspelt one is not taken for another.
    const int style = po::command_line_style::default_style & ~po::command_line_style::allow_guessing;
    po::store(po::command_line_parser(argc, argv).options(all).positional(positional).style(style).run(), given);
  }
  catch (const po::error& error)
  {
    throw UsageError(error.what());
  }
  return given;
}
}  // namespace

po::typed_value<std::string>* text(const char* name)
{
  return po::value<std::string>()->value_name(name);
}

std::string onlyFile(const Given& given, const std::string& positional, const std::string& what)
{
  const std::size_t files = given[positional].empty() ? 0 : given[positional].as<std::vector<std::string>>().size();
  if (files != 1)
  {
    throw UsageError(std::to_string(files) + " " + what + "s are given: must be one");
  }
  return given[positional].as<std::vector<std::string>>().front();
}

double number(const std::string& name, const std::string& text, double least, double greatest)
{
  const auto value = config::parseNumber(text);
  if (!value || *value < least || *value > greatest)
  {
    throw UsageError(name + " = \"" + text + "\": must be a number from " + config::formatNumber(least) + " to " +
                     config::formatNumber(greatest));
  }
  return *value;
}

double number(const Given& given, const std::string& option, double least, double greatest)
{
  return number("--" + option, given[option].as<std::string>(), least, greatest);
}

std::int64_t wholeNumber(const Given& given, const std::string& option, std::int64_t least, std::int64_t greatest)
{
  const std::string text = given[option].as<std::string>();
  const auto value = config::parseInteger(text);
  if (!value || *value < least || *value > greatest)
  {
    throw UsageError("--" + option + " = \"" + text + "\": must be a whole number from " + std::to_string(least) +
                     " to " + std::to_string(greatest));
  }
  return *value;
}

int runTool(const Tool& tool, int argc, char** argv, const std::function<void(const Given&)>& run)
{
  try
  {
    Options options = tool.options;
    options.add_options()("help,h", "show this text");
    const Given given = parse(options, tool.positional, argc, argv);
    if (given.count("help") != 0)
    {
      std::cout << tool.usage << "\n\n" << options;
    }
    else
    {
      run(given);
    }
    return 0;
  }
  catch (const UsageError& error)
  {
    std::cerr << tool.name << ": " << error.what() << " (see " << tool.name << " --help)" << std::endl;
    return 2;
  }
  catch (const std::exception& error)
  {
    std::cerr << tool.name << ": " << error.what() << std::endl;
    return 1;
  }
}

}  // namespace vibro_impact::tools
