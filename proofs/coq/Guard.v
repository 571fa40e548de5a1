(** The energy guard over the integers: what control/src/guard/mod.rs computes, with numbers of any size.

    Every number is a count of quanta. A signal (position, force) has 24 fractional bits, a gain (stiffness) 12 and an energy
    48, the product of two signals. Nothing saturates here but where the code says so and it can happen. A quotient by a power
    of two is rounded down, as [Z.div] does. *)

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
  count : Z;       (* at least delta, position *)
  late : Z;        (* s, ratio with a signal's digits *)
  stray : Z;       (* kappa, compliance with a signal's digits *)
  slack : Z;       (* half a count and what rounding leaves out, position *)
  per_reach : Z;   (* 1/D, gain *)
  in_flight : Z;   (* s d + half a count, position *)
  overrun : Z      (* (1 + s)/4c, compliance with a signal's digits *)
}.

(** The memory; [GuardState]. *)
Record memory : Set := { account : Z; force : Z; older : Z }.

Definition full (G : guard) : memory := {| account := capacity G; force := 0; older := 0 |}.

(** What the trusted damping took over a displacement of this size: [Guard::damped]. *)
Definition damped (G : guard) (distance : Z) : Z :=
  let surely := Z.max (distance - count G) 0 in
  damping G * surely / gain_one * surely.

(** What a force may still cost after the next sample: [Guard::reserve]. *)
Definition reserve (G : guard) (f : Z) : Z := Z.abs f * in_flight G.

(** The largest force that so much energy pays for over every displacement: [Guard::largest_force]. *)
Definition largest_force (G : guard) (free : Z) : Z := per_reach G * (free / signal_one) / gain_one.

(** The part of a displacement that is booked under the old force. *)
Definition under_older (G : guard) (moved before_change change : Z) : Z :=
  before_change + (late G * (moved - before_change) + stray G * change) / signal_one.

(** The account after a tick, before its ends: [Guard::booked]. *)
Definition booked (G : guard) (s : memory) (moved before_change : Z) : Z :=
  let change := force s - older s in
  account s + refill G
  + force s * moved - change * under_older G moved before_change change
  - Z.abs change * slack G
  + damped G (Z.abs moved).

(** What is left over the reserve: [free] of [Guard::step]. *)
Definition free (G : guard) (s : memory) (moved before_change : Z) : Z :=
  Z.max (Z.min (booked G s moved before_change) (capacity G) - reserve G (force s)) 0.

Definition within (x limit : Z) : Z := Z.max (Z.min x limit) (- limit).

(** A tick that is no overspeed, with an account that is no deficit. *)
Definition ordinary (G : guard) (s : memory) (moved before_change wanted : Z) : memory :=
  let f := free G s moved before_change in
  {| account := f + reserve G (force s);
     force := within wanted (largest_force G f);
     older := force s |}.

(** With a deficit no force is shown: [Guard::make_up]. *)
Definition make_up (G : guard) (s : memory) (moved : Z) : memory :=
  {| account := Z.min (account s + refill G + damped G (Z.abs moved)) (capacity G);
     force := 0; older := 0 |}.

(** What the forces that acted can have lost at most until they are off: [Guard::overrun]. *)
Definition lost (G : guard) (s : memory) : Z :=
  let size := Z.max (Z.abs (force s)) (Z.abs (older s)) in
  size * Z.min (Z.min (overrun G * size / signal_one) highest_signal + 1) highest_signal.

Definition after_overspeed (G : guard) (s : memory) : memory :=
  {| account := account s - lost G s; force := 0; older := 0 |}.

(** One tick: [Guard::tick_with_change], and with [before_change = 0] [Guard::tick]. The flag: no overspeed. *)
Definition tick (G : guard) (s : memory) (moved before_change wanted : Z) : memory * bool :=
  if (furthest G <? Z.abs moved) || (furthest G <? Z.abs before_change)
  then (after_overspeed G s, false)
  else if account s <? 0 then (make_up G s moved, true)
  else (ordinary G s moved before_change wanted, true).

(** The force is switched off and no tick follows: [Guard::switched_off]. *)
Definition switched_off (G : guard) (s : memory) : memory :=
  {| account := if force s =? 0 then account s - reserve G (older s) else Z.min (account s) 0;
     force := 0; older := 0 |}.

(** What is told of the force in the end: [Guard::commanded]. *)
Definition commanded (s : memory) (told : Z) : memory :=
  {| account := account s; force := within told (Z.abs (force s)); older := older s |}.
