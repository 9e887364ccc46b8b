#pragma once

#include <string>
#include <vector>

namespace vibro_impact::config
{
struct OutputFile
{
  std::string name;  ///< without a folder
  std::string text;
};

/// A directory for results, known to be writable before anything is computed for it.
class OutputDirectory
{
public:
  /// Creates the directory if it is missing. Throws Error if that fails or no file can be created in it.
  explicit OutputDirectory(std::string path);

  /// Writes all files or, if one fails, none: each goes to a temporary file beside its place first, and none is moved
  /// there before all are complete. Files of these names are replaced. Signals that end a program wait meanwhile.
  /// Throws Error.
  void write(const std::vector<OutputFile>& files) const;

  const std::string& path() const
  {
    return path_;
  }

private:
  std::string path_;
};

}  // namespace vibro_impact::config
