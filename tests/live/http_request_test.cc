// Bytes of strangers as requests: what is not exactly one is refused.
#include "sim/live/server/http_request.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "sim/live/server/page_server.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kGood =
    "POST /switch?token=ab HTTP/1.1\r\n"
    "hOST:  127.0.0.1:80 \r\n"
    "Accept: */*\r\n"
    "Origin: http://127.0.0.1:80\r\n"
    "X-Empty:\r\n"
    "Content-Length: 12\r\n"
    "\r\n";

/// A head with further fields, and one of them in place of the host.
std::string With(std::string_view fields) {
  return "GET / HTTP/1.1\r\nHost: a:1\r\n" + std::string(fields) + "\r\n";
}
std::string Of(std::string_view line) { return std::string(line) + "\r\nHost: a:1\r\n\r\n"; }

TEST(HttpRequest, ReadsWhatABrowserSends) {
  const auto head = ReadHttpHead(kGood);
  ASSERT_TRUE(head);
  EXPECT_EQ(head->method, "POST");
  EXPECT_EQ(head->path, "/switch");
  EXPECT_EQ(head->query, "token=ab");
  EXPECT_EQ(head->host, "127.0.0.1:80");
  EXPECT_EQ(head->origin, "http://127.0.0.1:80");
  EXPECT_EQ(head->body_bytes, 12U);

  const auto least = ReadHttpHead("GET / HTTP/1.1\r\nHost: a:1\r\n\r\n");
  ASSERT_TRUE(least);
  EXPECT_EQ(least->path, "/");
  EXPECT_EQ(least->query, "");
  EXPECT_FALSE(least->origin);
  EXPECT_EQ(least->body_bytes, 0U);
}

TEST(HttpRequest, HeadEndsWithItsEmptyLine) {
  const std::string request = std::string(kGood) + "tuned_kalman\r\n\r\n";
  EXPECT_EQ(HttpHeadSize(request), kGood.size());
  for (std::size_t size = 0; size < kGood.size(); ++size) {
    ASSERT_EQ(HttpHeadSize(kGood.substr(0, size)), 0U) << size;
  }
  EXPECT_EQ(HttpHeadSize("GET / HTTP/1.1\nHost: a:1\n\n"), 0U);
}

TEST(HttpRequest, RefusesALineThatIsNotOne) {
  EXPECT_TRUE(ReadHttpHead(Of("GET /?a HTTP/1.1")));
  for (const std::string_view line :
       {"GET / HTTP/1.0", "GET / HTTP/1.2", "GET / HTTP/2", "GET / http/1.1", "GET /", "GET", "",
        "GET  / HTTP/1.1", "GET / HTTP/1.1 ", " GET / HTTP/1.1", "GET / / HTTP/1.1",
        "GET a HTTP/1.1", "GET http://a:1/ HTTP/1.1", "GET * HTTP/1.1", "G(T / HTTP/1.1",
        "GET\t/ HTTP/1.1", "GET /\t HTTP/1.1", "GET /\x7F HTTP/1.1", "GET /\xC3\xA4 HTTP/1.1"}) {
    EXPECT_FALSE(ReadHttpHead(Of(line))) << line;
  }
  EXPECT_FALSE(ReadHttpHead(Of(std::string_view("GET /\0 HTTP/1.1", 15))));
  EXPECT_FALSE(ReadHttpHead(Of("GET /\n HTTP/1.1")));
}

TEST(HttpRequest, RefusesFieldsThatCanBeReadInTwoWays) {
  EXPECT_TRUE(ReadHttpHead(With("A: b c\t\xC3\xA4\r\n")));
  for (const std::string_view fields : {"Host: a:1\r\n",
                                        "Origin: a\r\nORIGIN: a\r\n",
                                        "Content-Length: 1\r\nContent-Length: 1\r\n",
                                        "Content-Length: \r\n",
                                        "Content-Length: +1\r\n",
                                        "Content-Length: -1\r\n",
                                        "Content-Length: 1 1\r\n",
                                        "Content-Length: 1,1\r\n",
                                        "Content-Length: 0x1\r\n",
                                        "Content-Length: 99999999999999999999\r\n",
                                        "Transfer-Encoding: chunked\r\n",
                                        "transfer-encoding: identity\r\n",
                                        "Expect: 100-continue\r\n",
                                        " folded\r\n",
                                        "A : b\r\n",
                                        ": b\r\n",
                                        "no colon\r\n",
                                        "A: b\rc\r\n",
                                        "A: b\nHost: c\r\n",
                                        "A\xC3: b\r\n",
                                        "A: \x7F\r\n",
                                        "A: \x01\r\n"}) {
    EXPECT_FALSE(ReadHttpHead(With(fields))) << fields;
  }
  EXPECT_FALSE(ReadHttpHead(With(std::string_view("A: \0\r\n", 6))));
  EXPECT_FALSE(ReadHttpHead("GET / HTTP/1.1\r\n\r\n")) << "no host";
}

TEST(HttpRequest, TakesAParameterThatIsThereOnce) {
  EXPECT_EQ(QueryValue("token=ab", "token"), "ab");
  EXPECT_EQ(QueryValue("a=1&token=ab=c&b", "token"), "ab=c");
  for (const std::string_view query :
       {"", "token", "token=", "xtoken=ab", "token2=ab", "Token=ab", "token=ab&token=ab", "&"}) {
    EXPECT_EQ(QueryValue(query, "token"), "") << query;
  }
}

TEST(PageMessage, OnlyWhatAPageCanSendIsTaken) {
  using Kind = PageMessage::Kind;
  constexpr std::size_t kControllers = 2;
  for (const PageMessage& good :
       {PageMessage{Kind::kSwitch, 0}, PageMessage{Kind::kSwitch, 1}, PageMessage{Kind::kMark, 0},
        PageMessage{Kind::kMark, 1}, PageMessage{Kind::kEnded, -1}, PageMessage{Kind::kEnded, 9}}) {
    EXPECT_TRUE(IsOfPage(good, kControllers)) << good.number;
  }
  for (const PageMessage& bad :
       {PageMessage{Kind::kSwitch, -1}, PageMessage{Kind::kSwitch, 2},
        PageMessage{Kind::kSwitch, INT32_MIN}, PageMessage{Kind::kMark, -1},
        PageMessage{Kind::kMark, 2}, PageMessage{Kind::kEnded, -2}, PageMessage{Kind::kEnded, 65},
        PageMessage{static_cast<Kind>(3), 0}, PageMessage{static_cast<Kind>(-1), 0}}) {
    EXPECT_FALSE(IsOfPage(bad, kControllers)) << static_cast<int>(bad.kind) << ' ' << bad.number;
  }
}

}  // namespace
}  // namespace gauntlet::sim
