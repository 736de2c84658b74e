#include "sim/live/device/address.h"

#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

using testing::HasSubstr;

TEST(DeviceAddress, IsReadInAllItsForms) {
  const auto source = [](std::string_view text) {
    return ParseDeviceAddress(text, DeviceRole::kSource);
  };
  const auto sink = [](std::string_view text) {
    return ParseDeviceAddress(text, DeviceRole::kSink);
  };
  EXPECT_EQ(source("stdin").kind, DeviceKind::kStdin);
  EXPECT_EQ(sink("stdout").kind, DeviceKind::kStdout);
  EXPECT_EQ(sink("none").kind, DeviceKind::kNone);
  EXPECT_EQ(source("file:a, b/c:d,csv").path, "a, b/c:d,csv");
  const DeviceAddress udp = source("udp:[::1]:9000,json");
  EXPECT_EQ(udp.host, "::1");
  EXPECT_EQ(udp.port, 9000);
  EXPECT_EQ(udp.format, FrameFormat::kJson);
  const DeviceAddress osc = source("osc:9001/glove/*");
  EXPECT_EQ(osc.host, "0.0.0.0");
  EXPECT_EQ(osc.port, 9001);
  EXPECT_EQ(osc.osc_address, "/glove/*");
  EXPECT_EQ(osc.format, FrameFormat::kOsc);
  EXPECT_EQ(sink("osc:robot.local:9001/motors").host, "robot.local");
  const DeviceAddress serial = source("serial:/dev/ttyUSB0@1000000,cyberglove,nodtr");
  EXPECT_EQ(serial.path, "/dev/ttyUSB0");
  EXPECT_EQ(serial.baud, 1000000);
  EXPECT_EQ(serial.format, FrameFormat::kCyberglove);
  EXPECT_EQ(serial.dtr, DeviceAddress::Dtr::kOff);
  EXPECT_EQ(source("serial:/dev/ttyACM0").baud, 115200);
}

TEST(DeviceAddress, HasNothingOfAnotherForm) {
  for (const std::string text : {"stdin", "file:glove.csv"}) {
    const DeviceAddress address = ParseDeviceAddress(text, DeviceRole::kSource);
    EXPECT_EQ(address.port, 0) << text;
    EXPECT_EQ(address.host + address.osc_address, "") << text;
    EXPECT_EQ(address.format, FrameFormat::kDetect) << text;
    EXPECT_EQ(address.dtr, DeviceAddress::Dtr::kAsFound) << text;
    EXPECT_EQ(address.baud, 115200) << text;
  }
}

TEST(DeviceAddress, ReachesTheEndsOfItsRanges) {
  const auto source = [](const std::string& text) {
    return ParseDeviceAddress(text, DeviceRole::kSource);
  };
  EXPECT_EQ(source("udp:127.0.0.1:1").port, 1);
  EXPECT_EQ(source("osc:65535").port, 65535);
  EXPECT_EQ(source("serial:/dev/x@1").baud, 1);
  EXPECT_EQ(source("serial:/dev/x@10000000").baud, 10'000'000);
  EXPECT_THROW(source("serial:/dev/x@0"), UserError);
  EXPECT_THROW(source("serial:/dev/x@10000001"), UserError);
}

TEST(DeviceAddress, ThatIsWrongIsRefusedWithWhatIsPossible) {
  const std::vector<std::pair<std::string, std::string>> sources = {
      {"", "is no source of frames: stdin, file:PATH"},
      {"usb", "is no source of frames"},
      {"stdout", "is no source of frames"},
      {"none", "is no source of frames"},
      {"file:", "has no path"},
      {"udp", "is no source of frames"},
      {"udp:9000", "has no host"},
      {"udp::9000", "the host is empty"},
      {"udp:127.0.0.1:", "the port is missing, must be 1 to 65535"},
      {"udp:127.0.0.1:0", "the port is 0, must be 1 to 65535"},
      {"udp:127.0.0.1:65536", "the port is 65536, must be 1 to 65535"},
      {"udp:127.0.0.1:9000,bianry", "bianry is not a word of this address"},
      {"udp:127.0.0.1:9000,bianry", "did you mean binary?"},
      {"udp:127.0.0.1:9000,", "is not a word of this address"},
      {"udp:127.0.0.1:9000,dtr", "dtr is not a word of this address"},
      {"osc:/glove", "the port is missing"},
      {"osc:9000/gl ove", "an OSC address contains none of"},
      {"osc:9000/*/x", "an OSC address contains none of"},
      {"serial:", "has no device"},
      {"serial:/dev/ttyUSB0@fast", "fast is no baud rate"},
  };
  for (const auto& [text, problem] : sources) {
    try {
      ParseDeviceAddress(text, DeviceRole::kSource);
      ADD_FAILURE() << text << " was taken";
    } catch (const UserError& error) {
      EXPECT_THAT(error.problem(), HasSubstr(problem)) << text;
      EXPECT_THAT(error.place(), HasSubstr(text.substr(0, 5))) << text;
    }
  }
  for (const std::string text : {"stdin", "file:x", "osc:9000/a", "osc:host:9000/a*"}) {
    EXPECT_THROW(ParseDeviceAddress(text, DeviceRole::kSink), UserError) << text;
  }
}

TEST(FrameFormatWords, AreReadAsTheyAreWritten) {
  for (int i = 0; i <= static_cast<int>(FrameFormat::kOsc); ++i) {
    const auto format = static_cast<FrameFormat>(i);
    EXPECT_EQ(ParseFrameFormat(WordOf(format)), format);
  }
  EXPECT_THROW(ParseFrameFormat("CSV"), UserError);
}

}  // namespace
}  // namespace gauntlet::sim
