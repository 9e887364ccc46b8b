#pragma once

#include <cstddef>
#include <fstream>
#include <istream>
#include <string>
#include <vector>

namespace vibro_impact::config
{
/// Opens a file to be read. Throws Error, naming the path, if it cannot be.
std::ifstream openTextFile(const std::string& path);

/// Throws Error, naming the path, if something went wrong while `file` was read.
void requireWhollyRead(const std::istream& file, const std::string& path);

/// A whole file. Throws Error, naming the path, if it cannot be read or is larger than `largest` bytes, "which `none`".
std::string readTextFile(const std::string& path, std::size_t largest, const std::string& none);

/// The cells of one line of a table, without its end of line.
std::vector<std::string> splitCells(std::string line);

}  // namespace vibro_impact::config
