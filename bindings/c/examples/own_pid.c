/* The energy guard around a PID control of your own, in less than forty lines. Your firmware gives `read_encoder`, `set_motor` and
 * `motor_off`, and calls `set_up` once, then `every_tick` a thousand times a second. `own_pid_bench.c` runs it on a simulated knob. */
#include "touchstone.h"

#define RATE_HZ 1000
#define COUNTS_PER_REV 16384

int32_t read_encoder(void);       /* counts; may run over the end of 32 bits */
void set_motor(float torque_n_m); /* along the encoder's angle */
void motor_off(void);

float kp, ki, kd, target_rad; /* N*m/rad, N*m/(rad*s), N*m*s/rad, rad */

static ts_guard guard;
static int32_t last_count;
static float integral, last_error;

ts_status set_up(void) {
  ts_guard_config config;
  ts_guard_defaults(&config);
  config.rate_hz = RATE_HZ;
  config.force_limit = TS_SI(0.3);                     /* N*m */
  config.count = TS_SI(6.283185308 / COUNTS_PER_REV);  /* rad */
  config.damping = TS_SI(0.0004);                      /* of the device alone, as measured, N*m*s/rad */
  config.capacity = TS_SI(0.02);                       /* J */
  config.delay = TS_SI(0.0005);                        /* from reading the encoder to the new torque, s */
  last_count = read_encoder();
  integral = last_error = 0.0f;
  return ts_guard_init(&guard, &config);
}

static float my_pid(float angle_rad) {
  float error = target_rad - angle_rad, change = error - last_error;
  last_error = error;
  integral += error / RATE_HZ;
  return kp * error + ki * integral + kd * change * RATE_HZ;
}

void every_tick(void) {
  int32_t count = read_encoder();
  ts_position moved = ts_moved((int32_t)((uint32_t)count - (uint32_t)last_count), TS_POSITION(6.283185307 / COUNTS_PER_REV));
  last_count = count;
  /* The guard counts a torque that resists a positive motion as positive. */
  ts_force torque = ts_from_float(-my_pid((float)count * (6.283185307f / COUNTS_PER_REV)));
  if (ts_guard_tick(&guard, moved, torque, &torque) != TS_OK) motor_off();
  set_motor(-ts_to_float(torque)); /* 0 after an error */
}
