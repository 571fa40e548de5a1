/* The energy guard around a PID of your own, with Arduino's functions alone: a brushed motor on an H bridge, an encoder with two tracks. Change pins
 * and the motor's figures to yours. A test compiles this file against the declarations in `tests/stand_in` and runs it on a simulated motor; nobody
 * has run it on a board. */
#include <Arduino.h>
#include <touchstone.h>

const uint32_t RATE_HZ = 1000, COUNTS_PER_REV = 4096; /* counts of all edges of both tracks */
const float LARGEST_TORQUE_N_M = 0.05f;               /* of the motor at rest with full PWM: measure it */
const int TRACK_A = 2, TRACK_B = 3, DIRECTION = 4, PWM = 5;

float kp = 0.3f, ki = 0.0f, kd = 0.002f, target_rad = 0.0f; /* N*m/rad, N*m/(rad*s), N*m*s/rad, rad */

ts_guard guard;
int works = 0;
volatile uint32_t edges = 0;
uint32_t last_edges = 0;
float angle_rad = 0, integral = 0, last_error = 0;

void on_edge() {
  static const int8_t STEPS[16] = {0, 1, -1, 0, -1, 0, 0, 1, 1, 0, 0, -1, 0, -1, 1, 0};
  static uint8_t last = 0;
  last = (uint8_t)((last << 2 | digitalRead(TRACK_A) << 1 | digitalRead(TRACK_B)) & 15);
  edges = edges + (uint32_t)STEPS[last];
}

/* Commands the torque, rounded towards zero to a step of the PWM. Returns the rounded torque. */
float set_motor(float torque_n_m) {
  float share = torque_n_m / LARGEST_TORQUE_N_M, size = share < 0 ? -share : share;
  int steps = size < 1 ? (int)(255 * size) : 255;
  digitalWrite(DIRECTION, share < 0 ? LOW : HIGH);
  analogWrite(PWM, steps);
  return (float)(share < 0 ? -steps : steps) * (LARGEST_TORQUE_N_M / 255);
}

float my_pid() {
  float error = target_rad - angle_rad, change = error - last_error;
  last_error = error;
  integral += error / RATE_HZ;
  return kp * error + ki * integral + kd * change * RATE_HZ;
}

void setup() {
  Serial.begin(115200);
  pinMode(TRACK_A, INPUT_PULLUP);
  pinMode(TRACK_B, INPUT_PULLUP);
  pinMode(DIRECTION, OUTPUT);
  pinMode(PWM, OUTPUT);
  attachInterrupt(digitalPinToInterrupt(TRACK_A), on_edge, CHANGE);
  attachInterrupt(digitalPinToInterrupt(TRACK_B), on_edge, CHANGE);
  ts_guard_config config;
  ts_guard_defaults(&config);
  config.rate_hz = RATE_HZ;
  config.force_limit = TS_SI(0.05);                   /* N*m, LARGEST_TORQUE_N_M */
  config.count = TS_SI(6.283185308 / COUNTS_PER_REV); /* rad */
  config.damping = TS_SI(0.0001);                     /* of the motor alone, as measured, N*m*s/rad */
  config.capacity = TS_SI(0.02);                      /* J */
  config.delay = TS_SI(0.0005);                       /* from reading the encoder to the new torque, s */
  config.lag = TS_SI(0.0002);                         /* time constant of the torque, s */
  static char problem[160];
  works = ts_guard_init(&guard, &config) == TS_OK;
  if (!works) {
    ts_guard_check(&config, problem, sizeof problem);
    Serial.println(problem);
  }
}

void loop() {
  static uint32_t next_us = micros();
  if ((int32_t)(micros() - next_us) < 0) return;
  next_us += 1000000 / RATE_HZ;
  if (!works) return;
  uint32_t now = edges;
  int32_t moved = (int32_t)(now - last_edges);
  last_edges = now;
  angle_rad = (float)(int32_t)now * (6.2831853f / COUNTS_PER_REV);
  /* The guard counts a torque that resists a positive motion as positive. */
  ts_force torque = ts_from_float(-my_pid());
  ts_status status = ts_guard_tick(&guard, ts_moved(moved, TS_POSITION(6.283185307 / COUNTS_PER_REV)), torque, &torque);
  /* The torque is 0 after an error. The guard is told how much of it the PWM gives. */
  ts_guard_commanded(&guard, ts_from_float(-set_motor(-ts_to_float(torque))));
  if (status == TS_OK) return;
  works = 0; /* such as a motor that is too fast for the guard: off until somebody resets the board */
  Serial.println(ts_status_text(status));
}
