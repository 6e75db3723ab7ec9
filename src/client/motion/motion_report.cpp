#include "client/motion/motion_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

#include "app/text_table.hpp"
#include "client/quantity_text.hpp"
#include "link/words.hpp"

namespace rc10::client {
namespace {

// Lines of a Bode table that one reads.
constexpr std::size_t kBodeLines = 12;

using Series = std::vector<double>;

Series seriesOf(const Curve& curve, double CurveSample::*member) {
  Series values;
  values.reserve(curve.size());
  for (const auto& sample : curve) values.push_back(sample.*member);
  return values;
}

double largest(const Curve& curve, double CurveSample::*member) {
  double most = std::numeric_limits<double>::quiet_NaN();
  for (const auto& sample : curve) {
    const double value = std::abs(sample.*member);
    if (!(most >= value) && !std::isnan(value)) most = value;
  }
  return most;
}

// The first tick of a step; the end of the curve: it is none, or did not get there.
Curve::const_iterator stepIn(const MotionRun& test) {
  const auto& excitation = test.settings().excitation;
  const auto& curve = test.curve();
  if (excitation.kind != ExcitationKind::kStep) return curve.end();
  const double target = test.origin() + excitation.base + excitation.amplitude;
  return std::find_if(curve.begin(), curve.end(),
                      [target](const auto& sample) { return sample.target == target; });
}

std::optional<StepResponse> stepOf(const MotionRun& test) {
  const auto& excitation = test.settings().excitation;
  const double start = test.origin() + excitation.base;
  const double target = start + excitation.amplitude;
  const auto& curve = test.curve();
  const auto begin = stepIn(test);
  if (begin == curve.end()) return std::nullopt;
  auto times = seriesOf(curve, &CurveSample::time_s);
  for (auto& time_s : times) time_s -= begin->time_s;
  return judgeStep(times, seriesOf(curve, &CurveSample::measured), start, target);
}

// Slope of the velocity by least squares, from when the current has risen.
double accelerationOf(const MotionRun& test) {
  constexpr double kRisingS = 0.02;
  const auto begin = stepIn(test);
  if (begin == test.curve().end() || test.settings().mode != ControlMode::kCurrent)
    return std::numeric_limits<double>::quiet_NaN();
  double count = 0.0;
  double time = 0.0;
  double velocity = 0.0;
  double squares = 0.0;
  double products = 0.0;
  for (const auto& sample : std::span(begin, test.curve().end())) {
    const double time_s = sample.time_s - begin->time_s - kRisingS;
    if (time_s < 0.0 || !std::isfinite(sample.velocity_rpm)) continue;
    count += 1.0;
    time += time_s;
    velocity += sample.velocity_rpm;
    squares += time_s * time_s;
    products += time_s * sample.velocity_rpm;
  }
  const double spread = squares - time * time / count;
  if (!(spread > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return (products - time * velocity / count) / spread;
}

// On the grid of the ticks from this time on: a tick that is missing is put between its neighbours.
Series onGrid(const Series& times, const Series& values, double from_s, double tick_s) {
  Series grid;
  std::size_t after = 1;
  for (double time_s = from_s; time_s <= times.back(); time_s += tick_s) {
    while (after + 1 < times.size() && times[after] < time_s) ++after;
    const double share = (time_s - times[after - 1]) / (times[after] - times[after - 1]);
    grid.push_back(values[after - 1] + share * (values[after] - values[after - 1]));
  }
  return grid;
}

FrequencyResponse responseOf(const MotionRun& test) {
  const auto& excitation = test.settings().excitation;
  const bool sweep = excitation.kind == ExcitationKind::kSweep;
  if (!sweep && excitation.kind != ExcitationKind::kMultisine) return {};
  const auto& curve = test.curve();
  // Angles from the origin: large offsets cost digits.
  Series inputs;
  Series outputs;
  Series times;
  for (const auto& sample : curve) {
    const double input = sample.target_shaped - test.origin();
    const double output = sample.measured - test.origin();
    if (!std::isfinite(input) || !std::isfinite(output)) continue;
    times.push_back(sample.time_s);
    inputs.push_back(input);
    outputs.push_back(output);
  }
  if (times.size() < 3) return {};
  const FrequencyBand band{excitation.from_hz, excitation.to_hz, sweep ? 0.0 : excitation.from_hz};
  return estimateResponse(onGrid(times, inputs, Excitation::kLeadS, test.tickS()),
                          onGrid(times, outputs, Excitation::kLeadS, test.tickS()), test.tickS(), band);
}

std::string nameAnd(std::string_view name, const std::string& value) {
  constexpr std::size_t kNameWidth = 22;
  std::string line{name};
  line.resize(std::max(kNameWidth, line.size() + 2), ' ');
  return line + value + '\n';
}

// Nine digits: those of a float, and of a microsecond in a test.
std::string csvLine(std::initializer_list<double> values) {
  std::string line;
  for (const double value : values) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.9g", value);
    line += (line.empty() ? "" : ",") + std::string(text.data());
  }
  return line + '\n';
}

Json abortJson(const std::optional<Abort>& abort) {
  if (!abort) return nullptr;
  return {{"criterion", toString(abort->criterion)},
          {"value", abort->value},
          {"limit", abort->limit},
          {"unit", abort->unit},
          {"text", abort->text}};
}

Json stepJson(const std::optional<StepResponse>& step) {
  if (!step) return nullptr;
  return {{"rise_s", step->rise_s},
          {"overshoot_percent", step->overshoot_percent},
          {"peak", step->peak},
          {"peak_s", step->peak_s},
          {"settling_s", step->settling_s},
          {"steady_error", step->steady_error}};
}

Json bodeJson(const FrequencyResponse& response) {
  Json points = Json::array();
  const auto phases = phasesDeg(response);
  for (std::size_t i = 0; i < response.size(); ++i)
    points.push_back({{"frequency_hz", response[i].frequency_hz},
                      {"gain_db", response[i].gainDb()},
                      {"phase_deg", phases[i]},
                      {"coherence", response[i].coherence}});
  return points;
}

// About equal ratios from one to the next.
std::vector<std::size_t> someOf(const FrequencyResponse& response) {
  std::vector<std::size_t> places;
  const double ratio = std::pow(response.back().frequency_hz / response.front().frequency_hz,
                                1.0 / static_cast<double>(kBodeLines - 1));
  double next_hz = 0.0;
  for (std::size_t i = 0; i < response.size(); ++i) {
    if (response[i].frequency_hz < next_hz * (1.0 - 1e-9)) continue;
    places.push_back(i);
    next_hz = response[i].frequency_hz * ratio;
  }
  return places;
}

std::string bodeText(const FrequencyResponse& response) {
  const auto right = TextTable::Align::kRight;
  TextTable table({{"FREQUENCY", right}, {"GAIN", right}, {"PHASE", right}, {"COHERENCE", right}});
  const auto phases = phasesDeg(response);
  for (const auto i : someOf(response))
    table.add({quantity(response[i].frequency_hz, 2, "Hz"), quantity(response[i].gainDb(), 1, "dB"),
               quantity(phases[i], 1, "deg"), number(response[i].coherence, 3)});
  return table.text();
}

std::string marginsText(const MotionReport& report) {
  const auto& margins = report.margins;
  const auto at = [](double value, int decimals, const char* unit, double hz) {
    return std::isnan(value) ? std::string("not within these frequencies")
                             : quantity(value, decimals, unit) + " at " + quantity(hz, 1, "Hz");
  };
  const std::string bandwidth = std::isnan(report.bandwidth_hz) ? "not within these frequencies"
                                                                : quantity(report.bandwidth_hz, 1, "Hz");
  return nameAnd("bandwidth (-3 dB)", bandwidth) +
         nameAnd("phase margin", at(margins.phase_deg, 1, "deg", margins.phase_at_hz)) +
         nameAnd("gain margin", at(margins.gain_db, 1, "dB", margins.gain_at_hz));
}

}  // namespace

MotionReport reportOf(const MotionRun& test) {
  const auto& curve = test.curve();
  MotionReport report;
  report.ticks = curve.size();
  const auto lead_end = std::find_if(curve.begin(), curve.end(),
                                     [](const auto& sample) { return sample.time_s >= Excitation::kLeadS; });
  const Curve excited(lead_end, curve.end());
  const auto targets = seriesOf(excited, &CurveSample::target);
  report.following = followingError(targets, seriesOf(excited, &CurveSample::measured));
  report.largest_velocity_rpm = largest(curve, &CurveSample::velocity_rpm);
  report.largest_current_a = largest(curve, &CurveSample::current_a);
  for (const auto& sample : excited) report.limits |= sample.limits;
  if (test.aborted()) return report;  // of a part of the excitation nothing else can be told
  report.step = stepOf(test);
  report.acceleration_rpm_per_s = accelerationOf(test);
  report.response = responseOf(test);
  report.bandwidth_hz = bandwidthHz(report.response);
  report.margins = stabilityMargins(report.response);
  return report;
}

std::string text(const MotionReport& report, const MotionRun& test) {
  const char* unit = unitOf(test.settings().mode);
  std::string lines = report.response.empty() ? "" : bodeText(report.response) + marginsText(report);
  if (report.step) {
    const auto& step = *report.step;
    lines += nameAnd("rise (10 to 90 %)", quantity(step.rise_s, 3, "s"));
    lines += nameAnd("overshoot", quantity(step.overshoot_percent, 1, "%"));
    lines += nameAnd("settling (to 2 %)", quantity(step.settling_s, 3, "s"));
    lines += nameAnd("steady error", quantity(step.steady_error, 2, unit));
  }
  if (!std::isnan(report.acceleration_rpm_per_s))
    lines += nameAnd("acceleration", quantity(report.acceleration_rpm_per_s, 1, "rpm/s"));
  lines += nameAnd("following error", "rms " + quantity(report.following.rms, 2, unit) + ", largest " +
                                          quantity(report.following.max, 2, unit));
  lines += nameAnd("largest speed", quantity(report.largest_velocity_rpm, 1, "rpm"));
  lines += nameAnd("largest current", quantity(report.largest_current_a, 2, "A"));
  const auto limits = link::limitWords(report.limits);
  lines += nameAnd("limits that acted", limits.empty() ? "none" : limits);
  return lines;
}

Json jsonOf(const MotionReport& report, const MotionRun& test) {
  const auto& settings = test.settings();
  return {{"motor", settings.motor},
          {"kind", toString(settings.excitation.kind)},
          {"mode", toString(settings.mode)},
          {"unit", unitOf(settings.mode)},
          {"origin", test.origin()},
          {"ticks", report.ticks},
          {"abort", abortJson(test.aborted())},
          {"following_error", {{"rms", report.following.rms}, {"max", report.following.max}}},
          {"largest_velocity_rpm", report.largest_velocity_rpm},
          {"largest_current_a", report.largest_current_a},
          {"limits", listOf(link::limitWords(report.limits))},
          {"step", stepJson(report.step)},
          {"acceleration_rpm_per_s", report.acceleration_rpm_per_s},
          {"bandwidth_hz", report.bandwidth_hz},
          {"phase_margin_deg", report.margins.phase_deg},
          {"phase_margin_at_hz", report.margins.phase_at_hz},
          {"gain_margin_db", report.margins.gain_db},
          {"gain_margin_at_hz", report.margins.gain_at_hz},
          {"response", bodeJson(report.response)}};
}

std::string curveCsv(const Curve& curve) {
  std::string csv =
      "time_s,target,target_shaped,measured,total_angle_deg,velocity_rpm,current_a,feedback_age_us,limits\n";
  for (const auto& s : curve)
    csv += csvLine({s.time_s, s.target, s.target_shaped, s.measured, s.total_angle_deg, s.velocity_rpm,
                    s.current_a, s.feedback_age_us, static_cast<double>(s.limits)});
  return csv;
}

std::string bodeCsv(const FrequencyResponse& response) {
  std::string csv = "frequency_hz,gain_db,phase_deg,coherence\n";
  const auto phases = phasesDeg(response);
  for (std::size_t i = 0; i < response.size(); ++i)
    csv += csvLine({response[i].frequency_hz, response[i].gainDb(), phases[i], response[i].coherence});
  return csv;
}

}  // namespace rc10::client
