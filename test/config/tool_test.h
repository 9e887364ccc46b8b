#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>

#include "temporary_directory.h"

/// What running a program brought.
struct Outcome
{
  int status = -1;
  std::string out;
  std::string error;
};

/// Runs a tool as a user does, in a directory that is gone afterwards.
class ToolTest : public testing::Test
{
protected:
  /// The program's file and the name by which it speaks of itself.
  ToolTest(std::string program, std::string name) : program_(std::move(program)), name_(std::move(name))
  {
  }

  Outcome run(const std::string& arguments) const
  {
    const std::string out = directory_.path() + "/stdout";
    const std::string error = directory_.path() + "/stderr";
    const std::string command = program_ + " " + arguments + " >" + out + " 2>" + error + " </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readText(out), readText(error)};
  }

  std::string results(const std::string& name = "results") const
  {
    return directory_.path() + "/" + name;
  }

  /// Expects a refusal with one line that holds `reason`, and no results. On a slow machine lines of progress precede
  /// it.
  void expectRefusal(const std::string& arguments, int status, const std::string& reason) const
  {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, status) << arguments;
    EXPECT_EQ(outcome.out, "") << arguments;
    const std::string message = withoutProgress(outcome.error);
    EXPECT_THAT(message, testing::AllOf(testing::StartsWith(name_ + ": "), testing::HasSubstr(reason))) << arguments;
    EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 1) << outcome.error;
    EXPECT_FALSE(std::filesystem::exists(results()) && !std::filesystem::is_empty(results())) << arguments;
  }

  TemporaryDirectory directory_;

private:
  std::string withoutProgress(const std::string& error) const
  {
    std::istringstream lines(error);
    std::string rest;
    for (std::string line; std::getline(lines, line);)
    {
      const bool progress = line.compare(0, name_.size(), name_) != 0 &&
                            (line.find(" frequencies") != std::string::npos || line.find("simulated ") == 0);
      rest += progress ? "" : line + '\n';
    }
    return rest;
  }

  std::string program_;
  std::string name_;
};
