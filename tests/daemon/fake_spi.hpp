#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "daemon/devices/spi_keeper.hpp"

namespace rc10::test {

/// An SPI device that remembers what was sent, and may be missing or fail.
struct FakeSpi {
  std::vector<std::vector<std::uint8_t>> sent;
  std::string missing;  ///< Reason why it cannot be opened; empty: it can.
  int error = 0;        ///< Error of every transfer; 0: it succeeds.
  int opened = 0;
  std::uint32_t speed_hz = 0;

  [[nodiscard]] SpiKeeper::Open opener() {
    return [this](const std::string& path, std::uint32_t hz) -> Result<std::unique_ptr<SpiPort>> {
      if (!missing.empty()) return fail("SPI device '" + path + "': " + missing);
      ++opened;
      speed_hz = hz;
      return std::make_unique<Port>(*this);
    };
  }

 private:
  class Port final : public SpiPort {
   public:
    explicit Port(FakeSpi& spi) : spi_(spi) {}
    [[nodiscard]] int send(std::span<const std::uint8_t> bytes) noexcept override {
      if (spi_.error == 0) spi_.sent.emplace_back(bytes.begin(), bytes.end());
      return spi_.error;
    }

   private:
    FakeSpi& spi_;
  };
};

}  // namespace rc10::test
