/* The energy guard around a firmware's own torque, in the interrupt of a 1 kHz timer, with ST's HAL. A quadrature encoder is at TIM3, the motor
 * driver's input at a DAC. CubeMX makes the handles and the set-up. A test compiles this file against the declarations in `tests/stand_in` and
 * runs it on simulated hardware; nobody has run it on a board. */
#include "main.h"
#include "touchstone.h"

extern TIM_HandleTypeDef htim3, htim6;
extern DAC_HandleTypeDef hdac1;
extern float your_torque(float angle_rad); /* along the angle, N*m */

#define COUNTS_PER_REV 4096
#define FULL_SCALE_N_M 0.5f

static ts_guard guard;
static uint16_t last_count;
static int32_t turned;

/* Writes the torque to the motor driver's input; the DAC code 2048 is no torque. Returns the torque of the code: the conversion to an integer rounds
 * towards zero, so it is never larger than the guard allows. */
static float command(float torque_n_m) {
  int32_t steps = (int32_t)(2047.0f * torque_n_m / FULL_SCALE_N_M);
  HAL_DAC_SetValue(&hdac1, DAC_CHANNEL_1, DAC_ALIGN_12B_R, (uint32_t)(2048 + steps));
  return (float)steps * (FULL_SCALE_N_M / 2047.0f);
}

/* Starts encoder, motor driver's input, guard and timer; the set-up that CubeMX makes starts none of them. Without a counting encoder the guard would
 * see no motion and limit nothing. Call it once, after that set-up. Returns 0, or -1 if a setting or the HAL refuses. */
int start_guard(void) {
  ts_guard_config config;
  ts_guard_defaults(&config);
  config.rate_hz = 1000;
  config.force_limit = TS_SI(0.5);
  config.count = TS_SI(6.283185 / COUNTS_PER_REV);
  config.damping = TS_SI(0.0004); /* of your device, as measured */
  config.delay = TS_SI(0.0001);
  command(0.0f);
  if (HAL_TIM_Encoder_Start(&htim3, TIM_CHANNEL_ALL) != HAL_OK || HAL_DAC_Start(&hdac1, DAC_CHANNEL_1) != HAL_OK) return -1;
  last_count = (uint16_t)__HAL_TIM_GET_COUNTER(&htim3);
  if (ts_guard_init(&guard, &config) != TS_OK) return -1;
  return HAL_TIM_Base_Start_IT(&htim6) == HAL_OK ? 0 : -1;
}

void HAL_TIM_PeriodElapsedCallback(TIM_HandleTypeDef *timer) {
  if (timer != &htim6) return;
  uint16_t count = (uint16_t)__HAL_TIM_GET_COUNTER(&htim3);
  int16_t moved = (int16_t)(count - last_count); /* also correct when the counter wraps around */
  last_count = count;
  turned += moved;
  /* The guard counts a torque that resists a positive motion as positive. */
  ts_force torque = ts_from_float(-your_torque((float)turned * (6.283185f / COUNTS_PER_REV)));
  ts_status status = ts_guard_tick(&guard, ts_moved(moved, TS_POSITION(6.283185307 / COUNTS_PER_REV)), torque, &torque);
  if (status != TS_OK) HAL_TIM_Base_Stop_IT(&htim6);
  /* The torque is 0 if the status is not TS_OK. The guard is told how much of it the DAC gives. */
  ts_guard_commanded(&guard, ts_from_float(-command(-ts_to_float(torque))));
}
