#include "vibro_impact/config/response_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "temporary_directory.h"
#include "vibro_impact/config/error.h"

namespace vibro_impact::config
{
namespace
{
using testing::HasSubstr;

const std::string response_header =
    "omega_star,frequency_hz,acceleration,period,steady,impacts,impacts_per_cycle,impulse_mean,impulse_min,impulse_max,"
    "impulse_star_mean,impulse_star_min,impulse_star_max,impulse_per_cycle,peak_force,duration_mean,contact_share,"
    "stiffness,clearance";
const std::string impact_header =
    "omega_star,number,onset_s,duration_s,impulse,peak_force,approach_speed,separation_speed,energy_lost,dissipated,"
    "mapping_loss,base_work";

std::vector<core::Response> someResponses()
{
  core::Response quiet;
  quiet.row.omega_star = 0.5;
  quiet.row.period = 1;
  core::Response loud;
  loud.row = {1.0 / 3.0, 90.5, 1.0,  2,   true,  2,      1.0, 0.1,   0.05,   0.15,
              1e-7,      2e-7, 3e-7, 0.1, 1.0e3, 0.7e-3, 0.4, 5.0e4, -1.0e-6};
  core::Impact impact;
  impact.number = 12345678901234;
  impact.duration = 0.7e-3;
  impact.impulse = 0.1;
  impact.peak_force = 1.0e3 / 7.0;
  impact.approach_speed = 0.25;
  impact.separation_speed = 0.2;
  impact.energy_lost = 3e-6;
  impact.dissipated = 1e-6;
  impact.mapping_loss = 2e-6;
  impact.base_work = -4e-6;
  loud.captured = {{1.25, impact}, {1.5, impact}};
  return {quiet, loud};
}

std::string complaint(const std::function<void()>& action)
{
  try
  {
    action();
  }
  catch (const Error& error)
  {
    return error.what();
  }
  return "";
}

std::string responseComplaint(const std::string& text)
{
  const TemporaryDirectory directory;
  const std::string path = directory.file("frf.csv", text);
  const std::string message = complaint([&] { readResponseTable(path); });
  EXPECT_EQ(message.find(path), 0u) << message;
  return message.substr(std::min(message.size(), path.size()));
}

TEST(ResponseTable, HasTheColumnsOfTheContract)
{
  const std::vector<core::Response> responses = someResponses();
  EXPECT_EQ(responseTable(responses).name, "frf.csv");
  EXPECT_EQ(
      responseTable(responses).text,
      response_header +
          "\n0.5,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0"
          "\n0.3333333333333333,90.5,1,2,1,2,1,0.1,0.05,0.15,1e-07,2e-07,3e-07,0.1,1000,0.0007,0.4,50000,-1e-06\n");
  EXPECT_EQ(impactTable(responses).name, "impacts.csv");
  EXPECT_EQ(
      impactTable(responses).text,
      impact_header +
          "\n0.3333333333333333,12345678901234,1.25,0.0007,0.1,142.85714285714286,0.25,0.2,3e-06,1e-06,2e-06,-4e-06"
          "\n0.3333333333333333,12345678901234,1.5,0.0007,0.1,142.85714285714286,0.25,0.2,3e-06,1e-06,2e-06,-4e-06\n");
  EXPECT_EQ(responseTable({}).text, response_header + "\n");
}

TEST(ResponseTable, ReadsBackExactly)
{
  const TemporaryDirectory directory;
  const std::vector<core::Response> responses = someResponses();
  const OutputDirectory output(directory.path() + "/new/folder");
  output.write({responseTable(responses), impactTable(responses)});

  const std::vector<core::ResponseRow> rows = readResponseTable(output.path() + "/frf.csv");
  ASSERT_EQ(rows.size(), 2u);
  const core::ResponseRow& row = rows[1];
  const core::ResponseRow& expected = responses[1].row;
  EXPECT_EQ(row.omega_star, expected.omega_star);
  EXPECT_EQ(row.frequency_hz, expected.frequency_hz);
  EXPECT_EQ(row.acceleration, expected.acceleration);
  EXPECT_EQ(row.period, expected.period);
  EXPECT_EQ(row.steady, expected.steady);
  EXPECT_EQ(row.impacts, expected.impacts);
  EXPECT_EQ(row.impacts_per_cycle, expected.impacts_per_cycle);
  EXPECT_EQ(row.impulse_mean, expected.impulse_mean);
  EXPECT_EQ(row.impulse_min, expected.impulse_min);
  EXPECT_EQ(row.impulse_max, expected.impulse_max);
  EXPECT_EQ(row.impulse_star_mean, expected.impulse_star_mean);
  EXPECT_EQ(row.impulse_star_min, expected.impulse_star_min);
  EXPECT_EQ(row.impulse_star_max, expected.impulse_star_max);
  EXPECT_EQ(row.impulse_per_cycle, expected.impulse_per_cycle);
  EXPECT_EQ(row.peak_force, expected.peak_force);
  EXPECT_EQ(row.duration_mean, expected.duration_mean);
  EXPECT_EQ(row.contact_share, expected.contact_share);
  EXPECT_EQ(row.stiffness, expected.stiffness);
  EXPECT_EQ(row.clearance, expected.clearance);
  EXPECT_FALSE(rows[0].steady);

  const std::vector<ImpactRow> impacts = readImpactTable(output.path() + "/impacts.csv");
  ASSERT_EQ(impacts.size(), 2u);
  const core::TimedImpact& captured = responses[1].captured[1];
  EXPECT_EQ(impacts[1].omega_star, expected.omega_star);
  EXPECT_EQ(impacts[1].number, captured.impact.number);
  EXPECT_EQ(impacts[1].onset_s, captured.onset);
  EXPECT_EQ(impacts[1].duration_s, captured.impact.duration);
  EXPECT_EQ(impacts[1].impulse, captured.impact.impulse);
  EXPECT_EQ(impacts[1].peak_force, captured.impact.peak_force);
  EXPECT_EQ(impacts[1].approach_speed, captured.impact.approach_speed);
  EXPECT_EQ(impacts[1].separation_speed, captured.impact.separation_speed);
  EXPECT_EQ(impacts[1].energy_lost, captured.impact.energy_lost);
  EXPECT_EQ(impacts[1].dissipated, captured.impact.dissipated);
  EXPECT_EQ(impacts[1].mapping_loss, captured.impact.mapping_loss);
  EXPECT_EQ(impacts[1].base_work, captured.impact.base_work);
}

TEST(ResponseTable, FindsColumnsByName)
{
  const TemporaryDirectory directory;
  const std::string path = directory.file("impacts.csv",
                                          "note,number,omega_star,duration_s,onset_s,impulse,peak_force,approach_speed,"
                                          "separation_speed,energy_lost,mapping_loss,dissipated,base_work\r\n"
                                          "fine,7,1.5,2,3,4,5,6,8,9,10,11,12\r\n");
  const std::vector<ImpactRow> rows = readImpactTable(path);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].number, 7u);
  EXPECT_EQ(rows[0].omega_star, 1.5);
  EXPECT_EQ(rows[0].onset_s, 3.0);
  EXPECT_EQ(rows[0].separation_speed, 8.0);
  EXPECT_EQ(rows[0].dissipated, 11.0);
}

TEST(ResponseTable, SaysWhatIsWrongAndWhere)
{
  EXPECT_EQ(responseComplaint(""), ": is empty: must be a table that starts with the names of its columns");
  EXPECT_EQ(responseComplaint("omega_star,frequency_hz,acceleration,period,steady,impacts,impacts_per_cycle,"
                              "impulse_mean,impulse_min,impulse_max,impulse_star_mean,impulse_star_min,"
                              "impulse_per_cycle,duration_mean,contact_share,stiffness,clearance\n"),
            ": line 1: columns are missing: impulse_star_max, peak_force");
  EXPECT_THAT(responseComplaint("hello\n"), HasSubstr(": line 1: columns are missing: omega_star, "));
  const std::string row = "\n1,2,3,1,1,15,1,0,0,0,0,0,0,0,0,0,0.5,1,0";
  EXPECT_EQ(responseComplaint(response_header + row + "\n1,2,3\n"), ": line 3: has 3 columns: must have 19");
  EXPECT_EQ(responseComplaint(response_header + row + "\n\n"), ": line 3: has 1 columns: must have 19");
  EXPECT_EQ(responseComplaint(response_header + "\n1,2,3x,1,1,15,1,0,0,0,0,0,0,0,0,0,0,0,0\n"),
            ": line 2: column acceleration = \"3x\": must be a finite number");
  EXPECT_EQ(responseComplaint(response_header + "\n1,2,nan,1,1,15,1,0,0,0,0,0,0,0,0,0,0,0,0\n"),
            ": line 2: column acceleration = \"nan\": must be a finite number");
  EXPECT_EQ(responseComplaint(response_header + "\n1,2,3,1.5,1,15,1,0,0,0,0,0,0,0,0,0,0,0,0\n"),
            ": line 2: column period = \"1.5\": must be a whole number");
  EXPECT_EQ(responseComplaint(response_header + "\n1,2,3,-1,1,15,1,0,0,0,0,0,0,0,0,0,0,0,0\n"),
            ": line 2: column period = \"-1\": must be a whole number");
  EXPECT_EQ(responseComplaint(response_header + "\n1,2,3,1,2,15,1,0,0,0,0,0,0,0,0,0,0,0,0\n"),
            ": line 2: column steady = \"2\": must be a whole number");
  const TemporaryDirectory directory;
  EXPECT_THAT(complaint([&] { readImpactTable(directory.path()); }), HasSubstr("it is a directory"));
  EXPECT_THAT(complaint([&] { readImpactTable(directory.path() + "/no.csv"); }), HasSubstr("No such file"));
  // A file that opens and then cannot be read, as on a bad disk.
  EXPECT_EQ(complaint([] { readImpactTable("/proc/self/mem"); }), "/proc/self/mem: cannot be read: Input/output error");
}

TEST(OutputDirectory, ReplacesFilesAndLeavesNothingElse)
{
  const TemporaryDirectory directory;
  directory.file("a.csv", "old");
  const OutputDirectory output(directory.path());
  output.write({{"a.csv", "new"}, {"b.csv", "other"}});
  EXPECT_EQ(readText(directory.path() + "/a.csv"), "new");
  EXPECT_EQ(readText(directory.path() + "/b.csv"), "other");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory.path()), {}), 2);
}

TEST(OutputDirectory, RefusesAPlaceThatCannotBeADirectory)
{
  const TemporaryDirectory directory;
  const std::string file = directory.file("file", "precious");
  EXPECT_THAT(complaint([&] { OutputDirectory output(file); }), HasSubstr(file + ": cannot be created: "));
  EXPECT_THAT(complaint([&] { OutputDirectory output(file + "/below"); }),
              HasSubstr(file + "/below: cannot be created: "));
  EXPECT_EQ(complaint([&] { OutputDirectory output(""); }), "the name of the output directory is empty");
  EXPECT_EQ(readText(file), "precious");
}

TEST(OutputDirectory, RefusesADirectoryThatCannotBeWritten)
{
  const TemporaryDirectory directory;
  const std::string closed = directory.path() + "/closed";
  std::filesystem::create_directory(closed);
  std::filesystem::permissions(closed, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  std::filesystem::permissions(directory.path(), std::filesystem::perms::all);
  // Permissions do not stop root.
  const uid_t user = geteuid();
  if (user == 0)
  {
    ASSERT_EQ(seteuid(65534), 0);
  }
  const std::string message = complaint([&] { OutputDirectory output(closed); });
  if (user == 0)
  {
    ASSERT_EQ(seteuid(0), 0);
  }
  EXPECT_THAT(message, HasSubstr(closed));
  EXPECT_THAT(message, HasSubstr("Permission denied"));
}

TEST(OutputDirectory, LeavesNothingBehindWhenWritingFails)
{
  const TemporaryDirectory directory;
  const OutputDirectory output(directory.path());

  // A disk that is full after 1000 bytes, as far as this program can tell.
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 1000;
  const auto handler = signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = complaint([&] { output.write({{"a.csv", "short"}, {"b.csv", std::string(2000, 'x')}}); });
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  signal(SIGXFSZ, handler);

  EXPECT_EQ(message, directory.path() + "/b.csv: cannot be written: File too large");
  EXPECT_TRUE(directory.empty());
}

}  // namespace
}  // namespace vibro_impact::config
