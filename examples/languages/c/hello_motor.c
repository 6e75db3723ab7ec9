// Enables one motor, turns it for a second and prints its state; Ctrl-C lets go of it. C, with nothing but
// LCM.
//   hello_motor ROBOT MOTOR RPM
#include <inttypes.h>
#include <lcm/lcm.h>
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "rc10_command_t.h"
#include "rc10_event_t.h"
#include "rc10_named_value_t.h"
#include "rc10_request_t.h"
#include "rc10_response_t.h"
#include "rc10_robot_state_t.h"

enum {
  kMotorStatus = 100,    // code of the events "ACTIVE -> READY (…)"
  kPauseUs = 100000,     // between two commands: Ctrl-Z, a busy computer
  kPatienceUs = 1000000  // for a state of after it
};

static char client[] = "hello-c";
static volatile sig_atomic_t interrupted = 0;

static void onInterrupt(int number) {
  (void)number;
  interrupted = 1;
}

typedef struct {
  lcm_t* lcm;
  const char* robot;
  char* motor;
  int64_t session;  // of this run; a later run has another
  int64_t seq;      // grows with every message of ours
  int64_t awaited;  // the request whose answer is awaited
  int8_t status;    // of that answer, -1: none yet
  bool enabled;     // by us
  int64_t commanded_us;
  int64_t state_us;   // time of the newest state
  char owner[32];     // client that commands the motor, by that state
  int8_t stop_cause;  // cause of its last stop
  char stopped[128];  // by whom or by what
  int64_t printed_us;
} program_t;

static int64_t nowUs(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

static const char* channel(const program_t* program, const char* kind) {
  static char name[128];
  snprintf(name, sizeof name, "%s.v1.%s", program->robot, kind);
  return name;
}

static void onState(const lcm_recv_buf_t* buffer, const char* name, const rc10_robot_state_t* state,
                    void* user) {
  (void)buffer;
  (void)name;
  program_t* program = user;
  program->state_us = state->mono_us;
  for (int i = 0; i < state->motor_count; ++i) {
    const rc10_motor_state_t* motor = &state->motors[i];
    if (strcmp(motor->name, program->motor) != 0) continue;
    snprintf(program->owner, sizeof program->owner, "%s", motor->owner);
    program->stop_cause = motor->stop_cause;
    if (state->mono_us < program->printed_us + 100000) continue;
    program->printed_us = state->mono_us;
    printf("%s status %d owner '%s' target %.1f measured %.1f rpm %.2f A\n", motor->name, motor->status,
           motor->owner, motor->target, (double)motor->velocity_rpm, (double)motor->current_a);
    fflush(stdout);
  }
}

static void stop(program_t* program, const char* why) {
  if (program->stopped[0] == '\0') snprintf(program->stopped, sizeof program->stopped, "%s", why);
}

// A motor that was stopped, and that somebody enables anew, is not driven on.
static void onEvent(const lcm_recv_buf_t* buffer, const char* name, const rc10_event_t* event, void* user) {
  (void)buffer;
  (void)name;
  program_t* program = user;
  const bool of_motor = event->code == kMotorStatus && strcmp(event->source, program->motor) == 0;
  if (program->enabled && of_motor && strncmp(event->text, "ACTIVE -> ", 10) == 0) stop(program, event->text);
}

static void onResponse(const lcm_recv_buf_t* buffer, const char* name, const rc10_response_t* response,
                       void* user) {
  (void)buffer;
  (void)name;
  program_t* program = user;
  // All clients hear all answers.
  if (response->session != program->session || response->seq != program->awaited) return;
  program->status = response->status;
  if (response->status != RC10_RESPONSE_T_STATUS_OK) fprintf(stderr, "hello_motor: %s\n", response->message);
}

static void receiveUntil(const program_t* program, int64_t end_us) {
  for (int64_t left_us; (left_us = end_us - nowUs(CLOCK_MONOTONIC)) > 0;) {
    lcm_handle_timeout(program->lcm, (int)(left_us / 1000) + 1);
  }
}

// Sends a request under one number until it is answered: rc10d carries it out once.
static bool request(program_t* program, char* operation, rc10_named_value_t* value) {
  rc10_request_t message = {.utime = nowUs(CLOCK_REALTIME),
                            .client = client,
                            .session = program->session,
                            .seq = ++program->seq,
                            .operation = operation,
                            .target = program->motor,
                            .value_count = value ? 1 : 0,
                            .values = value};
  program->awaited = message.seq;
  program->status = -1;
  for (int i = 0; i < 50 && program->status < 0; ++i) {
    rc10_request_t_publish(program->lcm, channel(program, "request"), &message);
    const int64_t end_us = nowUs(CLOCK_MONOTONIC) + 100000;
    while (program->status < 0 && nowUs(CLOCK_MONOTONIC) < end_us) lcm_handle_timeout(program->lcm, 10);
  }
  if (program->status < 0) fprintf(stderr, "hello_motor: no answer to '%s': is rc10d running?\n", operation);
  return program->status == RC10_RESPONSE_T_STATUS_OK;
}

// False once the motor was stopped. Events of a pause of ours may be lost: a state of after it shows what has
// become of the target.
static bool mayGoOn(program_t* program) {
  const int64_t resumed_us = nowUs(CLOCK_MONOTONIC);
  while (lcm_handle_timeout(program->lcm, 0) > 0) continue;  // all that waits
  if (program->commanded_us > 0 && resumed_us > program->commanded_us + kPauseUs) {
    while (program->state_us < resumed_us && nowUs(CLOCK_MONOTONIC) < resumed_us + kPatienceUs) {
      lcm_handle_timeout(program->lcm, 10);
    }
    const bool ours = strcmp(program->owner, client) == 0;
    const bool lapsed = program->owner[0] == '\0' && program->stop_cause == RC10_MOTOR_STATE_T_STOP_TIMEOUT;
    if (program->state_us < resumed_us || !(ours || lapsed)) stop(program, "in a pause of this program");
  }
  return program->stopped[0] == '\0';
}

static void command(program_t* program, int8_t mode, double value) {
  rc10_setpoint_t setpoint = {.motor = program->motor,
                              .mode = mode,
                              .value = value,
                              .stiffness_nm_per_rad = NAN,
                              .damping_nms_per_rad = NAN};
  rc10_command_t message = {.utime = nowUs(CLOCK_REALTIME),
                            .client = client,
                            .session = program->session,
                            .seq = ++program->seq,
                            .validity_ms = 100,
                            .setpoint_count = 1,
                            .setpoints = &setpoint};
  rc10_command_t_publish(program->lcm, channel(program, "command"), &message);
  program->commanded_us = nowUs(CLOCK_MONOTONIC);
}

int main(int count, char** words) {
  if (count != 4) {
    fprintf(stderr, "usage: hello_motor ROBOT MOTOR RPM\n");
    return 2;
  }
  program_t program = {.lcm = lcm_create(NULL), .robot = words[1], .motor = words[2]};
  if (program.lcm == NULL) {
    fprintf(stderr,
            "hello_motor: LCM could not start: sudo ip route add 239.255.76.67/32 dev lo src 127.0.0.1\n");
    return 1;
  }
  FILE* random = fopen("/dev/urandom", "rb");
  if (random == NULL || fread(&program.session, sizeof program.session, 1, random) != 1) return 1;
  fclose(random);
  // Ctrl-C ends the loop below, and the motor is disabled as ever; SA_RESETHAND: a second one ends at once.
  const struct sigaction on_interrupt = {.sa_handler = onInterrupt, .sa_flags = SA_RESETHAND};
  sigaction(SIGINT, &on_interrupt, NULL);
  sigaction(SIGTERM, &on_interrupt, NULL);
  rc10_robot_state_t_subscribe(program.lcm, channel(&program, "state"), onState, &program);
  rc10_event_t_subscribe(program.lcm, channel(&program, "event"), onEvent, &program);
  rc10_response_t_subscribe(program.lcm, channel(&program, "response"), onResponse, &program);

  program.enabled = request(&program, "enable", NULL);
  // The loop is what keeps the motor going: a command acts for 100 ms.
  for (int i = 0; program.enabled && !interrupted && mayGoOn(&program) && i < 50; ++i) {
    command(&program, RC10_SETPOINT_T_MODE_VELOCITY, atof(words[3]));
    receiveUntil(&program, nowUs(CLOCK_MONOTONIC) + 20000);
  }
  bool disabled = false;
  if (mayGoOn(&program)) {
    command(&program, RC10_SETPOINT_T_MODE_COAST, 0.0);
    // With our end: what an e-stop holds meanwhile stays held.
    rc10_named_value_t at_end = {.name = "at_end", .value = 1.0};
    disabled = request(&program, "disable", &at_end);
  } else {  // and, if it is enabled again, in the hands of another
    fprintf(stderr, "hello_motor: %s was stopped: %s\n", program.motor, program.stopped);
  }
  lcm_destroy(program.lcm);
  if (interrupted) return 130;
  return program.enabled && disabled ? 0 : 1;
}
