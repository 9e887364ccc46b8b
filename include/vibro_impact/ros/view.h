#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include <ros/ros.h>
#include <vibro_impact/Impact.h>
#include <vibro_impact/ModelInfo.h>
#include <vibro_impact/StructureMotion.h>

#include "vibro_impact/ros/log_throttle.h"
#include "vibro_impact/ros/motion_player.h"
#include "vibro_impact/ros/round_scale.h"
#include "vibro_impact/ros/view_scene.h"

namespace vibro_impact::graph
{
/// What the private parameters of a view say.
struct ViewParameters
{
  double frame_rate = 25.0;         ///< scenes per second of wall time, Hz
  double slow_motion = 0.0;         ///< shown time over stream time; 0: a drive cycle takes about two seconds
  double stretch = 6.0;             ///< shown time of a stretch of the motion, s
  double fade = 8.0;                ///< shown time over which the mark of an impact fades, s
  double displacement_scale = 0.0;  ///< drawn over true displacement; 0: automatic
  double force_scale = 0.0;         ///< drawn metres of the arrow for a newton; 0: automatic
};

/// Reads them; throws config::Error with all faults, `name` the name of the tree.
ViewParameters parseViewParameters(const XmlRpc::XmlRpcValue& tree, const std::string& name);

/// Draws what a simulator moves: motion, impact and model_info in, `view` (visualization_msgs/MarkerArray) out, slowed.
/// It listens to `motion` only while somebody looks at `view`.
///
/// All callbacks must come from one thread at a time.
class View
{
public:
  /// Throws config::Error with all faults of the private parameters.
  View(const ros::NodeHandle& node, const ros::NodeHandle& private_node);

private:
  void onModelInfo(const ModelInfo& info);
  void onMotion(const StructureMotion& motion);
  void onImpact(const Impact& impact);
  void onFrame(const ros::WallTimerEvent& event);
  visualization_msgs::MarkerArray scene();
  std::string complaint() const;
  void measureStretch();
  void addToStretch(const Impact& impact);
  double fade() const;

  ros::NodeHandle node_;
  ViewParameters parameters_;
  MotionPlayer player_;
  RoundScale displacement_scale_;
  RoundScale force_scale_;
  RoundScale impulse_scale_;
  std::unique_ptr<ViewScene> scene_;
  std::string model_fault_;              ///< why there is no scene_ though a model_info has come
  std::deque<Impact> impacts_;           ///< the newest
  std::vector<Impact> stretch_impacts_;  ///< those of the stretch that is shown, and those that fade in it
  ros::SteadyTime last_motion_;
  LogThrottle refusals_;
  ros::Publisher publisher_;
  ros::Subscriber model_info_subscriber_;
  ros::Subscriber impact_subscriber_;
  ros::Subscriber motion_subscriber_;
  ros::WallTimer timer_;
};

}  // namespace vibro_impact::graph
