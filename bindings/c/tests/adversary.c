/* Searches for the hand and the law that get the most energy out of the firmware `examples/own_pid.c`. The firmware runs as it is; its target
 * and its gains are the adversary's, so its PID asks for any force at any time. The adversary also moves the device, in two parts of each tick:
 * before and after the new force acts. Energy is summed in double precision over the true motion.
 *
 *     adversary EVALUATIONS [SEED]
 *
 * Prints the most energy found beside the guard's bound. Exits with 1 if it is above the bound, with 2 if it is below half of it. */
#include "touchstone.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

extern float kp, ki, kd, target_rad;
ts_status set_up(void);
void every_tick(void);

/* What the firmware tells the guard of the device. */
#define TICK_S 1e-3
#define DELAY_S 0.5e-3
#define FORCE_LIMIT_N_M 0.3
#define CAPACITY_J 0.02
#define REFILL_W 0.0005
#define COUNT_RAD (6.283185307179586 / 16384)
/* The least damping that the guard may rely on: 0.8 of the measured one. The device of this test has no more. */
#define DAMPING_N_M_S_PER_RAD (0.8 * 0.0004)
/* Just below the guard's over-speed of 60 rad/s, as a measured speed is wrong by a count. */
#define FASTEST_RAD_PER_S 59.0
#define BOUND_J (CAPACITY_J + 0.5 * FORCE_LIMIT_N_M * COUNT_RAD)

/* The device, as the firmware sees it. */
static double angle_rad, asked_n_m;
static int is_off;

int32_t read_encoder(void) { return (int32_t)floor(angle_rad / COUNT_RAD + 0.5); }
void set_motor(float torque_n_m) { asked_n_m = torque_n_m; }
void motor_off(void) { is_off = 1; }

ts_status without_guard(ts_guard *guard, ts_position moved, ts_force wanted, ts_force *allowed) {
  const ts_force limit = ts_from_float((float)FORCE_LIMIT_N_M);
  (void)guard, (void)moved;
  *allowed = wanted > limit ? limit : wanted < -limit ? -limit : wanted;
  return TS_OK;
}

/* A generator of random numbers (xorshift64*), so that a run can be repeated. */
static uint64_t random_state;
static double uniform(void) { /* -1 to 1 */
  random_state ^= random_state >> 12;
  random_state ^= random_state << 25;
  random_state ^= random_state >> 27;
  return (double)(int64_t)(random_state * 0x2545F4914F6CDD1Du) / 9223372036854775808.0;
}
static double normal(void) { return 1.2 * (uniform() + uniform() + uniform()); }

/* Three types of hand and law. */
enum way {
  /* Repeats every ten ticks: three numbers a tick, for the two speeds and the force asked for. */
  PERIODIC,
  /* Reacts: speeds and force asked for are functions of force, its change, place, last motion and a sine. */
  REACTING,
  /* Sixteen sections of 25 ticks, each with a speed and a force asked for; the gains stay those of a PID with any sign. */
  SECTIONS,
  WAYS
};
#define PERIOD 10
#define FEATURES 6
#define SECTION_COUNT 16
#define SECTION_TICKS 25
#define MOST_NUMBERS 40
static const int dimensions[WAYS] = {3 * PERIOD + 2, 3 * FEATURES + 3, 2 * SECTION_COUNT + 4};

static double limited(double value, double most) { return value > most ? most : value < -most ? -most : value; }

/* Plays a hand and a law for some ticks. Returns the most energy that came out in any window of time, less the refill in that window. */
static double play(enum way way, const double *n, int ticks) {
  double out_j = 0.0, lowest_j = 0.0, most_j = 0.0, acting = 0.0, change = 0.0, last_moved = 0.0;
  angle_rad = 0.0, asked_n_m = 0.0, is_off = 0;
  kp = 1.0f, ki = 0.0f, kd = 0.0f, target_rad = 0.0f;
  if (way == SECTIONS) kp = (float)n[0], ki = (float)(20.0 * n[1]), kd = (float)(0.01 * n[2]);
  if (set_up() != TS_OK) exit(3);
  for (int tick = 0; tick < ticks; tick++) {
    double speeds[2], wish_n_m = 0.0;
    const double phase = 6.283185307179586 * 20.0 * exp(limited(1.2 * n[1], 2.3)) * tick * TICK_S;
    const double features[FEATURES] = {1.0, 10.0 * acting, 30.0 * change, 100.0 * angle_rad, 300.0 * last_moved, sin(phase)};
    if (way == PERIODIC) {
      const double *step = n + 2 + 3 * (tick % PERIOD);
      const double size = FASTEST_RAD_PER_S * exp(limited(2.0 * n[0] - 3.0, 9.0));
      speeds[0] = size * step[0], speeds[1] = size * step[1], wish_n_m = step[2];
    } else if (way == REACTING) {
      const double size = FASTEST_RAD_PER_S * exp(limited(2.0 * n[0] - 3.0, 9.0));
      double sums[3] = {0.0, 0.0, 0.0};
      for (int row = 0; row < 3; row++)
        for (int i = 0; i < FEATURES; i++) sums[row] += n[3 + row * FEATURES + i] * features[i];
      speeds[0] = size * tanh(sums[0]), speeds[1] = size * tanh(sums[1]), wish_n_m = sums[2];
    } else {
      const double *section = n + 4 + 2 * (tick / SECTION_TICKS % SECTION_COUNT);
      const double size = FASTEST_RAD_PER_S * exp(limited(2.0 * n[3] - 3.0, 9.0));
      speeds[0] = speeds[1] = size * section[0], wish_n_m = section[1];
    }
    target_rad = (float)(angle_rad + wish_n_m);
    every_tick();
    /* The tick in which over-speed is found is beyond the bound: the promise leaves it out. */
    if (is_off) return most_j;
    lowest_j = fmin(lowest_j, out_j - REFILL_W * TICK_S * tick);
    const double from = angle_rad;
    for (int part = 0; part < 2; part++) {
      const double seconds = part == 0 ? DELAY_S : TICK_S - DELAY_S;
      const double force = part == 0 ? acting : asked_n_m;
      const double speed = limited(speeds[part], FASTEST_RAD_PER_S);
      out_j += force * speed * seconds - DAMPING_N_M_S_PER_RAD * speed * speed * seconds;
      angle_rad += speed * seconds;
      const double gone_s = TICK_S * tick + (part == 0 ? DELAY_S : TICK_S);
      most_j = fmax(most_j, out_j - REFILL_W * gone_s - lowest_j);
    }
    last_moved = angle_rad - from;
    change = asked_n_m - acting;
    acting = asked_n_m;
  }
  return most_j;
}

/* Climbs from random points by random steps, whose size grows with success and shrinks without. */
static double climb(enum way way, long evaluations, double *best) {
  const int ticks = 400;
  double best_j = -1.0;
  for (long spent = 0; spent < evaluations;) {
    double here[MOST_NUMBERS], here_j = -1.0, step = 1.0;
    for (int i = 0; i < dimensions[way]; i++) here[i] = normal();
    for (; spent < evaluations && step > 1e-3; spent++) {
      double tried[MOST_NUMBERS];
      for (int i = 0; i < dimensions[way]; i++) tried[i] = here[i] + (here_j < 0.0 ? 0.0 : step * normal());
      const double tried_j = play(way, tried, ticks);
      if (tried_j > here_j) {
        for (int i = 0; i < dimensions[way]; i++) here[i] = tried[i];
        here_j = tried_j, step *= 1.6;
      } else {
        step *= 0.95;
      }
      if (here_j > best_j) {
        best_j = here_j;
        for (int i = 0; i < dimensions[way]; i++) best[i] = here[i];
      }
    }
  }
  return best_j;
}

int main(int count, char **words) {
  static const char *const names[WAYS] = {"periodic", "reacting", "sections"};
  const long evaluations = count > 1 ? atol(words[1]) : 2000;
  const long seed = count > 2 ? atol(words[2]) : 1;
  double most_j = 0.0;
  for (int way = 0; way < WAYS; way++) {
    double best[MOST_NUMBERS];
    random_state = 0x9E3779B97F4A7C15u * (uint64_t)(seed + 1) + (uint64_t)way;
    const double found_j = climb((enum way)way, (evaluations + WAYS - 1) / WAYS, best);
    /* The worst hand once more, for ten seconds. */
    const double longer_j = play((enum way)way, best, 10000);
    printf("%s: %.3f mJ in 0.4 s, %.3f mJ in any window of 10 s\n", names[way], 1e3 * found_j, 1e3 * longer_j);
    most_j = fmax(most_j, fmax(found_j, longer_j));
  }
  printf("%ld evaluations: at most %.3f mJ above the refill; bound %.3f mJ\n", evaluations, 1e3 * most_j, 1e3 * BOUND_J);
  return most_j > BOUND_J ? 1 : most_j < 0.5 * BOUND_J ? 2 : 0;
}
