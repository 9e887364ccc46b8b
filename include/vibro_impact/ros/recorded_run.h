#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <ros/time.h>
#include <vibro_impact/BaseExcitation.h>
#include <vibro_impact/Impact.h>
#include <vibro_impact/ModelInfo.h>
#include <vibro_impact/StreamStart.h>

namespace vibro_impact::graph
{
/// A block of samples without its samples.
struct BlockHead
{
  std::uint64_t seq = 0;       ///< number of the first sample
  std::uint64_t samples = 0;   ///< how many there are
  ros::Time stamp;             ///< of the first sample
  double sample_period = 0.0;  ///< s

  std::uint64_t end() const
  {
    return seq + samples;
  }
};

/// Of a message BaseExcitation, Gap or ContactForce that has so many samples.
template <typename Block>
BlockHead headOf(const Block& block, std::size_t samples)
{
  return {block.seq, samples, block.header.stamp, block.sample_period};
}

/// Who is told what a recording holds, in the order in which it was recorded.
class RecordingSink
{
public:
  virtual ~RecordingSink() = default;
  virtual void onExcitation(const BaseExcitation& block) = 0;
  virtual void onGap(const BlockHead& block, const std::vector<double>& gap) = 0;  ///< `gap`: its samples, m
  virtual void onContactForce(const BlockHead& block,
                              const std::vector<double>& force) = 0;  ///< `force`: its samples, N
  virtual void onImpact(const Impact& impact) = 0;
  virtual void onModelInfo(const ModelInfo& info) = 0;
  virtual void onStreamStart(const StreamStart& start) = 0;
};

/// The topics of a run in a recording, found by the types of their messages; empty where there is none.
struct RecordedTopics
{
  std::string base_excitation;
  std::string gap;
  std::string contact_force;
  std::string impact;
  std::string model_info;
  std::string stream_start;
};

/// What a recording must hold.
enum class RecordedContents
{
  whole_run,  ///< excitation, its answers and model_info; there may be no impacts, since a recorder knows no topic on
              ///< which nothing was ever published
  excitation  ///< that alone will do; answers and impacts are not looked for
};

/// One or several bags of one run: a split bag is read as one.
class RecordedRun
{
public:
  /// How much has been read, from 0 to 1.
  using Progress = std::function<void(double)>;

  /// Opens the bags and finds the topics; where several have one type, that in `name_space` (such as "/rig1") is taken.
  /// `excitation`, unless it is empty, names the topic of the excitation. Throws config::Error, with a line that names
  /// the bag and says what to do, if a bag is missing, no bag, cut off or without an index, and if a topic is missing
  /// or ambiguous.
  explicit RecordedRun(const std::vector<std::string>& paths, const std::string& name_space = "",
                       RecordedContents contents = RecordedContents::whole_run, const std::string& excitation = "");
  ~RecordedRun();
  RecordedRun(RecordedRun&&) noexcept;
  RecordedRun& operator=(RecordedRun&&) noexcept;

  const RecordedTopics& topics() const;

  /// Reads everything, ordered by the time of recording. Throws config::Error if a bag is damaged.
  void read(RecordingSink& sink, const Progress& progress = {}) const;

  /// Reads model_info alone.
  void readModelInfo(const std::function<void(const ModelInfo&)>& sink) const;

  /// Reads the excitation alone.
  void readExcitation(const std::function<void(const BaseExcitation&)>& sink, const Progress& progress = {}) const;

  struct Implementation;

private:
  std::unique_ptr<Implementation> implementation_;
};

/// Reads one topic of one or several bags, ordered by the time of recording: of BaseExcitation,
/// geometry_msgs/AccelStamped or sensor_msgs/Imu. Throws config::Error as RecordedRun does.
template <typename Message>
void readTopic(const std::vector<std::string>& paths, const std::string& topic,
               const std::function<void(const Message&)>& sink);

}  // namespace vibro_impact::graph
