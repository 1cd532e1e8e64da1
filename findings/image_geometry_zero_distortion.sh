#!/usr/bin/env bash
# image_geometry 1.16.2: with all coefficients zero, a raw pixel is taken for a rectified one; a baseline is subtracted from pixels.
#
# Downloads the packages below into a temporary folder, compiles and runs a program against them, and fails when its output has changed.
# Needs Debian 12 (amd64) with its package lists, the network and g++. Nothing is installed. See README.md.
set -euo pipefail
export LC_ALL=C

packages=(
  libimage-geometry1d=1.16.2+ds-1+b3 libimage-geometry-dev=1.16.2+ds-1+b3 libsensor-msgs-dev=1.13.1-1+b1 libstd-msgs-dev
  libroscpp-core-dev libboost1.74-dev
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
#include <image_geometry/pinhole_camera_model.h>
#include <string>

sensor_msgs::CameraInfo camera(const std::string& model, double first, double fx, double fy) {
  sensor_msgs::CameraInfo info;
  info.width = 1280;
  info.height = 960;
  info.distortion_model = model;
  info.D.assign(model == "equidistant" ? 4 : 5, 0.0);
  info.D[0] = first;
  info.K = {fx, 0.0, 640.0, 0.0, fy, 480.0, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {fx, 0.0, 640.0, 0.0, 0.0, fy, 480.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

void show(const char* what, const sensor_msgs::CameraInfo& info, const cv::Point2d& pixel, bool is_raw) {
  image_geometry::PinholeCameraModel model;
  model.fromCameraInfo(info);
  const cv::Point3d ray = model.projectPixelTo3dRay(is_raw ? model.rectifyPoint(pixel) : pixel);
  std::printf("%s: azimuth %.6f rad\n", what, std::atan2(-ray.x, ray.z));
}

int main() {
  const cv::Point2d sixty(640.0 + 400.0 * std::acos(-1.0) / 3.0, 480.0);  // 60 degrees off the axis
  show("equidistant, k1 = 0 (right: -1.047198)", camera("equidistant", 0.0, 400.0, 400.0), sixty, true);
  show("equidistant, k1 = 1e-12", camera("equidistant", 1e-12, 400.0, 400.0), sixty, true);

  for (const double k1 : {0.0, 1e-12}) {
    sensor_msgs::CameraInfo other = camera("plumb_bob", k1, 600.0, 610.0);
    other.P = {500.0, 0.0, 630.0, 0.0, 0.0, 505.0, 470.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    show(k1 == 0.0 ? "P other than K, k1 = 0 (right: -0.408908)" : "P other than K, k1 = 1e-12", other, {900.0, 700.0}, true);
    other = camera("plumb_bob", k1, 600.0, 610.0);
    const double c = std::cos(0.1), s = std::sin(0.1);
    other.R = {c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c};
    show(k1 == 0.0 ? "R of 0.1 rad, k1 = 0 (right: -0.508908)" : "R of 0.1 rad, k1 = 1e-12", other, {900.0, 480.0}, true);
  }

  sensor_msgs::CameraInfo right = camera("plumb_bob", 0.0, 600.0, 610.0);
  right.P[3] = -600.0 * 0.12;
  show("principal point of a camera with a baseline of 0.12 m (right: 0)", right, {640.0, 480.0}, false);

  sensor_msgs::CameraInfo binned = camera("plumb_bob", 0.0, 600.0, 610.0);
  binned.binning_x = binned.binning_y = 2;
  show("binning 2 (right: 0.379788)", binned, {200.0, 150.0}, false);
}
PROGRAM
g++ -std=c++17 -O1 -I root/usr/include -I root/usr/include/opencv4 program.cpp -o program \
  "$libraries/libimage_geometry.so.1d" "$libraries/libopencv_calib3d.so.406" "$libraries/libopencv_core.so.406" -Wl,--allow-shlib-undefined
if ldd program | grep 'opencv\|image_geometry' | grep -v "$folder"; then
  echo "$0: the libraries of the temporary folder are not the ones that are used" >&2
  exit 2
fi

cat > expected <<'EXPECTED'
equidistant, k1 = 0 (right: -1.047198): azimuth -0.808449 rad
equidistant, k1 = 1e-12: azimuth -1.047198 rad
P other than K, k1 = 0 (right: -0.408908): azimuth -0.495133 rad
R of 0.1 rad, k1 = 0 (right: -0.508908): azimuth -0.408908 rad
P other than K, k1 = 1e-12: azimuth -0.408908 rad
R of 0.1 rad, k1 = 1e-12: azimuth -0.508908 rad
principal point of a camera with a baseline of 0.12 m (right: 0): azimuth -0.119429 rad
binning 2 (right: 0.379788): azimuth 0.380506 rad
EXPECTED
./program > seen
echo "Packages: ${packages[*]}" | grep -o 'lib\(image-geometry1d\|opencv-calib3d406\)=[^ ]*'
cat seen
if ! diff expected seen; then
  echo "$0: the behaviour has changed: look again at what was built on it" >&2
  exit 1
fi
echo "$0: as found."
