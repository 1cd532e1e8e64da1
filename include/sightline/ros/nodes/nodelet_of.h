#pragma once

#include <exception>
#include <memory>

#include <nodelet/nodelet.h>

namespace sightline_ros {

/// A nodelet that does nothing but hold a node.
template <typename Node>
class NodeletOf : public nodelet::Nodelet {
  void onInit() override {
    try {
      node_ = std::make_unique<Node>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& problem) {
      // The nodelet loader would die without a word.
      NODELET_FATAL_STREAM(problem.what());
      throw;
    }
  }

  std::unique_ptr<Node> node_;
};

}  // namespace sightline_ros
