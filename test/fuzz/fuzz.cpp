// The fuzz program of the core and of the files of other programs (fuzz_driver.cpp has its usage).
#include "fuzz/fuzz_driver.h"

int main(int argc, char** argv) {
  return sightline_fuzz::fuzzMain(argc, argv, sightline_fuzz::coreTargets());
}
