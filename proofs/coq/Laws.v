(** TDPA (thesis 2.1 to 2.6) and FBA (thesis 2.6a to 2.10) over the integers: what control/src/law/tdpa.rs and fba.rs compute.
    Numbers are integers in quanta (smallest steps of the number format), as in Guard.v. *)

Require Import ZArith Bool.
From Touchstone Require Import Guard.
Open Scope Z_scope.

Definition lowest_signal : Z := - 2 ^ 31.
Definition lowest_energy : Z := - 2 ^ 63.
Definition energy_cap : Z := 2 ^ 62.

(** The force [k e], rounded towards zero and limited to the format. *)
Definition spring (k e : Z) : Z := within (Z.quot (k * e) gain_one) highest_signal.

(** The energy [c moved^2] that a damper dissipates over one displacement; its force is rounded towards zero. *)
Definition damping_loss (c moved : Z) : Z := spring c moved * moved.

(** The memory of both laws inside the wall. Outside the wall every value is 0. *)
Record observed : Set := { shown : Z; energy : Z; inside : bool }.
Definition outside : observed := {| shown := 0; energy := 0; inside := false |}.

(** * TDPA *)

Record tdpa : Set := {
  t_desired : Z;   (* k_de, gain *)
  exact : bool;    (* energy from the last force f(n-1), as at the port; else from the new force f(n), thesis (2.1) *)
  t_damping : Z;   (* c_i/T, gain *)
  t_limit : Z      (* force *)
}.

(** Thesis (2.1) to (2.4): the force with which the energy sum is not negative, and the new sum. *)
Definition thesis_step (e wanted moved : Z) : Z * Z :=
  let force := if 0 <=? e + wanted * moved then wanted else e / - moved in
  (force, Z.min (e + force * moved) energy_cap).

(** The exact observer's force: a deficit is corrected under the assumption that the next displacement equals the last. *)
Definition exact_step (L : tdpa) (e wanted moved : Z) : Z :=
  let enough := Z.min (Z.abs e / Z.abs moved) highest_signal in
  let force := if (moved =? 0) || (0 <=? e + wanted * moved) then wanted
               else if (e <? 0) && (moved <? 0) then - enough else enough in
  Z.max (Z.min force (t_limit L)) (Z.max (- t_limit L) lowest_signal).

Definition tdpa_tick (L : tdpa) (m : observed) (e moved_ : Z) : observed :=
  if e <=? 0 then outside
  else
    let moved := Z.min moved_ e in
    let wanted := Z.min (spring (t_desired L) e) (t_limit L) in
    let loss := damping_loss (t_damping L) moved in
    if exact L then
      let e' := Z.min (Z.max (Z.max (energy m + shown m * moved) lowest_energy + loss) lowest_energy) energy_cap in
      {| shown := exact_step L e' wanted moved; energy := e'; inside := true |}
    else
      let (force, e') := thesis_step (Z.min (energy m + loss) energy_cap) wanted moved in
      {| shown := force; energy := e'; inside := true |}.

(** * FBA *)

Record fba : Set := {
  f_desired : Z;   (* k_de, gain *)
  f_damping : Z;   (* c_i/T, gain *)
  f_limit : Z      (* force *)
}.

(** [sqrt(4 c_i/T)], rounded down, with the fractional bits of a gain. *)
Definition bound (c : Z) : Z := Z.sqrt (4 * c * gain_one).

(** Thesis (2.7a): the largest force that an energy allows. *)
Definition allowed (c e : Z) : Z :=
  Z.min (bound c * Z.min (Z.sqrt e) highest_signal / gain_one) highest_signal.

Definition fba_tick (L : fba) (m : observed) (e moved_ : Z) : observed :=
  if e <=? 0 then outside
  else
    let moved := Z.min moved_ e in
    let e' := Z.min (energy m + shown m * moved + damping_loss (f_damping L) moved) energy_cap in
    let wanted := Z.min (spring (f_desired L) e) (f_limit L) in
    {| shown := Z.min wanted (allowed (f_damping L) e'); energy := e'; inside := true |}.
