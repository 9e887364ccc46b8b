#include "text_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "vibro_impact/config/error.h"

namespace vibro_impact::config
{
namespace
{
[[noreturn]] void fail(const std::string& path, const std::string& reason)
{
  throw Error(path + ": cannot be read: " + reason);
}
}  // namespace

std::ifstream openTextFile(const std::string& path)
{
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
  {
    fail(path, "it is a directory");
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file)
  {
    fail(path, std::strerror(errno));
  }
  return file;
}

void requireWhollyRead(const std::istream& file, const std::string& path)
{
  if (file.bad())
  {
    fail(path, std::strerror(errno));
  }
}

std::string readTextFile(const std::string& path, std::size_t largest, const std::string& none)
{
  std::ifstream file = openTextFile(path);
  std::string text(largest + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  requireWhollyRead(file, path);
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > largest)
  {
    fail(path, "it is larger than " + std::to_string(largest) + " bytes, which " + none);
  }
  return text;
}

std::vector<std::string> splitCells(std::string line)
{
  if (!line.empty() && line.back() == '\r')
  {
    line.pop_back();
  }
  std::vector<std::string> cells;
  std::size_t begin = 0;
  for (std::size_t end = line.find(','); end != std::string::npos; end = line.find(',', begin))
  {
    cells.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  cells.push_back(line.substr(begin));
  return cells;
}

}  // namespace vibro_impact::config
