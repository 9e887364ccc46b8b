// What the shaker says and how it dates its samples, without a graph.

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>

#include "vibro_impact/ros/process.h"
#include "vibro_impact/ros/progress.h"
#include "vibro_impact/ros/shaker.h"

namespace vibro_impact::graph
{
namespace
{
TEST(SampleTime, isThatOfTheCountToTheNanosecond)
{
  const Stamp start = 1700000000123456789;
  EXPECT_EQ(sampleTime(start, 0, 50000.0), start);
  EXPECT_EQ(sampleTime(start, 250, 50000.0), start + 5000000);
  // A year at 50 kHz.
  EXPECT_EQ(sampleTime(start, 50000ull * 31536000ull + 1, 50000.0), start + 31536000ll * 1000000000ll + 20000);
  // Three samples a second: thirds of a second, rounded, without a drift.
  EXPECT_EQ(sampleTime(start, 1, 3.0), start + 333333333);
  EXPECT_EQ(sampleTime(start, 2, 3.0), start + 666666667);
  EXPECT_EQ(sampleTime(start, 3000000002ull, 3.0), start + 1000000000ll * 1000000000ll + 666666667);
}

TEST(Clock, isReadByPeople)
{
  EXPECT_EQ(toClock(0.04), "0.0 s");
  EXPECT_EQ(toClock(59.94), "59.9 s");
  EXPECT_EQ(toClock(59.96), "1:00");
  EXPECT_EQ(toClock(61.0), "1:01");
  EXPECT_EQ(toClock(3600.0), "1:00:00");
  EXPECT_EQ(toClock(36061.0), "10:01:01");
}

TEST(Progress, saysHowFarItIsAndWhenItEnds)
{
  EXPECT_EQ(toText({128.9, 306.3, 2.578, 434.33, 271.457}),
            " 42.1 %, 434.3 Hz (1.600), 2:09 of 5:06, 50.0 x real time, 3.5 s left");
  EXPECT_EQ(toText({3.0, 3.0, 3.0, 100.0, 1.0}), "100.0 %, 100.0 Hz, 3.0 s of 3.0 s, 1.0 x real time, 0.0 s left");
  EXPECT_EQ(toText({1.0, 4.0, 2.0, 0.0, 1.0}), " 25.0 %, at rest, 1.0 s of 4.0 s, 0.5 x real time, 6.0 s left");
}

// A child process that sleeps or computes until the end of the test.
class Child
{
public:
  explicit Child(bool busy) : pid_(fork())
  {
    if (pid_ == 0)
    {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      for (volatile bool on = busy; on;)
      {
      }
      for (;;)
      {
        pause();
      }
    }
  }

  ~Child()
  {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }

  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  pid_t pid() const
  {
    return pid_;
  }

private:
  pid_t pid_;
};

TEST(Process, isAsleepOnlyWhereItIs)
{
  const Child sleeper(false);
  const Child worker(true);
  ASSERT_GT(sleeper.pid(), 0);
  ASSERT_GT(worker.pid(), 0);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!isAsleep(sleeper.pid()) && std::chrono::steady_clock::now() < end)
  {
  }
  EXPECT_TRUE(isAsleep(sleeper.pid()));
  for (int i = 0; i < 100; ++i)
  {
    ASSERT_FALSE(isAsleep(worker.pid()));
  }
  // Whoever asks is awake; and a process that is not there does nothing.
  EXPECT_FALSE(isAsleep(getpid()));
  EXPECT_TRUE(isAsleep(-1));
}

}  // namespace
}  // namespace vibro_impact::graph
