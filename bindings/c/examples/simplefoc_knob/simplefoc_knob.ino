/* A knob with a virtual wall, on SimpleFOC: a gimbal motor with an encoder AS5048A on a three-pin driver. Change pins, pole pairs and the motor's
 * figures to yours. A test compiles this file against the declarations in `tests/stand_in` and runs it on a simulated knob; nobody has run it on a
 * board. */
#include <SimpleFOC.h>
#include <math.h>
#include <touchstone.h>

const uint32_t RATE_HZ = 1000, COUNTS_PER_REV = 16384;
const float TORQUE_CONSTANT_N_M_PER_V = 0.02f; /* torque at rest over voltage: measure it */

MagneticSensorSPI sensor(AS5048_SPI, 10);
BLDCMotor motor(7);
BLDCDriver3PWM driver(9, 5, 6, 8);

ts_wall wall;
ts_settings settings;
int works = 0;

/* Sets up the wall. Returns null, or the first setting that is refused. */
const char *set_up_wall() {
  static const char *const rows[][2] = {
      {"timing.rate_hz", "1000"},
      {"wall.k_desired_n_m_per_rad", "0.5"},
      {"law.force_limit_n_m", "0.06"},
      /* The next values are those of your knob; `touchstone tune` finds the other settings for it. */
      {"law.estimator.inertia_kg_m2", "0.00002"},
      {"law.estimator.damping_n_m_s_per_rad", "0.0001"},
      {"law.guard.damping_n_m_s_per_rad", "0.0001"},
      {"law.guard.delay_s", "0.0001"},
  };
  ts_settings_init(&settings);
  for (auto row : rows)
    if (ts_settings_set(&settings, row[0], row[1]) != TS_OK) return row[0];
  ts_settings_set_counts_per_rev(&settings, COUNTS_PER_REV);
  static char problem[160];
  if (ts_wall_init(&wall, &settings) == TS_OK) return nullptr;
  ts_settings_check(&settings, problem, sizeof problem);
  return problem;
}

void setup() {
  Serial.begin(115200);
  sensor.init();
  driver.voltage_power_supply = 12;
  driver.init();
  motor.linkSensor(&sensor);
  motor.linkDriver(&driver);
  motor.controller = MotionControlType::torque;
  motor.torque_controller = TorqueControlType::voltage;
  motor.voltage_limit = 3;
  motor.init();
  const char *problem = set_up_wall();
  if (problem != nullptr) Serial.println(problem);
  works = problem == nullptr && motor.initFOC();
  if (!works) motor.disable();
}

void loop() {
  static uint32_t next_us = micros();
  motor.loopFOC();
  if ((int32_t)(micros() - next_us) < 0) return;
  next_us += 1000000 / RATE_HZ;
  if (!works) return;
  /* `move` acts along the motor's shaft, and the sensor may count against it: `initFOC` found out. */
  float angle_rad = motor.sensor_direction * sensor.getAngle();
  int64_t count = (int64_t)floorf(angle_rad * (COUNTS_PER_REV / 6.2831853f) + 0.5f);
  ts_force force;
  /* Any other status, such as a knob that is too fast for the guard: the motor is off until somebody resets the board. */
  if (ts_wall_tick(&wall, ts_penetration(count, COUNTS_PER_REV, TS_SI(0.5)), &force) != TS_OK) {
    motor.disable();
    works = 0;
    return;
  }
  motor.move(-ts_to_float(force) / TORQUE_CONSTANT_N_M_PER_V);
}
