#include "vibro_impact/core/parameters.h"

namespace vibro_impact::core
{
}
