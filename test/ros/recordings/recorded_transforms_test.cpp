#include "sightline/ros/recordings/recorded_transforms.h"

#include <gtest/gtest.h>

#include <tf2_msgs/TFMessage.h>

#include "sightline/ros/messages/conversions.h"

#include "support/scratch_folder.h"

using namespace sightline_ros;
namespace core = sightline::core;

namespace {

tf2_msgs::TFMessage transform(const std::string& child, double stamp, double x) {
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  auto& entry = message.transforms[0];
  entry.header.stamp = ros::Time(stamp);
  entry.header.frame_id = "world";
  entry.child_frame_id = child;
  entry.transform.translation.x = x;
  entry.transform.rotation.w = 1.0;
  return message;
}

/// A fixed frame "mast", and a frame "eye" with x = 10 (time - 100 s), its transforms out of order.
class RecordedTransformsTest : public testing::Test {
 protected:
  RecordedTransformsTest() {
    {
      rosbag::Bag bag(folder_.file("in.bag"), rosbag::bagmode::Write);
      bag.write("/tf_static", ros::Time(100.0), transform("mast", 0.0, 7.0));
      for (const double stamp : {100.1, 100.0, 100.2, 100.2, 100.3})
        bag.write("/tf", ros::Time(100.0), transform("eye", stamp, 10.0 * (stamp - 100.0)));
    }
    bag_.open(folder_.file("in.bag"), rosbag::bagmode::Read);
  }

  static double xOf(const RecordedTransforms& transforms, const std::string& frame, double time) {
    return transforms.buffer().lookupTransform("world", frame, ros::Time(time)).transform.translation.x;
  }

  ScratchFolder folder_;
  rosbag::Bag bag_;
};

TEST_F(RecordedTransformsTest, AreAvailableUpToTheTimeAndInterpolated) {
  RecordedTransforms transforms(bag_, KnownTransforms::up_to_time);
  EXPECT_FALSE(transforms.buffer().canTransform("world", "eye", ros::Time(100.0)));
  transforms.advanceTo(toCore(ros::Time(100.2)));
  EXPECT_NEAR(xOf(transforms, "eye", 100.15), 1.5, 1e-6);
  EXPECT_FALSE(transforms.buffer().canTransform("world", "eye", ros::Time(100.25)));
  transforms.advanceTo(core::Time::max());
  EXPECT_NEAR(xOf(transforms, "eye", 100.25), 2.5, 1e-6);
}

TEST_F(RecordedTransformsTest, FixedOnesAreAlwaysAvailable) {
  RecordedTransforms transforms(bag_);
  EXPECT_EQ(xOf(transforms, "mast", 5000.0), 7.0);
  transforms.rewind();
  EXPECT_EQ(xOf(transforms, "mast", 5000.0), 7.0);
}

TEST_F(RecordedTransformsTest, OneFurtherThereIsOneAfterEveryTime) {
  RecordedTransforms transforms(bag_);
  transforms.advanceTo(toCore(ros::Time(100.15)));
  EXPECT_NEAR(xOf(transforms, "eye", 100.15), 1.5, 1e-6);
  EXPECT_FALSE(transforms.buffer().canTransform("world", "eye", ros::Time(100.25))) << "two further";
  EXPECT_FALSE(transforms.buffer().canTransform("world", "eye", ros::Time(99.9))) << "never extrapolated";
  transforms.advanceTo(toCore(ros::Time(100.25)));
  EXPECT_NEAR(xOf(transforms, "eye", 100.25), 2.5, 1e-6);
  transforms.advanceTo(toCore(ros::Time(100.35)));
  EXPECT_FALSE(transforms.buffer().canTransform("world", "eye", ros::Time(100.35))) << "never extrapolated";
}

TEST_F(RecordedTransformsTest, RewoundTheyBeginAgain) {
  RecordedTransforms transforms(bag_, KnownTransforms::up_to_time);
  transforms.advanceTo(core::Time::max());
  transforms.rewind();
  EXPECT_FALSE(transforms.buffer().canTransform("world", "eye", ros::Time(100.1)));
  transforms.advanceTo(toCore(ros::Time(100.1)));
  EXPECT_NEAR(xOf(transforms, "eye", 100.05), 0.5, 1e-6);
}

}  // namespace
