// For libFuzzer (-fsanitize=fuzzer of clang): the first byte chooses the target, the others are the case.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "fuzz/fuzz_targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size < 2) return 0;
  const auto& targets = sightline_fuzz::coreTargets();
  const sightline_fuzz::FuzzTarget& target = targets[bytes[0] % targets.size()];
  sightline_fuzz::RandomInput input(bytes + 1, size - 1);
  sightline_fuzz::Trial trial;
  try {
    target.run(input, trial);
  } catch (const std::exception& fault) {
    std::fprintf(stderr, "FAULT %s, call %llu: %s\n", target.name.c_str(),
                 static_cast<unsigned long long>(trial.calls()), fault.what());
    std::abort();
  }
  return 0;
}
