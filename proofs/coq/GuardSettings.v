(** The coefficients that [Guard::new] computes from settings (control/src/guard/settings.rs) for the firmware's number format: a
    guard, or [None] if a value is refused ([accepted]). AcceptedIsValid.v proves that this guard satisfies the assumptions of the
    model checker's harnesses, AcceptedCovers.v that it covers the device that the settings describe, and AcceptedWindow.v its
    energy bound in joules.

    A setting is an integer in units of 2^-32 of its SI unit. The code's arithmetic of settings is written out here: products and
    quotients are rounded down, and results are limited to the largest number. compare.ml compares [made_of] with the code. *)

Require Import ZArith Bool.
From Touchstone Require Import Guard.
Open Scope Z_scope.

(** * The arithmetic of settings *)

Definition si_one : Z := 0x100000000.
Definition si_most : Z := 0x7fffffffffffffff.

Definition si_add (a b : Z) : Z := Z.min (a + b) si_most.
Definition si_mul (a b : Z) : Z := Z.min (a * b / si_one) si_most.
(** A quotient by zero or less is the largest number. *)
Definition si_over (a b : Z) : Z := if b <=? 0 then si_most else Z.min (a * si_one / b) si_most.

(** A signal has 24 fractional bits, a gain 12, an energy 48, a setting 32. A value that does not fit its word is refused. *)
Definition signal_of (x : Z) : Z := x / 2 ^ 8.
Definition gain_of (x : Z) : Z := x / 2 ^ 20.
Definition energy_of (x : Z) : Z := x * 2 ^ 16.
Definition signal_fits (x : Z) : bool := signal_of x <=? highest_signal.
Definition gain_fits (x : Z) : bool := gain_of x <=? highest_signal.
Definition energy_fits (x : Z) : bool := x <=? si_most / 2 ^ 16.
(** A value that enters the guard's sums must be at most a quarter of its format. *)
Definition quarter_fits (x : Z) : bool := signal_fits (si_mul x (4 * si_one)).

Definition signal_add (a b : Z) : Z := Z.min (a + b) highest_signal.
(** A position, rounded up. *)
Definition signal_up (x : Z) : Z := signal_add (signal_of x) 1.

Definition between (least x most : Z) : bool := (least <=? x) && (x <=? most).

(** * The settings, and the description of the device *)

Record settings : Set := {
  set_capacity : Z;    (* J *)
  set_refill : Z;      (* W *)
  set_share : Z;       (* trusted fraction of the damping *)
  set_damping : Z;     (* N m s/rad *)
  set_overspeed : Z;   (* rad/s *)
  set_delay : Z;       (* s *)
  set_lag : Z;         (* s *)
  set_measured : bool  (* whether the position is also read when the force changes *)
}.

Record told : Set := {
  told_rate : Z;   (* Hz, a whole number *)
  told_limit : Z;  (* largest force, N m *)
  told_count : Z   (* encoder count, rad *)
}.

(** Settings and device are type classes, so Coq infers them where they are not named, also in the proofs of other files. *)
Existing Class settings.
Existing Class told.

(** * Derived quantities *)

(** Added to a value that was rounded down, to make it an upper bound: more than the rounding errors of a sum of products and
    quotients. *)
Definition up_bits : Z := 8.
(** A quantum of a signal. *)
Definition step_bits : Z := 2 ^ 8.
(** The largest force for which the guard's sums have room, 31.9 N m. *)
Definition room_bits : Z := 137009456742.

Section Derived.

Context {S : settings} {T : told}.

Definition rate_of : Z := Z.min (told_rate T * si_one) si_most.
Definition tick_of : Z := si_over si_one rate_of.
Definition measured_of : Z := si_over (set_overspeed S) rate_of.
Definition refill_of : Z := si_over (set_refill S) rate_of.
Definition trusted_of : Z := si_mul (set_share S) (set_damping S).
Definition damping_of : Z := si_mul trusted_of rate_of.
(** The true displacement of a tick may be a count longer than the measured one. *)
Definition distance_of : Z := si_add (si_add measured_of (told_count T)) up_bits.
Definition reach_of : Z := si_add distance_of (told_count T).
Definition late_of : Z := si_mul (si_add (set_delay S) (set_lag S)) rate_of.

(** Roundings of displacements: a quantum and [up_bits] for that of the reserve, a quantum for each of the two measured
    positions. *)
Definition rounded_of : Z := si_add (si_add (si_add step_bits step_bits) step_bits) up_bits.
Definition per_reach_of : Z :=
  Z.min (si_over si_one (si_add reach_of rounded_of)) (si_over room_bits (set_capacity S)).
Definition largest_change_of : Z := si_mul (si_add (si_mul (set_capacity S) per_reach_of) up_bits) (2 * si_one).

(** [span_of] is the time in which the old force may still act, [mean_of] the mean time for which it does. *)
Definition span_of : Z := if set_measured S then tick_of - set_delay S else tick_of.
Definition mean_of : Z := if set_measured S then set_lag S else si_add (set_delay S) (set_lag S).
Definition share_of : Z := if 0 <? mean_of then Z.min (si_over mean_of span_of) si_one else 0.
Definition split_of : Z :=
  if 0 <? mean_of then si_add (si_mul share_of (Z.max (span_of - mean_of) 0)) up_bits else 0.
Definition stray_of : Z := if 0 <? split_of then si_over split_of (si_mul trusted_of (4 * si_one)) else 0.

Definition half_count : Z := told_count T / 2.
Definition left_out_of : Z := si_add (si_add largest_change_of distance_of) (set_overspeed S / 256).
(** Half a count plus what rounding leaves out: a quantum for each unit of [left_out_of] and one for the fraction of a unit.
    [slack_of] adds a quantum each for the position, for the part under the old force, and for a position that is measured at the
    change of force. *)
Definition half_count_up : Z := si_add half_count (step_bits * (Z.min (left_out_of / si_one) 0xffff + 1)).
Definition rounded_change : Z := if set_measured S then 1 else 0.
Definition slack_of : Z := signal_add (signal_add (signal_add (signal_up half_count_up) 1) 1) rounded_change.
Definition in_flight_of : Z :=
  if (0 <? set_delay S) || (0 <? set_lag S)
  then si_add (si_add (si_mul late_of distance_of) up_bits) half_count
  else half_count.
Definition overrun_of : Z :=
  let whole := si_over (si_add (si_add late_of up_bits) si_one) (si_mul damping_of (4 * si_one)) in
  if signal_fits whole then whole else 127 * si_one.

(** The checks of [validate], and every conversion that can be refused. *)
Definition fits : bool :=
  between 0 (set_capacity S) (16 * si_one) && between 0 (set_refill S) si_one &&
  between 0 (set_damping S) (1000 * si_one) && between 0 (set_share S) si_one &&
  between 4294967 (set_overspeed S) (1000 * si_one) &&
  between 0 (set_delay S) si_one && between 0 (set_lag S) si_one &&
  between 1 (told_rate T) 100000 && between 0 (told_limit T) (1000 * si_one) && between 0 (told_count T) 429496730 &&
  between 0 (set_delay S) tick_of && between 0 (set_lag S) (tick_of - set_delay S) &&
  signal_fits (told_limit T) && quarter_fits (set_capacity S) &&
  quarter_fits (si_mul damping_of distance_of) && quarter_fits distance_of && quarter_fits refill_of &&
  quarter_fits (si_mul stray_of largest_change_of) && signal_fits half_count_up &&
  quarter_fits (si_add in_flight_of rounded_of) &&
  energy_fits (set_capacity S) && energy_fits refill_of && gain_fits damping_of && signal_fits measured_of &&
  signal_fits (told_count T) && signal_fits share_of && signal_fits stray_of && gain_fits per_reach_of &&
  signal_fits in_flight_of.

Definition made : guard := {|
  capacity := energy_of (set_capacity S);
  refill := energy_of refill_of;
  damping := gain_of damping_of;
  furthest := signal_of measured_of;
  count := signal_add (signal_add (signal_up (told_count T)) 1) 1;
  late := signal_of share_of;
  stray := signal_of stray_of;
  slack := slack_of;
  per_reach := gain_of per_reach_of;
  in_flight := signal_add (signal_up in_flight_of) 1;
  overrun := signal_of overrun_of
|}.

(** [Guard::new] for settings whose delay and lag are at most a tick. *)
Definition accepted : option guard := if fits then Some made else None.

End Derived.

(** The claims name settings and device explicitly. *)
Arguments accepted : clear implicits.

(** * Delays of one last digit more than a tick *)

(** A delay is rounded to the nearest digit, but the tick is rounded down. So delay and lag may exceed a tick by one last digit.
    They are limited to the tick, and the theorems about [accepted] hold for the limited settings. *)
Definition cut (S : settings) (T : told) : settings :=
  let delay := Z.min (set_delay S) (@tick_of T) in
  {| set_capacity := set_capacity S; set_refill := set_refill S; set_share := set_share S; set_damping := set_damping S;
     set_overspeed := set_overspeed S; set_delay := delay; set_lag := Z.min (set_lag S) (@tick_of T - delay);
     set_measured := set_measured S |}.

(** [Guard::new]. *)
Definition made_of (S : settings) (T : told) : option guard :=
  if between 0 (set_delay S) (Z.min si_one (@tick_of T + 1)) && between 0 (set_lag S) (Z.min si_one (@tick_of T + 1 - set_delay S))
  then accepted (cut S T) T else None.
