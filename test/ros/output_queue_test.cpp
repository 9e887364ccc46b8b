#include <gtest/gtest.h>

#include "vibro_impact/ros/output_queue.h"

using vibro_impact::graph::MessageLedger;

namespace
{
void expectCounts(const MessageLedger& ledger, std::uint64_t published, std::uint64_t waiting, std::uint64_t dropped)
{
  EXPECT_EQ(ledger.counts().published, published);
  EXPECT_EQ(ledger.counts().waiting, waiting);
  EXPECT_EQ(ledger.counts().dropped, dropped);
}

TEST(MessageLedgerTest, messagesThatGoInTurnWereSent)
{
  MessageLedger ledger;
  for (std::uint64_t i = 0; i < 5; ++i)
  {
    EXPECT_EQ(ledger.add(), i);
  }
  expectCounts(ledger, 5, 5, 0);
  for (std::uint64_t i = 0; i < 5; ++i)
  {
    ledger.release(i);
  }
  expectCounts(ledger, 5, 0, 0);
  EXPECT_EQ(ledger.add(), 5U);
  ledger.release(5);
  expectCounts(ledger, 6, 0, 0);
}

TEST(MessageLedgerTest, aFullQueueDropsBehindTheMessageThatIsBeingWritten)
{
  MessageLedger ledger;
  for (int i = 0; i < 3; ++i)  // 0 is being written, 1 and 2 fill the queue
  {
    ledger.add();
  }
  for (std::uint64_t oldest = 1; oldest < 5; ++oldest)
  {
    ledger.add();
    ledger.release(oldest);
    expectCounts(ledger, oldest + 3, 3, oldest);
  }
  // The subscriber reads again: 0, 5 and 6.
  ledger.release(0);
  ledger.release(5);
  ledger.release(6);
  expectCounts(ledger, 7, 0, 4);
}

}  // namespace
