/* Binary messages between a board and rc10d's module serial_link, `protocol: cobs`. C99, no allocation.
 *   struct __attribute__((packed)) { uint8_t number; int16_t angle; float speed; } state = {7, 900, 1.5f};
 *   rc10_cobs_put(&state, sizeof state, uart_write);
 *   if ((size = rc10_cobs_get(&frame, byte)) == sizeof command && frame.bytes[0] == 1) memcpy(&command, frame.bytes, size);
 * `frame` is static or zeroed; the next byte may overwrite it: copy it before that.
 */
#ifndef RC10_COBS_H
#define RC10_COBS_H

#include <stddef.h>
#include <stdint.h>

enum { RC10_COBS_LONGEST = 128 };

typedef struct {
  uint8_t bytes[RC10_COBS_LONGEST + 4]; /* the message, when rc10_cobs_get() has returned its size */
  uint16_t size;
  uint8_t too_long;
} rc10_cobs_frame;

/* CRC-16/MODBUS */
static uint16_t rc10_cobs_crc(const uint8_t *bytes, size_t size) {
  uint16_t crc = 0xFFFF;
  for (size_t i = 0; i < size; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) ? (uint16_t)((crc >> 1) ^ 0xA001) : (uint16_t)(crc >> 1);
  }
  return crc;
}

/* `message`: 1 to 128 bytes, its number first, numbers lowest byte first. `write`: your UART's. */
static void rc10_cobs_put(const void *message, size_t size, void (*write)(const uint8_t *bytes, size_t size)) {
  const uint8_t *in = (const uint8_t *)message;
  uint8_t out[RC10_COBS_LONGEST + 4];
  if (size == 0 || size > RC10_COBS_LONGEST) return;
  const uint16_t crc = rc10_cobs_crc(in, size);
  size_t code_at = 0, at = 1;
  for (size_t i = 0; i < size + 2; ++i) {
    const uint8_t byte = i < size ? in[i] : (uint8_t)(crc >> (8 * (i - size)));
    if (byte != 0) {
      out[at++] = byte;
    } else {
      out[code_at] = (uint8_t)(at - code_at);
      code_at = at++;
    }
  }
  out[code_at] = (uint8_t)(at - code_at);
  out[at++] = 0;
  write(out, at);
}

/* One byte from the UART. The size of a message that is whole and right, else 0. */
static size_t rc10_cobs_get(rc10_cobs_frame *frame, uint8_t byte) {
  if (byte != 0) {
    if (frame->size == sizeof frame->bytes) frame->too_long = 1;
    if (!frame->too_long) frame->bytes[frame->size++] = byte;
    return 0;
  }
  const size_t stuffed = frame->too_long ? 0 : frame->size;
  frame->size = 0;
  frame->too_long = 0;
  size_t in = 0, out = 0;
  while (in < stuffed) {
    const size_t length = frame->bytes[in++] - 1u;
    if (in + length > stuffed) return 0;
    for (size_t i = 0; i < length; ++i) frame->bytes[out++] = frame->bytes[in++];
    if (length != 254 && in < stuffed) frame->bytes[out++] = 0;
  }
  if (out < 3) return 0;
  const uint16_t crc = rc10_cobs_crc(frame->bytes, out - 2);
  if (frame->bytes[out - 2] != (uint8_t)crc || frame->bytes[out - 1] != (uint8_t)(crc >> 8)) return 0;
  return out - 2;
}

#endif
