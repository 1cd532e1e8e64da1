#pragma once

#include <string>

/// Where the tests find files that are not compiled in.
namespace sightline::test {

/// Top folder of the sources, with config/, launch/ and scripts/.
std::string sourceDirectory();

/// Folder of the shared design and recordings ($SIGHTLINE_SHARED_DIR, or ../shared); empty where there is
/// none.
std::string sharedDirectory();

}  // namespace sightline::test
