/* Runs the example for ST's HAL against the stand-in. Prints the number of the first line that fails, and exits with 1. */
#include "main.h"
#include "touchstone.h"
#include <math.h>
#include <stdio.h>

int start_guard(void);

/* The test compiles both files with another name for `ts_guard_commanded`, to see which torque the example reports. */
#undef ts_guard_commanded
ts_status ts_guard_commanded(ts_guard *guard, ts_force force);
static float reported_n_m;
ts_status reported(ts_guard *guard, ts_force force) {
  reported_n_m = ts_to_float(force);
  return ts_guard_commanded(guard, force);
}

static TIM_TypeDef registers;
TIM_HandleTypeDef htim3 = {&registers}, htim6;
DAC_HandleTypeDef hdac1;

static float stiffness; /* N*m/rad; the simulated firmware's law is a spring */
static uint32_t code;
static int codes, is_running, is_refused, is_counting, is_dac_on;

float your_torque(float angle_rad) { return -stiffness * angle_rad; }
HAL_StatusTypeDef HAL_DAC_SetValue(DAC_HandleTypeDef *dac, uint32_t channel, uint32_t alignment, uint32_t data) {
  code = data;
  codes += dac == &hdac1 && channel == DAC_CHANNEL_1 && alignment == DAC_ALIGN_12B_R && data < 4096u;
  return HAL_OK;
}
HAL_StatusTypeDef HAL_DAC_Start(DAC_HandleTypeDef *dac, uint32_t channel) {
  is_dac_on = dac == &hdac1 && channel == DAC_CHANNEL_1;
  return is_dac_on ? HAL_OK : HAL_ERROR;
}
HAL_StatusTypeDef HAL_TIM_Encoder_Start(TIM_HandleTypeDef *timer, uint32_t channel) {
  is_counting = timer == &htim3 && channel == TIM_CHANNEL_ALL;
  return is_counting ? HAL_OK : HAL_ERROR;
}
HAL_StatusTypeDef HAL_TIM_Base_Start_IT(TIM_HandleTypeDef *timer) {
  is_running = timer == &htim6 && !is_refused;
  return is_running ? HAL_OK : HAL_ERROR;
}
HAL_StatusTypeDef HAL_TIM_Base_Stop_IT(TIM_HandleTypeDef *timer) {
  if (timer == &htim6) is_running = 0;
  return HAL_OK;
}

/* The wheel's 16-bit counter moves by some counts if it was started, then the timer fires. */
static void turn(int counts) {
  if (is_counting) registers.CNT = (uint16_t)(registers.CNT + (uint32_t)counts);
  if (is_running) HAL_TIM_PeriodElapsedCallback(&htim6);
}

#define IS(what)                     \
  do {                               \
    if (!(what)) {                   \
      printf("line %d\n", __LINE__); \
      return 1;                      \
    }                                \
  } while (0)

int main(void) {
  registers.CNT = 65530; /* the counter runs over its end in the first turns */
  is_refused = 1;
  IS(start_guard() == -1 && code == 2048);
  is_refused = 0;
  IS(start_guard() == 0 && is_running && is_dac_on);
  stiffness = 1.0f;
  for (int tick = 0; tick < 10; tick++) turn(1);
  /* Ten counts of a 4096th turn out of the centre. The torque is rounded towards none, and the guard is told. */
  IS(code == 2048u - (uint32_t)(2047.0f * 10 * 6.283185f / 4096 / 0.5f));
  IS(fabsf(reported_n_m - (float)(2048 - (int)code) * 0.5f / 2047) < 1e-6f);
  for (int tick = 0; tick < 30; tick++) turn(-1);
  IS(code > 2048);
  IS(fabsf(reported_n_m - (float)(2048 - (int)code) * 0.5f / 2047) < 1e-6f);
  /* A spring with the wrong sign pushes the wheel on and on; the guard takes its force away. The new torque acts after a tenth of the tick. */
  stiffness = -50.0f;
  const double speed_rad_per_s = 4 * 6.283185 / 4096 * 1000;
  double out_j = 0.0, most_j = 0.0, torque_n_m = 0.0;
  int counts = 0;
  for (int tick = 0; tick < 1000; tick++) {
    const double last_n_m = torque_n_m;
    turn(counts);
    torque_n_m = (code - 2048.0) / 2047.0 * 0.5;
    counts = torque_n_m >= 0.0 ? 4 : -4;
    out_j += (0.1 * last_n_m + 0.9 * torque_n_m) * counts * 6.283185 / 4096;
    out_j -= 0.8 * 0.0004 * speed_rad_per_s * speed_rad_per_s * 1e-3; /* lost in the wheel's damping */
    if (out_j > most_j) most_j = out_j;
  }
  printf("a wrong sign gave out %.3f J\n", most_j);
  /* The shipped capacity, the refill in a second, and half a count under the largest torque. */
  IS(most_j > 0.01 && most_j < 0.045 + 0.0005 + 0.5 * 0.5 * 6.283185 / 4096 && is_running);
  /* A jump of the encoder under a force is over-speed: motor and timer off. */
  turn(20000);
  IS(!is_running && code == 2048);
  IS(codes > 1000);
  HAL_TIM_PeriodElapsedCallback(&htim3); /* another timer does nothing */
  IS(code == 2048);
  return 0;
}
