#pragma once

#include <array>
#include <string>
#include <vector>

#include <visualization_msgs/MarkerArray.h>

#include "vibro_impact/core/parameters.h"
#include "vibro_impact/core/structure_shapes.h"
#include "vibro_impact/core/switched_model.h"

namespace vibro_impact::graph
{
/// Both structures, the contact point, the force and the last impacts as markers for RViz, in base_frame: z is the
/// contact normal; structure 1 lies above along x, structure 2 below along y. The contact point is at the origin.
/// Relative to the base: supports stand still.
///
/// The longest beam is drawn one metre long, sections and lengths by the same factor; displacements and gap by another.
class ViewScene
{
public:
  struct Impact
  {
    double age = 0.0;      ///< share of the time over which it fades, 0 to 1
    double impulse = 0.0;  ///< N s
  };

  /// What is to be seen at one time.
  struct Moment
  {
    const double* coordinates = nullptr;  ///< StructureShapes::size() of them
    double gap = 0.0;                     ///< m
    double force = 0.0;                   ///< N
    std::vector<Impact> impacts;          ///< at most most_impacts are drawn, the first ones
    double displacement_scale = 1.0;      ///< drawn over true displacement
    double force_scale = 1.0;             ///< drawn length of the arrow over force, m/N
    double largest_impulse = 0.0;         ///< has the largest mark, N s
    std::string text;                     ///< lines above the scene
  };

  static constexpr std::size_t most_impacts = 24;

  explicit ViewScene(const core::SystemParameters& parameters);

  /// Whose structureModes() the coordinates are.
  const core::SwitchedModel& model() const
  {
    return model_;
  }

  /// Drawn over true length.
  double lengthScale() const
  {
    return length_scale_;
  }

  /// The largest displacement of any point, or gap, m.
  double extent(const double* coordinates, double gap);

  /// Markers of the same names each time; what is not there is deleted.
  visualization_msgs::MarkerArray draw(const Moment& moment);

  /// A text alone, everything else deleted.
  static visualization_msgs::MarkerArray drawText(const std::string& text);

private:
  using Point = std::array<double, 2>;  ///< sideways and upwards, m

  /// How a structure is drawn.
  struct Side
  {
    std::vector<Point> section;  ///< corners, counted round; of a beam
    double half_height = 0.0;    ///< from the middle of the section to the contact surface, drawn
    std::vector<double> size;    ///< of the section at each position, as a factor
    std::vector<double> along;   ///< positions from the contact point, drawn
    std::array<core::End, 2> ends = {core::End::free, core::End::free};
  };

  Side makeSide(const core::StructureParameters& parameters, int structure) const;
  void addStructure(int structure, double height, double scale, visualization_msgs::MarkerArray& scene) const;
  void addSupports(int structure, double height, visualization_msgs::MarkerArray& scene) const;

  core::SystemParameters parameters_;
  core::SwitchedModel model_;
  core::StructureShapes shapes_;
  double length_scale_;
  std::array<Side, 2> sides_;
  core::StructureShapes::Displacements displacements_;
};

}  // namespace vibro_impact::graph
