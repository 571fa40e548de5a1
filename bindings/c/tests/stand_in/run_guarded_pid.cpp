// Runs the example of the guarded PID against the stand-in: a simulated motor with an encoder, whose PID first has the right signs and then a wrong
// one. Prints the number of the first line that fails, and exits with 1.
#include "Arduino.h"
#include "touchstone.h"
#include <cmath>
#include <cstdio>

void setup();
void loop();
extern float kp, kd, target_rad;
extern int works;

// The test compiles both files with another name for `ts_guard_commanded`, to see which torque the example reports.
#undef ts_guard_commanded
extern "C" ts_status ts_guard_commanded(ts_guard *guard, ts_force force);
static double reported_n_m = 1.0;
extern "C" ts_status reported(ts_guard *guard, ts_force force) {
  reported_n_m = ts_to_float(force);
  return ts_guard_commanded(guard, force);
}

Printer Serial;
static double angle_rad, speed_rad_per_s, torque_n_m;
static unsigned long now_us;
static long count;
static int direction, texts;
static void (*on_change)();

void Printer::begin(unsigned long) {}
void Printer::println(const char *text) {
  std::printf("%s\n", text);
  texts++;
}
unsigned long micros() { return now_us; }
void pinMode(int, int) {}
int digitalPinToInterrupt(int pin) { return pin; }
void attachInterrupt(int, void (*call)(), int) { on_change = call; }
// Track B leads: 00, 01, 11, 10.
int digitalRead(int pin) {
  const int phase = (int)(count & 3);
  return pin == 2 ? phase >> 1 : (phase ^ phase >> 1) & 1;
}
void digitalWrite(int, int value) { direction = value == HIGH ? 1 : -1; }
void analogWrite(int, int value) { torque_n_m = 0.05 * direction * value / 255; }

#define IS(what)                          \
  do {                                    \
    if (!(what)) {                        \
      std::printf("line %d\n", __LINE__); \
      return 1;                           \
    }                                     \
  } while (0)

static int wrong_reports; // ticks in which the guard was told another torque than the motor's
static double given_j, most_j; // energy out of the motor, beyond what its damping takes

static void run(int milliseconds) {
  for (int step = 0; step < 10 * milliseconds; step++) {
    loop();
    if (works) wrong_reports += std::fabs(reported_n_m + torque_n_m) > 1e-6;
    speed_rad_per_s += (torque_n_m - 0.0001 * speed_rad_per_s) / 2e-5 * 1e-4;
    angle_rad += speed_rad_per_s * 1e-4;
    given_j += (torque_n_m - 0.0001 * speed_rad_per_s) * speed_rad_per_s * 1e-4;
    most_j = std::fmax(most_j, given_j);
    const long reached = (long)std::floor(angle_rad * 4096 / 6.283185307179586 + 0.5);
    while (count != reached) {
      count += count < reached ? 1 : -1;
      on_change();
    }
    now_us += 100;
  }
}

int main() {
  now_us = 4294967000u; // the clock runs over its end while the example runs
  setup();
  IS(works && texts == 0 && on_change != nullptr);
  target_rad = 0.5f;
  run(1000);
  std::printf("went to %.3f rad\n", angle_rad);
  IS(works && std::fabs(angle_rad - 0.5) < 0.02);
  IS(wrong_reports == 0);
  // A derivative part with the wrong sign swings the motor up; the guard takes its force away.
  kd = -0.01f, given_j = most_j = 0.0, speed_rad_per_s = 1.0;
  run(5000);
  std::printf("a wrong sign gave out %.4f J\n", most_j);
  IS(most_j > 0.001 && most_j < 0.02 + 5 * 0.0005 + 0.05 * 3.1416 / 4096);
  // Far too fast under a force: the example switches the motor off and leaves it off.
  if (works) speed_rad_per_s = 500.0;
  run(20);
  IS(!works && torque_n_m == 0.0 && texts == 1);
  return 0;
}
