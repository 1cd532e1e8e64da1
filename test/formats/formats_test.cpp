#include "sightline/formats/formats.h"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "format_files.h"

namespace {

using namespace sightline::test;
using namespace sightline::formats;

TEST(Formats, EverySampleIsRecognisedByItsContentAlone) {
  const std::vector<std::pair<std::string, std::string>> samples{{"dfn_small_36.ecsv", "ecsv"},
                                                                 {"gfe.ecsv", "ecsv"},
                                                                 {"tdm_azel.txt", "tdm"},
                                                                 {"tdm_xsye.txt", "tdm"},
                                                                 {"tdm_azel.xml", "tdm-xml"},
                                                                 {"rms.txt", "rms"},
                                                                 {"cmn_apo.txt", "cmn"},
                                                                 {"odas_tracked.json", "odas"},
                                                                 {"odas_potential.json", "odas"},
                                                                 {"krakensdr.csv", "krakensdr"},
                                                                 {"iod.txt", "iod"},
                                                                 {"uk.txt", "uk"},
                                                                 {"mot_det.txt", "mot"},
                                                                 {"mot_gt.txt", "mot"}};
  for (const auto& [name, format] : samples) {
    const TextFile file("file", TextFile::fromFile(sample(name)).text());
    std::string first;
    for (const Format& one : formats()) {
      if (first.empty() && one.recognises(file)) first = one.name;
    }
    EXPECT_EQ(first, format) << name;
  }
}

TEST(Formats, WhatIsOfNoFormatIsRefusedWithTheFormatsThatThereAre) {
  const std::string why = refusalOf("hello\n");
  EXPECT_TRUE(contains(why, "none of the known formats") && contains(why, "ecsv") &&
              contains(why, "--format NAME"))
      << why;
  EXPECT_TRUE(contains(refusalOf(""), "is empty"));
  ImportOptions options;
  options.format = "fits";
  EXPECT_TRUE(contains(refusalOf("hello\n", options), "there is no format \"fits\"; there are ecsv, tdm"));
}

TEST(Formats, EveryFormatRefusesCutFilesInWordsOrReadsThem) {
  ImportOptions options = withSigma();
  options.sensor = "a";
  options.elevation = 0.0;
  options.frame_rate = 10.0;
  options.image_size = Eigen::Vector2d(640.0, 480.0);
  options.field_of_view = Eigen::Vector2d(0.5, 0.4);
  options.stations[""] = {0.8, 0.2, 100.0};
  for (const char* name :
       {"dfn_small_36.ecsv", "gfe.ecsv", "tdm_azel.txt", "tdm_azel.xml", "rms.txt", "cmn_apo.txt",
        "odas_tracked.json", "krakensdr.csv", "iod.txt", "uk.txt", "mot_det.txt"}) {
    const std::string text = TextFile::fromFile(sample(name)).text();
    for (std::size_t length = 0; length < text.size(); length += 1 + text.size() / 300) {
      std::size_t sightings = 0;
      const std::string why =
          refusal([&] { sightings = sightingsOf(read(text.substr(0, length), options)); });
      EXPECT_TRUE(sightings > 0 || contains(why, "file")) << name << " " << length << ": " << why;
    }
  }
}

TEST(Formats, TruthsHaveTargetsAndPlainNames) {
  Recording recording;
  FileSighting sighting;
  sighting.angles = {0.25, -0.5};
  sighting.target = "a,b";
  recording.scans.push_back({sightline::core::timeOf(1500000000), "s", {sighting}});
  EXPECT_EQ(truthCsv(recording),
            "time,target,sensor,azimuth,elevation\n1.500000000,a_b,s,0.2500000000,-0.5000000000\n");
}

}  // namespace
