/* Touchstone: an energy guard for any force, and hard virtual walls, in fixed point.
 *
 * Angles, forces and energies are integers: ts_position and ts_force hold rad and N*m times 2^24, ts_energy joules
 * times 2^48. Values of settings are ts_si, SI units times 2^32. With m and N in place of rad and N*m the same
 * numbers serve a linear device. No function allocates, keeps a global, or needs a floating-point unit.
 *
 * Threads: each object belongs to one thread or interrupt at a time. Two objects share nothing.
 * Objects hold no pointers, so they may be copied and moved.
 */


#ifndef TOUCHSTONE_H
#define TOUCHSTONE_H

/* Made by cbindgen from bindings/c/src. Change the source, then run: TOUCHSTONE_WRITE_HEADER=1 cargo test -p touchstone-c --test header */

#include <stddef.h>
#include <stdint.h>

/* A constant in SI units as a ts_si, computed by the compiler: TS_SI(0.0005) */
#define TS_SI(value) ((int64_t)((value) * 4294967296.0))

/* A constant in rad as a ts_position, rounded to the nearest: TS_POSITION(6.283185307 / 4096) is one count of 4096 a turn */
#define TS_POSITION(value) ((int32_t)((value) * 16777216.0 + ((value) < 0 ? -0.5 : 0.5)))


/*
 Size of a `ts_estimator` in 64-bit words.
 */
#define TS_ESTIMATOR_WORDS 24

/*
 Size of a `ts_feel` in 64-bit words.
 */
#define TS_FEEL_WORDS 480

/*
 Size of a `ts_guard` in 64-bit words.
 */
#define TS_GUARD_WORDS 24

/*
 The most walls of a feel.
 */
#define TS_FEEL_WALLS 6

/*
 The most points of a torque profile.
 */
#define TS_FEEL_POINTS 96

/*
 Size of a `ts_settings` in 64-bit words.
 */
#define TS_SETTINGS_WORDS 64

/*
 Size of a `ts_wall` in 64-bit words.
 */
#define TS_WALL_WORDS 160

/*
 Result of a call. `TS_OK` is 0. With any other result the output (force or energy) is 0, so that firmware that ignores it drives
 no motor.
 */
typedef enum {
  /*
   The call succeeded.
   */
  TS_OK = 0,
  /*
   A pointer argument is null.
   */
  TS_NULL_POINTER = 1,
  /*
   The object was never initialised, or its memory was overwritten. Call its `init` function.
   */
  TS_NOT_INITIALISED = 2,
  /*
   A setting is refused. `ts_guard_check`, `ts_settings_check` and `ts_feel_check` report which setting.
   */
  TS_OUT_OF_RANGE = 3,
  /*
   There is no setting with the given path.
   */
  TS_UNKNOWN_SETTING = 4,
  /*
   The text is not a valid value of the setting.
   */
  TS_BAD_VALUE = 5,
  /*
   The device moved faster than the energy guard's setting `overspeed`. The output force stays 0 until the guard or the wall is
   resumed: switch the motor off.
   */
  TS_OVERSPEED = 6,
  /*
   The guard's `change_is_measured` asks for the other tick function: `ts_guard_tick_with_change` if it is 1, `ts_guard_tick`
   if it is 0. The guard's account is emptied if a force acted.
   */
  TS_WRONG_TICK = 7,
} ts_status;

/*
 A state estimator: coefficients and state. A `ts_wall` has one of its own. Initialise it with `ts_estimator_init`.
 */
typedef struct {
  uint64_t memory[TS_ESTIMATOR_WORDS];
} ts_estimator;

/*
 The settings of a virtual wall. Initialise them with `ts_settings_init`.
 */
typedef struct {
  uint64_t memory[TS_SETTINGS_WORDS];
} ts_settings;

/*
 A position or displacement, rad (m) times 2^24.
 */
typedef int32_t ts_position;

/*
 A torque or force, N·m (N) times 2^24.
 */
typedef int32_t ts_force;

/*
 The value of a setting in its SI unit, times 2^32. The macro `TS_SI` makes one from a constant.
 */
typedef int64_t ts_si;

/*
 A wall; without stiffness there is none.
 */
typedef struct {
  /*
   Angle of the wall's surface, rad.
   */
  ts_si surface;
  /*
   Stiffness, N·m/rad.
   */
  ts_si stiffness;
  /*
   0: the wall is solid at angles above its surface; 1: below.
   */
  uint32_t solid_below;
} ts_feel_wall;

/*
 Detents: positions to which the device is drawn; without strength there are none.
 */
typedef struct {
  /*
   Largest torque, N·m.
   */
  ts_si strength;
  /*
   Number of detents per turn, 1 to 6283; 0: `pitch` says how far apart they are.
   */
  uint32_t per_turn;
  /*
   Distance between neighbours, rad, 0.001 to 6.283; used if `per_turn` is 0.
   */
  ts_si pitch;
  /*
   Angle of one of the detents, rad.
   */
  ts_si centre;
} ts_feel_detents;

/*
 A spring that draws to a centre; without strength there is none.
 */
typedef struct {
  /*
   Largest torque, N·m.
   */
  ts_si strength;
  /*
   Stiffness, N·m/rad, 0 to 100.
   */
  ts_si stiffness;
  /*
   Angle at which the spring gives no torque, rad.
   */
  ts_si centre;
} ts_feel_spring;

/*
 Friction in proportion to the speed; without damping there is none.
 */
typedef struct {
  /*
   Damping, N·m·s/rad. The largest value follows from the inertia and the delay in the settings.
   */
  ts_si damping;
  /*
   Bandwidth of the low-pass filter for the speed, Hz, 5 to 500.
   */
  ts_si bandwidth_hz;
} ts_feel_damper;

/*
 Dry friction, of one size at every speed; without strength there is none.
 */
typedef struct {
  /*
   Torque while the device slides, N·m.
   */
  ts_si strength;
  /*
   How far the device moves from rest until it slides, rad, 0.001 to 1.
   */
  ts_si stretch;
} ts_feel_dry_friction;

/*
 A short pulse when the device crosses one of many positions; without strength there is none.
 */
typedef struct {
  /*
   Torque of the pulse, N·m: first against the motion, then as long with it.
   */
  ts_si strength;
  /*
   Number of clicks per turn, 1 to 6283; 0: `pitch` says how far apart they are.
   */
  uint32_t per_turn;
  /*
   Distance between neighbours, rad, 0.001 to 6.283; used if `per_turn` is 0.
   */
  ts_si pitch;
  /*
   One of the angles that click, rad.
   */
  ts_si centre;
  /*
   Length of the pulse, s, 0.001 to 0.1.
   */
  ts_si duration;
} ts_feel_click;

/*
 A torque drawn over the angle, by points with straight lines between them; without strength there is none.
 */
typedef struct {
  /*
   Torque at a point of 10,000, N·m.
   */
  ts_si strength;
  /*
   Copies of the profile per turn, 1 to 6283; 0: it is there once, from `start` to `end`.
   */
  uint32_t per_turn;
  /*
   Angle of the first point, rad.
   */
  ts_si start;
  /*
   Angle of the last point, rad; used if `per_turn` is 0.
   */
  ts_si end;
  /*
   Number of points, 2 to `TS_FEEL_POINTS`.
   */
  uint32_t count;
  /*
   The points at equal distances, each from -10,000 to 10,000. A positive one pushes to larger angles.
   */
  int16_t points[TS_FEEL_POINTS];
} ts_feel_profile;

/*
 An added inertia, rendered as a virtual mass that the device drags by a damper; without inertia there is none.
 */
typedef struct {
  /*
   The mass, kg·m². The largest value follows from the inertia and the delay in the settings.
   */
  ts_si inertia;
  /*
   Frequency below which motions feel the mass, Hz, 5 to 30.
   */
  ts_si bandwidth_hz;
} ts_feel_inertia;

/*
 All parts of a feel. Start from `ts_feel_defaults`, which has no part, and set those that you want.
 */
typedef struct {
  /*
   Counts of the encoder per turn with all edges counted, at least 1.
   */
  uint32_t counts_per_rev;
  /*
   Walls, such as end stops.
   */
  ts_feel_wall walls[TS_FEEL_WALLS];
  /*
   Detents.
   */
  ts_feel_detents detents;
  /*
   Spring to a centre.
   */
  ts_feel_spring spring;
  /*
   Friction in proportion to the speed.
   */
  ts_feel_damper damper;
  /*
   Dry friction.
   */
  ts_feel_dry_friction dry_friction;
  /*
   Clicks.
   */
  ts_feel_click click;
  /*
   Torque profile.
   */
  ts_feel_profile profile;
  /*
   Added inertia.
   */
  ts_feel_inertia inertia;
} ts_feel_config;

/*
 Walls, detents, spring, friction, clicks and torque profile, and the energy guard behind them. Initialise it with
 `ts_feel_init`.
 */
typedef struct {
  uint64_t memory[TS_FEEL_WORDS];
} ts_feel;

/*
 An energy, J times 2^48.
 */
typedef int64_t ts_energy;

/*
 Properties of the device that the energy guard relies on, and the guard's energy limits. Units in brackets are for a linear
 device. Start from `ts_guard_defaults`.
 */
typedef struct {
  /*
   Control periods (calls of `ts_guard_tick`) per second, 1 to 100,000.
   */
  uint32_t rate_hz;
  /*
   Largest force that the energy guard lets through, N·m (N). Where its account allows less, the guard lets less through.
   */
  ts_si force_limit;
  /*
   Step of one encoder count, or twice the largest error of a measured position, in rad (m), at most 0.1.
   */
  ts_si count;
  /*
   Measured damping of the device alone, without a hand, N·m·s/rad (N·s/m).
   */
  ts_si damping;
  /*
   Fraction (0 to 1) of the measured damping that the energy guard relies on.
   */
  ts_si share_of_damping;
  /*
   Most energy that the energy guard's account holds, in J, at most 16. It is the most that a hand can get out at once.
   */
  ts_si capacity;
  /*
   Power that refills the energy guard's account, in W, at most 1. It is the most that a hand can get out in the long run.
   */
  ts_si refill;
  /*
   Largest speed at which the energy bound holds, rad/s (m/s). Above it the guard allows no force until `ts_guard_resume`.
   */
  ts_si overspeed;
  /*
   Time from reading the position until the force computed from it begins to act, in s, at most one control period.
   */
  ts_si delay;
  /*
   Mean delay of the current loop's step response, in s, counted from the moment at which a force begins to act. `delay` and
   `lag` together are at most one control period.
   */
  ts_si lag;
  /*
   1 if the position is read a second time when the commanded force changes: call `ts_guard_tick_with_change` in every tick.
   0 otherwise: call `ts_guard_tick`.
   */
  uint32_t change_is_measured;
} ts_guard_config;

/*
 An energy guard: coefficients and state. It bounds the energy that a hand can get out of a device. Initialise it with
 `ts_guard_init`.
 */
typedef struct {
  uint64_t memory[TS_GUARD_WORDS];
} ts_guard;

/*
 A virtual wall: coefficients and state of velocity estimator, control law and energy guard. Initialise it with `ts_wall_init`.
 */
typedef struct {
  uint64_t memory[TS_WALL_WORDS];
} ts_wall;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 Initialises a state estimator with the settings `timing.rate_hz`, `law.force_limit_n_m` and `law.estimator`. Call it again to
 forget all motion. Returns `TS_OUT_OF_RANGE` if a setting is refused; the estimator is then not initialised.
 */
ts_status ts_estimator_init(ts_estimator *estimator,
                            ts_settings *settings);

/*
 Runs one control period: takes the measured position, and gives the position and the displacement per control period that are
 expected when the next command begins to act. Displacement times rate is the speed. Call `ts_estimator_commanded` next.
 */
ts_status ts_estimator_tick(ts_estimator *estimator,
                            ts_position measured,
                            ts_position *position,
                            ts_position *moved);

/*
 Reports to the estimator the force that was commanded after `ts_estimator_tick`. It is positive against a positive motion, like
 the force of a wall.
 */
ts_status ts_estimator_commanded(ts_estimator *estimator,
                                 ts_force force);

/*
 Sets a feel to no part at all, and the counts of the encoder to 0, which `ts_feel_init` refuses.
 */
ts_status ts_feel_defaults(ts_feel_config *config);

/*
 Initialises a feel as at power-up, with a full energy account. Law, device and guard are those of the settings; the guard's
 count follows from `counts_per_rev`. Call it once, because each call fills the account again. It needs 12 KB of stack, `ts_feel_tick`
 0.4 KB.

 Returns `TS_OUT_OF_RANGE` if a value is refused, also a guard with `law.guard.change = measured`, because a feel gets one count a
 tick; the feel is then not initialised, and gives no force.
 */
ts_status ts_feel_init(ts_feel *feel,
                       ts_settings *settings,
                       const ts_feel_config *config);

/*
 Checks a feel. If it is refused, `message` gets the reason in one line; `message` may be null.
 */
ts_status ts_feel_check(ts_settings *settings, const ts_feel_config *config, char *message, size_t length);

/*
 Runs one control period of a feel: takes the encoder's count, and gives the force against growing angles. Command the negative of
 it along the angle, and hold it until the next call.

 The hand gets out at most the guard's `capacity + refill * time` more energy than it put in, over all parts together.
 */
ts_status ts_feel_tick(ts_feel *feel,
                       int64_t count,
                       ts_force *force);

/*
 Reports to estimators and guard the commanded force, if it was smaller than the force that `ts_feel_tick` gave.
 */
ts_status ts_feel_commanded(ts_feel *feel,
                            ts_force force);

/*
 Reports to the feel that the motor was switched off and that no call of `ts_feel_tick` follows until `ts_feel_resume`.
 */
ts_status ts_feel_switched_off(ts_feel *feel);

/*
 Resumes the feel when the motor is switched on again. All parts start anew; the energy guard's account keeps its level.
 */
ts_status ts_feel_resume(ts_feel *feel);

/*
 Reads the energy guard's account, the energy that the hand may still get out, in J times 2^48. It is 0 without a guard
 (`law.guard.on`).
 */
ts_status ts_feel_account(ts_feel *feel,
                          ts_energy *account);

/*
 Fills in capacity, refill, fraction of damping and largest speed with the values of Touchstone's simulated knob. Sets the
 properties of your own device to 0 (rate, force limit, count, damping and lag), and `delay` to -1 s. `ts_guard_init` refuses this
 rate and this delay: the energy bound fails with a wrong delay, so set the measured one.
 */
ts_status ts_guard_defaults(ts_guard_config *config);

/*
 Initialises an energy guard as at power-up, with a full energy account (the energy that a hand may still get out). Call it once,
 because each call fills the account again.

 Returns `TS_OUT_OF_RANGE` if a setting is refused; the guard is then not initialised, and allows no force.
 */
ts_status ts_guard_init(ts_guard *guard,
                        const ts_guard_config *config);

/*
 Checks the configuration of an energy guard. If it is refused, `message` gets the reason in one line, with the setting's name
 and range; `message` may be null.
 */
ts_status ts_guard_check(const ts_guard_config *config,
                         char *message,
                         size_t length);

/*
 Runs one control period of the energy guard. `moved` is the displacement since the last call, `wanted` the force that your
 control law requests, and `*allowed` the force to command. A force that resists a positive `moved` is positive.

 The hand gets out at most `capacity + refill * time` more energy than it put in.

 Returns `TS_WRONG_TICK` if `change_is_measured` is set: the force is then 0, and the account is emptied if a force acted.
 */
ts_status ts_guard_tick(ts_guard *guard,
                        ts_position moved,
                        ts_force wanted,
                        ts_force *allowed);

/*
 Displacement of a number of encoder counts, for `ts_guard_tick`: counts times the angle of one count, which `TS_POSITION` gives.

 Give the guard displacements made of counts, not of a rounded angle: these add up exactly, at every turn. A jump beyond the range
 of `ts_position` gives the end of the range, which the guard takes as over-speed.
 */
ts_position ts_moved(int32_t counts,
                     ts_position count);

/*
 Same as `ts_guard_tick`, for an encoder that is read a second time, at the moment at which the last commanded force begins to
 act. `before_change` is the part of `moved` before this second reading.

 Returns `TS_WRONG_TICK` if `change_is_measured` is 0: the force is then 0, and the account is emptied if a force acted.
 */
ts_status ts_guard_tick_with_change(ts_guard *guard,
                                    ts_position moved,
                                    ts_position before_change,
                                    ts_force wanted,
                                    ts_force *allowed);

/*
 Reports to the energy guard that your program commanded a smaller force than the allowed one. A larger force counts as the
 allowed one.
 */
ts_status ts_guard_commanded(ts_guard *guard,
                             ts_force force);

/*
 Reports to the guard that the motor was switched off and that no call of `ts_guard_tick` follows until `ts_guard_resume`.
 */
ts_status ts_guard_switched_off(ts_guard *guard);

/*
 Resumes an energy guard after the motor was switched off, or after the device was faster than `overspeed`. The energy account
 keeps its level: switching on again does not fill it.
 */
ts_status ts_guard_resume(ts_guard *guard);

/*
 Reads the energy guard's account, the energy that the hand may still get out, in J times 2^48. It is negative after an
 over-speed, until the refilling power and the device's damping have made up for the difference.
 */
ts_status ts_guard_account(ts_guard *guard,
                           ts_energy *account);

/*
 Sets all settings to the defaults, which describe the virtual wall on Touchstone's simulated knob. Change at least those that
 differ on your device.
 */
ts_status ts_settings_init(ts_settings *settings);

/*
 Sets one setting, named by its path, from a text that is a decimal number or a word: `"wall.k_desired_n_m_per_rad"`, `"5"`;
 `"law.kind"`, `"spring-damper"`. The range is checked later, by `ts_settings_check` or `ts_wall_init`.
 */
ts_status ts_settings_set(ts_settings *settings,
                          const char *path,
                          const char *value);

/*
 Sets the encoder's resolution, which speed estimator and energy guard use: counts per turn with all edges counted, at least 1.
 */
ts_status ts_settings_set_counts_per_rev(ts_settings *settings,
                                         uint32_t counts_per_rev);

/*
 Checks all settings of a virtual wall together. If they are refused, `message` gets the reason in one line, with the setting's
 name and range; `message` may be null.

 A guard with `law.guard.change = measured` is refused, because `ts_wall_tick` gets no second position: give `estimated`.
 */
ts_status ts_settings_check(ts_settings *settings,
                            char *message,
                            size_t length);

/*
 The meaning of a `ts_status` as text, for a log. Never null.
 */
const char *ts_status_text(int32_t status);

/*
 Initialises a virtual wall as at power-up. Returns `TS_OUT_OF_RANGE` if the settings are refused, also for a guard with
 `law.guard.change = measured`: the wall gets one position a tick. The wall is then not initialised, and gives no force.
 */
ts_status ts_wall_init(ts_wall *wall,
                       ts_settings *settings);

/*
 Runs one control period of a virtual wall: takes the penetration, positive inside the wall, and gives the force that pushes out.
 Command the negative of the force along the angle, and hold it until the next call.
 */
ts_status ts_wall_tick(ts_wall *wall,
                       ts_position penetration,
                       ts_force *force);

/*
 Reports to the wall's estimator and energy guard the commanded force, if it was smaller than the force that `ts_wall_tick` gave.
 */
ts_status ts_wall_commanded(ts_wall *wall,
                            ts_force force);

/*
 Reports to the wall that the motor was switched off and that no call of `ts_wall_tick` follows until `ts_wall_resume`.
 */
ts_status ts_wall_switched_off(ts_wall *wall);

/*
 Resumes the wall when the motor is switched on again, with the same settings or changed ones. Estimator and control law start
 anew; the energy guard's account keeps its level. Refuses the same settings as `ts_wall_init`; nothing is then resumed.
 */
ts_status ts_wall_resume(ts_wall *wall,
                         ts_settings *settings);

/*
 Penetration into a wall whose surface is at the angle `surface` (rad): `2 pi count / counts_per_rev - surface`, limited to the
 range of `ts_position`. It is 0 if `counts_per_rev` is 0.
 */
ts_position ts_penetration(int64_t count,
                           uint32_t counts_per_rev,
                           ts_si surface);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* TOUCHSTONE_H */

#ifndef TS_NO_FLOAT
/* Conversions for firmware with a floating-point unit. Values outside -127 to 127 saturate; not-a-number gives 0. */
static inline int32_t ts_from_float(float si) {
  if (!(si == si)) return 0;
  if (si > 127.0f) si = 127.0f;
  if (si < -127.0f) si = -127.0f;
  return (int32_t)(si * 16777216.0f);
}
static inline float ts_to_float(int32_t digits) { return (float)digits / 16777216.0f; }
#endif
