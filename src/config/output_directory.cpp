#include "vibro_impact/config/output_directory.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include "vibro_impact/config/error.h"

namespace vibro_impact::config
{
namespace
{
[[noreturn]] void fail(const std::string& path, int error)
{
  throw Error(path + ": cannot be written: " + std::strerror(error));
}

// A complete file beside its place, gone again unless it is moved there.
class TemporaryFile
{
public:
  TemporaryFile(const std::string& directory, const std::string& name, const std::string& text)
      : target_(directory + "/" + name), path_(directory + "/." + name + ".XXXXXX")
  {
    const int file = mkstemp(path_.data());
    if (file < 0)
    {
      fail(target_, errno);
    }
    const int error = fill(file, text);
    if (close(file) != 0 || error != 0)
    {
      const int reason = error != 0 ? error : errno;
      unlink(path_.c_str());
      fail(target_, reason);
    }
  }

  ~TemporaryFile()
  {
    if (!path_.empty())
    {
      unlink(path_.c_str());
    }
  }

  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void moveToPlace()
  {
    if (std::rename(path_.c_str(), target_.c_str()) != 0)
    {
      fail(target_, errno);
    }
    path_.clear();
  }

private:
  // 0, or what went wrong.
  static int fill(int file, const std::string& text)
  {
    // mkstemp() lets nobody else read its file; a table of results is an ordinary one.
    const mode_t mask = umask(0);
    umask(mask);
    if (fchmod(file, static_cast<mode_t>(0666) & ~mask) != 0)
    {
      return errno;
    }
    std::size_t written = 0;
    while (written < text.size())
    {
      const ssize_t count = ::write(file, text.data() + written, text.size() - written);
      if (count < 0 && errno != EINTR)
      {
        return errno;
      }
      written += count > 0 ? static_cast<std::size_t>(count) : 0;
    }
    return fsync(file) == 0 ? 0 : errno;
  }

  std::string target_;
  std::string path_;
};

// Holds back the signals that would end the program between two files.
class SignalGuard
{
public:
  SignalGuard()
  {
    sigset_t held;
    sigemptyset(&held);
    for (const int signal : {SIGHUP, SIGINT, SIGTERM})
    {
      sigaddset(&held, signal);
    }
    pthread_sigmask(SIG_BLOCK, &held, &before_);
  }

  ~SignalGuard()
  {
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }

  SignalGuard(const SignalGuard&) = delete;
  SignalGuard& operator=(const SignalGuard&) = delete;

private:
  sigset_t before_;
};

}  // namespace

OutputDirectory::OutputDirectory(std::string path) : path_(std::move(path))
{
  if (path_.empty())
  {
    throw Error("the name of the output directory is empty");
  }
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  std::error_code ignored;
  if (!std::filesystem::is_directory(path_, ignored))
  {
    throw Error(path_ + ": cannot be created: " + (error ? error.message() : "it is not a directory"));
  }
  // Only trying tells: permissions say nothing of a file system that is full or mounted read-only.
  const SignalGuard guard;
  const TemporaryFile probe(path_, "probe", "");
}

void OutputDirectory::write(const std::vector<OutputFile>& files) const
{
  const SignalGuard guard;
  std::vector<std::unique_ptr<TemporaryFile>> complete;
  complete.reserve(files.size());
  for (const OutputFile& file : files)
  {
    complete.push_back(std::make_unique<TemporaryFile>(path_, file.name, file.text));
  }
  for (const auto& file : complete)
  {
    file->moveToPlace();
  }
}

}  // namespace vibro_impact::config
