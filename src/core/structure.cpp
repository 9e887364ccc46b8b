#include "vibro_impact/core/structure.h"

#include "vibro_impact/core/beam.h"
#include "vibro_impact/core/modal_table.h"

namespace vibro_impact::core
{
namespace
{
std::unique_ptr<const Structure> make(const BeamParameters& parameters)
{
  return std::make_unique<Beam>(parameters);
}

std::unique_ptr<const Structure> make(const RigidSurface& /*surface*/)
{
  return nullptr;
}

std::unique_ptr<const Structure> make(const ModalTableParameters& parameters)
{
  return std::make_unique<ModalTable>(parameters);
}

}  // namespace

std::unique_ptr<const Structure> makeStructure(const StructureParameters& parameters)
{
  return std::visit([](const auto& kind) { return make(kind); }, parameters);
}

}  // namespace vibro_impact::core
