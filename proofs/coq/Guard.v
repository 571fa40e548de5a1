(** The energy guard over the integers: what control/src/guard/mod.rs computes, with numbers of any size.

    Every number is an integer in quanta (smallest steps of the number format). A signal (position, force) has 24 fractional bits,
    a gain (stiffness) 12 and an energy 48, the product of two signals. A value is limited to its format only where the code's
    value can reach the limit. A quotient by a power of two is rounded down, as by [Z.div]. *)

Require Import ZArith Bool.
Open Scope Z_scope.

Definition signal_one : Z := 2 ^ 24.
Definition gain_one : Z := 2 ^ 12.
Definition highest_signal : Z := 2 ^ 31 - 1.

(** The coefficients; names and units are those of [Guard]. *)
Record guard : Set := {
  capacity : Z;    (* C, energy *)
  refill : Z;      (* P T, energy *)
  damping : Z;     (* c, gain *)
  furthest : Z;    (* the longest measured displacement that is not overspeed, position *)
  count : Z;       (* at least an encoder count delta, position *)
  late : Z;        (* s, fraction with a signal's fractional bits *)
  stray : Z;       (* kappa, compliance with a signal's fractional bits *)
  slack : Z;       (* half a count and the errors of rounding, position *)
  per_reach : Z;   (* 1/D, gain *)
  in_flight : Z;   (* s d + half a count, position *)
  overrun : Z      (* (1 + s)/4c, compliance with a signal's fractional bits *)
}.

(** The memory; [GuardState]. *)
Record memory : Set := { account : Z; force : Z; older : Z }.

Definition full (G : guard) : memory := {| account := capacity G; force := 0; older := 0 |}.

(** Energy that the trusted damping surely dissipated over a measured displacement of this size: [Guard::damped]. *)
Definition damped (G : guard) (distance : Z) : Z :=
  let surely := Z.max (distance - count G) 0 in
  damping G * surely / gain_one * surely.

(** Energy that a force may still cost after the next sample: [Guard::reserve]. *)
Definition reserve (G : guard) (f : Z) : Z := Z.abs f * in_flight G.

(** The largest force whose work over every displacement without overspeed this energy covers: [Guard::largest_force]. *)
Definition largest_force (G : guard) (free : Z) : Z := per_reach G * (free / signal_one) / gain_one.

(** The part of a displacement that counts under the old force. *)
Definition under_older (G : guard) (moved before_change change : Z) : Z :=
  before_change + (late G * (moved - before_change) + stray G * change) / signal_one.

(** The account's energy after a tick, before it is limited: [Guard::booked]. *)
Definition booked (G : guard) (s : memory) (moved before_change : Z) : Z :=
  let change := force s - older s in
  account s + refill G
  + force s * moved - change * under_older G moved before_change change
  - Z.abs change * slack G
  + damped G (Z.abs moved).

(** Energy in the account beyond the reserve: [free] of [Guard::step]. *)
Definition free (G : guard) (s : memory) (moved before_change : Z) : Z :=
  Z.max (Z.min (booked G s moved before_change) (capacity G) - reserve G (force s)) 0.

Definition within (x limit : Z) : Z := Z.max (Z.min x limit) (- limit).

(** A tick without overspeed, with an account that is not negative. *)
Definition ordinary (G : guard) (s : memory) (moved before_change wanted : Z) : memory :=
  let f := free G s moved before_change in
  {| account := f + reserve G (force s);
     force := within wanted (largest_force G f);
     older := force s |}.

(** With a negative account no force is allowed: [Guard::make_up]. *)
Definition make_up (G : guard) (s : memory) (moved : Z) : memory :=
  {| account := Z.min (account s + refill G + damped G (Z.abs moved)) (capacity G);
     force := 0; older := 0 |}.

(** The most energy that the last two forces can cost until they are off: [Guard::overrun]. *)
Definition lost (G : guard) (s : memory) : Z :=
  let size := Z.max (Z.abs (force s)) (Z.abs (older s)) in
  size * Z.min (Z.min (overrun G * size / signal_one) highest_signal + 1) highest_signal.

Definition after_overspeed (G : guard) (s : memory) : memory :=
  {| account := account s - lost G s; force := 0; older := 0 |}.

(** One tick: [Guard::tick_with_change], and with [before_change = 0] [Guard::tick]. The second result is false for overspeed. *)
Definition tick (G : guard) (s : memory) (moved before_change wanted : Z) : memory * bool :=
  if (furthest G <? Z.abs moved) || (furthest G <? Z.abs before_change)
  then (after_overspeed G s, false)
  else if account s <? 0 then (make_up G s moved, true)
  else (ordinary G s moved before_change wanted, true).

(** The force is switched off and no tick follows: [Guard::switched_off]. *)
Definition switched_off (G : guard) (s : memory) : memory :=
  {| account := if force s =? 0 then account s - reserve G (older s) else Z.min (account s) 0;
     force := 0; older := 0 |}.

(** The guard learns the force [told] that was finally commanded: [Guard::commanded]. A larger force than the allowed one counts
    as the allowed one. *)
Definition commanded (s : memory) (told : Z) : memory :=
  {| account := account s; force := within told (Z.abs (force s)); older := older s |}.
