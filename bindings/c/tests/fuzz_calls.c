/* Calls every function of the library in random order with random arguments: null pointers, memory that was never initialised or belongs to
 * another type, extreme numbers, settings with any text, buffers of any length. After each call it checks the status, that an output is 0 unless
 * the call succeeded, that forces and accounts keep their limits, and that no byte beside the memory that the library owns has changed.
 *
 *     fuzz_calls CALLS SEED [PATH OF A SETTING]...
 *
 * Prints how many calls gave each status. At the first wrong answer it prints seed, call and function, and exits with 1. */
#include "touchstone.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t random_state;
static uint32_t next(void) {
  random_state ^= random_state >> 12;
  random_state ^= random_state << 25;
  random_state ^= random_state >> 27;
  return (uint32_t)((random_state * 0x2545F4914F6CDD1Du) >> 32);
}
static uint32_t below(uint32_t most) { return next() % most; }
static int one_in(uint32_t times) { return below(times) == 0; }

/* A number that is often extreme, small or a power of two. */
static int64_t number(void) {
  static const int64_t edges[] = {0, 1, -1, INT32_MAX, INT32_MIN, INT64_MAX, INT64_MIN, UINT32_MAX, 1 << 24, -(1 << 24)};
  switch (below(5)) {
  case 0: return edges[below(sizeof edges / sizeof edges[0])];
  case 1: return (int64_t)below(2001) - 1000;
  case 2: return (int64_t)(((uint64_t)1 << below(64)) * (one_in(2) ? 1u : UINT64_MAX) + below(3) - 1u);
  case 3: return (int32_t)next() >> below(31);
  default: return (int64_t)(((uint64_t)next() << 32) | next()) >> below(63);
  }
}

/* Mostly a number up to `usual` to either side, so that objects also work on for a while; at times any number. */
static int64_t mostly(int32_t usual) {
  return one_in(20) ? number() : (int64_t)below(2 * (uint32_t)usual + 1) - usual;
}

/* Memory of one object between two stretches of bytes that must not change. */
#define MARGIN 64
#define FILL 0x5A
typedef struct {
  unsigned char *start;
  size_t size;
} room;
static room make(size_t size) {
  room it = {malloc(size + 2 * MARGIN), size};
  if (it.start == NULL) abort();
  memset(it.start, FILL, MARGIN);
  memset(it.start + MARGIN, 0, size);
  memset(it.start + MARGIN + size, FILL, MARGIN);
  return it;
}
static int is_whole(const room *it) {
  for (size_t i = 0; i < MARGIN; i++)
    if (it->start[i] != FILL || it->start[MARGIN + it->size + i] != FILL) return 0;
  return 1;
}

#define EACH 3
static room guards[EACH], walls[EACH], settings_rooms[EACH], feels[EACH], estimators[EACH];
static room *const all[] = {guards, walls, settings_rooms, feels, estimators};
#define KINDS (sizeof all / sizeof all[0])

static int null_given; /* whether an argument of this call is null */
static void *of(room *rooms) {
  if (one_in(50)) {
    null_given = 1;
    return NULL;
  }
  /* At times memory of another type, which is large enough. */
  if (one_in(100)) return feels[below(EACH)].start + MARGIN;
  return rooms[below(EACH)].start + MARGIN;
}
static void *or_null(void *pointer) {
  if (!one_in(50)) return pointer;
  null_given = 1;
  return NULL;
}

static ts_guard_config guard_config(void) {
  ts_guard_config it;
  ts_guard_defaults(&it);
  it.rate_hz = 1000, it.force_limit = TS_SI(0.5), it.count = TS_SI(0.0002), it.damping = TS_SI(0.0004);
  it.change_is_measured = below(2);
  ts_si *const fields[] = {&it.force_limit, &it.count,     &it.damping, &it.share_of_damping, &it.capacity,
                           &it.refill,      &it.overspeed, &it.delay,   &it.lag};
  for (uint32_t i = below(3); i > 0; i--) *fields[below(9)] = number();
  if (one_in(8)) it.rate_hz = (uint32_t)number();
  if (one_in(8)) it.change_is_measured = (uint32_t)number();
  return it;
}

static ts_feel_config feel_config(void) {
  ts_feel_config it;
  ts_feel_defaults(&it);
  it.counts_per_rev = one_in(8) ? (uint32_t)number() : 16384;
  for (uint32_t i = below(4); i > 0; i--) {
    ts_feel_wall *wall = &it.walls[below(TS_FEEL_WALLS)];
    wall->surface = one_in(2) ? TS_SI(1) : number();
    wall->stiffness = one_in(8) ? number() : TS_SI(5);
    wall->solid_below = below(3);
  }
  if (one_in(2)) it.detents = (ts_feel_detents){TS_SI(0.03), below(30), TS_SI(0.2), number()};
  if (one_in(2)) it.spring = (ts_feel_spring){TS_SI(0.05), TS_SI(0.2), number()};
  if (one_in(2)) it.damper = (ts_feel_damper){TS_SI(0.0005), TS_SI(100)};
  if (one_in(2)) it.dry_friction = (ts_feel_dry_friction){TS_SI(0.01), TS_SI(0.01)};
  if (one_in(2)) it.click = (ts_feel_click){TS_SI(0.02), below(30), TS_SI(0.2), number(), TS_SI(0.01)};
  if (one_in(2)) it.inertia = (ts_feel_inertia){TS_SI(0.000005), TS_SI(12)};
  if (one_in(2)) {
    it.profile.strength = TS_SI(0.05);
    it.profile.per_turn = below(3);
    it.profile.start = TS_SI(-1);
    it.profile.end = one_in(4) ? number() : TS_SI(1);
    it.profile.count = one_in(8) ? (uint32_t)number() : 2 + below(TS_FEEL_POINTS - 1);
    for (int i = 0; i < TS_FEEL_POINTS; i++) it.profile.points[i] = (int16_t)((int32_t)below(20001) - 10000);
    if (one_in(8)) it.profile.points[below(TS_FEEL_POINTS)] = (int16_t)number();
  }
  ts_si *const fields[] = {&it.detents.strength, &it.detents.pitch,         &it.spring.strength,       &it.spring.stiffness,
                           &it.damper.damping,   &it.damper.bandwidth_hz,   &it.dry_friction.strength, &it.dry_friction.stretch,
                           &it.click.strength,   &it.click.pitch,           &it.click.duration,        &it.profile.strength,
                           &it.profile.start,    &it.inertia.inertia,       &it.inertia.bandwidth_hz};
  if (one_in(3)) *fields[below(sizeof fields / sizeof fields[0])] = number();
  if (one_in(12)) it.detents.per_turn = (uint32_t)number();
  if (one_in(12)) it.click.per_turn = (uint32_t)number();
  if (one_in(12)) it.profile.per_turn = (uint32_t)number();
  return it;
}

static char **paths;
static int path_count;
static char text_buffer[2][256];

/* Bytes of any kind, at times long; never a zero byte but the last. */
static const char *noise(char *buffer) {
  const uint32_t length = one_in(4) ? 255 : below(12);
  for (uint32_t i = 0; i < length; i++) buffer[i] = one_in(3) ? (char)(1 + below(255)) : "0123456789.-+e"[below(14)];
  buffer[length] = 0;
  return buffer;
}
static const char *path(void) {
  if (path_count == 0 || one_in(20)) return noise(text_buffer[0]);
  return paths[below((uint32_t)path_count)];
}
static const char *value(void) {
  static const char *const words[] = {"0",      "1",        "-1",        "0.5",           "5",         "1000",    "0.001",          "100000",
                                      "1e5",    "true",     "false",     "spring",        "tdpa",      "fba",     "sfa-continuous", "enhanced-sfa",
                                      "sfa",    "measured", "estimated", "spring-damper", "thesis",    "exact",   "keep-force",     "every-tick",
                                      "2147483647", "-2147483648", "0.000000000000000000000000001", "99999999999999999999"};
  if (one_in(10)) return noise(text_buffer[1]);
  if (one_in(3)) {
    snprintf(text_buffer[1], sizeof text_buffer[1], "%ld.%06u", (long)(number() >> 32), below(1000000));
    return text_buffer[1];
  }
  return words[below(sizeof words / sizeof words[0])];
}

/* A buffer for a message, at any address and of any length, between bytes that must not change. */
static char message_room[256];
static char *message;
static size_t message_length;
static void new_message(void) {
  memset(message_room, FILL, sizeof message_room);
  message = message_room + 1 + below(16);
  message_length = one_in(4) ? below(4) : below(200);
  if (one_in(20)) message = NULL, message_length = below(200);
}
static int message_is_good(void) {
  if (message == NULL) message = message_room, message_length = 0;
  for (char *at = message_room; at < message_room + sizeof message_room; at++)
    if ((at < message || at >= message + message_length) && *at != FILL) return 0;
  return message_length == 0 || memchr(message, 0, message_length) != NULL;
}

static const char *name = "";
#define CALL(what) (name = #what, (what))
static uint64_t counts[TS_WRONG_TICK + 1];

/* Runs one call and checks its answer. Returns 0 if the answer is right. */
static int call(void) {
  enum { UNTOUCHED = 77 };
  ts_force force = UNTOUCHED;
  ts_position moved = UNTOUCHED;
  ts_energy energy = UNTOUCHED;
  int status = -1, has_force = 0, has_energy = 0;
  null_given = 0;
  const uint32_t kind = below(100);
  if (kind < 22) {
    void *guard = of(guards);
    ts_force *to = or_null(&force);
    has_force = to != NULL;
    if (one_in(2)) status = CALL(ts_guard_tick(guard, (int32_t)mostly(5000), (int32_t)number(), to));
    else status = CALL(ts_guard_tick_with_change(guard, (int32_t)mostly(5000), (int32_t)mostly(2500), (int32_t)number(), to));
  } else if (kind < 40) {
    void *wall = of(walls);
    ts_force *to = or_null(&force);
    has_force = to != NULL;
    status = CALL(ts_wall_tick(wall, (int32_t)mostly(100000), to));
  } else if (kind < 58) {
    void *feel = of(feels);
    ts_force *to = or_null(&force);
    has_force = to != NULL;
    status = CALL(ts_feel_tick(feel, mostly(100), to));
  } else if (kind < 64) {
    void *estimator = of(estimators);
    ts_position *to = or_null(&force), *per_tick = or_null(&moved);
    status = CALL(ts_estimator_tick(estimator, (int32_t)mostly(100000), to, per_tick));
    if (status != TS_OK && ((to != NULL && force != 0) || (per_tick != NULL && moved != 0))) return 1;
  } else if (kind < 67) {
    ts_guard_config config = guard_config();
    void *guard = of(guards);
    status = CALL(ts_guard_init(guard, or_null(&config)));
  } else if (kind < 70) {
    void *wall = of(walls), *settings = of(settings_rooms);
    if (wall == settings) return 0;
    status = one_in(2) ? CALL(ts_wall_init(wall, settings)) : CALL(ts_wall_resume(wall, settings));
  } else if (kind < 73) {
    ts_feel_config config = feel_config();
    void *feel = of(feels), *settings = of(settings_rooms);
    if (feel == settings) return 0;
    status = CALL(ts_feel_init(feel, settings, or_null(&config)));
  } else if (kind < 75) {
    void *estimator = of(estimators), *settings = of(settings_rooms);
    if (estimator == settings) return 0;
    status = CALL(ts_estimator_init(estimator, settings));
  } else if (kind < 79) {
    status = CALL(ts_settings_init(of(settings_rooms)));
  } else if (kind < 82) {
    void *settings = of(settings_rooms);
    const char *where = or_null((char *)path()), *what = or_null((char *)value());
    status = CALL(ts_settings_set(settings, where, what));
  } else if (kind < 83) {
    status = CALL(ts_settings_set_counts_per_rev(of(settings_rooms), (uint32_t)number()));
  } else if (kind < 86) {
    new_message();
    if (one_in(3)) {
      status = CALL(ts_settings_check(of(settings_rooms), message, message_length));
    } else if (one_in(2)) {
      ts_guard_config config = guard_config();
      status = CALL(ts_guard_check(or_null(&config), message, message_length));
    } else {
      ts_feel_config config = feel_config();
      void *settings = of(settings_rooms);
      status = CALL(ts_feel_check(settings, or_null(&config), message, message_length));
    }
    if (!message_is_good()) return 1;
  } else if (kind < 89) {
    const int32_t commanded = (int32_t)number();
    const uint32_t which = below(4);
    status = which == 0   ? CALL(ts_guard_commanded(of(guards), commanded))
             : which == 1 ? CALL(ts_wall_commanded(of(walls), commanded))
             : which == 2 ? CALL(ts_feel_commanded(of(feels), commanded))
                          : CALL(ts_estimator_commanded(of(estimators), commanded));
  } else if (kind < 91) {
    const uint32_t which = below(3);
    status = which == 0   ? CALL(ts_guard_switched_off(of(guards)))
             : which == 1 ? CALL(ts_wall_switched_off(of(walls)))
                          : CALL(ts_feel_switched_off(of(feels)));
  } else if (kind < 94) {
    status = one_in(2) ? CALL(ts_guard_resume(of(guards))) : CALL(ts_feel_resume(of(feels)));
  } else if (kind < 96) {
    void *object = of(one_in(2) ? guards : feels);
    ts_energy *to = or_null(&energy);
    has_energy = to != NULL;
    status = one_in(2) ? CALL(ts_guard_account(object, to)) : CALL(ts_feel_account(object, to));
  } else if (kind < 97) {
    ts_guard_config config;
    ts_feel_config feel;
    status = one_in(2) ? CALL(ts_guard_defaults(or_null(&config))) : CALL(ts_feel_defaults(or_null(&feel)));
  } else if (kind < 98) {
    (void)CALL(ts_penetration(number(), (uint32_t)number(), number()));
    (void)CALL(ts_moved((int32_t)number(), (int32_t)number()));
    return CALL(ts_status_text((int32_t)number())) == NULL;
  } else if (kind < 99) {
    /* Objects may be copied. */
    const uint32_t which = below(KINDS);
    room *from = &all[which][below(EACH)], *to = &all[which][below(EACH)];
    if (from != to) memcpy(to->start + MARGIN, from->start + MARGIN, from->size);
    return 0;
  } else {
    /* Memory that was never initialised. */
    room *it = &all[below(KINDS)][below(EACH)];
    if (one_in(4)) memset(it->start + MARGIN, (int)below(256), it->size);
    return 0;
  }
  if (status < TS_OK || status > TS_WRONG_TICK) return 1;
  counts[status]++;
  /* With several wrong arguments any of the errors may be the answer. */
  if (status == (null_given ? TS_OK : TS_NULL_POINTER)) return 1;
  if (has_force && status != TS_OK && force != 0) return 1;
  if (has_energy && status != TS_OK && energy != 0) return 1;
  /* No account holds more than the largest capacity that a guard takes, 16 J. */
  if (has_energy && energy > (ts_energy)16 << 48) return 1;
  return 0;
}

int main(int argument_count, char **arguments) {
  if (argument_count < 3) return 2;
  const unsigned long long calls = strtoull(arguments[1], NULL, 10), seed = strtoull(arguments[2], NULL, 10);
  paths = arguments + 3, path_count = argument_count - 3;
  random_state = 0x9E3779B97F4A7C15u * (seed + 1);
  for (int i = 0; i < EACH; i++) {
    guards[i] = make(sizeof(ts_guard)), walls[i] = make(sizeof(ts_wall)), settings_rooms[i] = make(sizeof(ts_settings));
    feels[i] = make(sizeof(ts_feel)), estimators[i] = make(sizeof(ts_estimator));
  }
  for (unsigned long long at = 0; at < calls; at++) {
    int wrong = call();
    for (size_t kind = 0; kind < KINDS && !wrong; kind++)
      for (int i = 0; i < EACH; i++) wrong |= !is_whole(&all[kind][i]);
    if (wrong) {
      printf("seed %llu, call %llu: wrong answer of %s\n", seed, at, name);
      return 1;
    }
  }
  for (int status = TS_OK; status <= TS_WRONG_TICK; status++) printf("%s: %llu\n", ts_status_text(status), (unsigned long long)counts[status]);
  for (size_t kind = 0; kind < KINDS; kind++)
    for (int i = 0; i < EACH; i++) free(all[kind][i].start);
  for (int status = TS_OK; status <= TS_WRONG_TICK; status++)
    if (counts[status] == 0) return 3; /* the calls do not reach every answer */
  return 0;
}
