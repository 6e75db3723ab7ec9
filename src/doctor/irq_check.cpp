#include "doctor/irq_check.hpp"

#include "doctor/interrupt_threads.hpp"

namespace rc10::doctor {
namespace {

std::string fixFor(const CanReader& reader) {
  if (reader.priority < kInterruptPriority)
    return "sudo systemctl enable --now rc10-irq.service   # without the service: sudo rc10-irq --watch";
  return "sudo rc10-irq --watch --priority " + std::to_string(reader.priority + 1) +
         "   # or a lower priority of " + (reader.is_rx ? "rx" : "scheduler") + " in the configuration";
}

}  // namespace

Finding checkInterruptThreads(const std::string& interface, const std::vector<Process>& threads,
                              const CanReader& reader) {
  const std::string what = interface + " interrupt threads";
  if (threads.empty()) return pass(what, "none: its interrupts are not served by a thread");
  std::string low;
  std::string all;
  for (const auto& thread : threads) {
    const std::string words = thread.name + " " + priorityText(thread);
    all += (all.empty() ? "" : ", ") + words;
    if (thread.fifo && thread.priority > reader.priority) continue;
    low += (low.empty() ? "" : ", ") + words;
  }
  if (low.empty()) return pass(what, all);
  return warn(what,
              low + ": below rc10d's " + (reader.is_rx ? "receive thread" : "scheduler") + " (" +
                  std::to_string(reader.priority) + "), which then waits for what it holds up",
              fixFor(reader));
}

}  // namespace rc10::doctor
