// Random registrations and frames against a naive model: what FrameTable refuses, and whom it finds.

#include <fuzzer/FuzzedDataProvider.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <string>
#include <vector>

#include "bus/frame_table.hpp"

namespace {

using namespace rc10;

// Few bits that matter, so that collisions and hits are common and all frames can be enumerated.
constexpr std::uint32_t kIdBits = 6;
constexpr std::size_t kBytes = 2;

class Device : public FrameListener {
 public:
  Device(std::string name, std::vector<FrameFilter> filters, std::uint8_t picky_byte)
      : name_(std::move(name)), filters_(std::move(filters)), picky_byte_(picky_byte) {}
  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] std::span<const FrameFilter> filters() const noexcept override { return filters_; }
  [[nodiscard]] bool matchesFrame(const CanFrame& frame) const noexcept override {
    return frame.length == 0 || frame.data[0] != picky_byte_;
  }
  FrameVerdict updateFeedback(const CanFrame&) noexcept override { return FrameVerdict::kAccepted; }

 private:
  std::string name_;
  std::vector<FrameFilter> filters_;
  std::uint8_t picky_byte_;
};

void check(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

// The ids of the model: kIdBits bits, spread over the whole id so that masks and hashing see all of it.
std::uint32_t spread(std::uint32_t small, bool extended) {
  std::uint32_t id = 0;
  for (std::uint32_t bit = 0; bit < kIdBits; ++bit) {
    if ((small >> bit & 1U) != 0) id |= 1U << (bit * (extended ? 5U : 2U));
  }
  return id;
}

FrameFilter randomFilter(FuzzedDataProvider& data) {
  FrameFilter filter;
  filter.id.extended = data.ConsumeBool();
  constexpr std::uint32_t kLargest = (1U << kIdBits) - 1;
  filter.id.value = spread(data.ConsumeIntegralInRange<std::uint32_t>(0, kLargest), filter.id.extended);
  if (data.ConsumeBool()) {
    const auto ignored = data.ConsumeIntegralInRange<std::uint32_t>(0, kLargest);
    filter.mask = ~spread(ignored, filter.id.extended);
  }
  for (auto& wanted : filter.discriminators) {
    if (!data.ConsumeBool()) continue;
    wanted = PayloadDiscriminator{
        static_cast<std::uint8_t>(data.ConsumeIntegralInRange<std::size_t>(0, kBytes - 1)),
        data.ConsumeIntegral<std::uint8_t>(), data.ConsumeIntegral<std::uint8_t>()};
  }
  return filter;
}

bool naivelyAccepts(const FrameFilter& filter, CanId id, std::span<const std::uint8_t> payload) {
  if (filter.id.extended != id.extended) return false;
  for (std::uint32_t bit = 0; bit < (id.extended ? 29U : 11U); ++bit) {
    const bool wanted = (filter.mask >> bit & 1U) != 0;
    if (wanted && (filter.id.value >> bit & 1U) != (id.value >> bit & 1U)) return false;
  }
  for (const auto& wanted : filter.discriminators) {
    if (!wanted) continue;
    const auto& [index, mask, value] = *wanted;
    if (index >= payload.size() || (payload[index] & mask) != (value & mask)) return false;
  }
  return true;
}

// Some value of this byte suits both filters.
bool naivelyShareByte(const FrameFilter& a, const FrameFilter& b, std::size_t byte) {
  for (unsigned value = 0; value <= 0xFF; ++value) {
    bool suits = true;
    for (const FrameFilter* filter : {&a, &b}) {
      for (const auto& wanted : filter->discriminators)
        suits = suits && (!wanted || wanted->byte_index != byte ||
                          (value & wanted->mask) == (wanted->value & wanted->mask));
    }
    if (suits) return true;
  }
  return false;
}

// Tries every id of the model, and of each byte, as they say nothing of one another, every value.
bool naivelyOverlap(FrameFilter a, FrameFilter b) {
  for (std::size_t byte = 0; byte < kBytes; ++byte) {
    if (!naivelyShareByte(a, b, byte)) return false;
  }
  a.discriminators = {};
  b.discriminators = {};
  for (std::uint32_t small = 0; small < (1U << kIdBits); ++small) {
    const CanId id{spread(small, a.id.extended), a.id.extended};
    if (naivelyAccepts(a, id, {}) && naivelyAccepts(b, id, {})) return true;
  }
  return false;
}

bool naivelyCollide(const Device& a, const Device& b) {
  for (const FrameFilter& x : a.filters()) {
    for (const FrameFilter& y : b.filters()) {
      if (naivelyOverlap(x, y)) return true;
    }
  }
  return false;
}

const Device* naivelyFind(const std::vector<const Device*>& registered, const CanFrame& frame) {
  const Device* found = nullptr;
  for (const Device* device : registered) {
    for (const FrameFilter& filter : device->filters()) {
      if (frame.type != FrameType::kData || !naivelyAccepts(filter, frame.id, frame.payload())) continue;
      check(found == nullptr || found == device, "two devices accept one frame");
      found = device;
    }
  }
  return found != nullptr && found->matchesFrame(frame) ? found : nullptr;
}

CanFrame randomFrame(FuzzedDataProvider& data) {
  const bool extended = data.ConsumeBool();
  const auto bits = data.ConsumeIntegral<std::uint32_t>();
  // Half the ids of the model, half any.
  const CanId id{data.ConsumeBool() ? spread(bits % (1U << kIdBits), extended) : bits & idMask(extended),
                 extended};
  CanFrame frame =
      makeClassicFrame(id, data.ConsumeBytes<std::uint8_t>(data.ConsumeIntegralInRange<std::size_t>(0, 8)));
  if (data.ConsumeIntegralInRange(0, 15) == 0) frame.type = FrameType::kRemote;
  return frame;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedDataProvider data(bytes, size);
  FrameTable table;
  std::deque<Device> devices;
  std::vector<const Device*> registered;
  while (data.remaining_bytes() > 0) {
    if (data.ConsumeBool()) {
      const CanFrame frame = randomFrame(data);
      check(table.find(frame) == naivelyFind(registered, frame), "found another device than the model");
      continue;
    }
    std::vector<FrameFilter> filters(data.ConsumeIntegralInRange<std::size_t>(0, 3));
    for (FrameFilter& filter : filters) filter = randomFilter(data);
    Device& device = devices.emplace_back("d" + std::to_string(devices.size()), std::move(filters),
                                          data.ConsumeIntegral<std::uint8_t>());
    bool collides = false;
    for (const Device* other : registered) collides = collides || naivelyCollide(device, *other);
    const auto ok = table.add(device);
    const bool full = registered.size() == FrameTable::kMaxDevices;
    // A table may also be full of masks; then the message says so.
    const bool out_of_masks = !ok && ok.error().message.find("different masks") != std::string::npos;
    check(ok.has_value() == !(collides || full || out_of_masks), "registration differs from the model");
    if (ok) registered.push_back(&device);
  }
  check(table.size() == registered.size(), "the table lost count");
  return 0;
}
