#include "sightline/ros/params/param_reader.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <unistd.h>

#include <gtest/gtest.h>

namespace {

using sightline_ros::above;
using sightline_ros::anyNumber;
using sightline_ros::atLeast;
using sightline_ros::between;
using sightline_ros::inside;
using sightline_ros::ParamError;
using sightline_ros::ParamReader;

/// A YAML file that lives as long as the object.
class TemporaryYaml {
 public:
  explicit TemporaryYaml(const std::string& text)
      : path_(std::filesystem::temp_directory_path() /
              ("param_reader_test_" + std::to_string(getpid()) + ".yaml")) {
    std::ofstream(path_) << text;
  }
  ~TemporaryYaml() { std::filesystem::remove(path_); }

  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

ParamReader readerOf(const std::string& yaml) {
  return ParamReader::fromYaml(TemporaryYaml(yaml).path());
}

/// What the refusal says, less the name of the temporary file; empty when nothing was refused.
std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const ParamError& error) {
    std::string said = error.what();
    for (std::size_t at;
         (at = said.find(std::filesystem::temp_directory_path().string())) != std::string::npos;) {
      said.erase(at, said.find(".yaml", at) + 5 - at);
    }
    return said;
  }
  return "";
}

TEST(ParamReader, ValuesInRangeAreReadAndAbsentOnesFallBack) {
  const ParamReader reader = readerOf(
      "probability: 0.99\ncount: 3\nweighted: true\nestimator: imm\ntopics: [a, b]\nratios: [1, 2.5]\n");
  EXPECT_EQ(reader.number("probability", 0.5, inside(0, 1)), 0.99);
  EXPECT_EQ(reader.number("absent", 0.25, inside(0, 1)), 0.25);
  EXPECT_EQ(reader.integer("count", 1, 0, 10), 3);
  EXPECT_EQ(reader.flag("weighted", false), true);
  EXPECT_EQ(reader.choice("estimator", "twbls", {"twbls", "imm"}), "imm");
  EXPECT_EQ(reader.texts("topics", {}), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(reader.numbers("ratios", {}, anyNumber()), (std::vector<double>{1.0, 2.5}));
  EXPECT_NO_THROW(reader.finish());
}

TEST(ParamReader, NumberWithoutSignAndPointIsRefusedWithTheRemedy) {
  const ParamReader reader = readerOf("gate:\n  probability: 1e-3\n");
  EXPECT_EQ(refusal([&] { reader.sub("gate").number("probability", 0.5, inside(0, 1)); }),
            "/gate/probability: expected a number in (0, 1), got the string \"1e-3\" "
            "(write 0.001 or 1.0e-03 with a sign and a point)");
}

TEST(ParamReader, LargeNumberWithoutSignIsRefusedWithTheRemedy) {
  const ParamReader reader = readerOf("q: 1.25e3\n");
  EXPECT_EQ(refusal([&] { reader.number("q", 0.5, above(0), "rad^2/s^3"); }),
            "/q: expected a number > 0 [rad^2/s^3], got the string \"1.25e3\" "
            "(write 1250 or 1.25e+03 with a sign and a point)");
}

TEST(ParamReader, NumberOutOfRangeIsRefused) {
  const ParamReader reader = readerOf("age: -1.5\nprobability: 1\n");
  EXPECT_EQ(refusal([&] { reader.number("age", 1, atLeast(0), "s"); }),
            "/age: expected a number >= 0 [s], got -1.5");
  EXPECT_EQ(refusal([&] { reader.number("probability", 0.5, inside(0, 1)); }),
            "/probability: expected a number in (0, 1), got 1");
  EXPECT_EQ(reader.number("probability", 0.5, between(0, 1)), 1.0);
}

TEST(ParamReader, NotFiniteNumbersAreRefused) {
  const ParamReader reader = readerOf("a: .nan\nb: .inf\nc: -.inf\nlist: [1.0, .nan]\n");
  for (const char* key : {"a", "b", "c"}) {
    EXPECT_THROW(reader.number(key, 0, anyNumber()), ParamError) << key;
  }
  EXPECT_EQ(refusal([&] { reader.numbers("list", {}, anyNumber(), "rad"); }),
            "/list[1]: expected a number [rad], got nan");
}

TEST(ParamReader, WholeNumberServesAsNumberButNotTheOtherWayRound) {
  const ParamReader reader = readerOf("sigma: 3\ncount: 2.5\nalmost: 2.0\n");
  EXPECT_EQ(reader.number("sigma", 1.0, above(0)), 3.0);
  EXPECT_EQ(refusal([&] { reader.integer("count", 1, 0, 9); }),
            "/count: expected a whole number in [0, 9], got 2.5");
  EXPECT_THROW(reader.integer("almost", 1, 0, 9), ParamError);
}

TEST(ParamReader, WholeNumberOutOfRangeIsRefused) {
  const ParamReader reader = readerOf("count: 10\n");
  EXPECT_EQ(refusal([&] { reader.integer("count", 1, 0, 9); }),
            "/count: expected a whole number in [0, 9], got 10");
}

TEST(ParamReader, OtherTypesAreRefused) {
  const ParamReader reader =
      readerOf("flag: 1\ntext: 5\nlist: word\nnumber: true\nnothing: ~\nmap: {a: 1}\nnested: 3\n");
  EXPECT_EQ(refusal([&] { reader.flag("flag", false); }), "/flag: expected true or false, got 1");
  EXPECT_EQ(refusal([&] { reader.text("text", ""); }), "/text: expected a string, got 5 (put it in quotes)");
  EXPECT_EQ(refusal([&] { reader.texts("list", {}); }),
            "/list: expected a list of strings, got the string \"word\"");
  EXPECT_EQ(refusal([&] { reader.number("number", 1, anyNumber()); }),
            "/number: expected a number, got true");
  EXPECT_EQ(refusal([&] { reader.number("nothing", 1, anyNumber()); }),
            "/nothing: expected a number, got no value");
  EXPECT_EQ(refusal([&] { reader.number("map", 1, anyNumber()); }),
            "/map: expected a number, got a namespace with parameters");
  EXPECT_EQ(refusal([&] { reader.sub("nested"); }), "/nested: expected a namespace with parameters, got 3");
  EXPECT_EQ(refusal([&] { reader.list("nested"); }), "/nested: expected a list of maps, got 3");
}

TEST(ParamReader, ChoiceNamesWhatThereIsToChoose) {
  const ParamReader reader = readerOf("estimator: kallman\n");
  EXPECT_EQ(refusal([&] {
              reader.choice("estimator", "imm", {"imm", "kalman"});
            }),
            "/estimator: expected one of imm, kalman, got the string \"kallman\"");
}

TEST(ParamReader, MissingRequiredKeysAreRefused) {
  const ParamReader reader = readerOf("empty: []\nblank: ''\n");
  EXPECT_EQ(refusal([&] { reader.requiredNumber("rate", above(0), "Hz"); }),
            "/rate: expected a number > 0 [Hz], but it is not set (it is required)");
  EXPECT_EQ(refusal([&] { reader.requiredTexts("topics"); }),
            "/topics: expected a list of strings, but it is not set (it is required)");
  EXPECT_THROW(reader.requiredText("name"), ParamError);
  EXPECT_THROW(reader.requiredNumbers("numbers", anyNumber()), ParamError);
  EXPECT_THROW(reader.requiredTexts("empty"), ParamError);
  EXPECT_THROW(reader.requiredText("blank"), ParamError);
}

TEST(ParamReader, UnknownKeysAreRefusedAtEveryLevelWithTheLikelyMeaning) {
  const ParamReader reader =
      readerOf("gate:\n  probabilty: 0.9\nsensors:\n  - {name: a, colour: red}\nextra: {deep: 1}\n");
  reader.sub("gate").number("probability", 0.5, inside(0, 1));
  for (const ParamReader& sensor : reader.list("sensors")) sensor.requiredText("name");
  EXPECT_EQ(refusal([&] { reader.finish(); }),
            "/extra: nobody reads this parameter (remove it); "
            "/gate/probabilty: nobody reads this parameter (did you mean /gate/probability?); "
            "/sensors[0]/colour: nobody reads this parameter (remove it)");
}

TEST(ParamReader, SubReaderFinishesItsOwnPartOnly) {
  const ParamReader reader = readerOf("gate: {probability: 0.9}\nother: 1\n");
  const ParamReader gate = reader.sub("gate");
  gate.number("probability", 0.5, inside(0, 1));
  EXPECT_NO_THROW(gate.finish());
  EXPECT_THROW(reader.finish(), ParamError);
}

TEST(ParamReader, EmptyTreeGivesFallbacksAndFinishes) {
  const ParamReader reader(XmlRpc::XmlRpcValue(), "/node");
  EXPECT_EQ(reader.sub("gate").number("probability", 0.5, inside(0, 1)), 0.5);
  EXPECT_TRUE(reader.keys().empty());
  EXPECT_NO_THROW(reader.finish());
}

TEST(ParamReader, DifferencesNameWhatIsAbsentOrNotTheDefault) {
  const ParamReader reader = readerOf("same: 0.5\nother: 2\nlist: [1]\nsub: {flag: true}\n");
  reader.number("same", 0.5, anyNumber());
  reader.integer("other", 1, 0, 9);
  reader.numbers("list", {1.0}, anyNumber());
  reader.sub("sub").flag("flag", true);
  reader.sub("sub").text("absent", "");
  const std::vector<std::string> differences = reader.differences();
  ASSERT_EQ(differences.size(), 2u);
  EXPECT_EQ(differences[0], reader.name() + "/other");
  EXPECT_EQ(differences[1], reader.name() + "/sub/absent");
  EXPECT_EQ(reader.sub("sub").differences().size(), 1u);
}

TEST(ParamReader, YamlScalarsAreTypedAsRoslaunchTypesThem) {
  const ParamReader reader = readerOf(
      "int: 12\nhex: 0x10\nfloat: 1.0e-03\npoint: 5.\nangle: deg(180)\nradians: rad(0.5)\nyes: on\n"
      "quoted: \"1.5\"\nexponent: 1e5\nword: hello\n");
  EXPECT_EQ(reader.integer("int", 0, 0, 100), 12);
  EXPECT_EQ(reader.integer("hex", 0, 0, 100), 16);
  EXPECT_EQ(reader.number("float", 0, anyNumber()), 1e-3);
  EXPECT_EQ(reader.number("point", 0, anyNumber()), 5.0);
  EXPECT_DOUBLE_EQ(reader.number("angle", 0, anyNumber()), M_PI);
  EXPECT_EQ(reader.number("radians", 0, anyNumber()), 0.5);
  EXPECT_EQ(reader.text("quoted", ""), "1.5");
  EXPECT_EQ(reader.text("exponent", ""), "1e5");
  EXPECT_EQ(reader.text("word", ""), "hello");
  EXPECT_EQ(reader.keys().size(), 10u);
}

TEST(ParamReader, FilesThatCannotBeReadAreNamed) {
  EXPECT_EQ(refusal([] { ParamReader::fromYaml("/no/such/file.yaml"); }),
            "/no/such/file.yaml: cannot be opened (does it exist, and may it be read?)");
  EXPECT_NE(refusal([] { readerOf("a: [1\n"); }), "");
  EXPECT_EQ(refusal([] { readerOf("a: 1\na: 2\n"); }), "/a: given twice");
  EXPECT_THROW(readerOf("- 1\n- 2\n"), ParamError);
}

TEST(ParamReader, AYamlFileWithoutEndIsRefused) {
  const auto complaint = [](const std::string& text) { return refusal([&] { readerOf(text); }); };
  EXPECT_NE(complaint("a: &a [1, *a]\n").find("does an alias (*) stand within what it repeats?"),
            std::string::npos);
  std::string repeated = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";  // ten times as many in each line
  for (int k = 1; k < 5; ++k) {
    const std::string below = "*a" + std::to_string(k - 1), name = "a" + std::to_string(k);
    repeated += name + ": &" + name + " [" + below;
    for (int n = 1; n < 10; ++n) repeated += ", " + below;
    repeated += "]\n";
  }
  EXPECT_NE(complaint(repeated).find("more than 20000 values; do aliases (*) repeat one another?"),
            std::string::npos);
  EXPECT_EQ(complaint("a: &a [1, 2]\nb: *a\n"), "");
}

}  // namespace
