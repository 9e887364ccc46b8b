#pragma once

namespace vibro_impact::graph
{
/// Whether all threads of a process of this machine sleep at one and the same instant: then it has nothing left to do.
/// Also true if there is no such process to be seen.
bool isAsleep(int pid);

}  // namespace vibro_impact::graph
