/* The board of docs/serial-devices.md, on a computer: it speaks on a serial port as the firmware would.
 *   board TEXT|COBS PORT        PORT: a serial port (115200 8N1), or - for its standard input, both ways
 * It sends its range and its claw's angle every 20 ms, and moves the claw where it is told; without a word for
 * 200 ms the claw goes to 0, whatever it was told. */
#define _DEFAULT_SOURCE
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "rc10_cobs.h"
#include "rc10_text.h"

static int port = -1;
static void uart_write(const uint8_t *bytes, size_t size) {
  if (write(port, bytes, size) < 0) exit(0); /* unplugged */
}

/* A port of Linux passes on bytes as they are only when it is told so; a firmware's UART needs none of this. */
static void make_raw(int descriptor) {
  struct termios settings;
  if (tcgetattr(descriptor, &settings) != 0) return;
  cfmakeraw(&settings);
  cfsetspeed(&settings, B115200);
  tcsetattr(descriptor, TCSANOW, &settings);
}

static long now_ms(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * 1000L + time.tv_nsec / 1000000L;
}

/* Messages of `protocol: cobs`, in the order of the fields in the robot's file (docs/serial-devices.md). */
struct __attribute__((packed)) report {
  uint8_t number;
  uint16_t range_mm;
  int16_t angle_tenths;
};
struct __attribute__((packed)) order {
  uint8_t number;
  float angle_deg;
  uint8_t speed;
};

static float claw_deg = 0.0f;
static long heard_ms = 0;

static void hear(uint8_t byte, int cobs) {
  static rc10_text_line line;
  static rc10_cobs_frame frame;
  float angle_deg = 0.0f, speed = 0.0f;
  struct order order;
  if (!cobs && rc10_text_get(&line, byte) && sscanf(line.text, "claw,%f,%f", &angle_deg, &speed) == 2) {
    claw_deg = angle_deg;
    heard_ms = now_ms();
  }
  if (cobs && rc10_cobs_get(&frame, byte) == sizeof order && frame.bytes[0] == 1) {
    memcpy(&order, frame.bytes, sizeof order);
    claw_deg = order.angle_deg;
    heard_ms = now_ms();
  }
}

static void report(int cobs) {
  char text[64];
  const struct report state = {7, 1250, (int16_t)(claw_deg * 10.0f)};
  if (cobs) {
    rc10_cobs_put(&state, sizeof state, uart_write);
    return;
  }
  rc10_text_put("range,1250", uart_write);
  snprintf(text, sizeof text, "claw,%.1f", (double)claw_deg);
  rc10_text_put(text, uart_write);
}

int main(int argc, char **argv) {
  const int cobs = argc == 3 && strcmp(argv[1], "COBS") == 0;
  if (argc != 3 || (!cobs && strcmp(argv[1], "TEXT") != 0)) {
    fprintf(stderr, "usage: board TEXT|COBS PORT     PORT: a serial port, or - for standard input\n");
    return 2;
  }
  port = strcmp(argv[2], "-") == 0 ? STDIN_FILENO : open(argv[2], O_RDWR | O_NOCTTY);
  if (port < 0) {
    perror(argv[2]);
    return 1;
  }
  make_raw(port);
  for (long next_ms = now_ms();; next_ms += 20) {
    report(cobs);
    struct pollfd entry = {port, POLLIN, 0};
    for (long left = 20; left > 0; left = next_ms + 20 - now_ms()) {
      uint8_t byte;
      if (poll(&entry, 1, (int)left) <= 0) break;
      if (read(port, &byte, 1) != 1) return 0;
      hear(byte, cobs);
    }
    if (now_ms() - heard_ms > 200) claw_deg = 0.0f;
  }
}
