#include "doctor/report.hpp"

#include <algorithm>

#include "app/printable.hpp"
#include "app/style.hpp"
#include "client/json_line.hpp"

namespace rc10::doctor {
namespace {

std::string_view styleOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass: return style::kGood;
    case Verdict::kWarn: return style::kDoubtful;
    case Verdict::kFail: return style::kBad;
  }
  return {};
}

double micros(Duration duration) { return static_cast<double>(duration.count()) / 1000.0; }

}  // namespace

std::string text(const Finding& finding, bool colour) {
  const std::string mark =
      style::styled(word(finding.verdict), colour ? styleOf(finding.verdict) : std::string_view{});
  // Names of interfaces and threads come from the computer, not from us.
  std::string text = mark + "  " + printable(finding.what) + ": " + printable(finding.why) + "\n";
  if (!finding.fix.empty()) text += "      fix: " + printable(finding.fix) + "\n";
  return text;
}

std::string summary(const Findings& findings) {
  const auto count = [&](Verdict verdict) {
    return std::to_string(std::count_if(findings.begin(), findings.end(),
                                        [verdict](const auto& f) { return f.verdict == verdict; }));
  };
  return count(Verdict::kPass) + " passed, " + count(Verdict::kWarn) + " warned, " + count(Verdict::kFail) +
         " failed\n";
}

std::string json(const Finding& finding) {
  return client::lineOf({{"check", finding.what},
                         {"status", word(finding.verdict)},
                         {"why", finding.why},
                         {"fix", finding.fix.empty() ? client::Json(nullptr) : client::Json(finding.fix)}});
}

std::string json(const LatencyHistogram& histogram) {
  client::Json list = client::Json::array();
  for (const auto& row : rows(histogram))
    list.push_back({{"up_to_us", row.up_to_us != 0 ? client::Json(row.up_to_us) : client::Json(nullptr)},
                    {"count", row.count}});
  return client::lineOf({{"histogram", std::move(list)},
                         {"wake_ups", histogram.count()},
                         {"p50_us", micros(histogram.percentile(0.5))},
                         {"p99_us", micros(histogram.percentile(0.99))},
                         {"p999_us", micros(histogram.percentile(0.999))},
                         {"max_us", micros(histogram.max())}});
}

}  // namespace rc10::doctor
