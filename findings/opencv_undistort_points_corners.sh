#!/usr/bin/env bash
# OpenCV 4.6.0: undistortPoints stops after five steps, so that rays near the corners of a barrel lens are off.
#
# Downloads the packages below into a temporary folder, compiles and runs a program against them, and fails when its output has changed.
# Needs Debian 12 (amd64) with its package lists, the network and g++. Nothing is installed. See README.md.
set -euo pipefail
export LC_ALL=C

packages=(
  libopencv-calib3d406=4.6.0+dfsg-12 libopencv-core406=4.6.0+dfsg-12 libopencv-features2d406=4.6.0+dfsg-12
  libopencv-flann406=4.6.0+dfsg-12 libopencv-imgproc406=4.6.0+dfsg-12
  libopencv-calib3d-dev=4.6.0+dfsg-12 libopencv-core-dev=4.6.0+dfsg-12 libopencv-features2d-dev=4.6.0+dfsg-12
  libopencv-flann-dev=4.6.0+dfsg-12 libopencv-imgproc-dev=4.6.0+dfsg-12
  libtbb12 libblas3 liblapack3 libgfortran5 libquadmath0 libglx0 libglvnd0 libx11-6 libxcb1 libxau6 libxdmcp6 libbsd0 libmd0
)
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"

if ! apt-get -q download "${packages[@]}" > download.log 2>&1; then
  cat download.log >&2
  echo "$0: the packages cannot be downloaded: is this Debian 12 (amd64) with its package lists (apt-get update)?" >&2
  exit 2
fi
for package in *.deb; do dpkg -x "$package" root; done
libraries="$folder/root/usr/lib/x86_64-linux-gnu"
export LD_LIBRARY_PATH="$libraries:$libraries/blas:$libraries/lapack:$folder/root/lib/x86_64-linux-gnu"

cat > program.cpp <<'PROGRAM'
#include <cmath>
#include <cstdio>
#include <opencv2/calib3d.hpp>
#include <vector>

// k = (-0.26, 0.075, 0, 0, -0.009), f = 600 px: the model holds up to 62.83 degrees off the axis, 703.1 px from the centre.
int main() {
  const double degree = std::acos(-1.0) / 180.0;
  const cv::Matx33d K(600.0, 0.0, 640.0, 0.0, 600.0, 480.0, 0.0, 0.0, 1.0);
  const std::vector<double> D = {-0.26, 0.075, 0.0, 0.0, -0.009};
  for (const double angle : {20.0, 45.0, 55.0, 60.0, 62.0}) {
    const double r = std::tan(angle * degree), s = r * r;
    const double image = r * (1.0 - 0.26 * s + 0.075 * s * s - 0.009 * s * s * s);
    const std::vector<cv::Point2d> pixel = {{640.0 + 600.0 * image * 0.8, 480.0 + 600.0 * image * 0.6}};
    std::vector<cv::Point2d> ray;
    cv::undistortPoints(pixel, ray, K, D);
    const double found = std::atan(std::hypot(ray[0].x, ray[0].y)) / degree;
    std::printf("%.0f degrees off the axis, %.0f px from the centre: found %.3f\n", angle, 600.0 * image, found);
  }
}
PROGRAM
g++ -std=c++17 -O1 -I root/usr/include -I root/usr/include/opencv4 program.cpp -o program \
  "$libraries/libopencv_calib3d.so.406" "$libraries/libopencv_core.so.406" -Wl,--allow-shlib-undefined
if ldd program | grep 'opencv\|image_geometry' | grep -v "$folder"; then
  echo "$0: the libraries of the temporary folder are not the ones that are used" >&2
  exit 2
fi

cat > expected <<'EXPECTED'
20 degrees off the axis, 211 px from the centre: found 20.000
45 degrees off the axis, 484 px from the centre: found 44.976
55 degrees off the axis, 604 px from the centre: found 54.923
60 degrees off the axis, 678 px from the centre: found 59.833
62 degrees off the axis, 700 px from the centre: found 61.390
EXPECTED
./program > seen
echo "Packages: ${packages[*]}" | grep -o 'lib\(image-geometry1d\|opencv-calib3d406\)=[^ ]*'
cat seen
if ! diff expected seen; then
  echo "$0: the behaviour has changed: look again at what was built on it" >&2
  exit 1
fi
echo "$0: as found."
