#!/usr/bin/env bash
# OpenCV 4.6.0: fisheye::undistortPoints clamps the distorted angle to 90 degrees, so that rays beyond that are wrong (here from 86.8 degrees off the axis on).
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

// k = (0.02, -0.004, 0.001, 0): the polynomial grows up to beyond 110 degrees. A pinhole image ends at 90, but what is nearer is asked for.
int main() {
  const double degree = std::acos(-1.0) / 180.0;
  const cv::Matx33d K(400.0, 0.0, 0.0, 0.0, 400.0, 0.0, 0.0, 0.0, 1.0);
  const cv::Vec4d k(0.02, -0.004, 0.001, 0.0);
  for (const double angle : {60.0, 80.0, 85.0, 87.0, 89.0, 95.0, 100.0}) {
    const double theta = angle * degree, s = theta * theta;
    const double distorted = theta * (1.0 + s * (k[0] + s * (k[1] + s * k[2])));
    const std::vector<cv::Point2d> pixel = {{400.0 * distorted, 0.0}};
    std::vector<cv::Point2d> ray;
    cv::fisheye::undistortPoints(pixel, ray, K, k);
    std::printf("%.0f degrees off the axis: found %.3f\n", angle, std::atan(ray[0].x) / degree);
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
60 degrees off the axis: found 60.000
80 degrees off the axis: found 80.000
85 degrees off the axis: found 85.000
87 degrees off the axis: found 86.804
89 degrees off the axis: found 86.881
95 degrees off the axis: found 87.096
100 degrees off the axis: found 87.258
EXPECTED
./program > seen
echo "Packages: ${packages[*]}" | grep -o 'lib\(image-geometry1d\|opencv-calib3d406\)=[^ ]*'
cat seen
if ! diff expected seen; then
  echo "$0: the behaviour has changed: look again at what was built on it" >&2
  exit 1
fi
echo "$0: as found."
