#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/result.hpp"
#include "bus/bus_health.hpp"
#include "bus/can_frame.hpp"
#include "bus/can_socket.hpp"
#include "bus/command_packer.hpp"
#include "bus/foreign_listener.hpp"
#include "bus/frame_listener.hpp"
#include "bus/frame_table.hpp"
#include "bus/frame_tap.hpp"

namespace rc10 {

class SendBatch;

struct BusCounters {
  std::uint64_t rx_frames = 0;           ///< Data and remote frames; error frames are counted by health().
  std::uint64_t rx_unmatched = 0;        ///< Belong to no registered device.
  std::uint64_t rx_malformed = 0;        ///< A known id with a wrong length or content.
  std::uint64_t rx_foreign = 0;          ///< With a command id of ours: somebody else sends it.
  std::uint64_t tx_frames = 0;           ///< Accepted by the kernel.
  std::uint64_t tx_dropped = 0;          ///< Refused, by the kernel or before; never retried.
  std::uint64_t tx_held = 0;             ///< Not even tried, because the bus did not carry frames.
  std::uint64_t tx_watched = 0;          ///< With a watched command id, accepted by the kernel.
  std::uint64_t tx_watched_refused = 0;  ///< With a watched command id, refused by the kernel.
  /// Unstuffed bits of all frames, for the measured load: those at the nominal bit rate, and apart from
  /// them those of the data phase of FD frames with bit rate switch.
  std::uint64_t rx_bits = 0;
  std::uint64_t rx_data_bits = 0;
  std::uint64_t tx_bits = 0;
  std::uint64_t tx_data_bits = 0;
};

/// A frame with a command id of ours that we did not send: another controller commands our motors.
struct ForeignFrame {
  CanId id;
  bool sent_here = false;  ///< By another program on this computer; else by another node on the bus.
};

/// One CAN bus: pure communication, it never knows a protocol. Holds the registered devices and
/// packers; owns the socket.
///
/// Everything here belongs to the scheduler thread after start, except that another thread may read from
/// descriptor() through a CanReceiver of its own.
class fdCANbus {
 public:
  static constexpr std::size_t kMaxDevices = FrameTable::kMaxDevices;
  static constexpr std::size_t kMaxFramesPerTick = 64;

  /// Opens a SocketCAN interface.
  [[nodiscard]] static Result<std::unique_ptr<fdCANbus>> open(std::string name, const std::string& interface,
                                                              const CanSocketOptions& options);
  /// Takes over one end of a socketpair(AF_UNIX, SOCK_SEQPACKET) that carries struct can_frame and
  /// struct canfd_frame. `fd_frames`: whether the other end understands CAN FD.
  [[nodiscard]] static std::unique_ptr<fdCANbus> adopt(std::string name, UniqueFd fd, bool fd_frames);

  fdCANbus(const fdCANbus&) = delete;
  fdCANbus& operator=(const fdCANbus&) = delete;
  ~fdCANbus();

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] int descriptor() const noexcept { return socket_.fd.get(); }
  [[nodiscard]] bool fdFrames() const noexcept { return socket_.fd_frames; }

  /// Registers the receiving half of a device. Refused, naming both, if another device could accept
  /// one of its frames or has its name. Before start only.
  [[nodiscard]] Result<void> registerMotor(FrameListener& device);
  /// Registers the sending half. Refused, naming both, if another packer sends one of its ids.
  [[nodiscard]] Result<void> registerMotor(CommandPacker& packer);

  /// The command ids whose echoes are watched (counted in tx_watched). Before start only.
  void watch(std::span<const CanId> command_ids) { watched_.assign(command_ids.begin(), command_ids.end()); }

  /// `tap` sees every frame from now on; it outlives the bus. Before start only.
  void setTap(FrameTap& tap) noexcept { tap_ = &tap; }

  /// `listener` hears what somebody else sends; it outlives the bus. Before start only.
  void setForeignListener(ForeignListener& listener) noexcept { foreign_ = &listener; }

  /// Gives a received frame to the device it belongs to; error frames go to health().
  void dispatch(const CanFrame& frame) noexcept;

  /// Collects a frame for flush(). False, and counted as dropped, when the tick is full, the frame is not
  /// valid (id, length, an error message), or an FD frame meets a classic interface.
  bool sendFrame(const CanFrame& frame) noexcept;
  /// For one frame more in this tick.
  [[nodiscard]] bool hasRoom() const noexcept;
  /// Asks every packer for its frames, starting at the one that was refused last. A packer whose frames
  /// do not all fit into the tick sends none.
  void packCommands(const Tick& tick) noexcept;
  /// The same in the last ticks of rc10d, in which every drive rests: a packer that has nothing to say in
  /// this tick says that.
  void packLastCommands(const Tick& tick) noexcept;
  /// Asks every packer for its rest frames.
  void packRest() noexcept;
  /// Is this one of the packers' rest frames, whoever sent it?
  [[nodiscard]] bool isRest(const CanFrame& frame) const noexcept;
  /// Hands everything collected to the kernel in one sendmmsg(MSG_DONTWAIT). Refused frames are
  /// dropped and counted, and their packers told; the next tick starts packing there.
  void flush() noexcept;
  /// Throws everything collected away and counts it as held back.
  void holdBack() noexcept;
  /// errno with which the kernel refused the whole last flush(), else 0. ENETDOWN and ENXIO (gone) are link
  /// states: a send can take away the socket's one notice of going down before a receive reads it.
  [[nodiscard]] int sendError() const noexcept;

  [[nodiscard]] const BusCounters& counters() const noexcept { return counters_; }
  /// The last of counters().rx_foreign.
  [[nodiscard]] const ForeignFrame& lastForeign() const noexcept { return last_foreign_; }
  [[nodiscard]] BusHealth& health() noexcept { return health_; }
  [[nodiscard]] const BusHealth& health() const noexcept { return health_; }
  [[nodiscard]] const std::vector<CommandPacker*>& packers() const noexcept { return packers_; }

 private:
  fdCANbus(std::string name, CanSocket socket);

  /// A frame that was not accepted is counted, and told to the foreign listener.
  [[gnu::noinline]] void putAside(const CanFrame& frame, FrameVerdict verdict, bool unmatched) noexcept;
  [[nodiscard]] bool isCommandId(CanId id) const noexcept;
  /// It is a rest frame of rc10-guard or rc10-stop.
  [[nodiscard]] bool stops(const CanFrame& frame) noexcept;
  bool append(const CanFrame& frame, std::optional<std::size_t> packer) noexcept;
  template <typename Pack>
  void packAll(Pack pack) noexcept;
  void countSent() noexcept;
  void tellUnsent(std::optional<std::size_t> packer) const noexcept;

  std::string name_;
  CanSocket socket_;
  FrameTable table_;
  std::vector<CommandPacker*> packers_;
  std::size_t first_packer_ = 0;
  std::optional<std::size_t> first_crowded_out_;  // the first packer whose frames the tick had no room for
  std::array<CanFrame, kMaxFramesPerPacker> packed_{};  // of one packer; bytes behind a payload may be old
  std::vector<CanId> watched_;
  FrameTap* tap_ = nullptr;
  ForeignListener* foreign_ = nullptr;
  BusCounters counters_;
  ForeignFrame last_foreign_;
  MonotonicTime stops_since_{};  // rest frames of rc10-guard and rc10-stop, counted for a second
  int stops_ = 0;
  BusHealth health_;
  std::unique_ptr<SendBatch> batch_;
};

}  // namespace rc10
