#include "vibro_impact/config/spelling.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace vibro_impact::config
{
namespace
{
// The least number of inserted, deleted, replaced or swapped neighbouring characters that turns `a` into `b`; if it is
// more than `most`, any number above that.
std::size_t editDistance(const std::string& a, const std::string& b, std::size_t most)
{
  // Rows of the table of all beginnings of `a` against all beginnings of `b`: that of i characters of `a`, and the two
  // before it.
  std::vector<std::size_t> row(b.size() + 1);
  std::vector<std::size_t> above(b.size() + 1);
  std::vector<std::size_t> two_above(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i)
  {
    std::swap(two_above, above);
    std::swap(above, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j)
    {
      const std::size_t replaced = above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
      {
        row[j] = std::min(row[j], two_above[j - 2] + 1);
      }
    }
    // What follows is at least as much as the least of two rows.
    if (*std::min_element(row.begin(), row.end()) > most && *std::min_element(above.begin(), above.end()) > most)
    {
      return most + 1;
    }
  }
  return row.back();
}

std::string lowerCase(std::string text)
{
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

}  // namespace

std::optional<std::string> nearest(const std::string& misspelt, const std::vector<std::string>& words)
{
  constexpr std::size_t longest = 60;
  if (misspelt.size() > longest)
  {
    return std::nullopt;
  }
  const std::string spelt = lowerCase(misspelt);
  std::optional<std::string> best;
  std::size_t least = longest;
  for (const std::string& word : words)
  {
    // Every character that one is longer than the other is a wrong one.
    const std::size_t longer = std::max(spelt.size(), word.size()) - std::min(spelt.size(), word.size());
    if (3 * longer > word.size())
    {
      continue;
    }
    const std::size_t distance = editDistance(spelt, word, word.size() / 3);
    if (3 * distance <= word.size() && distance < least)
    {
      best = word;
      least = distance;
    }
  }
  return best;
}

}  // namespace vibro_impact::config
