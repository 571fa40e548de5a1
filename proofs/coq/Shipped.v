(** The shipped guards: the coefficients that [Guard::new] computes from the default settings at four delays (compared by
    proofs/tests/spec_guard.rs). They cover the device that the settings describe, and the theorem's bound for them is given in
    microjoules.

    The settings: capacity 45 mJ, refill 0.5 mW, trusted damping 80 % of 4e-4 N m s/rad, overspeed 60 rad/s, control rate 1 kHz,
    40,000 encoder counts a turn. *)

Require Import ZArith QArith Qabs Qminmax Lqa List.
From Touchstone Require Import Guard Port GuardLosesNothing.
Open Scope Q_scope.

Definition shipped (late_ stray_ in_flight_ overrun_ : Z) : guard := {|
  capacity := 12666373931008;
  refill := 140705792;
  damping := 1310;
  furthest := 1006632;
  count := 2638;
  late := late_;
  stray := stray_;
  slack := 1322;
  per_reach := 67910;
  in_flight := in_flight_;
  overrun := overrun_
|}.

(* delay 0 as shipped, and delays of 0.1, 0.5 and 1 ms *)
Definition at_once : guard := shipped 0 0 1319 13107205.
Definition tenth : guard := shipped 1677722 1179672 102246 14417926.
Definition half : guard := shipped 8388609 3276823 505953 19660808.
Definition whole : guard := shipped 16777216 24 1010587 26214409.

(** The knob with a delay of [s] ticks: at most 0.06 rad in a tick, a trusted damping over a tick of 0.32 N m/rad. A displacement
    is wrong by at most one encoder count, 2 pi/40,000 rad, and one quantum of rounding at each end. *)
Definition knob (s : Q) : device := {|
  c := 32 # 100;
  s := s;
  r := s;
  d := (6 # 100) * inject_Z (2 ^ 24);
  delta := 26375 # 10;
  kappa := s * (1 - s) / (4 * (32 # 100));
  way_after := inject_Z 1006632;
  rough := 0
|}.

Ltac by_numbers := constructor; repeat split; vm_compute; discriminate.

Theorem at_once_covers : covers at_once (knob 0). Proof. by_numbers. Qed.
Theorem tenth_covers : covers tenth (knob (1 # 10)). Proof. by_numbers. Qed.
Theorem half_covers : covers half (knob (1 # 2)). Proof. by_numbers. Qed.
Theorem whole_covers : covers whole (knob 1). Proof. by_numbers. Qed.

(** If a force changes in one step after the fraction [s_] of a tick, this knob satisfies [acts_late] with that fraction. So it
    does if a current loop's step response has the mean [s_] (current_loop_acts_late). *)
Theorem knob_acts_late (s_ early rest d1 d2 : Q) :
  0 <= s_ <= 1 ->
  let D := knob s_ in
  part_of_tick (c D) s_ early d1 -> part_of_tick (c D) (1 - s_) rest d2 ->
  Qabs early <= s_ * d D -> Qabs rest <= (1 - s_) * d D ->
  acts_late (c D) (s D) (d D) (kappa D) (s_ * (early + rest)) early rest (d1 + d2).
Proof.
  intros Hs D P1 P2 He Hr. apply pure_delay_acts_late; cbn in *; try assumption; try lra.
  - apply Qle_shift_div_l; [reflexivity|]. assert (0 <= s_ * (1 - s_)) by (apply times_nonneg; lra). lra.
  - assert (E : 4 * (32 # 100) * (s_ * (1 - s_) / (4 * (32 # 100))) == s_ * (1 - s_)) by (field; discriminate).
    rewrite E. lra.
Qed.

(** A quantum of energy is 2^-48 J. *)
Definition microjoules (quanta : Q) : Q := quanta * 1000000 / inject_Z (2 ^ 48).

(** [any_window_by_settings] in microjoules: [most] bounds its constant terms, [per_tick] the refill of a tick. *)
Lemma window_in_microjoules (G : guard) (D : device) (most per_tick : Q) (error0 : Q) (before window : list event)
    (early rest damped : Q) :
  covers G D ->
  microjoules (capacity G + largest G * (delta D * (1 # 2))) <= most -> microjoules (refill G) <= per_tick ->
  Qabs error0 <= delta D * (1 # 2) ->
  let begin := run G (power_up G error0) before in
  let w := run G begin window in
  all_may_precede G D (power_up G error0) before ->
  all_possible G D begin window ->
  Qabs early <= s D * d D -> Qabs rest <= (1 - s D) * d D -> 0 <= damped ->
  let port_took := taken w - taken begin + older (memory_of w) * early + force (memory_of w) * rest + damped in
  microjoules (- port_took) <= most + per_tick * inject_Z (Z.of_nat (length window)).
Proof.
  intros K C1 C2 E0 begin w Hb Hw He Hr Hd port_took.
  pose proof (any_window_by_settings G D K error0 before window early rest damped E0 Hb Hw He Hr Hd) as B.
  cbn zeta in B. fold begin w port_took in B.
  set (n := inject_Z (Z.of_nat (length window))) in *.
  assert (N : 0 <= n) by (unfold n; change 0 with (inject_Z 0); rewrite <- Zle_Qle; apply Zle_0_nat).
  unfold microjoules in *.
  set (A := capacity G + largest G * (delta D * (1 # 2))) in *.
  set (R := inject_Z (refill G)) in *.
  assert (T : (1000000 / inject_Z (2 ^ 48)) * - port_took <= (1000000 / inject_Z (2 ^ 48)) * (A + R * n)).
  { assert (0 <= 1000000 / inject_Z (2 ^ 48)) by (vm_compute; discriminate). unfold A. nra. }
  assert (T2 : R * 1000000 / inject_Z (2 ^ 48) * n <= per_tick * n) by nra.
  unfold Qdiv in *. lra.
Qed.

(** In a window of [n] ticks any hand gets out at most 45.059 mJ + n 0.0005 mJ, with any law before the guard, at each of these
    delays, whatever happened before the window. *)
Theorem shipped_window (G : guard) (D : device) (error0 : Q) (before window : list event) (early rest damped : Q) :
  In (G, D) ((at_once, knob 0) :: (tenth, knob (1 # 10)) :: (half, knob (1 # 2)) :: (whole, knob 1) :: nil) ->
  Qabs error0 <= delta D * (1 # 2) ->
  let begin := run G (power_up G error0) before in
  let w := run G begin window in
  all_may_precede G D (power_up G error0) before ->
  all_possible G D begin window ->
  Qabs early <= s D * d D -> Qabs rest <= (1 - s D) * d D -> 0 <= damped ->
  let port_took := taken w - taken begin + older (memory_of w) * early + force (memory_of w) * rest + damped in
  microjoules (- port_took) <= 45059 + (1 # 2) * inject_Z (Z.of_nat (length window)).
Proof.
  intros H E0 begin w Hb Hw He Hr Hd port_took.
  assert (K : covers G D /\ microjoules (capacity G + largest G * (delta D * (1 # 2))) <= 45059
              /\ microjoules (refill G) <= 1 # 2).
  { destruct H as [H|[H|[H|[H|[]]]]]; injection H as <- <-; (split; [|split; vm_compute; discriminate]).
    - exact at_once_covers.
    - exact tenth_covers.
    - exact half_covers.
    - exact whole_covers. }
  destruct K as (K & C1 & C2). exact (window_in_microjoules G D _ _ _ _ _ _ _ _ K C1 C2 E0 Hb Hw He Hr Hd).
Qed.
