#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

/// A fresh directory for one test, gone with all it holds afterwards.
class TemporaryDirectory
{
public:
  TemporaryDirectory() : path_((std::filesystem::temp_directory_path() / "vibro_impact_test.XXXXXX").string())
  {
    if (mkdtemp(path_.data()) == nullptr)
    {
      throw std::runtime_error("no temporary directory");
    }
  }
  ~TemporaryDirectory()
  {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const std::string& path() const
  {
    return path_;
  }

  /// Writes a file; returns its path.
  std::string file(const std::string& name, const std::string& text) const
  {
    std::string path = path_ + "/" + name;
    std::ofstream(path) << text;
    return path;
  }

  bool empty() const
  {
    return std::filesystem::is_empty(path_);
  }

private:
  std::string path_;
};

inline std::string readText(const std::string& path)
{
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}
