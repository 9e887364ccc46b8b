#include <gtest/gtest.h>

#include "vibro_impact/ros/source_guard.h"

using vibro_impact::graph::SourceGuard;

namespace
{
TEST(SourceGuard, firstPublisherIsTheSource)
{
  SourceGuard guard(1.0);
  EXPECT_EQ(guard.source(), "");
  EXPECT_TRUE(guard.admit("/shaker", 2, 10.0));
  EXPECT_TRUE(guard.admit("/shaker", 2, 10.5));
  EXPECT_EQ(guard.source(), "/shaker");
}

TEST(SourceGuard, secondPublisherIsRefusedWhileTheSourceSends)
{
  SourceGuard guard(1.0);
  guard.admit("/shaker", 1, 10.0);
  EXPECT_FALSE(guard.admit("/bag", 2, 10.1));
  EXPECT_TRUE(guard.admit("/shaker", 2, 10.9));
  EXPECT_FALSE(guard.admit("/bag", 2, 11.8));
  EXPECT_EQ(guard.source(), "/shaker");
}

TEST(SourceGuard, theOnlyPublisherLeftTakesOver)
{
  SourceGuard guard(1.0);
  guard.admit("/shaker", 1, 10.0);
  EXPECT_TRUE(guard.admit("/bag", 1, 10.1));
  EXPECT_EQ(guard.source(), "/bag");
}

TEST(SourceGuard, aSilentSourceIsReplaced)
{
  SourceGuard guard(1.0);
  guard.admit("/shaker", 1, 10.0);
  EXPECT_FALSE(guard.admit("/bag", 2, 11.0));
  EXPECT_TRUE(guard.admit("/bag", 2, 11.1));
  EXPECT_FALSE(guard.admit("/shaker", 2, 11.2));
}

TEST(SourceGuard, whoIsNotListenedToIsNotSilent)
{
  SourceGuard guard(1.0);
  guard.admit("/shaker", 2, 10.0);
  guard.listenAgain(12.5);
  EXPECT_FALSE(guard.admit("/bag", 2, 12.6));
  EXPECT_TRUE(guard.admit("/shaker", 2, 12.7));
  EXPECT_EQ(guard.source(), "/shaker");
}

}  // namespace
