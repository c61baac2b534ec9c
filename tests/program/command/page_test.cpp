// SPDX-License-Identifier: Apache-2.0
#include "page/page.hpp"

#include <gtest/gtest.h>

#include <string>

#include "program/support/nozzle_job.hpp"
#include "report/job_report.hpp"

namespace dseam::program {
namespace {

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

TEST(Page, needs_nothing_beside_it) {
  const test::NozzleJob nozzle;

  const std::string html = page(nozzle.job);

  EXPECT_EQ(occurrences(html, "http"), 0U);
  EXPECT_EQ(occurrences(html, "<script"), 0U);
  EXPECT_EQ(occurrences(html, "<link"), 0U);
  EXPECT_EQ(occurrences(html, "url("), 0U);
  EXPECT_EQ(occurrences(html, "href="), occurrences(html, "href=\"data:image/png;base64,"));
}

TEST(Page, shows_the_scan_from_three_directions_with_the_seam_over_it) {
  const test::NozzleJob nozzle;

  const std::string html = page(nozzle.job);

  EXPECT_EQ(occurrences(html, "data:image/png;base64,"), 3U);
  EXPECT_GE(occurrences(html, "<path class=\"seam"), 3U);
  EXPECT_GE(occurrences(html, "<path class=\"seam bridged"), 3U);
}

TEST(Page, gives_the_verdict_with_its_reason) {
  test::NozzleJob nozzle;
  nozzle.job.weld = false;
  nozzle.job.reason = "a hole of 80 degrees";

  const std::string html = page(nozzle.job);

  EXPECT_NE(html.find("<b>Refused</b>a hole of 80 degrees"), std::string::npos);
}

TEST(Page, escapes_what_comes_from_outside) {
  const test::NozzleJob nozzle;

  EXPECT_NE(page(nozzle.job).find("simulated &lt;camera&gt; &amp; robot"), std::string::npos);
}

TEST(Page, an_empty_job_is_still_a_page) {
  const std::string html = page(JobReport{});

  EXPECT_NE(html.find("</html>"), std::string::npos);
  EXPECT_EQ(occurrences(html, "data:image"), 0U);
}

TEST(Budget, parts_add_up_as_squares) {
  EXPECT_DOUBLE_EQ(total_sigma_mm({{"a", 0.03, ""}, {"b", 0.04, ""}}), 0.05);
}

}  // namespace
}  // namespace dseam::program
