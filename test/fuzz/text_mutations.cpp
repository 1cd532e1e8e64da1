#include "fuzz/text_mutations.h"

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace sightline_fuzz {
namespace {

std::size_t placeIn(RandomInput& input, const std::string& text) {
  return text.empty() ? 0 : static_cast<std::size_t>(input.bits() % text.size());
}

std::string absurdNumber(RandomInput& input) {
  return input.oneOf<const char*>({"nan",
                                   "-nan",
                                   "inf",
                                   "-inf",
                                   "1e999",
                                   "-1e999",
                                   "1e-999",
                                   "4.9e-324",
                                   "1e308",
                                   "-0",
                                   "0",
                                   "00",
                                   "",
                                   " ",
                                   "+",
                                   "-",
                                   ".",
                                   "e",
                                   "1e",
                                   "0x10",
                                   "1,5",
                                   "1_000",
                                   "--1",
                                   "+-1",
                                   "9223372036854775807",
                                   "-9223372036854775808",
                                   "18446744073709551616",
                                   "4294967295",
                                   "4294967296",
                                   "2147483648",
                                   "99999999999999999999999999",
                                   "360",
                                   "361",
                                   "-90.0000001",
                                   "90",
                                   "2000000000.123456789123",
                                   "NULL",
                                   "\"",
                                   "\"\"",
                                   "'",
                                   "\xc3\xa9",
                                   "\xff",
                                   "*1",
                                   "&a [*a]",
                                   "{",
                                   "}",
                                   "[",
                                   "]",
                                   "<",
                                   ">",
                                   "&amp;",
                                   "#",
                                   ":",
                                   "- "});
}

/// A run of characters that could be a number, from `from` on; empty when there is none.
std::pair<std::size_t, std::size_t> numberAfter(const std::string& text, std::size_t from) {
  const auto isDigit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  std::size_t begin = from;
  while (begin < text.size() && !isDigit(text[begin])) ++begin;
  std::size_t end = begin;
  while (end < text.size() && (isDigit(text[end]) || text[end] == '.' || text[end] == 'e')) ++end;
  return {begin, end};
}

std::pair<std::size_t, std::size_t> lineAt(const std::string& text, std::size_t place) {
  const std::size_t before = place == 0 ? std::string::npos : text.rfind('\n', place - 1);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  const std::size_t end = text.find('\n', place);
  return {begin, end == std::string::npos ? text.size() : end + 1};
}

void change(RandomInput& input, std::string& text) {
  const std::size_t place = placeIn(input, text);
  const auto [line, line_end] = lineAt(text, place);
  switch (input.between(0, 11)) {
    case 0:
      if (!text.empty()) text[place] = static_cast<char>(input.between(0, 255));
      break;
    case 1:
      if (!text.empty()) text[place] = static_cast<char>(text[place] ^ (1 << input.between(0, 7)));
      break;
    case 2:
      text.erase(place, static_cast<std::size_t>(input.between(1, 20)));
      break;
    case 3:
      text.insert(place, absurdNumber(input));
      break;
    case 4:
    case 5:
    case 6: {
      const auto [begin, end] = numberAfter(text, place);
      text.replace(begin, end - begin, absurdNumber(input));
      break;
    }
    case 7:
      text.erase(line, line_end - line);
      break;
    case 8: {
      const std::string copy = text.substr(line, line_end - line);
      for (int n = input.oneOf({1, 1, 3, 50}); n > 0; --n) text.insert(line, copy);
      break;
    }
    case 9:
      text.resize(place);
      break;
    case 10: {
      const char from = input.oneOf({',', ';', ' ', '\n', '.', ':', '\t'}),
                 to = input.oneOf({',', ';', ' ', '\r', '.', ':', '\t'});
      std::replace(text.begin(), text.end(), from, to);
      break;
    }
    default: {
      const std::size_t other = placeIn(input, text);
      const auto [begin, end] = lineAt(text, other);
      const std::string moved = text.substr(begin, end - begin);
      text.insert(line, moved);
      break;
    }
  }
}

}  // namespace

std::string mutated(RandomInput& input, std::string text) {
  for (int n = input.oneOf({0, 1, 1, 2, 4, 12}); n > 0; --n) change(input, text);
  return text;
}

}  // namespace sightline_fuzz
