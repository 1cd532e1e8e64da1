#pragma once

namespace sightline::core {

/// A grey image: row by row, without gaps. The brightness has any unit and scale.
struct GreyImage {
  const float* pixels = nullptr;
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
};

}  // namespace sightline::core
