#include <map>
#include <string>

#include <gtest/gtest.h>

#include "vibro_impact/ros/response_summary.h"

using diagnostic_msgs::DiagnosticStatus;
using vibro_impact::graph::ResponseSummary;

namespace
{
class ResponseSummaryTest : public testing::Test
{
protected:
  void addBlock(std::uint64_t seq, const std::vector<double>& gap_values, const std::vector<double>& force_values)
  {
    vibro_impact::Gap gap;
    gap.seq = seq;
    gap.gap = gap_values;
    summary_.add(gap);
    vibro_impact::ContactForce force;
    force.seq = seq;
    force.force = force_values;
    summary_.add(force);
  }

  void addImpact(std::uint64_t number, double impulse, double peak_force)
  {
    vibro_impact::Impact impact;
    impact.number = number;
    impact.impulse = impulse;
    impact.peak_force = peak_force;
    summary_.add(impact);
  }

  /// The level; the values go to value_.
  int report()
  {
    diagnostic_updater::DiagnosticStatusWrapper status;
    summary_.report(status);
    for (const auto& entry : status.values)
    {
      value_[entry.key] = entry.value;
    }
    return status.level;
  }

  ResponseSummary summary_;
  std::map<std::string, std::string> value_;
};

TEST_F(ResponseSummaryTest, sumsUp)
{
  addBlock(100, {2.0e-3, -1.0e-3}, {0.0, 4.0});
  addBlock(102, {1.0e-3, 3.0e-3}, {0.0, 0.0});
  addImpact(7, 0.5, 5.0);
  addImpact(8, 0.25, 3.0);
  EXPECT_EQ(report(), DiagnosticStatus::OK);
  EXPECT_EQ(value_["Samples of gap"], "4");
  EXPECT_EQ(value_["Samples of force"], "4");
  EXPECT_EQ(value_["Impacts"], "2");
  EXPECT_EQ(value_["Smallest gap (m)"], "-0.001");
  EXPECT_EQ(value_["Share of samples in contact"], "0.250000");
  EXPECT_EQ(value_["Greatest force (N)"], "5");
  EXPECT_EQ(value_["Impulse of all impacts (N s)"], "0.75");
  EXPECT_EQ(value_["Greatest impulse (N s)"], "0.5");
  EXPECT_EQ(value_["Samples of gap missing"], "0");
}

TEST_F(ResponseSummaryTest, sawWhatIsMissingAndWarnsOnce)
{
  addBlock(0, {1.0}, {0.0});
  addBlock(5, {1.0}, {0.0});
  addImpact(0, 0.0, 0.0);
  addImpact(3, 0.0, 0.0);
  EXPECT_EQ(report(), DiagnosticStatus::WARN);
  EXPECT_EQ(value_["Samples of gap missing"], "4");
  EXPECT_EQ(value_["Samples of force missing"], "4");
  EXPECT_EQ(value_["Impacts missing"], "2");
  EXPECT_EQ(report(), DiagnosticStatus::OK);
}

TEST_F(ResponseSummaryTest, aNewStartIsNoLoss)
{
  addBlock(1000, {1.0}, {0.0});
  addBlock(0, {1.0}, {0.0});
  addImpact(9, 0.0, 0.0);
  addImpact(0, 0.0, 0.0);
  EXPECT_EQ(report(), DiagnosticStatus::OK);
  EXPECT_EQ(value_["Samples of gap missing"], "0");
  EXPECT_EQ(value_["Impacts missing"], "0");
}

}  // namespace
