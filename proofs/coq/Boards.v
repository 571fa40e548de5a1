(** The guards that boards ship with: they read the encoder once more in a tick, when the force changes. The coefficients are those that
    [Guard::new] makes of each board's default settings and of what its current loop makes of the delay (compared by
    tests/tests/guards_of_boards.rs); they cover the device that the settings describe, and the theorem comes to the same for all.

    45 mJ, 60 rad/s, 1 kHz, 16,384 counts. *)

Require Import ZArith QArith Qabs Qminmax Lqa List.
From Touchstone Require Import Guard Port GuardLosesNothing Shipped.
Open Scope Q_scope.

Definition of_board (refill_ damping_ late_ stray_ in_flight_ overrun_ : Z) : guard := {|
  capacity := 12666373931008;
  refill := refill_;
  damping := damping_;
  furthest := 1006632;
  count := 6436;
  late := late_;
  stray := stray_;
  slack := 3221;
  per_reach := 67404;
  in_flight := in_flight_;
  overrun := overrun_
|}.

(* a gimbal motor on the IHM08M1 or the B-G431B-ESC1, the motor of the IHM16M1's kit, and a motor without current sensors *)
Definition gimbal : guard := of_board 140705792 1310 454968 257577 282217 16716923.
Definition kit : guard := of_board 166068224 29 454968 11447802 282217 742968423.
Definition mini : guard := of_board 166068224 29 401406 12980451 72867 622587124.

(** 0.06 rad in a tick; a count of 2 pi/16,384 as set and a quantum of rounding at either end; of the damping over a tick, the share that
    is trusted; delay and lag in settings' digits, of a tick of a millisecond. *)
Definition told (damping_per_tick : Q) (delay lag : Z) : device :=
  let tick := 4294967296 # 1000 in
  let rest := lag / (tick - delay) in
  {|
    c := damping_per_tick;
    s := (delay + lag) / tick;
    r := rest;
    d := (6 # 100) * inject_Z (2 ^ 24);
    delta := (1647100 # 256) + 2;
    kappa := lag / tick * (1 - rest) / (4 * damping_per_tick);
    way_after := (6 # 100) * inject_Z (2 ^ 24);
    rough := 1
  |}.

Definition gimbal_device : device := told (32 # 100) 1096084 86748.
Definition kit_device : device := told (72 # 10000) 1096084 86748.
Definition mini_device : device := told (72 # 10000) 197237 98041.

Theorem gimbal_covers : covers gimbal gimbal_device. Proof. by_numbers. Qed.
Theorem kit_covers : covers kit kit_device. Proof. by_numbers. Qed.
Theorem mini_covers : covers mini mini_device. Proof. by_numbers. Qed.

(** In a window of [n] ticks any hand gets out at most 45.145 mJ + n 0.00059 mJ, with any law before the guard, whatever was before. *)
Theorem board_window (G : guard) (D : device) (error0 : Q) (before window : list event) (early rest damped : Q) :
  In (G, D) ((gimbal, gimbal_device) :: (kit, kit_device) :: (mini, mini_device) :: nil) ->
  Qabs error0 <= delta D * (1 # 2) ->
  let begin := run G (power_up G error0) before in
  let w := run G begin window in
  all_may_precede G D (power_up G error0) before ->
  all_possible G D begin window ->
  Qabs early <= s D * d D -> Qabs rest <= (1 - s D) * d D -> 0 <= damped ->
  let port_took := taken w - taken begin + older (memory_of w) * early + force (memory_of w) * rest + damped in
  microjoules (- port_took) <= 45145 + (59 # 100) * inject_Z (Z.of_nat (length window)).
Proof.
  intros H E0 begin w Hb Hw He Hr Hd port_took.
  assert (K : covers G D /\ microjoules (capacity G + largest G * (delta D * (1 # 2))) <= 45145
              /\ microjoules (refill G) <= 59 # 100).
  { destruct H as [H|[H|[H|[]]]]; injection H as <- <-; (split; [|split; vm_compute; discriminate]).
    - exact gimbal_covers.
    - exact kit_covers.
    - exact mini_covers. }
  destruct K as (K & C1 & C2). exact (window_in_microjoules G D _ _ _ _ _ _ _ _ K C1 C2 E0 Hb Hw He Hr Hd).
Qed.
