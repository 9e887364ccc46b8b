#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>

namespace vibro_impact::graph
{
/// Samples in one piece that grows without being copied where the system can move its pages: a recording of minutes
/// needs no more memory than its samples. Not initialised where it has grown.
class SampleColumn
{
public:
  std::size_t size() const
  {
    return size_;
  }
  const double* data() const
  {
    return values_.get();
  }
  double* data()
  {
    return values_.get();
  }

  /// Throws std::bad_alloc where there is no more memory.
  void resize(std::size_t size);

  /// Gives back what was allocated for growth.
  void shrinkToFit();

private:
  void reserve(std::size_t capacity);

  struct Free
  {
    void operator()(double* values) const
    {
      std::free(values);
    }
  };
  std::unique_ptr<double[], Free> values_;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace vibro_impact::graph
