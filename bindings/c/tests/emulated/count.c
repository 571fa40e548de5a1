/* Counts the instructions of the calls of a control period, by a clock of the emulator: with QEMU's `-icount shift=10` every instruction takes
 * 1024 ns, and SysTick counts steps of some 50 ns. Prints for each call its mean and its largest number. Instructions are not cycles. */
#define TS_NO_FLOAT
#include "touchstone.h"
#include <stdio.h>

#define SYST_CSR (*(volatile uint32_t *)0xE000E010u)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014u)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018u)
#define FULL 0xFFFFFFu
#define TICKS 3000u

static uint32_t state = 0x2545F491u;
static uint32_t next(void) {
  state ^= state << 13;
  state ^= state >> 17;
  state ^= state << 5;
  return state;
}

static uint32_t steps(uint32_t before, uint32_t after) { return (before - after) & FULL; }

/* A call of it is 402 instructions: call, 400 of these, return. */
#define KNOWN 402u
__attribute__((noinline)) static void known(void) { __asm__ volatile(".rept 400\n nop\n .endr"); }

__attribute__((noinline)) static uint32_t once(void) {
  uint32_t before = SYST_CVR;
  known();
  return steps(before, SYST_CVR);
}
__attribute__((noinline)) static uint32_t twice(void) {
  uint32_t before = SYST_CVR;
  known();
  known();
  return steps(before, SYST_CVR);
}

/* Steps of the clock: of two readings without anything between, and of the known call. */
static uint32_t none, call;

static int begin(void) {
  SYST_RVR = FULL;
  SYST_CVR = 0;
  SYST_CSR = 5;
  uint32_t last = 0;
  /* The emulator counts right from the second time that it comes through. */
  for (int i = 0; i < 3; i++) {
    uint32_t before = SYST_CVR;
    none = steps(before, SYST_CVR);
    last = call;
    call = twice() - once();
  }
  /* Without `-icount`, time is that of the computer, and no two readings agree. */
  uint32_t apart = call > last ? call - last : last - call;
  return call > 10u * KNOWN && apart <= KNOWN / 100u;
}

/* Ends the calculation of a call's argument before the clock is read. */
static int32_t ready(int32_t value) {
  __asm__ volatile("" : "+r"(value) : : "memory");
  return value;
}

static uint32_t sum, worst;
static void add(uint32_t before, uint32_t after) {
  uint32_t taken = steps(before, after), own = taken > none ? taken - none : 0;
  uint32_t count = (uint32_t)(((uint64_t)own * KNOWN + call / 2u) / call);
  sum += count;
  if (count > worst) worst = count;
}

static void print(const char *part) {
  printf("%s %lu %lu\n", part, (unsigned long)((sum + TICKS / 2u) / TICKS), (unsigned long)worst);
  sum = worst = 0;
}

static ts_guard guard;
static ts_settings settings;
static ts_wall wall;
static ts_estimator estimator;
static int32_t place(void) { return ready((int32_t)(next() % 200001u) - 100000); }

static int law(const char *name) {
  if (ts_settings_set(&settings, "law.kind", name) != TS_OK) return 3;
  if (ts_wall_init(&wall, &settings) != TS_OK) return 4;
  for (uint32_t tick = 0; tick < TICKS; tick++) {
    ts_force force;
    int32_t at = place();
    uint32_t before = SYST_CVR;
    ts_wall_tick(&wall, at, &force);
    add(before, SYST_CVR);
  }
  print(name);
  return 0;
}

int main(void) {
  static const char *const laws[] = {"spring", "spring-damper", "tdpa", "fba", "sfa", "sfa-continuous", "enhanced-sfa"};
  ts_guard_config config;
  if (!begin()) return 9;
  ts_guard_defaults(&config);
  config.rate_hz = 1000;
  config.force_limit = TS_SI(0.5);
  config.count = TS_SI(0.000157079633);
  config.damping = TS_SI(0.0004);
  config.delay = 0;
  if (ts_guard_init(&guard, &config) != TS_OK) return 1;
  ts_settings_init(&settings);
  if (ts_estimator_init(&estimator, &settings) != TS_OK) return 2;
  for (uint32_t tick = 0; tick < TICKS; tick++) {
    ts_force force;
    int32_t moved = place(), wanted = ready((int32_t)next());
    uint32_t before = SYST_CVR;
    ts_guard_tick(&guard, moved, wanted, &force);
    add(before, SYST_CVR);
  }
  print("guard");
  for (uint32_t tick = 0; tick < TICKS; tick++) {
    ts_position at, moved;
    int32_t measured = place();
    uint32_t before = SYST_CVR;
    ts_estimator_tick(&estimator, measured, &at, &moved);
    ts_estimator_commanded(&estimator, 1000);
    add(before, SYST_CVR);
  }
  print("estimator");
  int result = 0;
  for (unsigned i = 0; i < sizeof laws / sizeof laws[0] && result == 0; i++) result = law(laws[i]);
  return result;
}
