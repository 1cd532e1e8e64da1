#include "support/paths.h"

#include <cstdlib>

namespace sightline::test {

std::string sourceDirectory() {
  return SIGHTLINE_SOURCE_DIR;
}

std::string sharedDirectory() {
  if (const char* directory = std::getenv("SIGHTLINE_SHARED_DIR")) return directory;
#ifdef SIGHTLINE_SHARED_DIR
  return SIGHTLINE_SHARED_DIR;
#else
  return {};
#endif
}

}  // namespace sightline::test
