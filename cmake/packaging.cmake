# cpack, run in the build folder, makes a .deb for the Debian release that it runs on. The package lies as Debian's own ROS
# packages do, in /usr/share/sightline, /usr/lib/sightline and /usr/lib, where roslaunch and rosrun find it without
# anything being sourced. Included at the end of CMakeLists.txt, after everything that is installed.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME ${PROJECT_NAME})
set(CPACK_PACKAGE_VERSION ${sightline_VERSION})  # of package.xml
set(CPACK_PACKAGE_CONTACT "The sightline developers <sightline@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "tracks and fuses the angular sightings of several passive sensors (ROS)")
set(CPACK_PACKAGE_DESCRIPTION "Azimuth and elevation in, tracks with honest covariances out: trackers, track fusion,
a six-sensor simulation and tools for recordings, as ROS nodes, nodelets and a C++ library.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# The libraries are found by dpkg-shlibdeps; what is started or imported at run time is named here. The names are those of
# Debian 12 and 13 alike.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_CURRENT_BINARY_DIR} ${CATKIN_DEVEL_PREFIX}/lib)
string(JOIN ", " CPACK_DEBIAN_PACKAGE_DEPENDS
  python3-roslaunch rosout      # roslaunch and what it starts
  rosbash                       # rosrun, in scripts/play_sightings
  python3-rosbag                # rosbag record and play
  libnodeletlib-tools           # the nodelet manager
  python3-genpy python3-std-msgs  # our messages in Python
)
string(JOIN ", " CPACK_DEBIAN_PACKAGE_RECOMMENDS
  rviz python3-matplotlib python3-plotly
  python3-rostopic python3-rosnode python3-rosparam python3-rosservice
  python3-diagnostic-msgs python3-geometry-msgs python3-nav-msgs python3-sensor-msgs python3-std-srvs python3-tf2-msgs
  python3-visualization-msgs python3-dynamic-reconfigure)
# Headers and sightlineConfig.cmake are in the package too: what a program needs that builds against it.
string(JOIN ", " CPACK_DEBIAN_PACKAGE_SUGGESTS libroscpp-dev libtf2-ros-dev libeigen3-dev libyaml-cpp-dev)

set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_BINARY_DIR}/check_packaging.cmake)
if(CATKIN_INSTALL_INTO_PREFIX_ROOT)
  # catkin would install the setup files of a workspace, and outside the package at that.
  file(WRITE ${CPACK_PROJECT_CONFIG_FILE} "message(FATAL_ERROR
    \"To package sightline, configure with -DCATKIN_INSTALL_INTO_PREFIX_ROOT=OFF, as scripts/build does.\")\n")
else()
  file(WRITE ${CPACK_PROJECT_CONFIG_FILE} "")
endif()

# What is installed, made into what Debian expects in /usr:
# - libraries lie in the folder of the machine's architecture, the only one where Debian's pluginlib looks for nodelets;
# - what other packages read to build against this one, written by catkin, names /usr and that folder;
# - what Python compiled here is left out.
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_BINARY_DIR}/tidy_package.cmake)
file(WRITE ${CPACK_PRE_BUILD_SCRIPTS} "set(configured \"${CMAKE_INSTALL_PREFIX}\")
set(libraries lib/${CMAKE_LIBRARY_ARCHITECTURE})\n" [=[
set(usr ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/usr)
file(MAKE_DIRECTORY ${usr}/${libraries})
file(GLOB found ${usr}/lib/libsightline_*)
foreach(library IN LISTS found)
  get_filename_component(name ${library} NAME)
  file(RENAME ${library} ${usr}/${libraries}/${name})
endforeach()
foreach(file lib/pkgconfig/sightline.pc share/sightline/cmake/sightlineConfig.cmake)
  file(READ ${usr}/${file} text)
  if(NOT configured STREQUAL /usr)
    string(REPLACE "${configured}" /usr text "${text}")
  endif()
  string(REPLACE "-L\${prefix}/lib " "-L\${prefix}/${libraries} " text "${text}")
  file(WRITE ${usr}/${file} "${text}")
endforeach()
file(GLOB compiled ${usr}/lib/python3/dist-packages/sightline/__pycache__
  ${usr}/lib/python3/dist-packages/sightline/*/__pycache__)
if(compiled)
  file(REMOVE_RECURSE ${compiled})
endif()
]=])
# The build folder lies in the source folder as a rule, where a second six_sensors.launch would keep roslaunch from starting
# the first.
set(CPACK_POST_BUILD_SCRIPTS ${CMAKE_CURRENT_BINARY_DIR}/remove_package_tree.cmake)
file(WRITE ${CPACK_POST_BUILD_SCRIPTS} "file(REMOVE_RECURSE \${CPACK_TEMPORARY_INSTALL_DIRECTORY}/usr)\n")

include(CPack)
