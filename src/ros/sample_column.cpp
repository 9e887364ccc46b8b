#include "vibro_impact/ros/sample_column.h"

#include <algorithm>
#include <new>

namespace vibro_impact::graph
{
void SampleColumn::resize(std::size_t size)
{
  if (size > capacity_)
  {
    reserve(std::max(size, 2 * capacity_));
  }
  size_ = size;
}

void SampleColumn::shrinkToFit()
{
  reserve(std::max<std::size_t>(size_, 1));
}

void SampleColumn::reserve(std::size_t capacity)
{
  if (capacity > static_cast<std::size_t>(-1) / sizeof(double))
  {
    throw std::bad_alloc();
  }
  void* const moved = std::realloc(values_.get(), capacity * sizeof(double));
  if (moved == nullptr)
  {
    throw std::bad_alloc();
  }
  static_cast<void>(values_.release());  // realloc has freed or kept it
  values_.reset(static_cast<double*>(moved));
  capacity_ = capacity;
}

}  // namespace vibro_impact::graph
