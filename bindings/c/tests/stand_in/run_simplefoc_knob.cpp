// Runs the SimpleFOC example against the stand-in: a hand turns the simulated knob into the wall, holds it and lets go. Prints the number of the
// first line that fails, and exits with 1. With SENSOR_DIRECTION = -1 the sensor counts against the motor's shaft.
#include "SimpleFOC.h"
#include <cmath>
#include <cstdio>

#ifndef SENSOR_DIRECTION
#define SENSOR_DIRECTION 1
#endif

void setup();
void loop();

MagneticSensorSPIConfig_s AS5048_SPI;
Printer Serial;

static double angle_rad, speed_rad_per_s, applied_v;
static float measured_rad;
static unsigned long now_us;
static int moves, refusals;
static bool is_off, is_started;

MagneticSensorSPI::MagneticSensorSPI(MagneticSensorSPIConfig_s, int) {}
void MagneticSensorSPI::init(void *) {}
float MagneticSensorSPI::getAngle() { return measured_rad; }
BLDCDriver3PWM::BLDCDriver3PWM(int, int, int, int) {}
int BLDCDriver3PWM::init() { return 1; }
BLDCMotor::BLDCMotor(int) {}
void BLDCMotor::linkSensor(Sensor *) {}
void BLDCMotor::linkDriver(BLDCDriver3PWM *) {}
int BLDCMotor::init() { return 1; }
int BLDCMotor::initFOC() {
  is_started = controller == MotionControlType::torque && torque_controller == TorqueControlType::voltage;
  sensor_direction = (Direction)SENSOR_DIRECTION;
  return is_started;
}
// SimpleFOC reads the sensor here.
void BLDCMotor::loopFOC() {
  const double count = 6.283185307179586 / 16384;
  measured_rad = (float)(std::floor(SENSOR_DIRECTION * angle_rad / count + 0.5) * count);
}
void BLDCMotor::move(float target) {
  applied_v = is_off ? 0.0 : target;
  moves++;
}
void BLDCMotor::disable() {
  is_off = true;
  applied_v = 0.0;
}
void Printer::begin(unsigned long) {}
void Printer::println(const char *text) {
  std::printf("%s\n", text);
  refusals++;
}
unsigned long micros() { return now_us; }

#define IS(what)                          \
  do {                                    \
    if (!(what)) {                        \
      std::printf("line %d\n", __LINE__); \
      return 1;                           \
    }                                     \
  } while (0)

// Lets the hand push with a torque in N*m, for some milliseconds.
static void push(double torque_n_m, int milliseconds) {
  for (int step = 0; step < 10 * milliseconds; step++) {
    loop();
    speed_rad_per_s += (torque_n_m + 0.02 * applied_v - 0.001 * speed_rad_per_s) / 2e-5 * 1e-4;
    angle_rad += speed_rad_per_s * 1e-4;
    now_us += 100;
  }
}

int main() {
  now_us = 4294967000u; // the clock runs over its end while the example runs
  setup();
  IS(refusals == 0 && is_started && !is_off);
  push(0.005, 1);
  IS(applied_v == 0.0);
  push(0.005, 500);
  // At rest in the wall of 0.5 N*m/rad from 0.5 rad on: the motor holds what the hand pushes.
  std::printf("held at %.4f rad with %.2f V\n", angle_rad, applied_v);
  IS(std::fabs(angle_rad - 0.51) < 0.002 && std::fabs(0.02 * applied_v + 0.005) < 2e-4);
  IS(moves > 490 && moves < 510);
  push(-0.005, 200);
  IS(angle_rad < 0.45 && applied_v == 0.0);
  // Far too fast under a force: the example switches the motor off and leaves it off.
  angle_rad = 0.55, speed_rad_per_s = 0.0;
  push(0.02, 20);
  speed_rad_per_s = 300.0;
  push(0.0, 5);
  IS(is_off && applied_v == 0.0);
  const int before = moves;
  push(0.0, 20);
  IS(moves == before);
  return 0;
}
