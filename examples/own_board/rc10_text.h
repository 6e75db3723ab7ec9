/* Text lines between a board and rc10d's module serial_link, `protocol: text`. C99, no allocation.
 *   rc10_text_put("range,1250", uart_write);                     sends $range,1250*55
 *   if (rc10_text_get(&line, byte)) sscanf(line.text, "claw,%f,%f", &angle_deg, &speed);
 * Numbers are plain decimals (no exponent, no +, at most 15 digits), the line at most 120 bytes. `line` is
 * static or zeroed; the next byte may overwrite its text: copy it before that. With newlib-nano %f needs
 * `-u _printf_float -u _scanf_float`; or send whole tenths, with `scale: 0.1` in the robot's file.
 */
#ifndef RC10_TEXT_H
#define RC10_TEXT_H

#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef struct {
  char text[120]; /* text between $ and *, once rc10_text_get() has returned 1 */
  uint8_t size;
  uint8_t in_line;
} rc10_text_line;

static uint8_t rc10_text_sum(const char *text, size_t size) {
  uint8_t sum = 0;
  for (size_t i = 0; i < size; ++i) sum ^= (uint8_t)text[i];
  return sum;
}

/* `write`: your UART's. */
static void rc10_text_put(const char *content, void (*write)(const uint8_t *bytes, size_t size)) {
  char out[121]; /* rc10d drops a longer line */
  const int size = snprintf(out, sizeof out, "$%s*%02X\n", content, rc10_text_sum(content, strlen(content)));
  if (size > 0 && size < (int)sizeof out) write((const uint8_t *)out, (size_t)size);
}

/* One byte from the UART. 1: a line is whole and its checksum is right. */
static int rc10_text_get(rc10_text_line *line, uint8_t byte) {
  static const char hex[] = "0123456789ABCDEF";
  if (byte == '$') {
    line->size = 0;
    line->in_line = 1;
    return 0;
  }
  if (!line->in_line) return 0;
  if (byte != '\n') {
    if (line->size == sizeof line->text - 1) line->in_line = 0; /* too long */
    if (line->in_line) line->text[line->size++] = (char)byte;
    return 0;
  }
  line->in_line = 0;
  if (line->size > 0 && line->text[line->size - 1] == '\r') --line->size;
  if (line->size < 4 || line->text[line->size - 3] != '*') return 0;
  const uint8_t sum = rc10_text_sum(line->text, (size_t)line->size - 3);
  if (line->text[line->size - 2] != hex[sum >> 4] || line->text[line->size - 1] != hex[sum & 15]) return 0;
  line->text[line->size - 3] = '\0';
  return 1;
}

#endif
